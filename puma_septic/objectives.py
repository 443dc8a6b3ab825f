"""What a motion can be judged by in one number, by name: the objectives of comparison and optimisation."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.assessment import Assessment, assess
from puma_septic.batch import torque_spans
from puma_septic.dynamics import check_inertia
from puma_septic.errors import InputError
from puma_septic.motion import Motion, compute_motion
from puma_septic.paths import ToolLimits
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_choice, checked_list

__all__ = [
    "OBJECTIVES",
    "Candidate",
    "Objective",
    "checked_objectives",
    "find_torques",
    "interval_extremes",
    "non_dominated",
]

# A difference below this part is rounding: values of motions that are equal but for rounding do not beat each other.
_EQUAL = 1e-9


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Candidate:
    """A trajectory, with the robot that is to run it where one is known.

    It is assessed when first asked, and the result kept (hence no slots).

    Attributes
    ----------
    trajectory : Trajectory
    robot : Robot or None
    dwell : float
        Rest before the cycle repeats, in the root mean squares, s.
    floor : float or None
        Height that the arm must stay above, m.
    tool_limits : ToolLimits or None
        What the tool may do at most.
    """

    trajectory: Trajectory
    robot: Robot | None = None
    dwell: float = 0.0
    floor: float | None = None
    tool_limits: ToolLimits | None = None

    @property
    def known_robot(self) -> Robot:
        """The robot.

        Raises
        ------
        InputError
            Without one.
        """
        if self.robot is None:
            raise InputError("torque, energy and limits need a robot: give robot=...")
        return self.robot

    @cached_property
    def motion(self) -> Motion:
        """The robot on the trajectory.

        Raises
        ------
        InputError
            Without a robot.
        """
        return compute_motion(self.known_robot, self.trajectory)

    @cached_property
    def assessment(self) -> Assessment:
        """The motion checked against its limits."""
        return assess(self.motion, dwell=self.dwell, floor=self.floor, tool_limits=self.tool_limits)

    @cached_property
    def torque_ends(self) -> Array:
        """Least and greatest torque of each joint, (2, n_joints), N m (N)."""
        extrema = self.motion.torque.extrema()
        return np.stack([extrema.min, extrema.max])

    @cached_property
    def rms_torque(self) -> Array:
        """Root mean square torque of each joint over motion and dwell, (n_joints,), N m (N)."""
        return self.assessment.rms_torque


def find_torques(candidates: Sequence[Candidate]) -> None:
    """Compute `torque_ends` and, without a dwell, `rms_torque` of several candidates of one robot at once.

    They are kept as if they had been asked for; what does not go with the others is left for when it is asked for.
    """
    if not candidates or candidates[0].robot is None:
        return
    found = torque_spans(candidates[0].robot, [one.trajectory for one in candidates])
    for candidate, span in zip(candidates, found, strict=True):
        if span is not None:
            candidate.__dict__["torque_ends"] = span[0]
            if not candidate.dwell:
                candidate.__dict__["rms_torque"] = span[1]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Objective:
    """A number to make small.

    Attributes
    ----------
    name, unit, meaning : str
    parts : callable
        Of a candidate; the objective is the largest of the parts, each of which changes smoothly with the motion
        as long as it is bounded.
    order : int
        The objective is unbounded where the derivative of this order is; 0 if it never is.
    needs_robot : bool
    is_of_torque : bool
        It follows from `Candidate.torque_ends` or `Candidate.rms_torque`, see `find_torques`.
    """

    name: str
    unit: str
    meaning: str
    parts: Callable[[Candidate], Array]
    order: int = 0
    needs_robot: bool = False
    is_of_torque: bool = False

    def __reduce__(self) -> tuple[Any, ...]:
        return _named, (self.name,)

    def value(self, candidate: Candidate) -> float:
        """The number, infinite where unbounded."""
        if self.order and not np.isnan(candidate.trajectory.unbounded(self.order)).all():
            return np.inf
        return float(self.parts(candidate).max())


def _named(name: str) -> Objective:
    return OBJECTIVES[name]


def checked_objectives(names: Iterable[str], *, at_least: int = 1, at_most: int | None = None) -> tuple[Objective, ...]:
    """The objectives of these names, each once.

    Raises
    ------
    InputError
        For an unknown name, with the valid ones; one that occurs twice; too few or too many.
    """
    wanted = (names,) if isinstance(names, str) else checked_list("objectives", names)
    found = tuple(OBJECTIVES[checked_choice("objective", name, OBJECTIVES)] for name in wanted)
    if len(set(wanted)) < len(wanted):
        raise InputError(f"objectives: {', '.join(wanted)}: each can be named only once")
    if len(wanted) < at_least or (at_most is not None and len(wanted) > at_most):
        bound = f"{at_least} to {at_most}" if at_most is not None else f"at least {at_least}"
        raise InputError(f"objectives: {bound} are needed, got {len(wanted)}")
    return found


def interval_extremes(function: Piecewise) -> Array:
    """Greatest value and greatest negated value of each component on each interval, shape (2 n m,).

    Each interval's series is searched as a component of its own: the intervals' lengths do not matter for a value.
    """
    series = function.coefficients.reshape(function.degree + 1, 1, -1)
    extrema = Piecewise(breaks=np.array([0.0, 1.0]), coefficients=series).extrema()
    return np.concatenate([extrema.max, -extrema.min])


def non_dominated(values: ArrayLike) -> NDArray[np.bool_]:
    """Whether each row of values, all to be small, is Pareto-optimal.

    Row b beats row a if it is nowhere larger and somewhere smaller (by more than 1e-9 of the magnitude).

    Parameters
    ----------
    values : array_like, shape (n, m)
        May be infinite.

    Returns
    -------
    ndarray of bool, shape (n,)

    Examples
    --------
    >>> non_dominated([[1.0, 3.0], [2.0, 2.0], [3.0, 3.0]]).tolist()
    [True, True, False]
    """
    table: Array = np.asarray(values, dtype=np.float64)
    finite = np.where(np.isfinite(table), table, np.finfo(np.float64).max)
    slack = _EQUAL * np.abs(np.where(np.isfinite(table), table, 0.0))
    beaten = np.zeros(len(finite), dtype=bool)
    for k, row in enumerate(finite):
        nowhere_larger = (finite <= row + slack[k]).all(axis=1)
        somewhere_smaller = (finite < row - slack[k]).any(axis=1)
        beaten[k] = bool((nowhere_larger & somewhere_smaller).any())
    return ~beaten


def _integral_of_square(order: int) -> Callable[[Candidate], Array]:
    def parts(candidate: Candidate) -> Array:
        function = candidate.trajectory.derivative(order)
        return np.array([function.inner(function).sum()])

    return parts


def _peak(order: int) -> Callable[[Candidate], Array]:
    return lambda candidate: interval_extremes(candidate.trajectory.derivative(order))


def _torque_use(candidate: Candidate) -> Array:
    robot = candidate.known_robot
    check_inertia(robot)
    limit = robot.limits.effort
    unknown = np.isnan(limit)
    if unknown.any():
        names = [name for name, missing in zip(robot.joint_names, unknown, strict=True) if missing]
        raise InputError(
            f"peak_torque_utilisation needs the effort limit of every joint; unknown for: {', '.join(names)};"
            " give it by robot.with_limits(effort=...), or take rms_torque"
        )
    least, greatest = candidate.torque_ends
    return np.concatenate([greatest / limit, -least / limit])


def _rms_torque(candidate: Candidate) -> Array:
    check_inertia(candidate.known_robot)
    return np.array([np.sqrt((candidate.rms_torque**2).sum())])


def _energy(candidate: Candidate) -> Array:
    check_inertia(candidate.motion.robot)
    return np.array([candidate.assessment.energy_in.sum()])


_ALL: Final = (
    Objective(
        name="duration",
        unit="s",
        meaning="time from start to end",
        parts=lambda candidate: np.array([candidate.trajectory.duration]),
    ),
    Objective(
        name="integral_of_squared_acceleration",
        unit="rad^2/s^3",
        meaning="integral of acceleration^2 over time, summed over the joints",
        parts=_integral_of_square(2),
        order=2,
    ),
    Objective(
        name="integral_of_squared_jerk",
        unit="rad^2/s^5",
        meaning="integral of jerk^2 over time, summed over the joints",
        parts=_integral_of_square(3),
        order=3,
    ),
    Objective(
        name="peak_velocity",
        unit="rad/s",
        meaning="largest speed of any joint",
        parts=_peak(1),
    ),
    Objective(
        name="peak_acceleration",
        unit="rad/s^2",
        meaning="largest acceleration of any joint",
        parts=_peak(2),
        order=2,
    ),
    Objective(
        name="peak_jerk",
        unit="rad/s^3",
        meaning="largest jerk of any joint",
        parts=_peak(3),
        order=3,
    ),
    Objective(
        name="overshoot",
        unit="rad",
        meaning="largest excess of any joint beyond the hull of the points",
        parts=lambda candidate: candidate.trajectory.overshoot,
    ),
    Objective(
        name="via_miss",
        unit="rad",
        meaning="largest distance of any joint from a point at its time",
        parts=lambda candidate: candidate.trajectory.via_miss,
    ),
    Objective(
        name="peak_torque_utilisation",
        unit="1",
        meaning="largest torque as a share of its limit, of any joint",
        parts=_torque_use,
        order=2,
        needs_robot=True,
        is_of_torque=True,
    ),
    Objective(
        name="rms_torque",
        unit="N m",
        meaning="root of the sum over the joints of their mean square torques",
        parts=_rms_torque,
        order=2,
        needs_robot=True,
        is_of_torque=True,
    ),
    Objective(
        name="energy",
        unit="J",
        meaning="work that the actuators do, summed over the joints; what flows back is not subtracted",
        parts=_energy,
        order=2,
        needs_robot=True,
    ),
)
# Units are those of revolute joints; a prismatic joint counts in m and N.
OBJECTIVES: Final = MappingProxyType({objective.name: objective for objective in _ALL})
