"""The least time through given points under limits of velocity, acceleration, jerk, effort and position."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.document import SCHEMAS, card, one_line, plain
from puma_septic.errors import InputError, NoSolution
from puma_septic.limit_check import AT_LIMIT
from puma_septic.objectives import Candidate
from puma_septic.optimisation._constraints import (
    Verdict,
    check_cell,
    checked_quantities,
    excess_function,
    known_quantities,
    told,
    verdict_of,
)
from puma_septic.optimisation._problem import (
    MOST_RESTARTS,
    Progress,
    Setting,
    best_kept,
    checked_setting,
    random_starts,
    search_from,
)
from puma_septic.optimisation._proportions import Proportions
from puma_septic.optimisation._search import COARSE, FINE, KEPT, Found
from puma_septic.optimisation._variables import MakeTrajectory
from puma_septic.paths import ToolLimits
from puma_septic.quantities import COMMON, MOTION
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_each, checked_times, checked_whole, frozen, n_dimensions
from puma_septic.views.tables import Cell

__all__ = ["LeastTime", "least_time"]

# Of its largest velocity, what a motion that is made to start at rest may have there by rounding.
_STILL: Final = 1e-9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LeastTime:
    """What `least_time` reached.

    Attributes
    ----------
    trajectory : Trajectory
        The quickest motion found that keeps the limits.
    start : Trajectory or None
        The segments in the proportions begun with, as quick as the limits allow; None if they keep them at no duration.
    limits : ndarray, shape (3, n_joints)
        Of velocity, acceleration, jerk, that the search kept; NaN where there is none.
    ends : tuple of float
        Least time at the end of each search, s; infinite where a limit stayed violated.
    n_evaluations : int
    n_cut : int
        Searches that were ended by the number of their evaluations, before they converged.
    verdict : Verdict or None
        The motion found, assessed in full: limits respected, not held, not assessed; None without a robot.
    """

    trajectory: Trajectory
    start: Trajectory | None
    limits: Array
    ends: tuple[float, ...]
    n_evaluations: int
    n_cut: int
    verdict: Verdict | None

    @property
    def duration(self) -> float:
        """Least time found, s."""
        return self.trajectory.duration

    @property
    def utilisation(self) -> Array:
        """Exact peaks as shares of the limits, shape (3, n_joints); NaN where there is no limit."""
        return frozen(np.stack([self.trajectory.peak(order)[0] for order in (1, 2, 3)]) / self.limits)

    @property
    def is_feasible(self) -> bool:
        """Whether every exact peak keeps its limit, and the motion every known limit of the robot, respected or not."""
        used = self.utilisation
        is_kept = bool(np.all((used <= 1 + AT_LIMIT) | np.isnan(self.limits)))
        return is_kept and (self.verdict is None or self.verdict.is_feasible)

    @property
    def statement(self) -> str:
        """What was reached, how sure it is, and what the limits say to it."""
        return self._reached if self.verdict is None else f"{self._reached}; {self.verdict.statement}"

    @property
    def _reached(self) -> str:
        same = sum(end <= self.duration * (1 + 1e-3) for end in self.ends)
        tolerance = FINE if self.verdict is None or "effort" not in self.verdict.respected else COARSE
        cut = f"; {self.n_cut} of them ended by the number of evaluations, not yet converged" if self.n_cut else ""
        what = "the best verified motion" if self.n_cut else "a local optimum, the best"
        return (
            f"{what} of {len(self.ends)} searches, {same} of which ended within 0.1 % of it{cut}; no"
            f" proof that none is quicker; feasible by exact extrema: {'yes' if self.is_feasible else 'no'}; SLSQP with"
            f" central differences, relative tolerance {tolerance:g}, {self.n_evaluations} evaluations"
        )

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document, SI units."""
        return {
            "schema": SCHEMAS["least-time"],
            "profile": self.trajectory.profile,
            "duration": self.duration,
            "times": plain(self.trajectory.times),
            "breaks": plain(self.trajectory.breaks),
            "start": self.start and {"duration": self.start.duration, "times": plain(self.start.times)},
            "is_feasible": self.is_feasible,
            "utilisation": {name: plain(column) for name, column in self._used().items()},
            "ends": plain(self.ends),
            "n_evaluations": self.n_evaluations,
            "n_cut": self.n_cut,
            "limits": None if self.verdict is None else self.verdict.to_dict(),
            "statement": self.statement,
        }

    @property
    def sentence(self) -> str:
        """What was found, in one line."""
        times = ", ".join(f"{t:z.4f}" for t in self.trajectory.times)
        start = "at no duration" if self.start is None else f"{self.start.duration:z.4f} s"
        return (
            f"{self.trajectory.profile}: least time {self.duration:z.4f} s ({start} with the segments in the given"
            f" proportions); points at {times} s"
        )

    @property
    def table(self) -> tuple[tuple[str, ...], tuple[tuple[Cell, ...], ...]]:
        """Heads and rows: what each joint uses of each limit."""
        names = self._joint_names()
        rows: list[list[Cell]] = [
            [name, *("--" if np.isnan(column[j]) else f"{100 * column[j]:z.1f} %" for column in self._used().values())]
            for j, name in enumerate(names)
        ]
        return ("used of the limit", *self._used()), tuple(map(tuple, rows))

    @property
    def notes(self) -> tuple[str, ...]:
        """Which limits were respected, and how the optimum was reached."""
        return (*([] if self.verdict is None else [self.verdict.sentence]), f"Reached: {self._reached}.")

    def __str__(self) -> str:
        return told(self.sentence, self.table, self.notes)

    def _joint_names(self) -> Sequence[str]:
        if self.verdict is not None:
            return self.verdict.joint_names
        return self.trajectory.joint_names or [f"joint {j + 1}" for j in range(self.trajectory.n_joints)]

    def _used(self) -> dict[str, Array]:
        """Use of each limit by each joint, of the robot's too where it was not respected; NaN where there is none."""
        used = dict(zip(MOTION[1:], self.utilisation, strict=True))
        if self.verdict is None:
            return used
        nothing = np.full(self.trajectory.n_joints, np.nan)
        return {
            name: np.fmax(used.get(name, nothing), self.verdict.used(name)) for name in (*used, "effort", "position")
        }

    def __repr__(self) -> str:
        return one_line("LeastTime", self._facts())

    def _repr_html_(self) -> str:
        return card("LeastTime", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "profile": self.trajectory.profile,
            "duration": f"{self.duration:.6g} s",
            "feasible": "yes" if self.is_feasible else "no",
        }


