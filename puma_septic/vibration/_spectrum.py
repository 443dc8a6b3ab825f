"""How large an oscillation a motion leaves behind: a Fourier integral of its acceleration, in closed form."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.polynomial import chebyshev, legendre
from numpy.typing import ArrayLike, NDArray
from scipy.special import jve

from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.piecewise.matrices import kept
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array, checked_kind, checked_number, n_dimensions

__all__ = [
    "Complex",
    "checked_damping",
    "checked_frequencies",
    "forced_response",
    "residual_vibration",
]

Complex = NDArray[np.complex128]

# Values of Bessel functions that are held at once: 160 MB.
_MOST_AT_ONCE: Final = 10_000_000


def residual_vibration(trajectory: Trajectory, frequency: ArrayLike, *, damping: float = 0.0) -> Array:
    """Amplitude of the oscillation that a motion leaves in a spring-mass on each joint, exactly.

    The oscillator sits on the joint and is shaken by its acceleration a(t); with ``w = 2 pi frequency``, its deflection
    x obeys ``x'' + 2 damping w x' + w^2 x = -a(t)``, at rest before the motion. After the end T it swings freely, and
    its envelope there is

    ``|integral of a(t) exp((-damping + i sqrt(1 - damping^2)) w (T - t)) dt| / (w sqrt(1 - damping^2))``,

    a Fourier integral that each interval's series gives in closed form: ``exp(-i z x)`` times a Legendre polynomial of
    degree n integrates to ``2 (-i)^n j_n(z)`` with the spherical Bessel function (DLMF 18.17.19), at any z. A step of
    the velocity, at the ends too, is an impulse.

    Parameters
    ----------
    trajectory : Trajectory
    frequency : array_like, shape () or (k,)
        Natural frequencies of the undamped oscillator, Hz, above 0.
    damping : float
        Damping ratio, from 0 to below 1.

    Returns
    -------
    ndarray, shape (n_joints,) or (k, n_joints)
        rad (m for prismatic joints), correct to rounding of what the acceleration could excite: about 1e-15 of its
        integral over w. ``w^2`` times it is the acceleration amplitude.

    Raises
    ------
    InputError
        For a frequency or a damping ratio out of range.

    Examples
    --------
    A cycloidal move of 1 rad in 1 s leaves ``8 pi^2 |sin(w / 2)| / (w |w^2 - 4 pi^2|)``, 8 / (15 pi) at 1.5 Hz:

    >>> import puma_septic as ps
    >>> move = ps.profiles.cycloidal([[0.0], [1.0]], [0.0, 1.0])
    >>> ps.residual_vibration(move, [1.5, 3.0]).ravel().round(9).tolist()
    [0.169765273, 0.0]
    """
    hertz = checked_frequencies(frequency)
    damping = checked_damping(damping)
    omega = 2 * np.pi * hertz.reshape(-1)
    damped = omega * np.sqrt(1 - damping**2)
    response = forced_response(trajectory, -damping * omega + 1j * damped)
    amplitude = np.abs(response) / damped[:, None]
    return np.asarray(amplitude.reshape(*hertz.shape, trajectory.n_joints))


def checked_frequencies(frequency: ArrayLike) -> Array:
    """Frequencies in Hz, shape () or (k,), each above 0."""
    shape = () if n_dimensions(frequency) == 0 else (None,)
    hertz = checked_array("frequency", frequency, shape, unit="Hz", above=0.0)
    if not hertz.size:
        raise InputError("frequency: at least one natural frequency is needed, in Hz")
    return hertz


def checked_damping(damping: float) -> float:
    """A damping ratio at which the oscillator still swings."""
    ratio = checked_number("damping", damping, at_least=0.0)
    if ratio >= 1:
        raise InputError(f"damping = {ratio:g}: a damping ratio from 0 to below 1 is needed; from 1 on nothing swings")
    return ratio


def forced_response(trajectory: Trajectory, rates: Complex) -> Complex:
    """``integral of a(t) exp(rate (T - t)) dt`` over a motion that ends at T, for rates that decay and turn forwards.

    Returns
    -------
    ndarray of complex, shape (k, n_joints)
    """
    total = _of_series(checked_kind("trajectory", trajectory, Trajectory).derivative(2), rates)
    impulses = trajectory.jumps(1)
    if len(impulses.times):
        since = trajectory.breaks[-1] - impulses.times
        total = total + np.exp(rates[:, None] * since) @ impulses.sizes
    return total


def _of_series(function: Piecewise, rates: Complex) -> Complex:
    """The same integral of a function, interval by interval, in blocks that fit into memory."""
    series = np.tensordot(_to_legendre(function.degree), function.coefficients, 1)
    block = max(1, _MOST_AT_ONCE // (series.shape[0] * series.shape[1]))
    parts = [_of_block(function, series, rates[k : k + block]) for k in range(0, len(rates), block)]
    return np.concatenate(parts)


def _of_block(function: Piecewise, series: Array, rates: Complex) -> Complex:
    half = function.lengths / 2
    middles = function.offsets[:-1] + half
    # exp(rate (T - middle - half x)) = exp(rate (T - middle)) exp(-i z x), the real part of z above 0.
    z = -1j * np.multiply.outer(rates, half)
    degrees = np.arange(len(series))
    bessel = np.sqrt(np.pi / 2 / z)[..., None] * jve(degrees + 0.5, z[..., None])
    # jve has left out exp(|imaginary part of z|), which the decay since the interval's end more than makes up for.
    decay = np.exp(rates[:, None] * (function.duration - middles) + np.abs(z.imag))
    return np.asarray(np.einsum("fid,dij,fi->fj", 2 * (-1j) ** degrees * bessel, series, decay * half, optimize=True))


@kept
def _to_legendre(degree: int) -> Array:
    """Matrix from Chebyshev to Legendre coefficients, by Gauss's rule, which is exact for them."""
    x, weights = legendre.leggauss(degree + 1)
    scale = np.arange(degree + 1) + 0.5
    matrix = scale[:, None] * (legendre.legvander(x, degree).T * weights) @ chebyshev.chebvander(x, degree)
    matrix.setflags(write=False)
    return np.asarray(matrix)
