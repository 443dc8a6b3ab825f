"""Straight segments whose corners are rounded by blends of continuous curvature."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.errors import InputError, PumaSepticError
from puma_septic.paths._curves import checked_pose, turning
from puma_septic.paths._fitting import fit_state
from puma_septic.paths._path import Path
from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array, checked_array, checked_each

__all__ = ["polyline"]

_SAME_POINT = 1e-9
# Cosine of the corner at which the path turns back on itself: there a blend would stand still.
_REVERSES = -1 + 1e-6
# The blend from -1 to 0 over u in [0, 1], by powers of u: its slope falls from 2 to 0 as 2 (1 - 3 u^2 + 2 u^3). It is
# the quintic with the slope of uniform motion straight through a corner, for which the fifth power vanishes.
_BLEND = np.polynomial.Polynomial([-1.0, 2.0, 0.0, -2.0, 1.0])


class _Part(NamedTuple):
    """One stretch of the path: its position and turns, and their axes and rotation on all pieces of it."""

    position: Piecewise
    turns: Piecewise
    axes: Array
    rotation: Array


def polyline(poses: ArrayLike, *, zone: ArrayLike) -> Path:
    r"""Straight lines from pose to pose, each corner rounded within a zone.

    Within the zone of radius z about a corner :math:`p_v, R_v`, both lines are followed at once,

    .. math:: p = p_v + a\,d_1 + b\,d_2, \qquad
              R = \exp(a\,\omega_1)\exp(b\,\omega_2) R_v,

    with their directions d and turns per metre :math:`\omega`; a runs from -z to 0 and b from 0 to z by
    :math:`a = z(-1 + 2u - 2u^3 + u^4)`, :math:`b(u) = -a(1-u)`, whose second derivatives vanish at both ends: curvature
    and angular acceleration are continuous (Biagiotti and Melchiorri, Trajectory Planning, chapter 9, blend two
    segments in position so).

    Parameters
    ----------
    poses : array_like, shape (k, 4, 4)
        At least three poses of the tool, lengths in m.
    zone : array_like, shape () or (k - 2,)
        Radius about each inner pose within which the path leaves its lines, m, positive; the zones of two neighbours
        must fit between them.

    Returns
    -------
    Path

    Raises
    ------
    InputError
        For poses that are not rigid, equal neighbours, half a turn between them, a zone that is not positive or longer
        than its segment, a path that turns back on itself.

    Examples
    --------
    >>> import numpy as np
    >>> from puma_septic import paths
    >>> corners = np.tile(np.eye(4), (3, 1, 1))
    >>> corners[1:, :2, 3] = [[1, 0], [1, 1]]
    >>> way = paths.polyline(corners, zone=0.2)
    >>> way.frames([0.0, way.length])[:, :2, 3].round(12).tolist(), bool(way.length < 2)
    ([[0.0, 0.0], [1.0, 1.0]], True)
    """
    given = checked_array("poses", poses, (None, 4, 4))
    if len(given) < 3:
        raise InputError(f"polyline needs at least 3 poses, got {len(given)}; for 2 use line")
    rotations, points = zip(*(checked_pose(f"poses[{k}]", pose) for k, pose in enumerate(given)), strict=True)
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    if (lengths <= _SAME_POINT).any():
        k = int(np.argmin(lengths))
        raise InputError(f"polyline: poses[{k}] and poses[{k + 1}] have the same position, {points[k].tolist()} m")
    directions = steps / lengths[:, None]
    zones = _checked_zones(zone, lengths, directions)
    turns = [turning(f"polyline, segment {k + 1}", rotations[k], rotations[k + 1], None) for k in range(len(steps))]
    margins = np.concatenate([[0.0], zones, [0.0]])
    parts: list[_Part] = []
    for k, length in enumerate(lengths):
        axis, rate = turns[k][0], turns[k][1] / length
        parts += _straight(points[k], rotations[k], directions[k], axis, rate, margins[k], length - margins[k + 1])
        if k < len(zones):
            rates = np.array([rate, turns[k + 1][1] / lengths[k + 1]])
            axes = np.stack([axis, turns[k + 1][0]])
            parts.append(_corner(points[k + 1], rotations[k + 1], directions[k : k + 2], axes, rates, zones[k]))
    return Path(
        kind="polyline",
        position=Piecewise.sequence([part.position for part in parts]),
        turns=Piecewise.sequence([part.turns for part in parts]),
        axes=np.concatenate([np.tile(part.axes, (len(part.position.lengths), 1, 1)) for part in parts]),
        rotations=np.concatenate([np.tile(part.rotation, (len(part.position.lengths), 1, 1)) for part in parts]),
    )


def _checked_zones(zone: ArrayLike, lengths: Array, directions: Array) -> Array:
    count = len(lengths) - 1
    labels = [f"poses[{k + 1}]" for k in range(count)]
    remedy = "; to stop at a corner make a line to it and one from it"
    zones = checked_each("zone", zone, count, unit="m", labels=labels, above=0.0, remedy=remedy)
    margins = np.concatenate([[0.0], zones, [0.0]])
    taken = margins[:-1] + margins[1:]
    if (taken > lengths * (1 + 1e-12)).any():
        k = int(np.argmax(taken - lengths))
        raise InputError(
            f"polyline, segment {k + 1}: its zones take {taken[k]:.6g} m of {lengths[k]:.6g} m between poses[{k}] and"
            f" poses[{k + 1}]; zones that fit are up to {lengths.min() / 2:.6g} m everywhere"
        )
    cosines = (directions[:-1] * directions[1:]).sum(axis=1)
    if (cosines < _REVERSES).any():
        k = int(np.argmin(cosines))
        raise InputError(f"polyline: the path turns back on itself at poses[{k + 1}]; stop there, with two lines")
    return zones


def _straight(
    point: Array, rotation: Array, direction: Array, axis: Array, rate: float, first: float, last: float
) -> list[_Part]:
    """The stretch of a segment between its zones, none where they meet."""
    if last - first <= _SAME_POINT:
        return []
    start, length = point + first * direction, last - first
    return [
        _Part(
            Piecewise.from_power([0.0, length], np.stack([start, length * direction])[:, None]),
            Piecewise.from_power([0.0, length], [[[first * rate, 0.0]], [[length * rate, 0.0]]]),
            np.stack([axis, np.zeros(3)]),
            rotation,
        )
    ]


def _corner(point: Array, rotation: Array, directions: Array, axes: Array, rates: Array, zone: float) -> _Part:
    """The blend about a corner; its turn of the incoming segment is counted from the corner's orientation."""
    shares = _blend_by_length(float(directions[0] @ directions[1]), zone)
    return _Part(shares.combined(directions) + point, shares * rates, axes, rotation)


