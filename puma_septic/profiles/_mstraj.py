"""LSPB as the paper ran it: straight segments with quintic blends, after Corke's mstraj."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.profiles._info import ProfileInfo
from puma_septic.profiles._quintic import quintic_powers
from puma_septic.profiles._vias import Vias, checked_points
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array, checked_each, checked_number

__all__ = ["LSPB", "lspb", "mstraj"]

LSPB = ProfileInfo(
    name="lspb",
    continuity="C2",
    inside="C2",
    needs="durations or speed limits, blend time",
    at_vias="misses",
    overshoots=False,
    source="Corke, Robotics Toolbox, mstraj",
)

# Two durations that differ by less than this part are one, to some thousand roundings.
_SAME_LENGTH = 1e-12


def mstraj(
    points: ArrayLike,
    *,
    durations: ArrayLike | None = None,
    max_velocity: ArrayLike | None = None,
    blend_time: float,
    joint_names: Sequence[str] | None = None,
) -> Trajectory:
    """Straight segments joined by quintic blends: Corke's `mstraj` as a function of continuous time.

    Segment k runs at ``v_k = (q_k - q_k-1) / T_k``. Around each via, a quintic of length `blend_time` with zero
    acceleration at both ends leads from ``(q_k - v_k tb, v_k)`` to ``(q_k + v_k+1 tb, v_k+1)``, tb = blend_time / 2.
    The first blend, of length tb, leads from rest at q_0 to ``(q_0 + v_1 tb, v_1)``; the last likewise to rest.
    Nothing is rounded to a time step, as it is in the toolbox (Corke, Robotics Toolbox, ``mstraj``). `lspb`, as the
    paper calls it, is the same function; linear segments with parabolic blends are `trapezoidal`.

    Consequences in closed form: a via is missed by ``3/32 blend_time dv``, the interior blend's acceleration peaks at
    ``1.5 dv / blend_time`` and its jerk steps by ``6 dv / blend_time^2``; the first and last blend overspeed to
    ``1.512 v``. Position, velocity and acceleration are continuous. With ``blend_time=0``, or one
    below 1e-12 of the whole duration, which double precision does not resolve, the velocity steps.

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    durations : array_like, shape (k - 1,)
        Of the segments, each at least `blend_time`, s. Either this or `max_velocity`.
    max_velocity : array_like, shape () or (n_joints,)
        Positive, rad/s. Each segment then takes ``max(2 blend_time, max over joints of b + |dq| / max_velocity)``
        with b = tb for the first segment and blend_time for the others, as `mstraj` does; the speed is not held
        exactly (see above), the assessment tells by how much.
    blend_time : float
        Length of an interior blend (`tacc` of mstraj), s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        From time 0, with breaks where blends begin and end.

    Raises
    ------
    InputError
        For a blend longer than a segment, both or neither of `durations` and `max_velocity`, and bad arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> move = profiles.mstraj([[0.0], [1.0]], durations=[2.0], blend_time=0.5)
    >>> float(move(1.0, order=1)[0])
    0.5
    """
    q = checked_points("lspb", points)
    blend = checked_number("blend_time", blend_time, unit="s", at_least=0.0)
    lengths = _durations(q, durations, max_velocity, blend)
    # Lengths that are meant to be equal may differ by rounding, as 0.3 and 3 * 0.1 do.
    too_short = lengths < blend * (1 - _SAME_LENGTH)
    if too_short.any():
        k = int(np.argmax(too_short))
        raise InputError(
            f"blend_time = {blend:g} s is longer than segment {k + 1} (point {k} to {k + 1}), which takes"
            f" {lengths[k]:g} s; the blends at both its ends would overlap"
        )
    times = np.concatenate([[0.0], np.cumsum(lengths)])
    position = _blended(q, times, np.diff(q, axis=0) / lengths[:, None], blend / 2)
    return Vias.of("lspb", q, times, joint_names).trajectory(position)


# The name by which the paper, and most who call it, know it.
lspb = mstraj


def _durations(points: Array, durations: ArrayLike | None, max_velocity: ArrayLike | None, blend: float) -> Array:
    """Segment durations, given or from the speed limit."""
    if (durations is None) == (max_velocity is None):
        given = "both are" if durations is not None else "neither is"
        raise InputError(f"lspb takes either durations or max_velocity; {given} given")
    if durations is not None:
        return checked_array("durations", durations, (len(points) - 1,), unit="s", above=0.0)
    assert max_velocity is not None
    speed = checked_each("max_velocity", max_velocity, points.shape[1], above=0.0)
    needed = (np.abs(np.diff(points, axis=0)) / speed).max(axis=1)
    needed[0] += blend / 2
    needed[1:] += blend
    lengths = np.maximum(needed, 2 * blend)
    if not (lengths > 0).all():
        raise InputError(f"segment {int(np.argmin(lengths)) + 1}: equal points and no blend leave it without duration")
    return np.asarray(lengths)


def _blended(points: Array, times: Array, v: Array, tb: float) -> Piecewise:
    """Blends and lines in turn; intervals of no length are left out."""
    rest = np.zeros((1, points.shape[1]))
    v_in, v_out = np.concatenate([rest, v]), np.concatenate([v, rest])
    start, end = times - tb, times + tb
    start[0], end[-1] = times[0], times[-1]
    blend_from, blend_to = points - v_in * tb, points + v_out * tb
    powers = np.zeros((6, 2 * len(points) - 1, points.shape[1]))
    powers[:, ::2] = quintic_powers(blend_from, blend_to, end - start, v0=v_in, v1=v_out)
    powers[0, 1::2] = blend_to[:-1]
    powers[1, 1::2] = blend_from[1:] - blend_to[:-1]
    breaks = np.stack([start, end], axis=1).ravel()
    kept = np.diff(breaks) > _SAME_LENGTH * times[-1]
    return Piecewise.from_power(np.append(breaks[:-1][kept], times[-1]), powers[:, kept])
