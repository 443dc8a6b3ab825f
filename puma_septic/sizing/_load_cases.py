"""Load cases: the cycles that the same drives must do, each with its share of the operating time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, final

import numpy as np

from puma_septic.assessment import assess
from puma_septic.cycle import Cycle
from puma_septic.drives import Drivetrain
from puma_septic.errors import InputError
from puma_septic.limit_check import LimitCheck
from puma_septic.motion import Motion, compute_motion
from puma_septic.profiles import quintic_segments
from puma_septic.robot import Robot
from puma_septic.sizing._checks import NotAssessed, Outcome, assess_joint
from puma_septic.sizing._demands import Demands
from puma_septic.sizing._load_features import LoadGrid, load_grid
from puma_septic.sizing._loads import JointLoad, gearbox_load, joint_load, motor_load
from puma_septic.validation import Array, checked_flag, checked_kind, checked_number, checked_texts
from puma_septic.worst_case import worst_holding_torque

__all__ = [
    "LIFE",
    "RARE_CHECKS",
    "JointCase",
    "LoadCase",
    "checked_cases",
    "joint_cases",
    "life_of_mix",
    "outcomes_of_cases",
    "position_remarks",
    "shared_life",
    "shortest_cycle",
    "with_brakes",
    "worst_outcome",
    "worst_poses",
]

# A joint that holds less than this part of the largest torque, as one about an upright axis, has no worst pose.
_HOLDS: Final = 1e-3
_GAP: Final = 0.05


def worst_poses(robot: Robot, duration: float) -> Iterator[tuple[str, Cycle]]:
    """Each joint that gravity loads, and the arm held where that joint holds most within its limits.

    Returns
    -------
    iterator of (str, Cycle)
    """
    worst = worst_holding_torque(robot, gap=_GAP)
    for joint, pose, torque in zip(robot.joint_names, worst.poses, worst.attained, strict=True):
        if torque > _HOLDS * worst.attained.max():
            still = quintic_segments(np.array([pose, pose]), [0.0, duration], joint_names=robot.joint_names)
            yield joint, Cycle(steps=(compute_motion(robot, still),))


def position_remarks(cycle: Cycle) -> tuple[str, ...]:
    """One remark that names the joints whose position limits a motion of the cycle violates; empty where none does."""
    motions = [step for step in cycle.steps if isinstance(step, Motion)]
    beyond = {check.joint for motion in motions for check in assess(motion).violations if check.quantity == "position"}
    if not beyond:
        return ()
    names = ", ".join(name for name in cycle.joint_names if name in beyond)
    return (f"whatever the drives, the motion itself violates the position limits of {names}",)


LIFE: Final = "gearbox life"
RARE_CHECKS: Final = frozenset(
    {
        "actuator effort at the joint", "motor torque", "motor torque at speed", "voltage at torque and speed",
        "motor speed", "peak current", "gearbox momentary peak torque", "gearbox input speed",
    }
)  # fmt: skip
"""The checks of a rare event, such as an emergency stop: of peaks, and of the gearbox the momentary one."""
_UNPOWERED: Final = frozenset({"gearbox momentary peak torque"})


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LoadCase:
    """A cycle that the drives must do.

    Parameters
    ----------
    name : str
        Cases that concern different joints may have the same.
    cycle : Cycle
    share : float
        Of the operating time, relative to the other cases; it counts for the life of the gearboxes and for energy. 0: a
        case that is to be kept, but takes no time, as a worst pose.
    joints : tuple of str
        Whom it concerns; all joints where empty.
    is_rare : bool
        An emergency stop: its peaks are held against what parts bear rarely, its means against nothing.
    is_powered : bool
        Of a rare case: whether the motors do it, and not the brakes.
    note : str
        What more a reader wants to know.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> cases = [
    ...     LoadCase(name=f"{m} kg", cycle=ps.cycle.with_return(
    ...         ps.compute_motion(robot.with_payload(ps.Payload(mass=m)), move)), share=share)
    ...     for m, share in ((0.0, 0.7), (2.5, 0.3))]
    >>> ps.size(cases).governing.case
    '2.5 kg'
    """

    name: str
    cycle: Cycle
    share: float = 1.0
    joints: tuple[str, ...] = ()
    is_rare: bool = False
    is_powered: bool = True
    note: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.cycle, Cycle):
            raise InputError(f"load case {self.name!r}: expected a Cycle, got {type(self.cycle).__name__}")
        for text in ("name", "note"):
            checked_kind(f"{text} of a load case", getattr(self, text), str)
        object.__setattr__(self, "joints", checked_texts(f"joints of load case {self.name!r}", self.joints))
        share = checked_number(f"share of load case {self.name!r}", self.share, at_least=0.0)
        object.__setattr__(self, "share", share)
        for flag in ("is_rare", "is_powered"):
            object.__setattr__(self, flag, checked_flag(f"{flag} of load case {self.name!r}", getattr(self, flag)))
        for joint in self.joints:
            if joint not in self.cycle.joint_names:
                valid = ", ".join(self.cycle.joint_names)
                raise InputError(f"load case {self.name!r}: unknown joint {joint!r}; valid: {valid}")

    @property
    def only(self) -> frozenset[str] | None:
        """The checks that count; None: all."""
        return (RARE_CHECKS if self.is_powered else _UNPOWERED) if self.is_rare else None


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class JointCase:
    """A load case at one joint (the cache needs a ``__dict__``, hence no slots).

    Attributes
    ----------
    name : str
    share : float
        Of the operating time, of all cases 1.
    load : JointLoad
    only : frozenset of str or None
        The checks that count; None: all.
    """

    name: str
    share: float
    load: JointLoad
    only: frozenset[str] | None = None

    @cached_property
    def grid(self) -> LoadGrid:
        """Prepared for many drive trains."""
        return load_grid(self.load)

    @cached_property
    def peak_torque(self) -> float:
        """At the gearbox's output, N m (N)."""
        return float(self.load.torque.extrema().peak[0])

    @property
    def momentary_torque(self) -> float:
        """What a rare case asks of the gearbox, N m (N); NaN of any other."""
        return np.nan if self.only is None else self.peak_torque

    @property
    def is_braked(self) -> bool:
        """Whether a holding brake is used, which the motor must then have."""
        return bool(self.load.braked.any())

    def through(self, train: Drivetrain) -> JointCase:
        """The same as the gearbox of a drive train sees it: behind a sliding joint's stage."""
        load = gearbox_load(self.load, train)
        return self if load is self.load else replace(self, load=load)

    def demands(self, train: Drivetrain) -> Demands:
        """What the case asks of a drive train."""
        if self.only is not None:
            train = replace(train, momentary_torque=float(np.fmax(train.momentary_torque, self.peak_torque)))
        return Demands(load=self.load, train=train, motor=motor_load(self.load, train))


