"""What sizing is asked: whether these drive trains are strong enough, or which of a catalogue are."""

from __future__ import annotations

from typing import overload

from numpy.typing import ArrayLike

from puma_septic.cycle import Cycle
from puma_septic.drives import Catalogue
from puma_septic.errors import InputError
from puma_septic.sizing import _result
from puma_septic.sizing._drive_masses import PLACEMENTS, Placement, select_consistent
from puma_septic.sizing._drivetrains import GivenDrivetrains
from puma_septic.sizing._joint_selection import Rank
from puma_septic.sizing._result import Sizing
from puma_septic.sizing._selection import Selection, select
from puma_septic.validation import checked_choice

__all__ = ["size"]


@overload
def size(cycle: Cycle, *, drivetrains: GivenDrivetrains | None = None) -> Sizing: ...


@overload
def size(
    cycle: Cycle,
    *,
    catalogue: Catalogue,
    drivetrains: GivenDrivetrains | None = None,
    rank: Rank = "mass",
    keep: int | None = 5,
    masses: Placement | None = None,
    own_masses: ArrayLike | None = None,
) -> Selection: ...


def size(
    cycle: Cycle,
    *,
    catalogue: Catalogue | None = None,
    drivetrains: GivenDrivetrains | None = None,
    rank: Rank = "mass",
    keep: int | None = 5,
    masses: Placement | None = None,
    own_masses: ArrayLike | None = None,
) -> Sizing | Selection:
    """Hold a duty cycle against the drive trains that are to do it, or choose them from a catalogue.

    The drive trains replace the robot's own: their rotors, friction and efficiency come in, the robot's are left out.
    With a catalogue every pair of motor and gearbox is accepted or rejected at every joint with the same verdict that
    its full assessment has; the best are assessed in full.

    Parameters
    ----------
    cycle : Cycle
    catalogue : Catalogue, optional
    drivetrains : sequence of Drivetrain, or mapping of str to Drivetrain, optional
        One per joint, in the robot's order or by joint name; by default the robot's own, as far as its actuators and
        limits tell. With a catalogue: what the joints have whatever the parts, that is drive (its unknown bus voltage
        is the motor's nominal one), ambient temperature, momentary torque and required life; motor and gearbox are
        ignored.
    rank : {"mass", "cost", "margin"}
        What the best pair has least (margin: most) of; between equals the margin decides.
    keep : int or None
        How many pairs per joint are assessed in full; None: all that are strong enough.
    masses : {"before", "at"}, optional
        Place the masses of the chosen parts on the arm, on the link before their joint or on the one that it moves, and
        choose from the wrist to the base. By default they load nothing.
    own_masses : array_like, shape (n_joints,), optional
        Of the drives that the arm's model includes already, kg, taken off first; with `masses` alone.

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
    if catalogue is None:
        return _result.size(cycle, drivetrains=drivetrains)
    if not isinstance(catalogue, Catalogue):
        raise InputError(f"catalogue: expected a Catalogue, as load_catalogue returns it, got {catalogue!r}")
    if masses is None:
        return select(cycle, catalogue, rank=rank, keep=keep, places=drivetrains)
    checked_choice("placement of masses", masses, PLACEMENTS)
    return select_consistent(
        cycle,
        catalogue,
        placement=masses,
        own_masses=own_masses,
        rank=rank,
        keep=keep,
        places=drivetrains,
    )
