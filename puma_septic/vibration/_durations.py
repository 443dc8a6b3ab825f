"""Durations at which a motion, stretched in time, leaves nothing of a mode."""

from __future__ import annotations

from typing import Final

import numpy as np

from puma_septic.errors import InputError
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_kind, checked_number
from puma_septic.vibration._spectrum import Complex, forced_response

__all__ = ["nulling_durations"]

# The response has no faster feature than the motion is long: points per turn of its phase over the whole motion.
_POINTS: Final = 16
_MOST_POINTS: Final = 100_000
_NEWTON: Final = 60
# A least response below this part of what stands beside it is a null.
_NULL: Final = 1e-6
# What remains of a response by rounding, of the integral of the acceleration's magnitude.
_ROUNDING: Final = 1e-13


def nulling_durations(trajectory: Trajectory, frequency: float, *, longest: float) -> tuple[Array, ...]:
    """The durations that null the residual vibration of an undamped mode, when the motion is stretched in time.

    Stretched to the duration T', the motion leaves ``T / T'`` times the response that it has at ``frequency T' / T``,
    see `residual_vibration`; the durations are the zeros of that function: bracketed on a grid that its bandwidth
    resolves, refined by Newton's method on the complex response and its derivative by the frequency. Only motions whose
    parts cancel have nulls: those of symmetrical segments do, most others have minima.

    Parameters
    ----------
    trajectory : Trajectory
    frequency : float
        Natural frequency of the mode, Hz.
    longest : float
        The longest duration of interest, s.

    Returns
    -------
    tuple of ndarray
        Increasing durations of each joint, s; empty where it has none up to the longest, or does not move.

    Raises
    ------
    InputError
        For a frequency or duration that is not positive, or more periods than can be told apart.

    Examples
    --------
    A cycloidal move nulls a mode in all whole multiples of its period from two on:

    >>> import puma_septic as ps
    >>> move = ps.profiles.cycloidal([[0.0], [1.0]], [0.0, 1.0])
    >>> nulling_durations(move, 10.0, longest=0.55)[0].round(9).tolist()
    [0.2, 0.3, 0.4, 0.5]
    """
    checked_kind("trajectory", trajectory, Trajectory)
    hertz = checked_number("frequency", frequency, unit="Hz", above=0.0)
    longest = checked_number("longest", longest, unit="s", above=0.0)
    turns = hertz * longest
    count = int(np.ceil(_POINTS * turns)) + 2
    if count > _MOST_POINTS:
        raise InputError(
            f"longest = {longest:g} s is {turns:.6g} periods of {hertz:g} Hz; at most {_MOST_POINTS // _POINTS} are"
            " told apart"
        )
    omega = np.linspace(0.0, 2 * np.pi * count / (_POINTS * trajectory.duration), count + 1)[1:]
    size = np.abs(_response(trajectory, omega))
    floor = _ROUNDING * _excitation(trajectory)
    found = [_nulls(trajectory, j, omega, size[:, j], float(floor[j])) for j in range(trajectory.n_joints)]
    durations = [zeros * trajectory.duration / (2 * np.pi * hertz) for zeros in found]
    return tuple(values[values <= longest * (1 + _ROUNDING)] for values in durations)


def _excitation(trajectory: Trajectory) -> Array:
    """What no response exceeds: the integral of the acceleration's magnitude, at most, and its impulses."""
    acceleration = trajectory.derivative(2)
    impulses = np.abs(trajectory.jumps(1).sizes).sum(axis=0)
    return np.asarray(acceleration.lengths @ acceleration.bounds() + impulses)


def _nulls(trajectory: Trajectory, j: int, omega: Array, size: Array, floor: float) -> Array:
    """Angular frequencies at which a joint's response is zero."""
    inside = np.flatnonzero((size[1:-1] <= size[:-2]) & (size[1:-1] < size[2:])) + 1
    if not len(inside):
        return np.empty(0)
    beside = np.array([size[max(0, k - _POINTS // 2) : k + _POINTS // 2 + 1].max() for k in inside])
    distinct = beside * _NULL > floor
    inside, beside = inside[distinct], beside[distinct]
    step = omega[1] - omega[0]
    at = omega[inside].copy()
    for _ in range(_NEWTON):
        value, slope = _with_slope(trajectory, j, at)
        change = (slope.conj() * value).real / np.maximum(np.abs(slope) ** 2, np.finfo(float).tiny)
        at = np.clip(at - np.clip(change, -step / 2, step / 2), omega[inside - 1], omega[inside + 1])
    value, _ = _with_slope(trajectory, j, at)
    return np.sort(at[np.abs(value) <= _NULL * beside])


def _with_slope(trajectory: Trajectory, j: int, omega: Array) -> tuple[Complex, Complex]:
    """A joint's response about the middle of the motion, and its derivative by the frequency, by central difference.

    About the middle its phase turns slowest; the difference costs half the digits of the slope, which Newton's method
    does not need.
    """
    if not len(omega):
        return np.empty(0, dtype=complex), np.empty(0, dtype=complex)
    half = trajectory.duration / 2
    step = 1e-6 / half
    steps = omega[:, None] + step * np.array([-1.0, 0.0, 1.0])
    response = _response(trajectory, steps.ravel())[:, j].reshape(-1, 3) * np.exp(-1j * half * steps)
    return response[:, 1], (response[:, 2] - response[:, 0]) / (2 * step)


def _response(trajectory: Trajectory, omega: Array) -> Complex:
    """Of undamped oscillators."""
    return forced_response(trajectory, np.asarray(1j * omega, dtype=np.complex128))