def checked_cases(what: object) -> tuple[LoadCase, ...]:
    """Load cases of one arm, or a cycle as the only one.

    Raises
    ------
    InputError
        For anything else, a name that occurs twice, cases of different arms, or of no time at all.
    """
    if isinstance(what, Cycle):
        return (LoadCase(name="", cycle=what),)
    cases = tuple(what) if isinstance(what, Iterable) and not isinstance(what, (str, np.ndarray)) else ()
    if not cases or not all(isinstance(case, LoadCase) for case in cases):
        raise InputError(
            f"size takes a Cycle or a sequence of LoadCase, got {type(what).__name__}; Cycle(steps=[motion]) makes one"
            " of a motion"
        )
    names = [(case.name, joint) for case in cases for joint in case.joints or case.cycle.joint_names]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise InputError(f"load case {twice[0]!r} occurs twice; each needs a name of its own")
    arms = {case.cycle.joint_names for case in cases}
    if len(arms) > 1:
        raise InputError(f"load cases of one arm; got joints {' and '.join(', '.join(arm) for arm in sorted(arms))}")
    if not any(case.share for case in cases):
        raise InputError("no load case has a share of the operating time; give at least one a share above 0")
    if cases[0].joints or cases[0].is_rare:
        raise InputError(f"load case {cases[0].name!r}: the first one must concern all joints, and not be a rare one")
    return cases