def _blend_by_length(cosine: float, zone: float) -> Piecewise:
    """The blends a and b, m, as functions of the arc length along them."""
    a, b = zone * _BLEND, -zone * _BLEND(np.polynomial.Polynomial([1.0, -1.0]))
    blends = [[f.deriv(k) if k else f for k in range(4)] for f in (a, b)]
    # The square of the speed |dp/du| is a polynomial, and positive: the path does not turn back.
    square = blends[0][1] ** 2 + blends[1][1] ** 2 + 2 * cosine * blends[0][1] * blends[1][1]
    speed = Piecewise.fit(lambda u: np.sqrt(square(u))[:, None], [0.0, 1.0], tolerance=1e-15)
    covered = speed.integral()
    length = float(covered(1.0)[0])

    def sample(_: NDArray[np.int64], x: Array) -> Array:
        u = _parameter(covered, speed, (x + 1) / 2 * length)
        slope, half, bend = square(u), square.deriv()(u) / 2, square.deriv(2)(u) / 2
        # u(s) and its derivatives: u' = w^(-1/2), w the square of the speed; each further one by the chain rule.
        u1 = 1 / np.sqrt(slope)
        u2 = -half / slope**2
        u3 = (-bend / slope**2 + 4 * half**2 / slope**3) * u1
        return np.stack([_by_length([f(u) for f in parts], u1, u2, u3) for parts in blends], axis=-1)

    return fit_state(sample, np.array([0.0, length]), _not_smooth)


def _by_length(f: list[Array], u1: Array, u2: Array, u3: Array) -> Array:
    """A function of u and its derivatives as those by arc length, (4, k): the chain rule."""
    return np.array([f[0], f[1] * u1, f[2] * u1**2 + f[1] * u2, f[3] * u1**3 + 3 * f[2] * u1 * u2 + f[1] * u3])


def _parameter(covered: Piecewise, speed: Piecewise, s: Array) -> Array:
    """U at which the length s is covered: Newton, from the even share, which it needs a few steps from."""
    u: Array = s / covered(1.0)[0]
    for _ in range(30):
        step = (covered(u)[:, 0] - s) / speed(u)[:, 0]
        u = np.clip(u - step, 0.0, 1.0)
        if np.abs(step).max() < 1e-15:
            break
    return u


def _not_smooth(s: float) -> PumaSepticError:
    return PumaSepticError(f"the blend of a corner is not smooth at s = {s:.9g} m")
