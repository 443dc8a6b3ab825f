"""For test suites: fail when a motion does not keep its limits, or a planned trajectory must not go to the robot.

Both are fixtures of the same names where pytest runs, through the package's plug-in.
"""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike

from numpy.typing import ArrayLike

from puma_septic.assessment import Assessment, LimitCheck
from puma_septic.cycle import CycleAssessment
from puma_septic.doctor import CODES, examine
from puma_septic.errors import InputError
from puma_septic.gate import START_TOLERANCE, check_trajectory
from puma_septic.limit_check import HEIGHT
from puma_septic.paths import TOOL, TOOL_QUANTITIES, ToolLimits
from puma_septic.quantities import QUANTITIES
from puma_septic.robot import Robot
from puma_septic.ros import read_joint_trajectories
from puma_septic.validation import checked_choice, checked_kind
from puma_septic.views.checks import unmet_text

__all__ = ["assert_feasible", "assert_sound_model", "assert_trajectory_ok"]


def assert_feasible(
    assessment: Assessment | CycleAssessment, margin: float = 0.0, *, ignore: Iterable[str | tuple[str, str]] = ()
) -> None:
    """Fail unless every known limit is kept, with something to spare.

    Velocity, acceleration, jerk and effort must stay below ``(1 - margin) * limit``. A position must stay
    within its bounds, whatever the margin: its distance to a bound is an angle, not a share of anything.
    A limit that is not known cannot fail, unless the acceleration or torque is unbounded; the message lists it.

    Parameters
    ----------
    assessment : Assessment or CycleAssessment
        Of a cycle the whole counts, rests included.
    margin : float
        Share of each limit that must be left, from 0 to 1.
    ignore : iterable of str or (str, str)
        What may fail: a joint's name (all its limits), a quantity of all joints ("position", "velocity",
        "acceleration", "jerk", "effort"), or a pair (joint, quantity). What the cell asks is ignored by its own name
        alone: "tool", or a pair such as ("tool", "jerk"), and "height" of the floor.

    Raises
    ------
    AssertionError
        With a table of the limits that are not kept: joint, quantity, demand, limit, instant and margin; or with what
        must be settled before a verdict.
    InputError
        For a margin outside [0, 1], or a name in `ignore` that is neither a joint nor a quantity.

    Examples
    --------
    >>> import puma_septic as ps
    >>> from puma_septic.testing import assert_feasible
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> assert_feasible(ps.assess(ps.load_robot(), move), margin=0.2)
    """
    __tracebackhide__ = True  # pytest then points at the caller's line
    judged = assessment.whole if isinstance(assessment, CycleAssessment) else assessment
    ignored = _ignored(checked_kind("assessment", judged, Assessment), ignore)
    failed = [check for check in judged.keeps(margin) if ignored.isdisjoint(_names(check))]
    if failed:
        raise AssertionError(unmet_text(failed, judged.not_assessed, margin))
    if judged.undecided:
        raise AssertionError("undecided: " + "; ".join(judged.undecided))


def assert_trajectory_ok(
    path: str | PathLike[str],
    robot: Robot,
    *,
    start: ArrayLike | None = None,
    start_tolerance: float = START_TOLERANCE,
    allow: Iterable[str] = (),
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
) -> None:
    """Fail unless every JointTrajectory in a file may go to the robot; the gate of ``puma-septic check``.

    Parameters
    ----------
    path : path_like
        YAML, JSON, a rosbag2 folder or an MCAP file; see `read_joint_trajectory`.
    robot : Robot
    start : array_like, shape (n_joints,), optional
        Where the arm stands before the first, rad (m).
    start_tolerance : float
        rad (m).
    allow : iterable of str
        Reasons that do not count, such as "limit_unknown:jerk"; see `check_trajectory`.
    floor, tool_limits : optional
        What the cell asks: as `assess` takes them.

    Raises
    ------
    AssertionError
        With the verdict, its reasons and the worst margins.
    InputError
        For a file that cannot be read as trajectories of this robot, and misspelt reasons.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import puma_septic as ps
    >>> from puma_septic.testing import assert_trajectory_ok
    >>> robot = ps.load_robot()
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0], joint_names=robot.joint_names)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = ps.write_joint_trajectory(pathlib.Path(folder, "move.yaml"), move)
    ...     assert_trajectory_ok(path, robot, allow=["limit_unknown"])
    """
    __tracebackhide__ = True
    allowed = tuple(allow)
    for planned in read_joint_trajectories(path, robot, start=start):
        place = None if planned.start is None else planned.start.position
        check = check_trajectory(
            robot,
            planned.trajectory,
            start=place,
            start_tolerance=start_tolerance,
            allow=allowed,
            floor=floor,
            tool_limits=tool_limits,
        )
        if not check.is_ok:
            raise AssertionError(f"{planned.origin}: {check}")


def assert_sound_model(robot: Robot, *, allow: Iterable[str] = ()) -> None:
    """Fail if a robot's data are impossible or doubtful: placeholders, other units, inertias that no body has.

    What is merely missing does not fail; see `puma_septic.doctor.examine`.

    Parameters
    ----------
    robot : Robot
    allow : iterable of str
        Codes that do not count, such as "effort_equal", or "effort_equal:joint4" for one joint or link.

    Raises
    ------
    AssertionError
        With what is found.
    InputError
        For an unknown code.

    Examples
    --------
    >>> import puma_septic as ps
    >>> from puma_septic.testing import assert_sound_model
    >>> assert_sound_model(ps.load_robot(), allow=["inertia_impossible:link3"])  # as measured: 9 % above the sum
    """
    __tracebackhide__ = True
    allowed = set(allow)
    for name in allowed:
        checked_choice("code in allow", name.partition(":")[0], CODES)
    found = [
        f"{finding.severity}, {finding.code}: {finding.message}"
        for finding in examine(robot).findings
        if finding.severity != "missing"
        and finding.code not in allowed
        and not {f"{finding.code}:{part}" for part in finding.parts} <= allowed
    ]
    if found:
        raise AssertionError("\n".join([f"robot {robot.name!r}: doubtful data", *found]))


def _names(check: LimitCheck) -> set[str | tuple[str, str]]:
    """What a check can be ignored by: those of tool and floor are no joint's, whatever their quantity is called."""
    if check.quantity == HEIGHT:
        return {HEIGHT}
    if check.joint == TOOL:
        return {TOOL, (TOOL, check.quantity)}
    return {check.joint, check.quantity, (check.joint, check.quantity)}


def _ignored(assessment: Assessment, ignore: Iterable[str | tuple[str, str]]) -> set[str | tuple[str, str]]:
    """Refuse misspelt names: the test would not fail for the reason that its author sees."""
    if isinstance(ignore, str):
        raise InputError(f"ignore: expected a list of names, got the text {ignore!r}; write [{ignore!r}]")
    names = set(ignore)
    joints = assessment.motion.robot.joint_names
    for name in names:
        if isinstance(name, str):
            checked_choice("joint or quantity in ignore", name, [*joints, *QUANTITIES, TOOL, HEIGHT])
        elif isinstance(name, tuple) and len(name) == 2:
            checked_choice("joint in ignore", name[0], [*joints, TOOL])
            checked_choice("quantity in ignore", name[1], TOOL_QUANTITIES if name[0] == TOOL else QUANTITIES)
        else:
            raise InputError(f"ignore: expected a joint, a quantity or a pair (joint, quantity), got {name!r}")
    return names
