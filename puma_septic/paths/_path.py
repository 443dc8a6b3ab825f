"""Path: where the tool leads along a curve, as a function of the distance covered."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.errors import InputError
from puma_septic.paths._rotations import turned
from puma_septic.piecewise import Piecewise
from puma_septic.validation import Array, checked_array, n_dimensions, numbers, read_only

__all__ = ["Path", "PathRates"]


class PathRates(NamedTuple):
    """Poses of a path and their derivatives by distance, for n places.

    ``poses`` (n, 4, 4); ``linear`` and ``angular`` (3, n, 3): derivatives of the position of orders 1 to 3, and the
    turning per metre with its first two derivatives, in world axes.
    """

    poses: Array
    linear: Array
    angular: Array


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Path:
    r"""A curve of the tool, parametrised by its arc length s in [0, length].

    On piece i the position is a Chebyshev series of s, the orientation

    .. math:: R(s) = \exp(\alpha(s)\,e_{i1})\,\exp(\beta(s)\,e_{i2})\,R_i

    with fixed world axes e and a fixed rotation R: one turn on lines and arcs, two that overlap in rounded corners.
    `line`, `arc`, `circle` and `polyline` make paths.

    Attributes
    ----------
    kind : str
        "line", "arc", "circle" or "polyline".
    position : Piecewise
        Of three components, m over m.
    turns : Piecewise
        The angles alpha and beta, rad over m, on the same pieces.
    axes : ndarray, shape (n, 2, 3)
        Unit axes, or zeros where nothing turns.
    rotations : ndarray, shape (n, 3, 3)
    """

    kind: str
    position: Piecewise
    turns: Piecewise
    axes: Array
    rotations: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "axes", read_only(self.axes))
        object.__setattr__(self, "rotations", read_only(self.rotations))

    @property
    def length(self) -> float:
        """Arc length, m."""
        return self.position.duration

    @property
    def breaks(self) -> Array:
        """Distances at which pieces meet, both ends included, m."""
        return self.position.breaks

    def frames(self, s: ArrayLike) -> Array:
        """Poses T_world_tool at distances s, shape () or (n,), as (4, 4) or (n, 4, 4).

        Raises
        ------
        InputError
            For a distance outside the path.
        """
        places = self._checked(s)
        piece = self.pieces(places)
        poses = self._poses(piece, _on_pieces(self._series, piece, places)[0])
        return poses if n_dimensions(s) else poses[0]

    def curvature(self, s: ArrayLike) -> Array:
        """Curvature of the tool's way at distances s, 1/m: the length of the second derivative of the position."""
        places = self._checked(s)
        second = self.rates(self.pieces(places), places).linear[1]
        return np.asarray(np.linalg.norm(second, axis=1).reshape(np.shape(s)))

    def pieces(self, s: Array) -> NDArray[np.int64]:
        """Which piece each distance lies on; a break belongs to the one after it."""
        return np.searchsorted(self.breaks[1:-1], s, side="right")

    def rates(self, piece: NDArray[np.int64], s: Array) -> PathRates:
        """Poses and derivatives at distances s (n,), each seen from its piece (n,)."""
        state = _on_pieces(self._series.with_derivatives(3), piece, s)
        moved, turns = state[:, :, :3], state[:, :, 3:]
        first, second = self.axes[piece, 0], self.axes[piece, 1]
        angular = _turning(first, turned(first, turns[0, :, 0], second), turns[1:])
        return PathRates(self._poses(piece, state[0]), moved[1:], angular)

    @property
    def _series(self) -> Piecewise:
        """Position and turns side by side."""
        return Piecewise.concatenate([self.position, self.turns])

    def _poses(self, piece: NDArray[np.int64], values: Array) -> Array:
        """Poses (n, 4, 4) from position and turns (n, 5)."""
        poses = np.zeros((len(values), 4, 4))
        inner = turned(self.axes[piece, 1, None], values[:, None, 4], self.rotations[piece].transpose(0, 2, 1))
        poses[:, :3, :3] = turned(self.axes[piece, 0, None], values[:, None, 3], inner).transpose(0, 2, 1)
        poses[:, :3, 3], poses[:, 3, 3] = values[:, :3], 1.0
        return poses

    def _checked(self, s: ArrayLike) -> Array:
        places = checked_array("s", np.ravel(numbers("s", s)), (None,), unit="m")
        if not ((places >= 0) & (places <= self.length * (1 + 1e-12))).all():
            worst = places[np.argmax(np.abs(places - self.length / 2))]
            raise InputError(f"s = {worst:.9g} m is outside the path, [0, {self.length:.9g}] m")
        return places


def _turning(first: Array, second: Array, turns: Array) -> Array:
    """Angular rate by distance and its derivatives, (3, n, 3): ``e1 alpha' + f beta'`` with f = the turned e2."""
    (a1, b1), (a2, b2), (a3, b3) = (rates.T[:, :, None] for rates in turns)
    across = np.cross(first, second)
    slope = a1 * across
    bend = a2 * across + a1 * np.cross(first, slope)
    return np.stack(
        [
            first * a1 + second * b1,
            first * a2 + second * b2 + slope * b1,
            first * a3 + second * b3 + 2 * slope * b2 + bend * b1,
        ]
    )


def _on_pieces(state: Piecewise, piece: NDArray[np.int64], s: Array) -> Array:
    """Values of all orders, (orders, n, 5), each read from its piece, also at a break."""
    left, right = state.offsets[piece], state.offsets[piece + 1]
    values = state.at(piece, np.clip((2 * s - left - right) / (right - left), -1.0, 1.0))
    return values.reshape(len(s), values.shape[1] // 5, 5).transpose(1, 0, 2)
