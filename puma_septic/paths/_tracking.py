"""Arms without a closed form, or with joints to spare: the least-norm motion from a start posture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from puma_septic.paths._differential import Follower
from puma_septic.paths._path import Path, PathRates
from puma_septic.paths._refusal import off_path, singular
from puma_septic.piecewise import Piecewise, matrices
from puma_septic.validation import Array

__all__ = ["track"]

_DEGREE = 20
# Sweeps of the fixed point until all nodes agree to the tolerance, in rad or m; more mean that the step is too long.
_SWEEPS, _AGREED = 40, 1e-14
_TAIL = 1e-12
# What the pose at the end of a step may be off before it is corrected, in m or rad.
_OFF = 1e-10
_SMALLEST = 2.0**-20


def track(follower: Follower, path: Path, start: Array, held: str) -> Piecewise:
    r"""Joint positions by distance, from a start posture on the path.

    The differential equation :math:`q' = J^+(q)\,x'(s)`, the least norm of joint rates, is solved on intervals at 21
    Chebyshev nodes: :math:`q \leftarrow q_0 + \int J^+(q)\,x'` until all nodes agree, the interval halved where they do
    not or where the series has not converged. The end of each is moved onto its pose.

    Raises
    ------
    NoSolution
        At a singular posture, or where the arm cannot hold the pose.
    """
    breaks, series = [0.0], []
    q, left, piece, length = start, 0.0, 0, path.length / 8
    while left < path.length:
        end = float(path.breaks[piece + 1])
        right = end if end - left <= 1.2 * length else left + length
        step = _step(follower, path, piece, (left, right), q)
        if step is None:
            length = (right - left) / 2
            if length < _SMALLEST * path.length:
                raise singular(path, left, q, follower.robot, held)
            continue
        q, residual = follower.polished(step.sum(axis=0)[None], path.frames(np.array([right])))
        if residual[0] > _OFF:
            raise off_path(path, right, q[0], float(residual[0]), held)
        q = q[0]
        breaks.append(right)
        series.append(step)
        length, left, piece = 1.5 * (right - left), right, piece + (right == end)
    return Piecewise(breaks=np.array(breaks), coefficients=np.stack(series, axis=1))


def _step(follower: Follower, path: Path, piece: int, span: tuple[float, float], start: Array) -> Array | None:
    """Series (degree + 2, n_joints) on one interval, or None where it is too long."""
    nodes, half = matrices.nodes(_DEGREE), (span[1] - span[0]) / 2
    pieces: NDArray[np.int64] = np.full(len(nodes), piece)
    rates: PathRates = path.rates(pieces, span[0] + half * (nodes + 1))
    wanted = follower.targets(rates)[0][:, :, None]
    to_series = matrices.coefficients_from_values(_DEGREE)
    to_values = matrices.values_matrix(_DEGREE + 1, _DEGREE)
    q, change = np.tile(start, (len(nodes), 1)), np.inf
    for _ in range(_SWEEPS):
        inverse, _ = follower.inverse(q)
        slopes = to_series @ (inverse @ wanted)[:, :, 0]
        integral = half * matrices.integral_matrix(_DEGREE) @ slopes
        integral[0] += start
        moved = to_values @ integral
        before, change = change, float(np.abs(moved - q).max())
        q = moved
        if change <= _AGREED * max(1.0, float(np.abs(q).max())):
            break
        if not change <= 1.0 or change > 2 * before:
            return None
    tail, size = np.abs(slopes[-3:]).max() * half, max(1.0, float(np.abs(q).max()))
    agreed = change <= 100 * _AGREED * size and tail <= _TAIL * size
    return np.asarray(integral) if agreed else None
