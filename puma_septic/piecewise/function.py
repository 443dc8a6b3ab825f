"""Piecewise: the one kind of thing that every computed quantity is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.checks import Array, checked_array, checked_times
from puma_septic.errors import InputError
from puma_septic.piecewise import matrices
from puma_septic.piecewise.fitting import fit_series
from puma_septic.piecewise.results import Extrema, Jumps
from puma_septic.piecewise.search import find_extrema, find_sign_changes

__all__ = ["Piecewise"]

# Two times closer than this part of the largest time are one: a few hundred roundings of a time stamp.
_SAME_TIME = 1e-13


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Piecewise:
    """A vector function of time, one Chebyshev series per interval and component.

    On interval i, with ``x = (2 t - breaks[i] - breaks[i+1]) / (breaks[i+1] - breaks[i])``, component j is
    ``sum_k coefficients[k, i, j] T_k(x)``. At an interior break the function has the right-hand value, at the
    end the left-hand one; it may step at breaks and is smooth between them.

    Parameters
    ----------
    breaks : array_like, shape (n + 1,)
        Strictly increasing times in s.
    coefficients : array_like, shape (degree + 1, n, m)

    Examples
    --------
    >>> ramp_and_rest = Piecewise.from_power([0.0, 1.0, 3.0], [[[0.0], [2.0]], [[2.0], [0.0]]])
    >>> ramp_and_rest([0.5, 2.0]).ravel()
    array([1., 2.])
    >>> float(ramp_and_rest.integral()(3.0)[0])
    5.0
    """

    breaks: Array
    coefficients: Array

    def __post_init__(self) -> None:
        breaks = _checked_breaks(self.breaks)
        coefficients = checked_array("coefficients", self.coefficients, (None, len(breaks) - 1, None))
        if not coefficients.size:
            raise InputError(f"coefficients: at least one per interval and component, got {coefficients.shape}")
        object.__setattr__(self, "breaks", breaks)
        object.__setattr__(self, "coefficients", coefficients)

    @classmethod
    def _trusted(cls, breaks: Array, coefficients: Array) -> Piecewise:
        """From arrays that this module has just made: no copy, no check; non-finite values still surface."""
        new = object.__new__(cls)
        breaks.setflags(write=False)
        coefficients.setflags(write=False)
        object.__setattr__(new, "breaks", breaks)
        object.__setattr__(new, "coefficients", coefficients)
        return new

    @classmethod
    def from_power(cls, breaks: ArrayLike, powers: ArrayLike) -> Piecewise:
        """From powers of ``s = (t - breaks[i]) / (breaks[i+1] - breaks[i])``.

        Parameters
        ----------
        powers : array_like, shape (degree + 1, n, m)
            ``powers[k, i, j]`` multiplies ``s**k`` on interval i in component j.
        """
        powers = np.asarray(powers, dtype=np.float64)
        matrix = matrices.from_power_matrix(len(powers) - 1)
        return cls(breaks=np.asarray(breaks), coefficients=_apply(matrix, powers))

    @classmethod
    def fit(cls, f: Callable[[Array], Array], breaks: ArrayLike, *, tolerance: float = 1e-11) -> Piecewise:
        """The series of a function that is smooth between the breaks.

        The degree is raised until the tail of each component's series is below `tolerance` times that
        component's own largest value (or below its rounding), then intervals are bisected.

        Parameters
        ----------
        f : callable
            ``f(t)`` with t of shape (k,) returns shape (k, m). It is called with many times at once, strictly
            inside or at the ends of the intervals.
        breaks : array_like, shape (n + 1,)
            Where `f` may be less than smooth.
        tolerance : float
            Relative to each component's largest value.

        Raises
        ------
        PumaSepticError
            Where no degree and no bisection converges: `f` is not smooth inside an interval, or not finite.

        Notes
        -----
        Whatever happens between 25 Chebyshev points of an interval and leaves no trace there, such as a spike, is
        not seen; give it a break.
        """
        return cls._trusted(*fit_series(f, _checked_breaks(breaks), tolerance))

    @classmethod
    def concatenate(cls, functions: Sequence[Piecewise]) -> Piecewise:
        """One function with the components of all, which must share their breaks, side by side."""
        if not all(np.array_equal(f.breaks, functions[0].breaks) for f in functions[1:]):
            raise InputError("functions whose components are to stand side by side must share their breaks")
        degree, ends = max(f.degree for f in functions), np.cumsum([f.n_components for f in functions])
        side_by_side = np.zeros((degree + 1, len(functions[0].breaks) - 1, ends[-1]))
        for f, end in zip(functions, ends, strict=True):
            side_by_side[: f.degree + 1, :, end - f.n_components : end] = f.coefficients
        return cls._trusted(functions[0].breaks, side_by_side)

    @property
    def n_components(self) -> int:
        """Number of components m."""
        return int(self.coefficients.shape[2])

    @property
    def degree(self) -> int:
        """Common degree of the series."""
        return len(self.coefficients) - 1

    @property
    def duration(self) -> float:
        """Length of the span in s."""
        return float(self.breaks[-1] - self.breaks[0])

    def __call__(self, t: ArrayLike) -> Array:
        """Values at times t: shape () gives (m,), shape (k,) gives (k, m); outside the span is an InputError."""
        times = np.asarray(t, dtype=np.float64)
        flat = times.reshape(-1)
        inside = (flat >= self.breaks[0]) & (flat <= self.breaks[-1])
        if not inside.all():
            worst = flat[np.argmin(inside)]
            raise InputError(f"t = {worst:.9g} s is outside the span [{self.breaks[0]:.9g}, {self.breaks[-1]:.9g}] s")
        piece = np.searchsorted(self.breaks[1:-1], flat, side="right") if len(self.breaks) > 2 else 0
        left, right = self.breaks[piece], self.breaks[piece + 1]
        x = (2 * flat - (left + right)) / (right - left)
        values = _evaluated(matrices.basis_at(x, self.degree), self.coefficients, piece)
        return values.reshape(*times.shape, self.n_components)

    def power_coefficients(self) -> Array:
        """Coefficients of powers of ``t - breaks[i]`` on each interval, ascending, shape (n, degree + 1, m).

        Meant for series of low degree: powers are ill conditioned beyond about 15.
        """
        powers = _apply(matrices.to_power_matrix(self.degree), self.coefficients)
        lengths = np.diff(self.breaks) ** -np.arange(self.degree + 1.0)[:, None]
        return np.moveaxis(powers * lengths[..., None], 0, 1)

    def derivative(self) -> Piecewise:
        """The derivative by time within the intervals; steps are left to `jumps`."""
        scale = 2 / (self.breaks[1:] - self.breaks[:-1])[:, None]
        return self._trusted(self.breaks, _apply(matrices.derivative_matrix(self.degree), self.coefficients) * scale)

    def with_derivatives(self, count: int) -> Piecewise:
        """The function and its first `count` derivatives by time, side by side as (count + 1) m components."""
        degree, n, m = self.degree, len(self.breaks) - 1, self.n_components
        series = matrices.state_matrix(degree, count) @ self.coefficients.reshape(degree + 1, -1)
        scale = (2 / np.diff(self.breaks)) ** np.arange(count + 1)[:, None]
        scaled = series.reshape(count + 1, degree + 1, n, m) * scale[:, None, :, None]
        return self._trusted(self.breaks, scaled.transpose(1, 2, 0, 3).reshape(degree + 1, n, -1))

    def integral(self) -> Piecewise:
        """The continuous integral from the start of the span."""
        scale = np.diff(self.breaks)[:, None] / 2
        series = _apply(matrices.integral_matrix(self.degree), self.coefficients) * scale
        series[0, 1:] += np.cumsum(series.sum(axis=0), axis=0)[:-1]
        return self._trusted(self.breaks, series)

    def inner(self, other: Piecewise) -> Array:
        """The integral of the product with `other` over the span, componentwise, shape (m,).

        Exact for the series, without forming the product: ``f.inner(f)`` is T times the mean square.
        """
        f, g = _aligned(self, other)
        top = max(f.degree, g.degree)
        weighted = _apply(matrices.gram_matrix(top)[: f.degree + 1, : g.degree + 1], g.coefficients)
        return np.asarray(np.einsum("dnm,dnm,n->m", f.coefficients, weighted, np.diff(f.breaks) / 2))

    def extrema(self) -> Extrema:
        """Least and greatest finite values, one-sided values at steps included."""
        low, high = find_extrema(self.breaks, self.coefficients)
        return Extrema(min=low[0], t_min=low[1], max=high[0], t_max=high[1])

    def roots(self) -> tuple[Array, ...]:
        """Times inside the intervals at which each component changes sign, one sorted array per component.

        A zero without a change of sign (a double zero, rest) is none, and a change of sign across a break needs no
        root: it is at the break.
        """
        return find_sign_changes(self.breaks, self.coefficients)

    def signs(self) -> Array:
        """Sign of each component in the middle of each interval, shape (n, m); 0 where it is zero throughout.

        It is the sign on the whole interval once the function has been split at its `roots`.
        """
        middle = matrices.basis_at(np.zeros(()), self.degree) @ self.coefficients.reshape(self.degree + 1, -1)
        return np.sign(middle).reshape(self.coefficients.shape[1:])

    def ends(self) -> tuple[Array, Array]:
        """Values at the left and right end of each interval, each of shape (n, m)."""
        left = np.tensordot(matrices.signs(self.degree), self.coefficients, 1)
        return left, self.coefficients.sum(axis=0)

    def jumps(self) -> Jumps:
        """Steps at all interior breaks, rounding included."""
        left, right = self.ends()
        return Jumps(times=self.breaks[1:-1], sizes=left[1:] - right[:-1])

    def split(self, times: ArrayLike) -> Piecewise:
        """The same function with further breaks; times outside the span or at a break change nothing."""
        breaks = _merged(self.breaks, checked_array("times", np.ravel(times), (None,), unit="s"))
        if len(breaks) == len(self.breaks):
            return self
        parent = np.searchsorted(self.breaks[1:-1], (breaks[:-1] + breaks[1:]) / 2)
        left, right = self.breaks[parent], self.breaks[parent + 1]
        start, stop = (2 * (end - left) / (right - left) - 1 for end in (breaks[:-1], breaks[1:]))
        y = matrices.nodes(self.degree)
        x = start + (stop - start) * (y[:, None] + 1) / 2
        values = _evaluated(matrices.basis_at(x.T.ravel(), self.degree), self.coefficients, np.repeat(parent, len(y)))
        at_nodes = values.reshape(len(parent), len(y), -1).transpose(1, 0, 2)
        return self._trusted(breaks, _apply(matrices.coefficients_from_values(self.degree), at_nodes))

    def __add__(self, other: Piecewise) -> Piecewise:
        if not isinstance(other, Piecewise):
            return NotImplemented
        f, g = _aligned(self, other)
        if f.degree < g.degree:
            f, g = g, f
        total = f.coefficients.copy()
        total[: g.degree + 1] += g.coefficients
        return self._trusted(f.breaks, total)

    def __sub__(self, other: Piecewise) -> Piecewise:
        return self + other * -1.0 if isinstance(other, Piecewise) else NotImplemented

    def __mul__(self, other: Piecewise | ArrayLike) -> Piecewise:
        """The product, componentwise, with a function or with a constant of shape () or (m,)."""
        if not isinstance(other, Piecewise):
            factor = checked_array("factor", other, () if np.ndim(other) == 0 else (self.n_components,))
            return self._trusted(self.breaks, self.coefficients * factor)
        f, g = _aligned(self, other)
        degree = f.degree + g.degree
        at_nodes = [_apply(matrices.values_matrix(h.degree, degree), h.coefficients) for h in (f, g)]
        product = _apply(matrices.coefficients_from_values(degree), at_nodes[0] * at_nodes[1])
        return self._trusted(f.breaks, product)

    __rmul__ = __mul__
    # An array on the left leaves the product to us, instead of multiplying element by element.
    __array_ufunc__: ClassVar[None] = None


def _checked_breaks(breaks: ArrayLike) -> Array:
    times = checked_times("breaks", breaks)
    if len(times) < 2:
        raise InputError(f"breaks: at least 2 times are needed, got {len(times)}")
    return times


def _evaluated(basis: Array, coefficients: Array, piece: NDArray[np.int64] | int) -> Array:
    """Values (k, m) of the series of each point's piece, from the basis (degree + 1, k) at the points."""
    if isinstance(piece, int):
        return np.asarray(basis.T @ coefficients[:, piece])
    values = np.empty((len(piece), coefficients.shape[2]))
    # One product per run of points in the same piece.
    ends = [*(np.flatnonzero(piece[1:] != piece[:-1]) + 1).tolist(), len(piece)]
    if len(ends) > coefficients.shape[1]:
        order = np.argsort(piece, kind="stable")
        values[order] = _evaluated(basis[:, order], coefficients, piece[order])
        return values
    start = 0
    for end in ends if len(piece) else ():
        values[start:end] = basis[:, start:end].T @ coefficients[:, piece[start]]
        start = end
    return values


