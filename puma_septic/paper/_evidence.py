"""Everything that is computed to judge the paper's claims."""

from __future__ import annotations

import statistics
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.assessment import Assessment, LimitCheck, assess
from puma_septic.kinematics import forward_kinematics, inverse_kinematics
from puma_septic.paper._inputs import PaperInputs
from puma_septic.piecewise import Piecewise
from puma_septic.profiles import lspb, quintic_segments, quintic_spline, septic
from puma_septic.robot import Robot
from puma_septic.simulation import Controller, Simulation, simulate_all
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, read_only
from puma_septic.vibration import residual_vibration

__all__ = [
    "FREQUENCIES",
    "TIME_STEP",
    "ComputingTimes",
    "Evidence",
    "Executed",
    "LeastDuration",
    "execute_profiles",
    "gather",
    "least_duration",
    "median_seconds",
    "stretched",
]

# The search ends at this relative width of the duration, and gives up where this many doublings do not help.
_PRECISION: Final = 1e-7
_DOUBLINGS: Final = 12


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LeastDuration:
    """The shortest duration of a motion that is only stretched in time.

    Attributes
    ----------
    duration : float
        s; infinite where no stretch helps, 0 where every one does.
    governing : LimitCheck or None
        The limit that is reached at it.
    """

    duration: float
    governing: LimitCheck | None


def stretched(trajectory: Trajectory, factor: float) -> Trajectory:
    """The same path in `factor` times the time; v, a and jerk are divided by its powers 1, 2 and 3."""
    position = trajectory.position
    return Trajectory(
        position=Piecewise(breaks=position.breaks * factor, coefficients=position.coefficients),
        points=trajectory.points,
        times=trajectory.times * factor,
        profile=trajectory.profile,
        joint_names=trajectory.joint_names,
    )


def least_duration(robot: Robot, trajectory: Trajectory) -> LeastDuration:
    """Shorten (or lengthen) a motion until its limits on velocity, acceleration, jerk and torque are just kept.

    Positions do not change. Inertial torque goes with 1/T^2 and viscous friction with 1/T, but gravity and
    Coulomb friction do not depend on the time, so the motion is assessed anew at each duration. Found by
    bisection, from the given duration downwards (upwards where that is too short already).
    """

    def governing(factor: float) -> LimitCheck | None:
        checks = assess(robot, stretched(trajectory, factor)).checks
        return max((c for c in checks if c.quantity != "position"), key=lambda c: c.utilisation, default=None)

    def is_kept(factor: float) -> bool:
        check = governing(factor)
        return check is None or not check.is_violated

    step = 0.5 if is_kept(1.0) else 2.0
    factor = 1.0
    for _ in range(_DOUBLINGS):
        if is_kept(factor * step) != (step < 1):
            break
        factor *= step
    else:
        return LeastDuration(duration=0.0 if step < 1 else float("inf"), governing=None)
    broken, kept = sorted((factor, factor * step))
    while kept - broken > _PRECISION * kept:
        middle = (broken + kept) / 2
        broken, kept = (broken, middle) if is_kept(middle) else (middle, kept)
    return LeastDuration(duration=trajectory.duration * kept, governing=governing(kept))


def median_seconds(compute: Callable[[], object], runs: int, clock: Callable[[], float]) -> float:
    """The median time of the runs, after one that does not count."""
    compute()
    times = []
    for _ in range(runs):
        start = clock()
        compute()
        times.append(clock() - start)
    return statistics.median(times)


_SHARES: Final = (1.0, 0.5)
"""Durations that are simulated, of the paper's."""

FREQUENCIES: Final = np.linspace(5.0, 25.0, 81)
"""Structures of industrial arms swing at 5 to 25 Hz (Craig, "Introduction to Robotics", 3rd ed., 2005, chapter 9)."""

# Of the durations that the spectrum is taken at, of the paper's.
_SPECTRUM: Final = np.linspace(1 / 3, 1.0, 9)
# Controllers and a step that show the profiles' difference and cost little: rates below the usual 1 kHz.
_LAWS: Final = ("pd_gravity", "feedforward")
_RATE, _STEP, _REST_SPEED, _SETTLE = 250.0, 4e-3, 0.04, 0.1


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Executed:
    """Tracking and vibration of the profiles.

    Attributes
    ----------
    durations : ndarray, shape (k,)
        Simulated ones, s.
    tool_rms : mapping of str to ndarray, shape (k, n_profiles)
        Root mean square distance of the tool from its plan by control law, m; infinite where the arm diverged.
    residual : ndarray, shape (n_durations, n_frequencies, n_profiles)
        Amplitude left in an undamped spring-mass on the joint that it is largest of, rad.
    """

    durations: Array
    tool_rms: dict[str, Array]
    residual: Array


def execute_profiles(robot: Robot, profiles: tuple[Trajectory, ...]) -> Executed:
    """Simulate all profiles at each duration under each law, and take the spectra of what they leave behind."""
    total = profiles[0].duration
    moves = [_lasting(one, share * total) for share in _SHARES for one in profiles]
    # The nearest rate that divides each motion, whatever the inputs are.
    shortest = total * min(_SHARES)
    rate = round(_RATE * shortest) / shortest
    tool_rms = {}
    for law in _LAWS:
        controller = Controller(law=law, rate=rate)
        made = simulate_all(robot, moves, controller=controller, settle=_SETTLE, step=_STEP, rest_speed=_REST_SPEED)
        tool_rms[law] = np.array([_rms(one) for one in made]).reshape(len(_SHARES), -1)
    spectra = [
        [residual_vibration(_lasting(one, share * total), FREQUENCIES).max(axis=1) for one in profiles]
        for share in _SPECTRUM
    ]
    return Executed(
        durations=np.array([share * total for share in _SHARES]),
        tool_rms=tool_rms,
        residual=np.moveaxis(np.array(spectra), 1, 2),
    )


def _lasting(trajectory: Trajectory, duration: float) -> Trajectory:
    return stretched(trajectory, duration / trajectory.duration)


def _rms(simulation: Simulation) -> float:
    return np.inf if simulation.has_diverged else simulation.metrics.tool_rms_error


# The toolbox's frame 6 and its base, which stands at shoulder height (urdf/SOURCES.md).
_TOOL_FRAME: Final = "wrist_center"
_BASE_FRAME: Final = "shoulder_base"
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
    robot = robot.with_tool(_TOOL_FRAME)
    T_world_base = forward_kinematics(robot, np.zeros(robot.n_joints), frame=_BASE_FRAME)
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
