"""A choice of drives that carry each other: the mass of each loads the joints before it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, Literal

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from puma_septic.cycle import Cycle, Dwell
from puma_septic.drives import Catalogue
from puma_septic.errors import InputError
from puma_septic.motion import compute_motion
from puma_septic.robot import Robot
from puma_septic.sizing._conditions import Conditions
from puma_septic.sizing._drivetrains import GivenDrivetrains, checked_drivetrains
from puma_septic.sizing._joint_selection import JointSelection, Rank, select_joint
from puma_septic.sizing._load_cases import LoadCase, joint_cases
from puma_septic.sizing._selection import Selection, checked_rank, select
from puma_septic.validation import Array, checked_array, checked_choice, checked_kind

__all__ = ["PLACEMENTS", "Placement", "select_consistent", "with_drive_masses"]

Placement = Literal["before", "at"]
PLACEMENTS: Final[tuple[Placement, ...]] = ("before", "at")
# A joint that carries its own drive settles at once or swings between few candidates.
_MOST_ROUNDS: Final = 8


def with_drive_masses(robot: Robot, masses: ArrayLike, *, placement: Placement = "before") -> Robot:
    """The arm with a point mass at each joint's origin.

    Parameters
    ----------
    robot : Robot
    masses : array_like, shape (n_joints,)
        kg; negative to take off what is there already.
    placement : {"before", "at"}
        On the link before the joint, so that the joint does not carry its own drive, or on the link that it moves.

    Raises
    ------
    InputError
        If a link's mass would become negative.
    """
    added = checked_array("masses", masses, (checked_kind("robot", robot, Robot).n_joints,), unit="kg")
    checked_choice("placement", placement, ("before", "at"))
    model = robot.bare_model.copy()
    for name, mass in zip(robot.joint_names, added.tolist(), strict=True):
        joint = model.getJointId(name)
        link = model.parents[joint] if placement == "before" else joint
        point = model.jointPlacements[joint].translation if placement == "before" else np.zeros(3)
        unit = pin.Inertia(1.0, point, np.zeros((3, 3))).toDynamicParameters()
        # Mass, first and second moments are sums: a negative mass takes its part off.
        total = model.inertias[link].toDynamicParameters() + mass * unit
        if link and total[0] < 0:
            raise InputError(f"joint {name!r}: taking {-mass:g} kg off leaves its link with {total[0]:.4g} kg")
        if link and mass:
            model.inertias[link] = pin.Inertia.FromDynamicParameters(total)
    return replace(robot, bare_model=model)


def select_consistent(
    cases: tuple[LoadCase, ...],
    catalogue: Catalogue,
    *,
    placement: Placement = "before",
    own_masses: ArrayLike | None = None,
    rank: Rank = "mass",
    keep: int | None = 5,
    places: GivenDrivetrains | None = None,
    conditions: Conditions | None = None,
    same: Sequence[Sequence[str]] = (),
) -> Selection:
    """Choose with each drive's mass on the arm when the joints before it are chosen.

    A joint's torque depends on what lies beyond it. With drives on the link before their joint, one pass from the wrist
    to the base is therefore consistent; a joint that carries its own drive is chosen again until its choice stays, and
    so are all joints where some are to have one size. Pairs of unknown mass count as weightless.

    Parameters
    ----------
    cases : tuple of LoadCase
    catalogue : Catalogue
    placement : {"before", "at"}
    own_masses : array_like, shape (n_joints,), optional
        Of the drives that the arm's model includes, kg, taken off first; none by default.
    rank, keep, places, conditions, same
        See `size`.
    """
    names = cases[0].cycle.joint_names
    n = len(names)
    checked_rank(rank, keep)
    asked = Conditions() if conditions is None else conditions
    given = asked.places(names, None if places is None else checked_drivetrains(cases[0].cycle, places))
    own = np.zeros(n) if own_masses is None else checked_array("own_masses", own_masses, (n,), unit="kg")
    masses, notes = np.zeros(n), [f"masses of the chosen drives on the link {_WORDS[placement]} each joint"]
    joints: dict[int, JointSelection] = {}
    loaded = _loaded(cases, masses - own, placement)
    for j in _from_the_tip(cases[0].cycle.robot):
        seen: list[float] = []
        for _ in range(_MOST_ROUNDS):
            joints[j] = select_joint(
                joint_cases(loaded, j), catalogue, j, rank=rank, keep=keep, places=given, conditions=asked
            )
            seen.append(_mass(joints[j]))
            if masses[j] == seen[-1]:
                break
            masses[j] = seen[-1]
            loaded = _loaded(cases, masses - own, placement)
            if placement == "before":
                break
        else:
            tried = ", ".join(f"{mass:g}" for mass in seen)
            notes.append(f"{joints[j].joint}: did not settle in {_MOST_ROUNDS} rounds (masses tried: {tried} kg)")
    if any(np.isnan(one.best.mass) for one in joints.values() if one.best is not None):
        notes.append("chosen pairs of unknown mass count as weightless")
    found = Selection(
        load_cases=loaded,
        catalogue=catalogue,
        rank=rank,
        joints=tuple(joints[j] for j in range(n)),
        conditions=asked,
        notes=tuple(notes),
    )
    if same:
        found = _with_common_sizes(found, cases, own, placement, same)
    added = np.array([_mass(one) for one in found.joints]) - own
    told = "masses added: " + ", ".join(f"{mass:g}" for mass in added.tolist()) + " kg"
    return replace(found, notes=(*found.notes, told))


def _from_the_tip(robot: Robot) -> list[int]:
    """Joints, each after all that it carries, whatever order the URDF's text has them in.

    Pinocchio counts a joint behind those that carry it.
    """
    return sorted(range(robot.n_joints), key=lambda j: -int(robot.model.getJointId(robot.joint_names[j])))


def _with_common_sizes(
    found: Selection, cases: tuple[LoadCase, ...], own: Array, placement: Placement, same: Sequence[Sequence[str]]
) -> Selection:
    """Choose all joints again on the arm with the last choice, until the choice stays."""
    keep = max(1, *(len(one.kept) for one in found.joints))
    for _ in range(_MOST_ROUNDS):
        before = np.array([_mass(one) for one in found.joints])
        loaded = _loaded(cases, before - own, placement)
        again = select(
            loaded, found.catalogue, rank=found.rank, keep=keep, places=found.joints[0].places,
            conditions=found.conditions, same=same,
        )  # fmt: skip
        found = replace(again, notes=(*found.notes[:1], *again.notes))
        if [_mass(one) for one in found.joints] == before.tolist():
            return found
    return replace(found, notes=(*found.notes, f"the common sizes did not settle in {_MOST_ROUNDS} rounds"))


_WORDS: Final = {"before": "before", "at": "moved by"}


def _mass(one: JointSelection) -> float:
    return 0.0 if one.best is None else float(np.nan_to_num(one.best.mass))


def _loaded(cases: tuple[LoadCase, ...], masses: Array, placement: Placement) -> tuple[LoadCase, ...]:
    """The load cases with masses on their arm."""
    if not masses.any():
        return cases
    return tuple(replace(case, cycle=_loaded_cycle(case.cycle, masses, placement)) for case in cases)


def _loaded_cycle(cycle: Cycle, masses: Array, placement: Placement) -> Cycle:
    return Cycle(
        steps=tuple(
            step
            if isinstance(step, Dwell)
            else compute_motion(with_drive_masses(step.robot, masses, placement=placement), step.trajectory)
            for step in cycle.steps
        )
    )
