"""Everything that is computed to judge the paper's claims."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.assessment import Assessment, assess
from puma_septic.kinematics import forward_kinematics, inverse_kinematics
from puma_septic.paper._durations import LeastDuration, least_duration, median_seconds
from puma_septic.paper._inputs import PaperInputs
from puma_septic.profiles import lspb, quintic_segments, quintic_spline, septic
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, read_only

__all__ = ["BASE_FRAME", "TIME_STEP", "TOOL_FRAME", "ComputingTimes", "Evidence", "gather"]

# The toolbox's frame 6 and its base, which stands at shoulder height (urdf/SOURCES.md).
TOOL_FRAME: Final = "wrist_center"
BASE_FRAME: Final = "shoulder_base"
# Step at which both trajectories are evaluated to time them, s; the paper does not state its own.
TIME_STEP: Final = 0.05


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ComputingTimes:
    """Median times on this machine of making the coefficients and evaluating all joint positions.

    Attributes
    ----------
    septic, lspb : float
        s.
    runs, instants : int
        Of how many runs the median is taken, and at how many instants each evaluates.
    """

    septic: float
    lspb: float
    runs: int
    instants: int


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Evidence:
    """What the inputs and the robot give.

    Attributes
    ----------
    inputs : PaperInputs
    robot : Robot
        With the wrist centre as its tool.
    branch : str
        The branch of the inverse kinematics that Table 1 belongs to.
    table_1 : ndarray, shape (4, 6)
        That branch at ``inputs.points``, with whole turns as printed, rad.
    branches_within_limits : tuple of int, length 4
        How many of the eight branches respect the joint limits at each point.
    tool_points : ndarray, shape (4, 3)
        Where the printed Table 1 puts the wrist centre, in the paper's base, m.
    base_height : float
        Of the paper's base above the floor, m.
    table_2 : ndarray, shape (8, 6)
        Coefficients of the septic through the printed Table 1, ascending powers of t.
    septic, lspb, quintic : Assessment
        The paper's two profiles and the three-segment quintic that it promises, through the printed Table 1.
    spline : Trajectory
        The quintic spline through the same points at the same times, with the least integral of jerk^2.
    least_durations : dict
        Of "septic" and "lspb" (stretched with its blends) and "lspb, longest blends".
    computing : ComputingTimes
    """

    inputs: PaperInputs
    robot: Robot
    branch: str
    table_1: Array
    branches_within_limits: tuple[int, ...]
    tool_points: Array
    base_height: float
    table_2: Array
    septic: Assessment
    lspb: Assessment
    quintic: Assessment
    spline: Trajectory
    least_durations: dict[str, LeastDuration]
    computing: ComputingTimes

    @property
    def trajectories(self) -> tuple[Trajectory, Trajectory, Trajectory]:
        """Septic, LSPB and three-segment quintic."""
        return tuple(one.motion.trajectory for one in (self.septic, self.lspb, self.quintic))  # type: ignore[return-value]


def gather(robot: Robot, inputs: PaperInputs, *, runs: int, clock: Callable[[], float]) -> Evidence:
    """Compute it all; `runs` and `clock` serve the computing times alone."""
    robot = robot.with_tool(TOOL_FRAME)
    T_world_base = forward_kinematics(robot, np.zeros(robot.n_joints), frame=BASE_FRAME)
    tool = np.linalg.inv(T_world_base) @ forward_kinematics(robot, inputs.table_1)
    branch, table_1, within = _table_1(robot, inputs, T_world_base)
    points, times, durations = inputs.table_1, inputs.times, np.diff(inputs.times)
    names = robot.joint_names
    one_septic = septic(points, times, joint_names=names)
    one_lspb = lspb(points, durations=durations, blend_time=inputs.blend_time, joint_names=names)
    longest = lspb(points, durations=durations, blend_time=durations.min(), joint_names=names)
    return Evidence(
        inputs=inputs,
        robot=robot,
        branch=branch,
        table_1=table_1,
        branches_within_limits=within,
        tool_points=read_only(tool[:, :3, 3]),
        base_height=float(T_world_base[2, 3]),
        table_2=read_only(one_septic.power_coefficients()[0]),
        septic=assess(robot, one_septic),
        lspb=assess(robot, one_lspb),
        quintic=assess(robot, quintic_segments(points, times, joint_names=names)),
        spline=quintic_spline(points, times, joint_names=names),
        least_durations={
            "septic": least_duration(robot, one_septic),
            "lspb": least_duration(robot, one_lspb),
            "lspb, longest blends": least_duration(robot, longest),
        },
        computing=_computing_times(inputs, runs, clock),
    )


def _table_1(robot: Robot, inputs: PaperInputs, T_world_base: Array) -> tuple[str, Array, tuple[int, ...]]:
    """The branch nearest to the printed Table 1, its joint angles, and how many branches keep the limits."""
    poses = np.tile(np.eye(4), (len(inputs.points), 1, 1))
    poses[:, :3, 3] = inputs.points  # the tool's axes are parallel to the base's (R = I)
    solutions = [inverse_kinematics(robot, T_world_base @ pose) for pose in poses]
    q = np.array([found.q for found in solutions])  # (point, branch, joint)
    printed = inputs.table_1[:, None, :]
    q = q - 2 * np.pi * np.round((q - printed) / (2 * np.pi))
    nearest = int(np.abs(q - printed).max(axis=(0, 2)).argmin())
    within = tuple(int(found.within_limits.sum()) for found in solutions)
    return solutions[0].configurations[nearest], read_only(q[:, nearest]), within


def _computing_times(inputs: PaperInputs, runs: int, clock: Callable[[], float]) -> ComputingTimes:
    """Both profiles from the four joint points to positions at every time step."""
    points, times, durations = inputs.table_1, inputs.times, np.diff(inputs.times)
    t = np.linspace(times[0], times[-1], round(times[-1] / TIME_STEP) + 1)
    return ComputingTimes(
        septic=median_seconds(lambda: septic(points, times)(t), runs, clock),
        lspb=median_seconds(lambda: lspb(points, durations=durations, blend_time=inputs.blend_time)(t), runs, clock),
        runs=runs,
        instants=len(t),
    )
