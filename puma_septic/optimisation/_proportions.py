"""Proportions of the segments, and the least duration that each allows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np

from puma_septic.errors import InputError, NoSolution
from puma_septic.objectives import Candidate, interval_extremes
from puma_septic.optimisation._constraints import Excess
from puma_septic.optimisation._problem import Setting
from puma_septic.optimisation._search import COARSE, KEPT, Problem
from puma_septic.optimisation._torque_cuts import least_duration
from puma_septic.paths import ToolLimits, tool_rates
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["Proportions"]

# A part of the needed time far below the largest one never governs; below this share of it, its root is cut off, which
# has an infinite slope at zero.
_IDLE: Final = 0.1
# Peaks are brought to within this part of their limits.
_ROUNDING: Final = 1e-12
# A profile whose peaks, made anew at the scaled times, are this far off does not obey the law of scaling.
_UNSCALED: Final = 1e-9
# Evaluations of one search where effort is to be kept, by velocity, acceleration and jerk alone, and with torque, which
# takes some ms each time: with free velocities of six joints a search would go on for minutes.
_MOST_TIMES: Final = 3000
_MOST_TORQUES: Final = 1000
# The duration changes by no more than this factor in one search.
_STRETCH: Final = 100.0
# How free values scale with time: knots are times, velocities and accelerations go down.
_POWERS: Final = {"free_knots": 1, "velocities": -1, "accelerations": -2}


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Proportions:
    """What is searched: the variables of a motion of 1 s, under limits that scale with its duration.

    Attributes
    ----------
    setting : Setting
        Of a motion of 1 s; its own constraints (positions, overshoot) do not depend on the duration.
    limits : ndarray, shape (3, n_joints)
        Of velocity, acceleration, jerk; NaN where there is none.
    torque : callable or None
        By how much a candidate exceeds its effort limits, where these are to be kept.
    tool_limits : ToolLimits or None
        They scale with the duration, as those of the joints do.
    """

    setting: Setting
    limits: Array
    torque: Excess | None
    tool_limits: ToolLimits | None

    def made(self, x: Array, duration: float) -> Candidate:
        """The motion of these proportions in this time."""
        variables = self.setting.variables
        times = variables.times(x)
        values = variables.values(x, times)
        scaled = {name: value * duration ** _POWERS[name] for name, value in values.items()}
        made = self.setting.judged(variables.make(variables.points, times * duration, **scaled))
        return replace(made, tool_limits=self.tool_limits)

    def quickest(self, x: Array) -> Candidate:
        """The motion of these proportions in the least time that all limits allow.

        Raises
        ------
        NoSolution
            If no duration keeps the effort limits.
        InputError
            If a limited derivative is unbounded, nothing bounds the duration, or the profile does not scale.
        """
        first = self.made(x, 1.0)
        unit, shortest = first.trajectory, self.needed(first)
        if not np.isfinite(shortest):
            raise InputError(f"profile {unit.profile} has unbounded derivatives that are limited, whatever the times")
        if self.torque is None:
            if shortest == 0:
                raise InputError("no joint with a limit moves: any time is long enough")
            return self._scaled(x)
        if not np.isnan(unit.unbounded(2)).all():
            raise InputError(f"profile {unit.profile} takes unbounded torque, whatever the times: its velocity steps")
        candidate = self._scaled(x) if shortest else None
        return least_duration(
            lambda duration: self.made(x, duration), 0.0 if candidate is None else candidate.trajectory.duration
        )

    def start(self, x: Array) -> Trajectory | None:
        """The quickest motion; None where no duration keeps the effort limits."""
        try:
            return self.quickest(x).trajectory
        except NoSolution:
            return None

    def least(self, x: Array) -> float:
        """The least time of these proportions, s; infinite where they keep the limits at no duration.

        Random proportions of which not even a motion can be made count as such, too.
        """
        try:
            candidate = self.quickest(x)
        except (InputError, NoSolution):
            return float("inf")
        is_kept = self.setting.excess(candidate).max(initial=-np.inf) <= KEPT
        return candidate.trajectory.duration if is_kept else float("inf")

    def _scaled(self, x: Array) -> Candidate:
        """The least time for velocity, acceleration and jerk, made anew at that time and measured again.

        Rounding may leave a peak a few units in the last place above its limit; the second pass takes it back.
        """
        duration = 1.0
        for _ in range(3):
            candidate = self.made(x, duration)
            excess = self.needed(candidate)
            if duration != 1.0 and abs(excess - 1) <= _UNSCALED and excess <= 1 + _ROUNDING / 3:
                return candidate
            duration *= excess * (1 + _ROUNDING / 10)
        raise InputError(
            f"profile {candidate.trajectory.profile} does not scale with its times: at the time that it should need,"
            f" its peaks are {excess:.6g} of what the limits allow"
        )

    def without_torque(self, first: Array) -> Problem:
        """Least time by velocity, acceleration and jerk: the largest of what each limit and interval needs."""
        idle = _IDLE * self.needed(self.made(first, 1.0))
        problem = self.setting.problem(lambda candidate: self._times_needed(candidate, idle))
        return problem if self.torque is None else replace(problem, most=_MOST_TIMES)

    def with_torque(self, first: Array) -> tuple[Problem, Callable[[Array], Array]]:
        """Least duration, which is one more variable, under all limits; and where to begin for proportions x."""
        setting = self.setting
        scale = self._duration(first)
        lower, upper = setting.variables.bounds()
        torque = self.torque
        assert torque is not None

        def evaluate(y: Array) -> tuple[Array, Array]:
            duration = scale * float(np.exp(y[-1]))
            candidate = self.made(y[:-1], duration)
            kinematic = self._times_needed(candidate, _IDLE) - 1
            return np.array([duration]), np.concatenate([kinematic, torque(candidate), setting.excess(candidate)])

        reach = np.log(_STRETCH)
        problem = Problem(
            evaluate=evaluate,
            lower=np.append(lower, -reach),
            upper=np.append(upper, reach),
            tolerance=COARSE,
            most=_MOST_TORQUES,
        )
        return problem, lambda x: np.append(x, np.clip(np.log(self._duration(x) / scale), -reach, reach))

    def _duration(self, x: Array) -> float:
        """To begin with: the least duration, or where there is none that by velocity, acceleration and jerk."""
        try:
            return self.quickest(x).trajectory.duration
        except NoSolution:
            return self.needed(self.made(x, 1.0)) or 1.0

    def _times_needed(self, candidate: Candidate, idle: float) -> Array:
        """For each limit, joint and interval, the needed time over that of the motion, over 1 s; idle ones cut off."""
        known = ~np.isnan(self.limits)
        needed = [np.zeros(0)]
        for order in (1, 2, 3):
            extremes = interval_extremes(candidate.trajectory.derivative(order)).reshape(-1, self.limits.shape[1])
            shares = (extremes / self.limits[order - 1])[:, known[order - 1]].ravel()
            needed.append(np.maximum(shares, idle**order) ** (1 / order))
        if self.tool_limits is not None:
            needed.append(np.array([max(self._of_tool(candidate), idle)]))
        return np.concatenate(needed)

    def needed(self, candidate: Candidate) -> float:
        """What velocity, acceleration, jerk and the tool need over what the motion takes; infinite where unbounded."""
        peaks = np.stack([candidate.trajectory.peak(order)[0] for order in (1, 2, 3)])
        joints = np.nanmax((peaks / self.limits) ** (1 / np.array([[1.0], [2.0], [3.0]])), initial=0.0)
        return max(float(joints), self._of_tool(candidate))

    def _of_tool(self, candidate: Candidate) -> float:
        robot, limits = candidate.robot, self.tool_limits
        if robot is None or limits is None:
            return 0.0
        return tool_rates(robot, candidate.trajectory).needed_stretch(limits)
