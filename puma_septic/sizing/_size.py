"""What sizing is asked: whether these drive trains are strong enough, or which of a catalogue are."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import overload

from numpy.typing import ArrayLike

from puma_septic.cycle import Cycle
from puma_septic.drives import Catalogue
from puma_septic.errors import InputError
from puma_septic.sizing._conditions import Conditions
from puma_septic.sizing._drive_masses import PLACEMENTS, Placement, select_consistent
from puma_septic.sizing._drivetrains import GivenDrivetrains
from puma_septic.sizing._joint_selection import Rank
from puma_septic.sizing._load_cases import LoadCase, checked_cases
from puma_septic.sizing._result import Sizing, sized
from puma_septic.sizing._selection import Selection, select
from puma_septic.validation import checked_choice

__all__ = ["size"]


@overload
def size(
    cycle: Cycle | Iterable[LoadCase],
    *,
    drivetrains: GivenDrivetrains | None = None,
    conditions: Conditions | None = None,
) -> Sizing: ...


@overload
def size(
    cycle: Cycle | Iterable[LoadCase],
    *,
    catalogue: Catalogue,
    drivetrains: GivenDrivetrains | None = None,
    conditions: Conditions | None = None,
    rank: Rank = "mass",
    keep: int | None = 5,
    masses: Placement | None = None,
    own_masses: ArrayLike | None = None,
    same: Sequence[Sequence[str]] = (),
) -> Selection: ...


def size(
    cycle: Cycle | Iterable[LoadCase],
    *,
    catalogue: Catalogue | None = None,
    drivetrains: GivenDrivetrains | None = None,
    conditions: Conditions | None = None,
    rank: Rank = "mass",
    keep: int | None = 5,
    masses: Placement | None = None,
    own_masses: ArrayLike | None = None,
    same: Sequence[Sequence[str]] = (),
) -> Sizing | Selection:
    """Hold a duty cycle against the drive trains that are to do it, or choose them from a catalogue.

    The drive trains replace the robot's own: their rotors, friction and efficiency come in, the robot's are left out.
    With a catalogue every pair of motor and gearbox is accepted or rejected at every joint with the same verdict that
    its full assessment has; the best are assessed in full. A pair that keeps every known limit, but lacks a value of
    the least set (`puma_septic.drives.LEAST_SET`), is not decidable: it is listed apart, and never chosen.

    Parameters
    ----------
    cycle : Cycle or sequence of LoadCase
        Of several load cases the same drives must do all; each check is made in the case that uses most of its limit.
    catalogue : Catalogue, optional
    drivetrains : sequence of Drivetrain, or mapping of str to Drivetrain, optional
        One per joint, in the robot's order or by joint name; by default the robot's own, as far as its actuators and
        limits tell. With a catalogue: what the joints have whatever the parts, that is drive (its unknown bus voltage
        is the motor's nominal one), ambient temperature, momentary torque and required life; motor and gearbox are
        ignored.
    conditions : Conditions, optional
        Supply, ambient, life, and what must be left of each limit; they come before what `drivetrains` say.
    rank : {"mass", "cost", "margin"}
        What the best pair has least (margin: most) of; between equals the margin decides.
    keep : int or None
        How many pairs per joint are assessed in full; None: all that are strong enough.
    masses : {"before", "at"}, optional
        Place the masses of the chosen parts on the arm, on the link before their joint or on the one that it moves, and
        choose from the wrist to the base. By default they load nothing.
    own_masses : array_like, shape (n_joints,), optional
        Of the drives that the arm's model includes already, kg, taken off first; with `masses` alone.
    same : sequence of sequences of str
        Groups of joints that are to have one size, where a pair is strong enough at all of them.

    Returns
    -------
    Sizing or Selection
        A violated limit, or a joint for which nothing is strong enough, is part of the answer, not an error; what is
        unknown is listed as not assessed.

    Raises
    ------
    InputError
        If there is not one drive train for each joint, or for an unknown rank.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> there = ps.compute_motion(robot, ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0]))
    >>> cycle = ps.cycle.with_return(there, dwell=1.0)
    >>> sizing = ps.size(cycle)
    >>> sizing.is_feasible, sizing.governing.joint
    (True, 'joint2')
    >>> selection = ps.size(cycle, catalogue=ps.built_in_catalogue())
    >>> selection.joint("joint2").best.motor
    'INVENTED-M100'
    """
    cases = checked_cases(cycle)
    if catalogue is None:
        return sized(cases, drivetrains=drivetrains, conditions=conditions)
    if not isinstance(catalogue, Catalogue):
        raise InputError(f"catalogue: expected a Catalogue, as load_catalogue returns it, got {catalogue!r}")
    if masses is None:
        return select(
            cases, catalogue, rank=rank, keep=keep, places=drivetrains, conditions=conditions, same=same
        )  # fmt: skip
    checked_choice("placement of masses", masses, PLACEMENTS)
    return select_consistent(
        cases,
        catalogue,
        placement=masses,
        own_masses=own_masses,
        rank=rank,
        keep=keep,
        places=drivetrains,
        conditions=conditions,
        same=same,
    )
