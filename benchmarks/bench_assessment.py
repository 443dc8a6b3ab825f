"""Joint metrics of the paper's move: peaks and root mean squares of velocity, acceleration, jerk and torque."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.interpolate import make_interp_spline

import puma_septic as ps
from puma_septic.paper import PAPER

sys.path.append(str(Path(__file__).parents[1] / "tests"))
from helpers.sampled import quadrature, refined_peak, torque_with_friction

Array = NDArray[np.float64]
# Peaks and root mean squares, each of shape (4, n_joints): velocity, acceleration, jerk, torque.
Metrics = tuple[Array, Array]

# Table 1 and times of Raji, Asaolu, Akano, rad and s; joint 4 does not move.
POINTS, TIMES = PAPER.table_1, PAPER.times
MOVING = [0, 1, 2, 4, 5]
DT = 1e-3  # 9,001 samples
BLEND_TIME = 1.0
ROUNDS = 25


def run() -> list[tuple[str, ...]]:
    """Time all in turn, round by round, so that a busy machine slows all of them alike."""
    septic = ps.septic(POINTS, TIMES)
    lspb = ps.lspb(POINTS, durations=np.diff(TIMES), blend_time=BLEND_TIME)
    contenders: dict[str, tuple[Callable[[], Metrics], ps.Trajectory]] = {
        "puma_septic: septic, exact": (exactly(), septic),
        "SciPy septic + pin.rnea loop, 1 kHz": (sampled_with_pinocchio(), septic),
    }
    if find_spec("roboticstoolbox") is not None:
        contenders["Robotics Toolbox mstraj + rne, 1 kHz"] = (sampled_with_toolbox(), lspb)
    metrics = {name: contender() for name, (contender, _) in contenders.items()}
    seconds: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(ROUNDS):
        for name, (contender, _) in contenders.items():
            start = perf_counter()
            contender()
            seconds[name].append(perf_counter() - start)
    first = next(iter(contenders))
    rows = [
        (
            "joint metrics of the paper's move",
            "median",
            "best",
            "times slower",
            "peak torque error",
            "RMS torque error",
            "joint 4's (at rest)",
        )
    ]
    for name, values in seconds.items():
        slower = np.median(np.array(values) / seconds[first])
        errors = torque_errors(metrics[name], contenders[name][1])
        rows.append((name, _ms(np.median(values)), _ms(min(values)), f"{slower:.1f}", *errors))
    if len(contenders) == 2:
        rows.append(("Robotics Toolbox is not installed (extra: bench)", "", "", "", "", "", ""))
    return rows


def exactly() -> Callable[[], Metrics]:
    """What a user writes, tool metrics apart, which are computed when they are asked for."""
    robot = ps.load_robot()

    def metrics() -> Metrics:
        a = ps.assess(robot, ps.septic(POINTS, TIMES))
        peaks = a.peak_velocity, a.peak_acceleration, a.peak_jerk, a.peak_torque
        return np.array(peaks), np.array([a.rms_velocity, a.rms_acceleration, a.rms_jerk, a.rms_torque])

    return metrics


def sampled_with_pinocchio() -> Callable[[], Metrics]:
    """The septic as a SciPy spline of one piece, inverse dynamics sample by sample, friction added."""
    robot = ps.load_robot()
    model, data = robot.model, robot.model.createData()
    positive, negative = robot.coulomb_friction.T
    t = np.arange(0.0, TIMES[-1] + DT / 2, DT)
    knots = np.repeat(TIMES[[0, -1]], 8)
    rest = [(1, np.zeros(6)), (2, np.zeros(6))]

    def metrics() -> Metrics:
        spline = make_interp_spline(TIMES, POINTS, k=7, t=knots, bc_type=(rest, rest))
        q, v, a, jerk = (spline(t, order) for order in range(4))
        tau = np.empty_like(q)
        rnea = pin.rnea
        for i in range(len(t)):
            tau[i] = rnea(model, data, q[i], v[i], a[i])
        tau += robot.viscous_friction * v + np.where(v > 0, positive, np.where(v < 0, negative, 0.0))
        return of_samples(t, v, a, jerk, tau)

    return metrics


def sampled_with_toolbox() -> Callable[[], Metrics]:
    """The toolbox's LSPB, which has no derivatives: differences; its inverse dynamics adds friction."""
    import roboticstoolbox as rtb

    puma = rtb.models.DH.Puma560()

    def metrics() -> Metrics:
        move = rtb.mstraj(POINTS, dt=DT, tacc=BLEND_TIME, tsegment=np.diff(TIMES))
        q = np.vstack([POINTS[0], move.q])  # it leaves the first point out
        t = DT * np.arange(len(q))
        v = np.gradient(q, DT, axis=0)
        a = np.gradient(v, DT, axis=0)
        return of_samples(t, v, a, np.gradient(a, DT, axis=0), puma.rne(q, v, a))

    return metrics


def of_samples(t: Array, *series: Array) -> Metrics:
    peaks = np.array([np.abs(x).max(axis=0) for x in series])
    return peaks, np.array([np.sqrt(np.trapezoid(x**2, t, axis=0) / t[-1]) for x in series])


def torque_errors(metrics: Metrics, trajectory: ps.Trajectory) -> tuple[str, str, str]:
    """Largest relative error of peak and RMS torque on the joints that move, and of the peak on the one that rests.

    Against dense samples refined locally and Gauss quadrature between the reversals.
    """
    torque, breaks = torque_with_friction(ps.load_robot(), trajectory)
    peak = refined_peak(torque, breaks, 20_000)
    rms = np.sqrt(quadrature(lambda t: torque(t) ** 2, breaks, 200) / trajectory.duration)
    of_peak, of_rms = (np.abs(got[3] / true - 1) for got, true in zip(metrics, (peak, rms), strict=True))
    return f"{of_peak[MOVING].max():.0e}", f"{of_rms[MOVING].max():.0e}", f"{of_peak[3]:.0e}"


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.2f} ms"
