"""Tasks as search problems: where to begin, what to evaluate, from where to begin again."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, TypeVar, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError, NoSolution
from puma_septic.objectives import Candidate, Objective, find_torques
from puma_septic.optimisation._analytic import best_free_values
from puma_septic.optimisation._constraints import (
    Excess,
    Verdict,
    check_cell,
    checked_quantities,
    excess_function,
    verdict_of,
)
from puma_septic.optimisation._search import COARSE, FINE, KEPT, Found, Problem, search
from puma_septic.optimisation._variables import MakeTrajectory, Variables, checked_variables
from puma_septic.paths import ToolLimits
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_kind, checked_number, checked_whole

__all__ = [
    "MOST_RESTARTS",
    "Progress",
    "Setting",
    "best_kept",
    "checked_setting",
    "random_starts",
    "refusable",
    "search_from",
]

Progress = Callable[[int, int], None]
Given = TypeVar("Given")
Answer = TypeVar("Answer")

# Random shares: Dirichlet's distribution, a little away from vanishing segments.
_CONCENTRATION: Final = 2.0
# Each is a search of its own.
MOST_RESTARTS: Final = 10_000


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Setting:
    """A task for the optimiser: what may change, what must be kept, who runs it."""

    variables: Variables
    excess: Excess
    keep: tuple[str, ...]
    is_constrained: bool
    robot: Robot | None
    dwell: float
    floor: float | None
    tool_limits: ToolLimits | None

    def candidate(self, x: Array) -> Candidate:
        """The motion of variables x."""
        return self.judged(self.variables.trajectory(x))

    def candidates(self, several: Sequence[Array]) -> list[Candidate | None]:
        """The motions of several x, their torque computed together; None where one is refused."""
        made = [refusable(self.candidate, x) for x in several]
        find_torques([one for one in made if one is not None])
        return made

    def judged(self, trajectory: Trajectory) -> Candidate:
        """A trajectory with the robot that runs it."""
        return Candidate(
            trajectory=trajectory,
            robot=self.robot,
            dwell=self.dwell,
            floor=self.floor,
            tool_limits=self.tool_limits,
        )

    def verdict(self, trajectory: Trajectory) -> Verdict | None:
        """What the robot's limits say to a trajectory; None without a robot."""
        return verdict_of(self.judged(trajectory), self.keep)

    def bounded_value(self, objective: Objective, trajectory: Trajectory) -> float:
        """The objective's value.

        Raises
        ------
        InputError
            If it is unbounded, which no via times change, or the duration, which is given.
        """
        if objective.name == "duration":
            raise InputError("objective 'duration': the total time stays as given; least_time is what chooses it")
        value = objective.value(self.judged(trajectory))
        if not np.isfinite(value):
            raise InputError(
                f"{objective.name} is unbounded for profile {trajectory.profile}: a lower derivative steps, whatever"
                " the via times"
            )
        return value

    def problem(
        self,
        parts: Callable[[Candidate], Array],
        *,
        needs_robot: bool = False,
        is_of_torque: bool = False,
        gradient: Callable[[Trajectory], Array] | None = None,
    ) -> Problem:
        """To make the largest part least, to the accuracy that torque has where a robot is needed.

        With `is_of_torque` the torque of several motions is computed together.
        """

        def evaluated(candidate: Candidate) -> tuple[Array, Array]:
            return parts(candidate), self.excess(candidate)

        def together(several: Sequence[Array]) -> list[tuple[Array, Array] | None]:
            candidates = self.candidates(several)
            return [None if one is None else refusable(evaluated, one) for one in candidates]

        variables = self.variables
        lower, upper = variables.bounds()
        chained = None
        if gradient is not None:
            by_times = gradient

            def chained(x: Array) -> Array:
                return variables.chained(by_times(variables.trajectory(x)), x)

        return Problem(
            evaluate=lambda x: evaluated(self.candidate(x)),
            lower=lower,
            upper=upper,
            tolerance=COARSE if needs_robot else FINE,
            gradient=chained,
            evaluate_together=together if is_of_torque else None,
        )

    def first(self) -> Array:
        """The given times, with free via values that make acceleration (jerk, if accelerations are free) least."""
        variables = self.variables
        free = tuple(name for name in variables.free if name != "free_knots")
        values: Mapping[str, Array] | None = None
        if free:
            order = 3 if "accelerations" in free else 2
            values = best_free_values(variables.make, variables.points, variables.start, free=free, order=order)
        return variables.encode(variables.start, values)

    def with_best_values(self, order: int) -> Setting:
        """Via values no longer free but, at any times, those with the least integral of the squared derivative."""
        make, free = self.variables.make, self.variables.free

        def best(points: Array, times: Array) -> Trajectory:
            return make(points, times, **best_free_values(make, points, times, free=free, order=order))

        return replace(self, variables=replace(self.variables, make=best, free=()))