def least_time(
    make: MakeTrajectory,
    points: ArrayLike,
    times: ArrayLike,
    *,
    robot: Robot | None = None,
    keep: Sequence[str] | None = None,
    max_velocity: ArrayLike | None = None,
    max_acceleration: ArrayLike | None = None,
    max_jerk: ArrayLike | None = None,
    max_overshoot: ArrayLike | None = None,
    dwell: float = 0.0,
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
    free: Sequence[str] = (),
    restarts: int = 4,
    seed: int = 0,
    progress: Progress | None = None,
) -> LeastTime:
    """Choose the segments' durations so that the whole takes the least time within the limits.

    For given proportions of the segments the least time is known exactly. Stretching time by k divides velocity,
    acceleration and jerk by k, k^2 and k^3, so with the exact peaks V, A, J of the motion that takes 1 s they need the
    largest of ``V/v_max``, ``(A/a_max)^(1/2)``, ``(J/j_max)^(1/3)`` over the joints. It divides the inertial torque by
    k^2, viscous friction by k, and leaves weight and Coulomb friction as they are: the least duration from there on at
    which torque keeps its limits follows from a quadratic at each instant. The proportions are searched.

    Parameters
    ----------
    make : callable
        A profile whose motion is determined by points and times, such as `cubic_spline_free_knots`.
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints); without a robot, any unit that the limits share will do.
    times : array_like, shape (k,) or ()
        Proportions to begin with, or 1. The motion begins at the first of them, s, or at 0.
    robot : Robot, optional
        Whose limits are kept; needed for effort and position.
    keep : sequence of str, optional
        Which of them: "position", "velocity", "acceleration", "jerk", "effort"; all that are known by default. The
        others, such as the torque's rate, are assessed too, and named where they are not held.
    max_velocity, max_acceleration, max_jerk : array_like, shape () or (n_joints,), optional
        Further limits, or those without a robot; NaN where there is none. rad/s, rad/s^2, rad/s^3.
    max_overshoot : array_like, shape () or (n_joints,), optional
        Largest excess beyond the hull of the points, rad.
    dwell : float
        Rest after the motion, s: its holding torque must keep the effort limits too.
    floor : float, optional
        Height that the arm must stay above, m: kept, as are the limits of the tool.
    tool_limits : ToolLimits, optional
        What the tool may do at most.
    free : sequence of str
        Arguments of `make` to be chosen as well: "free_knots", or "velocities", "accelerations" at the vias.
    restarts, seed, progress
        As in `optimise_via_times`.

    Returns
    -------
    LeastTime

    Raises
    ------
    InputError
        For arguments that are not valid, an acceleration or jerk that is unbounded although it is limited, or a
        profile that does not scale with its times.
    NoSolution
        For an excerpt that starts or ends moving, and if no duration keeps the limits of position (points beyond them),
        overshoot, or effort: weight and Coulomb
        friction do not become less in any time. The message has the joint, its value and its limit.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> points = [[0.0], [1.0], [2.0]]
    >>> result = least_time(profiles.quintic_spline, points, 1.0, max_jerk=60.0, restarts=0)
    >>> round(result.duration, 4), result.is_feasible  # (60 h / j)^(1/3), h = 2
    (1.2599, True)
    """
    quantities = _respected(robot, keep)
    check_cell(robot, floor, tool_limits)
    given = np.zeros(1) if n_dimensions(times) == 0 else checked_times("times", times)
    begin, total = float(given[0]), 1.0 if n_dimensions(times) == 0 else _shares(given)
    untimed = [name for name in quantities if name == "position"]
    setting = checked_setting(
        make,
        points,
        total,
        robot=robot,
        free=free,
        max_overshoot=max_overshoot,
        keep=untimed,
        dwell=dwell,
        floor=floor,
        tool_limits=None,
        least=2,
    )
    race = _race(setting, (max_velocity, max_acceleration, max_jerk), robot, quantities, tool_limits)
    count = checked_whole("restarts", restarts, at_least=0, at_most=MOST_RESTARTS) if setting.variables.size else 0
    starts = random_starts(setting.variables, setting.first(), count, seed)
    _refuse_moving_ends(setting.variables.trajectory(starts[0]))
    start = race.start(starts[0])
    candidate, ends, found = _raced(race, starts, progress)
    if begin:
        start = start and start.shifted(begin)
        candidate = replace(candidate, trajectory=candidate.trajectory.shifted(begin))
    verdict = verdict_of(candidate, quantities)
    if verdict is not None and verdict.failures:
        raise _nothing_keeps(race, candidate, str(verdict.failures[0]))
    return LeastTime(
        trajectory=candidate.trajectory,
        start=start,
        limits=race.limits,
        ends=ends,
        n_evaluations=sum(one.n_evaluations for one in found),
        n_cut=sum(one.is_cut for one in found),
        verdict=verdict,
    )