def _apply(matrix: Array, coefficients: Array) -> Array:
    """A matrix on the first axis, as one product."""
    result = matrix @ coefficients.reshape(len(coefficients), -1)
    return result.reshape(len(matrix), *coefficients.shape[1:])


def _merged(breaks: Array, times: Array) -> Array:
    """Breaks with those times added that lie inside the span and are not a break already."""
    same = _SAME_TIME * max(abs(breaks[0]), abs(breaks[-1]))
    inside = np.unique(times[(times > breaks[0] + same) & (times < breaks[-1] - same)])
    if not len(inside):
        return breaks
    nearest = np.searchsorted(breaks, inside)
    new = (inside - breaks[nearest - 1] > same) & (breaks[nearest] - inside > same)
    new[1:] &= np.diff(inside) > same
    return np.sort(np.concatenate([breaks, inside[new]]))


def _aligned(f: Piecewise, g: Piecewise) -> tuple[Piecewise, Piecewise]:
    """Both functions on the union of their breaks."""
    if f.n_components != g.n_components:
        raise InputError(f"functions of {f.n_components} and {g.n_components} components cannot be combined")
    if np.array_equal(f.breaks, g.breaks):
        return f, g
    if f.breaks[0] != g.breaks[0] or f.breaks[-1] != g.breaks[-1]:
        raise InputError(
            f"functions on [{f.breaks[0]:g}, {f.breaks[-1]:g}] s and [{g.breaks[0]:g}, {g.breaks[-1]:g}] s"
            " cannot be combined: their spans differ"
        )
    f = f.split(g.breaks)
    return f, Piecewise._trusted(f.breaks, g.split(f.breaks).coefficients)