def checked_setting(
    make: MakeTrajectory,
    points: ArrayLike,
    times: ArrayLike,
    *,
    robot: Robot | None,
    free: Sequence[str],
    max_overshoot: ArrayLike | None,
    keep: Sequence[str],
    dwell: float,
    floor: float | None,
    tool_limits: ToolLimits | None,
    least: int = 3,
) -> Setting:
    """The setting of these arguments, with `least` points or more; see `optimise_via_times` for the others."""
    variables = checked_variables(make, points, times, free, least=least)
    n_joints = variables.points.shape[1]
    if robot is not None and checked_kind("robot", robot, Robot).n_joints != n_joints:
        raise InputError(f"points: {n_joints} joints, but robot {robot.name!r} has {robot.n_joints}")
    quantities = checked_quantities(keep)
    check_cell(robot, floor, tool_limits)
    return Setting(
        variables=variables,
        excess=excess_function(
            robot, n_joints, max_overshoot=max_overshoot, keep=quantities, floor=floor, tool_limits=tool_limits
        ),
        keep=quantities,
        is_constrained=bool(quantities) or any(rule is not None for rule in (max_overshoot, floor, tool_limits)),
        robot=robot,
        dwell=checked_number("dwell", dwell, unit="s", at_least=0.0),
        floor=floor,
        tool_limits=tool_limits,
    )


def random_starts(variables: Variables, first: Array, count: int, seed: int) -> list[Array]:
    """The first start, and further ones with random times; free values stay the first's."""
    rng = np.random.default_rng(checked_whole("seed", seed, at_least=0))
    t = variables.start
    starts = [first]
    for _ in range(count):
        shares = rng.dirichlet(np.full(len(t) - 1, _CONCENTRATION))
        shares = variables.least + (1 - len(shares) * variables.least) * shares
        times = t[0] + (t[-1] - t[0]) * np.concatenate([[0.0], np.cumsum(shares)])
        x = first.copy()
        x[: variables.n_times] = variables.encode(times)[: variables.n_times]
        starts.append(x)
    return starts


def search_from(problem: Problem, starts: Sequence[Array], progress: Progress | None) -> list[Found]:
    """One search from each start, and one more, from where the constraints are nearest to kept, if none kept them.

    A random start that cannot even be made is passed over.
    """
    found = []
    for k, start in enumerate(starts):
        try:
            found.append(search(problem, start))
        except InputError:
            if k == 0:
                raise
        if progress is not None:
            progress(k + 1, len(starts))
    nearest = min(found, key=lambda one: one.rank)
    if nearest.excess > KEPT:
        found.append(_towards_kept(problem, nearest))
    return found


def _towards_kept(problem: Problem, near: Found) -> Found:
    """The excess alone is made least first: a search stops where linearised constraints contradict each other."""
    alone = replace(problem, evaluate=lambda x: (problem.evaluate(x)[1], np.zeros(0)), gradient=None)
    nearest = search(alone, near.x)
    found = search(problem, nearest.x)
    return replace(found, n_evaluations=nearest.n_evaluations + found.n_evaluations)


def refusable(f: Callable[[Given], Answer], given: Given) -> Answer | None:
    """The answer, or None where it is refused."""
    try:
        return f(given)
    except InputError:
        return None


def best_kept(setting: Setting, found: Sequence[Found]) -> Found:
    """The best of several searches, its limits verified by a full assessment.

    Raises
    ------
    NoSolution
        If none kept the constraints.
    """
    best = min(found, key=lambda one: one.rank)
    trajectory = setting.variables.trajectory(best.x)
    verdict = setting.verdict(trajectory)
    failures = () if verdict is None else verdict.failures
    if best.excess > KEPT or failures:
        where = f" ({failures[0]})" if failures else ""
        raise NoSolution(
            f"no via times were found that keep the constraints: the least excess is {best.excess:.4g} (rad, or share"
            f" of a limit){where} at times {np.round(trajectory.times, 4).tolist()} s, after {len(found)} searches",
            residual=best.excess,
            q=trajectory((trajectory.breaks[0] + trajectory.breaks[-1]) / 2),
        )
    return best