def joint_cases(cases: tuple[LoadCase, ...], j: int) -> tuple[JointCase, ...]:
    """The cases that concern joint j."""
    total = sum(case.share for case in cases)
    return tuple(
        JointCase(name=case.name, share=case.share / total, load=joint_load(case.cycle, j), only=case.only)
        for case in cases
        if not case.joints or case.cycle.joint_names[j] in case.joints
    )


def shortest_cycle(cases: Iterable[JointCase]) -> float:
    """Duration of the shortest cycle that is repeated, s; infinite where none is."""
    return min((case.load.duration for case in cases if case.only is None and case.share), default=np.inf)


def shared_life(lives: Array, shares: Array) -> Array:
    """Life in a mix of cases, each of which uses up its share: ``1 / sum(share / life)`` (Palmgren, Miner).

    Parameters
    ----------
    lives : ndarray, shape (n_cases, ...)
    shares : ndarray, shape (n_cases,)
        Of a sum of 1.
    """
    used = [share / life for share, life in zip(shares, lives, strict=True) if share]
    with np.errstate(divide="ignore"):
        return np.asarray(1 / np.sum(used, axis=0))


def with_brakes(train: Drivetrain, cases: Iterable[JointCase]) -> Drivetrain:
    """The drive train with the motor's holding brake, where a case uses it.

    Returns
    -------
    Drivetrain
    """
    uses = any(case.is_braked for case in cases)
    return replace(train, with_brake=True) if uses and not train.with_brake else train


def outcomes_of_cases(cases: tuple[JointCase, ...], every: tuple[Demands, ...]) -> tuple[Outcome, ...]:
    """All checks of one joint, each in the case that uses most of the limit; the gearbox's life in their mix."""
    if len(cases) == 1:
        return assess_joint(every[0])
    found: dict[str, list[Outcome]] = {}
    for case, demands in zip(cases, every, strict=True):
        for outcome in assess_joint(demands):
            if case.only is None or outcome.quantity in case.only:
                named = replace(outcome, case=case.name) if isinstance(outcome, LimitCheck) else outcome
                found.setdefault(outcome.quantity, []).append(named)
    if LIFE in found:
        found[LIFE] = [_mixed_life(cases, every, found[LIFE])]
    return tuple(worst_outcome(outcomes) for outcomes in found.values())


def worst_outcome(outcomes: list[Outcome]) -> Outcome:
    """The made check of highest utilisation, else the first that was not.

    Returns
    -------
    LimitCheck or NotAssessed
    """
    made = [outcome for outcome in outcomes if isinstance(outcome, LimitCheck)]
    # Of two that agree to nine digits the first, whatever rounding says.
    return max(made, key=lambda check: float(f"{check.utilisation:.9g}")) if made else outcomes[0]


def _mixed_life(cases: tuple[JointCase, ...], every: tuple[Demands, ...], outcomes: list[Outcome]) -> Outcome:
    if unmade := next((one for one in outcomes if isinstance(one, NotAssessed)), None):
        return unmade
    life = life_of_mix(cases, every)
    first = next(one for one in outcomes if isinstance(one, LimitCheck))
    return LimitCheck.of_magnitude(
        joint=first.joint,
        quantity=LIFE,
        demand=first.demand,
        limit=life,
        unit=first.unit,
        time=first.time,
        kind=first.kind,
        source=f"{first.source}; in the mix of the load cases",
    )


def life_of_mix(cases: tuple[JointCase, ...], every: tuple[Demands, ...]) -> float:
    """Expected life of a joint's gearbox in the mix of its cases, h; NaN where unknown.

    Returns
    -------
    float
    """
    lives = np.array([demands.assured_life_hours for demands in every])
    return float(shared_life(lives, np.array([case.share for case in cases])))
