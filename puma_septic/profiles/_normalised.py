"""The profiles' coefficients for one unit of movement in one unit of time, from rest to rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from puma_septic.piecewise import Piecewise
from puma_septic.profiles._blends import polynomial_blends, trapezoidal
from puma_septic.profiles._bspline import bspline
from puma_septic.profiles._double_s import double_s
from puma_septic.profiles._hermite import classic_septic, cubic
from puma_septic.profiles._mstraj import lspb
from puma_septic.profiles._quintic import quintic
from puma_septic.profiles._rest_to_rest import (
    bang_bang,
    cycloidal,
    harmonic,
    modified_sine,
    modified_trapezoidal,
)
from puma_septic.profiles._trigonometric import trigonometric_spline
from puma_septic.trajectory import Trajectory

__all__ = ["NormalisedRow", "normalised_table"]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class NormalisedRow:
    """Coefficients of a move of h in T from rest to rest; infinite where unbounded.

    Attributes
    ----------
    profile : str
        The family and its parameters.
    velocity, acceleration, jerk : float
        Peaks: ``max|v| = velocity h/T``, ``max|a| = acceleration h/T^2``, ``max|j| = jerk h/T^3``.
    finite_jerk : float
        The peak of the jerk beside impulses.
    rms_velocity, rms_acceleration, rms_jerk : float
        Root mean squares in the same units.
    power : float
        ``max|v a|`` in h^2/T^3: what a pure inertia asks of a motor.
    continuity : str
        Measured class of the whole motion, rest included; C3 says at least 3.
    end_jerk : float
        The larger of the jerks at both ends in h/T^3.
    """

    profile: str
    velocity: float
    acceleration: float
    jerk: float
    finite_jerk: float
    rms_velocity: float
    rms_acceleration: float
    rms_jerk: float
    power: float
    continuity: str
    end_jerk: float


def normalised_table() -> tuple[NormalisedRow, ...]:
    """One row for each law from rest to rest, computed from the profiles themselves.

    Returns
    -------
    tuple of NormalisedRow

    Examples
    --------
    >>> from puma_septic import profiles
    >>> {row.profile: round(row.velocity, 4) for row in profiles.normalised_table()}["classic septic 4-5-6-7"]
    2.1875
    """
    return tuple(_row(label, trajectory) for label, trajectory in _moves().items())


def _moves() -> dict[str, Trajectory]:
    """Every move from 0 to 1 in 1 s."""
    points, times = [[0.0], [1.0]], [0.0, 1.0]
    third = 1 / 3
    return {
        "bang-bang": bang_bang(points, times),
        "LSPB, Ta = T/3": trapezoidal(points, times, blend_time=third),
        "cubic": cubic(points, times),
        "harmonic": harmonic(points, times),
        "cycloidal": cycloidal(points, times),
        "quintic 3-4-5": quintic(points, times),
        "classic septic 4-5-6-7": classic_septic(points, times),
        # Ramps of Tj and 2 Tj + Tv = Ta lead to v = h/(T - Ta), a = v/(Ta - Tj), j = a/Tj.
        "double-S, Tj = T/4": double_s(points, max_velocity=2, max_acceleration=8, max_jerk=32),
        "double-S, Tj = T/8, Ta = T/2": double_s(points, max_velocity=2, max_acceleration=16 / 3, max_jerk=128 / 3),
        "modified trapezoidal": modified_trapezoidal(points, times),
        "modified sine": modified_sine(points, times),
        "linear with quintic blends, Ta = T/3": polynomial_blends(points, times, blend_time=third),
        "mstraj, half blend T/6": lspb(points, durations=[1.0], blend_time=third),
        "trigonometric spline, angle pi/4": trigonometric_spline(points, times, angle=np.pi / 4),
        "quintic B-spline": bspline(points, times),
    }


def _row(label: str, trajectory: Trajectory) -> NormalisedRow:
    derivatives = [trajectory.derivative(order) for order in (1, 2, 3)]
    peaks = [float(f.extrema().peak[0]) for f in derivatives]
    velocity_rms, acceleration_rms, jerk_rms = (_rms(f) for f in derivatives)
    class_number = next((k for k in (0, 1, 2) if len(trajectory.jumps(k + 1).times)), 3)
    at_ends = np.abs(trajectory(trajectory.times[[0, -1]], order=3)).max()
    return NormalisedRow(
        profile=label,
        velocity=peaks[0],
        acceleration=peaks[1],
        jerk=np.inf if class_number < 2 else peaks[2],
        finite_jerk=peaks[2],
        rms_velocity=velocity_rms,
        rms_acceleration=acceleration_rms,
        rms_jerk=np.inf if class_number < 2 else jerk_rms,
        power=float((derivatives[0] * derivatives[1]).extrema().peak[0]),
        continuity=f"C{class_number}",
        end_jerk=np.inf if class_number < 2 else float(at_ends),
    )


def _rms(f: Piecewise) -> float:
    return float(np.sqrt(f.inner(f)[0] / f.duration))
