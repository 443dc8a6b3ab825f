"""Profiles made and evaluated, position to jerk: one move at 1,000 times, and 10,000 septics in one call."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BPoly, BSpline, PPoly, make_interp_spline

import puma_septic as ps
from puma_septic.paper import PAPER

Array = NDArray[np.float64]

# Table 1 and times of Raji, Asaolu, Akano, rad and s; joint 4 does not move.
POINTS, TIMES = PAPER.table_1, PAPER.times
BLEND_TIME = 1.0
DT = 9e-3  # mstraj rounds durations and blends up or down to it and comes out at 995 steps
CASES, CASE_TIMES = 10_000, 200
ROUNDS, FEW_ROUNDS = 60, 5

Contenders = dict[str, Callable[[], Array]]


def run() -> list[tuple[str, ...]]:
    """Three races; in each all take turns, round by round, so that a busy machine slows all of them alike."""
    return [
        ("made and evaluated, position to jerk", "median", "best", "times slower", "largest difference"),
        *raced("septic, 6 joints, 1,000 times", one_septic(), ROUNDS),
        *raced("LSPB, 6 joints, 1,000 times", one_lspb(), ROUNDS),
        *raced(f"{CASES:,} septics, 6 joints, {CASE_TIMES} times", many_septics(), FEW_ROUNDS),
    ]


def raced(title: str, contenders: Contenders, rounds: int) -> list[tuple[str, ...]]:
    answers = {name: contender() for name, contender in contenders.items()}
    seconds: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(rounds):
        for name, contender in contenders.items():
            start = perf_counter()
            contender()
            seconds[name].append(perf_counter() - start)
    first = next(iter(contenders))
    rows = [(f"{title}:", "", "", "", "")]
    for name, values in seconds.items():
        slower = np.median(np.array(values) / seconds[first])
        same = answers[name].shape == answers[first].shape
        difference = f"{np.abs(answers[name] - answers[first]).max():.0e}" if same else "-"
        rows.append((f"  {name}", _ms(np.median(values)), _ms(min(values)), f"{slower:.2f}", difference))
    return rows


def one_septic() -> Contenders:
    t = np.linspace(0.0, 9.0, 1000)

    def ours() -> Array:
        return ps.septic(POINTS, TIMES).state(t)

    def order_by_order() -> Array:
        move = ps.septic(POINTS, TIMES)
        return np.hstack([move(t, order) for order in range(4)])

    def ppoly() -> Array:
        return of_ppoly(septic_ppoly(POINTS), t)

    def spline() -> Array:
        return of_ppoly(septic_spline(POINTS), t)

    contenders = {
        "puma_septic: trajectory.state(t)": ours,
        "puma_septic: trajectory(t, order), four calls": order_by_order,
        "SciPy: 8 equations, PPoly": ppoly,
        "SciPy: make_interp_spline": spline,
    }
    if find_spec("roboticstoolbox") is not None:
        contenders["Robotics Toolbox: mstraj, differences"] = toolbox()
    return contenders


def one_lspb() -> Contenders:
    t = np.linspace(0.0, 9.0, 1000)
    move = ps.lspb(POINTS, durations=np.diff(TIMES), blend_time=BLEND_TIME)
    powers, breaks = np.moveaxis(move.power_coefficients(), 1, 0)[::-1].copy(), move.breaks
    ends = np.stack([move(breaks, order) for order in range(3)], axis=1)

    def ours() -> Array:
        return ps.lspb(POINTS, durations=np.diff(TIMES), blend_time=BLEND_TIME).state(t)

    def evaluated_by_ppoly() -> Array:
        return of_ppoly(PPoly(powers, breaks), t)

    def made_by_scipy() -> Array:
        return of_ppoly(lspb_ppoly(breaks, ends), t)

    contenders = {
        "puma_septic: trajectory.state(t)": ours,
        "SciPy: BPoly.from_derivatives, PPoly": made_by_scipy,
        "SciPy: PPoly, evaluated only, coefficients given": evaluated_by_ppoly,
    }
    if find_spec("roboticstoolbox") is not None:
        contenders["Robotics Toolbox: mstraj, differences"] = toolbox()
    return contenders


def toolbox() -> Callable[[], Array]:
    """Its motion has no derivatives: differences."""
    import roboticstoolbox as rtb

    def mstraj() -> Array:
        parts = [rtb.mstraj(POINTS, dt=DT, tacc=BLEND_TIME, tsegment=np.diff(TIMES)).q]
        for _ in range(3):
            parts.append(np.gradient(parts[-1], DT, axis=0))
        return np.hstack(parts)

    return mstraj


def many_septics() -> Contenders:
    """Many moves with the same times are one with more joints: points (4, cases, 6) become (4, cases * 6)."""
    rng = np.random.default_rng(560)
    points = rng.uniform(-2.0, 2.0, (CASES, 4, 6))
    t = np.linspace(0.0, 9.0, CASE_TIMES)

    def batch() -> Array:
        state = ps.septic(points.transpose(1, 0, 2).reshape(4, -1), TIMES).state(t)
        return state.reshape(CASE_TIMES, 4, CASES, 6)[:, :, -1]

    def loop(make: Callable[[Array], Any]) -> Array:
        states = np.empty((CASES, CASE_TIMES, 24))
        for state, case in zip(states, points, strict=True):
            curve = make(case)
            for order in range(4):
                state[:, 6 * order : 6 * (order + 1)] = curve(t, order)
        return states[-1].reshape(CASE_TIMES, 4, 6)

    return {
        "puma_septic: one call": batch,
        "SciPy: 8 equations, PPoly, in a loop": lambda: loop(septic_ppoly),
        "SciPy: make_interp_spline in a loop": lambda: loop(septic_spline),
    }


def septic_ppoly(points: Array) -> PPoly:
    """Positions at four times, velocity and acceleration zero at both ends, in powers of s = t/T."""
    s, k = TIMES / TIMES[-1], np.arange(8)
    conditions = np.vstack([s[:, None] ** k, np.eye(8)[1:3] * [[1], [2]], k, k * (k - 1)])
    powers = np.linalg.solve(conditions, np.vstack([points, np.zeros((4, points.shape[1]))]))
    powers /= TIMES[-1] ** k[:, None]
    return PPoly(powers[::-1, None], TIMES[[0, -1]])


def septic_spline(points: Array) -> BSpline:
    """The same by SciPy's own function for it: a B-spline of degree 7 without inner knots."""
    rest = [(1, np.zeros(points.shape[1])), (2, np.zeros(points.shape[1]))]
    return make_interp_spline(TIMES, points, k=7, t=np.repeat(TIMES[[0, -1]], 8), bc_type=(rest, rest))


def lspb_ppoly(breaks: Array, ends: Array) -> PPoly:
    """Blends and lines are all quintics: SciPy's Hermite interpolation of position, velocity and acceleration."""
    return PPoly.from_bernstein_basis(BPoly.from_derivatives(breaks, ends))


def of_ppoly(curve: PPoly | BSpline, t: Array) -> Array:
    return np.hstack([curve(t, order) for order in range(4)])


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.3f} ms"


if __name__ == "__main__":
    for row in run():
        print("  ".join(f"{cell:52}" if k == 0 else f"{cell:>14}" for k, cell in enumerate(row)))
