"""The via times (and free via values) that make one objective least, for a given total time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.document import SCHEMAS, card, one_line, plain
from puma_septic.objectives import Objective, checked_objectives
from puma_septic.optimisation._analytic import SQUARES, best_free_values, gradient_by_times
from puma_septic.optimisation._constraints import Verdict, told
from puma_septic.optimisation._problem import (
    MOST_RESTARTS,
    Progress,
    Setting,
    best_kept,
    checked_setting,
    random_starts,
    search_from,
)
from puma_septic.optimisation._search import COARSE, FINE, KEPT
from puma_septic.optimisation._variables import MakeTrajectory
from puma_septic.paths import ToolLimits
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, FrozenMap, checked_whole
from puma_septic.views.tables import Cell

__all__ = ["OptimisedTimes", "optimise_via_times"]

# Ends of searches this close to the best one, relative to it, are the same optimum.
_SAME_OPTIMUM: Final = 1e-4


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class OptimisedTimes:
    """What `optimise_via_times` reached.

    Attributes
    ----------
    trajectory, start : Trajectory
        The best motion found, and the one begun with.
    objective : Objective
    value, start_value : float
    ends : tuple of float
        Value at the end of each search; infinite where a constraint stayed violated. The first began with the
        given times.
    n_evaluations : int
        Trajectories made and judged.
    free_values : mapping
        Via velocities, accelerations or free knots, where they were free.
    has_gradient : bool
        Whether the gradient came from the family's structure rather than from differences.
    verdict : Verdict or None
        The motion found, assessed in full: limits respected, not held, not assessed; None without a robot.
    """

    trajectory: Trajectory
    start: Trajectory
    objective: Objective
    value: float
    start_value: float
    ends: tuple[float, ...]
    n_evaluations: int
    free_values: Mapping[str, Array]
    has_gradient: bool
    verdict: Verdict | None

    @property
    def times(self) -> Array:
        """Via times, s."""
        return self.trajectory.times

    @property
    def improvement(self) -> float:
        """``1 - value / start_value``."""
        return 1 - self.value / self.start_value if self.start_value else 0.0

    @property
    def statement(self) -> str:
        """What was reached, how sure it is, and what the limits say to it."""
        return self._reached if self.verdict is None else f"{self._reached}; {self.verdict.statement}"

    @property
    def _reached(self) -> str:
        same = sum(end <= self.value + _SAME_OPTIMUM * abs(self.value) for end in self.ends)
        tolerance = COARSE if self.objective.needs_robot else FINE
        slopes = "the gradient from the family's structure" if self.has_gradient else "central differences"
        return (
            f"a local optimum, the best of {len(self.ends)} searches, {same} of which ended here (to"
            f" {_SAME_OPTIMUM:g} of the value); no proof that none is better; SLSQP with {slopes}, simplex where the"
            f" objective has kinks, relative tolerance {tolerance:g}, {self.n_evaluations} evaluations"
        )

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document, SI units."""
        return {
            "schema": SCHEMAS["optimisation"],
            "profile": self.trajectory.profile,
            "objective": {"name": self.objective.name, "unit": self.objective.unit},
            "start": {"times": plain(self.start.times), "value": plain(self.start_value)},
            "optimum": {"times": plain(self.times), "value": plain(self.value)},
            "improvement": plain(self.improvement),
            "free_values": {name: plain(values) for name, values in self.free_values.items()},
            "ends": plain(self.ends),
            "n_evaluations": self.n_evaluations,
            "limits": None if self.verdict is None else self.verdict.to_dict(),
            "statement": self.statement,
        }

    @property
    def sentence(self) -> str:
        """What was found, in one line."""
        change = f"{100 * abs(self.improvement):z.1f} % {'lower' if self.improvement >= 0 else 'higher'}"
        return f"{self.start.profile}, {self.objective.name}: {change}"

    @property
    def table(self) -> tuple[tuple[str, ...], tuple[tuple[Cell, ...], ...]]:
        """Heads and rows: the times and the objective, as given and at the optimum."""
        headers = ["", *(f"t{k} [s]" for k in range(len(self.times))), f"{self.objective.name} [{self.objective.unit}]"]
        rows: list[list[Cell]] = [
            ["start", *(f"{t:z.4f}" for t in self.start.times), self.start_value],
            ["optimum", *(f"{t:z.4f}" for t in self.times), self.value],
        ]
        return tuple(headers), tuple(map(tuple, rows))

    @property
    def notes(self) -> tuple[str, ...]:
        """Which limits were respected, and how the optimum was reached."""
        return (*([] if self.verdict is None else [self.verdict.sentence]), f"Reached: {self._reached}.")

    def __str__(self) -> str:
        return told(self.sentence, self.table, self.notes)

    def __repr__(self) -> str:
        return one_line("OptimisedTimes", self._facts())

    def _repr_html_(self) -> str:
        return card("OptimisedTimes", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "profile": self.trajectory.profile,
            "objective": self.objective.name,
            "improvement": f"{100 * self.improvement:z.1f} %",
            "times": [float(f"{t:.4g}") for t in self.times],
        }