def _race(
    setting: Setting,
    given: Sequence[ArrayLike | None],
    robot: Robot | None,
    quantities: Sequence[str],
    tool_limits: ToolLimits | None,
) -> Proportions:
    """Which proportions are to be found, and the limits by which they take their least time."""
    n_joints = setting.variables.points.shape[1]
    limits = _checked_limits(n_joints, given, robot, quantities)
    has_effort = "effort" in quantities
    if np.isnan(limits).all() and not has_effort and tool_limits is None:
        raise InputError(
            "without a limit there is no least time; give max_velocity, max_acceleration or max_jerk, or a robot whose"
            " limits are known"
        )
    torque = excess_function(robot, n_joints, max_overshoot=None, keep=("effort",)) if has_effort else None
    return Proportions(setting=setting, limits=limits, torque=torque, tool_limits=tool_limits)


def _refuse_moving_ends(trajectory: Trajectory) -> None:
    """Raise a NoSolution where an excerpt starts or ends moving: another duration would change that velocity."""
    ends = [(0, trajectory.rest_before), (-1, trajectory.rest_after)]
    still = _STILL * float(trajectory.peak(1)[0].max())
    for end, is_at_rest in ends:
        speed = float(np.abs(trajectory(trajectory.breaks[end], 1)).max())
        if not is_at_rest and speed > still:
            raise NoSolution(
                "no stretch keeps the velocity with which the motion starts or ends; give one from rest to rest",
                residual=speed,
                q=trajectory(trajectory.breaks[end]),
            )


