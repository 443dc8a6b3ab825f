"""Laws of motion from rest to rest, by name: cycloidal, harmonic, modified trapezoidal, modified sine,
bang-bang.

Each is a law y(s) with y(0) = 0, y(1) = 1 and zero velocity at both ends; a segment is
``q0 + (q1 - q0) y((t - t0)/T)``. Several points mean a stop at each via. Formulas: Biagiotti and Melchiorri,
Trajectory Planning for Automatic Machines and Robots; Norton, Cam Design and Manufacturing
Handbook (modified laws).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.piecewise import Piecewise
from puma_septic.profiles._info import BIAGIOTTI, ProfileInfo
from puma_septic.profiles._integration import integrated, smooth_series
from puma_septic.profiles._vias import Vias
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = [
    "BANG_BANG",
    "CYCLOIDAL",
    "HARMONIC",
    "MODIFIED_SINE",
    "MODIFIED_TRAPEZOIDAL",
    "bang_bang",
    "cycloidal",
    "harmonic",
    "modified_sine",
    "modified_trapezoidal",
]

BANG_BANG = ProfileInfo(
    name="bang_bang",
    continuity="C1",
    inside="C1",
    needs="times",
    at_vias="stops",
    overshoots=False,
    source=f"{BIAGIOTTI}, 2.1.2",
)
HARMONIC = ProfileInfo(
    name="harmonic",
    continuity="C1",
    inside="C1",
    needs="times",
    at_vias="stops",
    overshoots=False,
    source=f"{BIAGIOTTI}, 2.2.1",
)
CYCLOIDAL = ProfileInfo(
    name="cycloidal",
    continuity="C2",
    inside="C2",
    needs="times",
    at_vias="stops",
    overshoots=False,
    source=f"{BIAGIOTTI}, 2.2.2",
)
MODIFIED_TRAPEZOIDAL = ProfileInfo(
    name="modified_trapezoidal",
    continuity="C2",
    inside="C2",
    needs="times",
    at_vias="stops",
    overshoots=False,
    source=f"{BIAGIOTTI}, 3.7",
)
MODIFIED_SINE = ProfileInfo(
    name="modified_sine",
    continuity="C2",
    inside="C2",
    needs="times",
    at_vias="stops",
    overshoots=False,
    source="Norton, Cam Design and Manufacturing Handbook, 3",
)


def bang_bang(points: ArrayLike, times: ArrayLike, *, joint_names: Sequence[str] | None = None) -> Trajectory:
    """Constant acceleration for the first half of each segment, the opposite for the second.

    ``y = 2 s^2`` up to s = 1/2, then ``1 - 2 (1 - s)^2``: the least peak acceleration, ``4 h/T^2``, with
    velocity up to ``2 h/T``. The acceleration steps at the points and between them. The arm stops at each
    point.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points and between them.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase, non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> float(profiles.bang_bang([[0.0], [1.0]], [0.0, 1.0]).extrema(2).max[0])
    4.0
    """
    return _stopping("bang_bang", points, times, _bang_bang_law(), joint_names)


def cycloidal(points: ArrayLike, times: ArrayLike, *, joint_names: Sequence[str] | None = None) -> Trajectory:
    """``y = s - sin(2 pi s) / (2 pi)``: a sine of one period as acceleration.

    Velocity up to ``2 h/T``, acceleration ``2 pi h/T^2``, jerk ``4 pi^2 h/T^3``, which steps at the points.
    The arm stops at each point.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase, non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> round(float(profiles.cycloidal([[0.0], [1.0]], [0.0, 1.0]).extrema(1).max[0]), 12)
    2.0
    """
    return _stopping("cycloidal", points, times, _cycloidal_law(), joint_names)


def harmonic(points: ArrayLike, times: ArrayLike, *, joint_names: Sequence[str] | None = None) -> Trajectory:
    """``y = (1 - cos(pi s)) / 2``: the projection of a uniform motion on half a circle.

    Velocity up to ``pi/2 h/T``, acceleration ``pi^2/2 h/T^2``, which steps at the points. The arm stops at
    each point.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase, non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> round(float(profiles.harmonic([[0.0], [1.0]], [0.0, 1.0])(0.25)[0]), 12)  # (1 - cos 45 deg) / 2
    0.146446609407
    """
    return _stopping("harmonic", points, times, _harmonic_law(), joint_names)


def modified_trapezoidal(
    points: ArrayLike, times: ArrayLike, *, joint_names: Sequence[str] | None = None
) -> Trajectory:
    """A trapezoidal acceleration whose flanks are quarters of a sine, each an eighth of the segment long.

    Acceleration ``A sin(4 pi s)`` up to s = 1/8, A up to 3/8, ``A cos(4 pi (s - 3/8))`` up to 5/8, -A up to
    7/8, and back to zero; ``A = 8 pi / (2 + pi) h/T^2``. Velocity up to ``2 h/T``; the jerk steps. The arm
    stops at each point.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks where the law of a segment changes.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase, non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> round(float(profiles.modified_trapezoidal([[0.0], [1.0]], [0.0, 1.0]).extrema(2).max[0]), 5)
    4.88812
    """
    return _stopping("modified_trapezoidal", points, times, _modified_trapezoidal_law(), joint_names)


def modified_sine(points: ArrayLike, times: ArrayLike, *, joint_names: Sequence[str] | None = None) -> Trajectory:
    """A sine acceleration that rises and ends three times as fast as it turns over.

    Acceleration ``A sin(4 pi s)`` up to s = 1/8, ``A sin(pi/3 (1 + 4 s))`` up to 7/8, ``A sin(4 pi s)`` at
    the end; ``A = 4 pi^2 / (4 + pi) h/T^2``. Velocity up to ``1.75960 h/T``; the jerk steps. The arm stops at
    each point.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks where the law of a segment changes.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase, non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> round(float(profiles.modified_sine([[0.0], [1.0]], [0.0, 1.0]).extrema(2).max[0]), 5)
    5.52796
    """
    return _stopping("modified_sine", points, times, _modified_sine_law(), joint_names)


def _stopping(
    profile: str, points: ArrayLike, times: ArrayLike, law: Piecewise, joint_names: Sequence[str] | None
) -> Trajectory:
    """The law, scaled to every segment and joint."""
    vias = Vias.of(profile, points, times, joint_names)
    inner = vias.t[:-1, None] * (1 - law.breaks[:-1]) + vias.t[1:, None] * law.breaks[:-1]
    pieces = len(law.breaks) - 1
    series = np.tile(law.coefficients, (1, len(vias.q) - 1, 1)) * np.repeat(np.diff(vias.q, axis=0), pieces, axis=0)
    series[0] += np.repeat(vias.q[:-1], pieces, axis=0)
    return vias.trajectory(Piecewise(breaks=np.append(inner.ravel(), vias.t[-1]), coefficients=series))


def _from_jerk(breaks: Array, jerks: Sequence[Callable[[Array], Array]], start_acceleration: float = 0.0) -> Piecewise:
    """A law from its jerk, one smooth function for each interval."""
    # Fitted one by one, so that each is asked for its own value at a common break.
    fits = [smooth_series(f, *breaks[i : i + 2]) for i, f in enumerate(jerks)]
    series = np.zeros((max(map(len, fits)), len(fits), 1))
    for i, fit in enumerate(fits):
        series[: len(fit), i, 0] = fit
    return integrated(Piecewise(breaks=breaks, coefficients=series), start_acceleration, 0.0, 0.0)


def _still(s: Array) -> Array:
    return np.zeros_like(s)


@lru_cache(maxsize=1)
def _bang_bang_law() -> Piecewise:
    return integrated(Piecewise.from_power([0.0, 0.5, 1.0], [[[4.0], [-4.0]]]), 0.0, 0.0)


@lru_cache(maxsize=1)
def _cycloidal_law() -> Piecewise:
    return _from_jerk(np.array([0.0, 1.0]), [lambda s: 4 * np.pi**2 * np.cos(2 * np.pi * s)])


@lru_cache(maxsize=1)
def _harmonic_law() -> Piecewise:
    return _from_jerk(np.array([0.0, 1.0]), [lambda s: -(np.pi**3) / 2 * np.sin(np.pi * s)], np.pi**2 / 2)


@lru_cache(maxsize=1)
def _modified_trapezoidal_law() -> Piecewise:
    size = 4 * np.pi * 8 * np.pi / (2 + np.pi)
    return _from_jerk(
        np.array([0, 1, 3, 5, 7, 8]) / 8,
        [
            lambda s: size * np.cos(4 * np.pi * s),
            _still,
            lambda s: -size * np.sin(4 * np.pi * (s - 3 / 8)),
            _still,
            lambda s: size * np.sin(4 * np.pi * (s - 7 / 8)),
        ],
    )


@lru_cache(maxsize=1)
def _modified_sine_law() -> Piecewise:
    size = 4 * np.pi * 4 * np.pi**2 / (4 + np.pi)
    return _from_jerk(
        np.array([0, 1, 7, 8]) / 8,
        [
            lambda s: size * np.cos(4 * np.pi * s),
            lambda s: size / 3 * np.cos(np.pi / 3 * (1 + 4 * s)),
            lambda s: size * np.cos(4 * np.pi * s),
        ],
    )
