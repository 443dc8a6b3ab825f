"""Candidates: pairs of motor and gearbox that no known limit rejects, assessed in full."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from puma_septic.drives import Drivetrain, lacking
from puma_septic.limit_check import LimitCheck, most_used_first
from puma_septic.sizing._conditions import Conditions
from puma_septic.sizing._demands import Demands
from puma_septic.sizing._load_cases import JointCase, life_of_mix, outcomes_of_cases, shortest_cycle
from puma_septic.sizing._load_features import LoadGrid
from puma_septic.sizing._ratios import LoadMoments, RatioWindow, ratio_window

__all__ = ["Candidate", "assessed", "governing_check"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Candidate:
    """A pair that no known limit rejects, assessed in full.

    Attributes
    ----------
    demands : Demands
        With the drive train; of several load cases those of the one that governs.
    checks : tuple of LimitCheck
        All limits that are known, the most used first, each in the load case that uses most of it.
    governing : LimitCheck or None
        The one with the least left of what may be used, rules of thumb apart; None where none is known.
    stress : float
        Its utilisation over what may be used, ``utilisation / (1 - margin)``; 0 where none is known.
    mass, cost : float
        Of motor and gearbox; NaN: unknown.
    life_hours : float
        Expected of the gearbox in the mix of the load cases; NaN: unknown.
    lacking : tuple of str
        What of the least set is not known; such a pair is not decidable.
    window : RatioWindow or None
        Ratios that would do for this motor with this gearbox's inertia and efficiencies; None where its continuous
        torque or the inertia is unknown. It knows of RMS torque and speed alone, and of no friction.
    """

    demands: Demands
    checks: tuple[LimitCheck, ...]
    governing: LimitCheck | None
    stress: float
    mass: float
    cost: float
    life_hours: float
    lacking: tuple[str, ...]
    window: RatioWindow | None

    @property
    def drivetrain(self) -> Drivetrain:
        """What was assessed."""
        return self.demands.train

    @property
    def motor(self) -> str:
        """Name of the motor."""
        return self.drivetrain.motor.name

    @property
    def gearbox(self) -> str:
        """Name of the gearbox."""
        return self.drivetrain.gearbox.name

    @property
    def margin(self) -> float:
        """What is left of the governing limit, ``1 - demand / limit``; NaN where none is known."""
        return np.nan if self.governing is None else self.governing.margin


def assessed(cases: tuple[JointCase, ...], train: Drivetrain, conditions: Conditions) -> Candidate:
    """A drive train in full, in every case, by the code that assesses any drive train."""
    every = tuple(case.demands(train) for case in cases)
    outcomes = outcomes_of_cases(cases, every)
    checks = most_used_first(one for one in outcomes if isinstance(one, LimitCheck))
    governing = governing_check(checks, conditions)
    names = [case.name for case in cases]
    where = names.index(governing.case) if governing is not None and governing.case in names else 0
    windows = [_window(one, case.grid) for case, one in zip(cases, every, strict=True) if case.only is None]
    return Candidate(
        demands=every[where],
        checks=checks,
        governing=governing,
        stress=0.0 if governing is None else conditions.stress(governing),
        mass=train.motor.mass + train.gearbox.mass,
        cost=train.motor.cost + train.gearbox.cost,
        life_hours=life_of_mix(cases, every),
        lacking=lacking(train, cycle=shortest_cycle(cases)),
        window=_common(windows),
    )


def governing_check(checks: tuple[LimitCheck, ...], conditions: Conditions) -> LimitCheck | None:
    """The first with the least left of what may be used, rules of thumb apart.

    Returns
    -------
    LimitCheck or None
    """
    binding = [check for check in checks if check.kind != "rule of thumb"]
    return max(binding, key=lambda check: float(f"{conditions.stress(check):.9g}"), default=None)


def _window(demands: Demands, grid: LoadGrid) -> RatioWindow | None:
    """By the moments of the load as it comes through the gears, losses of either direction included."""
    train = demands.train
    torque = demands.continuous_torque
    if not (torque > 0 and train.inertia > 0):
        return None
    passed = train.transmission[::-1]
    moments = LoadMoments(
        torque_square=max(float(passed @ grid.gram[1:4, 1:4] @ passed), 0.0),
        acceleration_square=float(grid.gram[0, 0]),
        product=float(grid.gram[0, 1:4] @ passed),
        peak_speed=grid.moments.peak_speed,
    )
    limits = [train.motor.max_speed, train.gearbox.max_input_speed, np.inf]
    return ratio_window(moments, inertia=train.inertia, continuous_torque=torque, max_speed=float(np.nanmin(limits)))


def _common(windows: list[RatioWindow | None]) -> RatioWindow | None:
    """The ratios that do in every case; the optimum is that of the first in which the joint moves."""
    known = [window for window in windows if window is not None]
    if len(known) < len(windows) or not known:
        return None
    least, most = max(window.least for window in known), min(window.most for window in known)
    if any(window.is_empty for window in known) or not least <= most:
        least = most = np.nan
    optimal = next((window.optimal for window in known if np.isfinite(window.optimal)), np.inf)
    return RatioWindow(least=least, most=most, optimal=optimal)