def optimise_via_times(
    make: MakeTrajectory,
    points: ArrayLike,
    times: ArrayLike,
    *,
    objective: str = "integral_of_squared_jerk",
    robot: Robot | None = None,
    free: Sequence[str] = (),
    max_overshoot: ArrayLike | None = None,
    keep: Sequence[str] = (),
    dwell: float = 0.0,
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
    restarts: int = 4,
    seed: int = 0,
    progress: Progress | None = None,
) -> OptimisedTimes:
    """Choose the via times for a given total time, so that an objective becomes least.

    Parameters
    ----------
    make : callable
        A profile such as `septic`: ``make(points, times)`` returns a Trajectory.
    points : array_like, shape (k, n_joints)
        At least three, rad (m for prismatic joints).
    times : array_like, shape (k,) or ()
        To begin with, s; or the total time alone. The first and the last stay.
    objective : str
        Name in `puma_septic.objectives.OBJECTIVES`.
    robot : Robot, optional
        Needed for torque, energy and limits.
    free : sequence of str
        Arguments of `make` to be chosen as well: "velocities", "accelerations" at the vias, "free_knots". For an
        integral of squares without constraints the best velocities and accelerations follow from a linear system.
    max_overshoot : array_like, shape () or (n_joints,), optional
        Largest excess beyond the hull of the points, rad. Minimising torque alone rewards folding the arm.
    keep : sequence of str
        Limits of the robot to respect: "position", "velocity", "acceleration", "jerk", "effort". What is returned keeps
        them by a full assessment; the others are assessed too, and named where they are not held.
    dwell : float
        Rest after the motion, in the root mean squares, s.
    floor : float, optional
        Height that the arm must stay above, m: kept, as are the limits of the tool.
    tool_limits : ToolLimits, optional
        What the tool may do at most.
    restarts : int
        Searches from random times, in addition to the one from the given times.
    seed : int
        Of the random times; the same seed gives the same result.
    progress : callable, optional
        Called with the number of searches done and of all.

    Returns
    -------
    OptimisedTimes

    Raises
    ------
    InputError
        For arguments that are not valid, or an objective that is unbounded for this profile.
    NoSolution
        If no search kept the constraints: `residual` is the least excess found, `q` the posture at mid-motion there.

    Examples
    --------
    >>> import puma_septic as ps
    >>> result = optimise_via_times(ps.septic, [[0.0], [1.0], [3.0], [4.0]], [0.0, 2.0, 5.0, 9.0], restarts=0)
    >>> result.times.round(2).tolist(), result.value < result.start_value
    ([0.0, 3.23, 5.77, 9.0], True)
    """
    setting = checked_setting(
        make,
        points,
        times,
        robot=robot,
        free=free,
        max_overshoot=max_overshoot,
        keep=keep,
        dwell=dwell,
        floor=floor,
        tool_limits=tool_limits,
    )
    goal = checked_objectives([objective], at_most=1)[0]
    count = checked_whole("restarts", restarts, at_least=0, at_most=MOST_RESTARTS)
    start = make(setting.variables.points, setting.variables.start)
    start_value = setting.bounded_value(goal, start)
    searched = _with_structure(setting, goal)
    is_plain = not setting.is_constrained and not setting.variables.free
    gradient = gradient_by_times(make, goal.name) if is_plain else None
    starts = random_starts(searched.variables, searched.first(), count, seed)
    problem = searched.problem(
        goal.parts, needs_robot=goal.needs_robot, is_of_torque=goal.is_of_torque, gradient=gradient
    )
    found = search_from(problem, starts, progress)
    best = best_kept(searched, found)
    trajectory = searched.variables.trajectory(best.x)
    return OptimisedTimes(
        trajectory=trajectory,
        start=start,
        objective=goal,
        value=goal.value(setting.judged(trajectory)),
        start_value=start_value,
        ends=tuple(one.value if one.excess <= KEPT else np.inf for one in found),
        n_evaluations=sum(one.n_evaluations for one in found),
        free_values=_free_values(setting, searched, best.x, goal),
        has_gradient=gradient is not None,
        verdict=setting.verdict(trajectory),
    )


def _with_structure(setting: Setting, goal: Objective) -> Setting:
    """Free via values are not searched for where a linear system gives them."""
    free = setting.variables.free
    if goal.name in SQUARES and free and "free_knots" not in free and not setting.is_constrained:
        return setting.with_best_values(SQUARES[goal.name])
    return setting


def _free_values(setting: Setting, searched: Setting, x: Array, goal: Objective) -> Mapping[str, Array]:
    variables, times = setting.variables, searched.variables.times(x)
    if searched is setting:
        return FrozenMap(variables.values(x, times))
    order = SQUARES[goal.name]
    return best_free_values(variables.make, variables.points, times, free=variables.free, order=order)