def _shares(times: Array) -> Array:
    """Times from 0 to 1; a single one, which `checked_setting` refuses, as it is."""
    return (times - times[0]) / float(np.ptp(times)) if len(times) > 1 else times


def _respected(robot: Robot | None, keep: Sequence[str] | None) -> tuple[str, ...]:
    """The named limits, or all that are known of those that the search can keep."""
    if keep is None:
        return tuple(name for name in known_quantities(robot) if name in COMMON)
    quantities = checked_quantities(keep)
    for name in quantities:
        if name not in COMMON:
            raise InputError(
                f"least time cannot keep the {name} limit; valid: {', '.join(COMMON)}. It is assessed, and named where"
                " it is not held"
            )
    return quantities


def _checked_limits(
    n_joints: int, given: Sequence[ArrayLike | None], robot: Robot | None, quantities: Sequence[str]
) -> Array:
    """Those given and those of the robot, the lesser of both, shape (3, n_joints); NaN where there is none."""
    limits = np.full((3, n_joints), np.nan)
    for row, name, value in zip(limits, MOTION[1:], given, strict=True):
        if value is not None:
            row[:] = checked_each(f"max_{name}", value, n_joints, allow_nan=True, above=0.0)
        if robot is not None and name in quantities:
            row[:] = np.fmin(row, getattr(robot.limits, name))
    limits.setflags(write=False)
    return limits


def _raced(
    race: Proportions, starts: Sequence[Array], progress: Progress | None
) -> tuple[Candidate, tuple[float, ...], list[Found]]:
    """The quickest motion, the least time at the end of each search that counts, and all searches.

    Where the least time by velocity, acceleration and jerk keeps the effort limits as well, nothing is quicker; else
    the search begins anew, with the duration as a variable, from the timings that keep all limits at some duration.
    """
    first: list[Found] = []
    if not np.isnan(race.limits).all() or race.tool_limits is not None:
        first = search_from(race.without_torque(starts[0]), starts, progress)
        best = best_kept(race.setting, first)
        if race.torque is None or race.least(best.x) <= best.value * (1 + KEPT):
            ends = tuple(one.value if one.excess <= KEPT else np.inf for one in first)
            return race.quickest(best.x), ends, first
        starts = [best.x, *starts]
    starts = [x for x in starts if np.isfinite(race.least(x))] or starts[:1]
    problem, begin = race.with_torque(starts[0])
    found = search_from(problem, [begin(x) for x in starts], progress)
    tried = [*(one.x[:-1] for one in found), *starts]
    least = [race.least(x) for x in tried]
    if not np.isfinite(min(least)):
        raise _none_found(race, tried)
    candidate = race.quickest(tried[int(np.argmin(least))])
    return candidate, tuple(least[: len(found)]), [*first, *found]


def _none_found(race: Proportions, tried: Sequence[Array]) -> NoSolution:
    """No proportions that were tried keep all limits: why the first do not."""
    try:
        candidate = race.quickest(tried[0])
    except NoSolution as error:
        searched = f"; {len(tried)} timings of the segments were tried" if len(tried[0]) else ""
        return NoSolution(f"{error}{searched}", residual=error.residual, q=error.q)
    return _nothing_keeps(race, candidate, "position or overshoot is exceeded wherever effort is kept")


def _nothing_keeps(race: Proportions, nearest: Candidate, why: str) -> NoSolution:
    trajectory = nearest.trajectory
    return NoSolution(
        f"no duration was found that keeps the limits: {why}",
        residual=float(race.setting.excess(nearest).max(initial=0.0)),
        q=trajectory((trajectory.breaks[0] + trajectory.breaks[-1]) / 2),
    )
