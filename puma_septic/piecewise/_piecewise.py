"""Piecewise: the one kind of thing that every computed quantity is."""

from __future__ import annotations

import reprlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial, reduce
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.document import card, one_line
from puma_septic.errors import InputError, PumaSepticError
from puma_septic.piecewise import matrices
from puma_septic.piecewise._fitting import Intervals, fit_series
from puma_septic.piecewise._results import Extrema, Jumps
from puma_septic.piecewise._search import find_extrema, find_sign_changes
from puma_septic.validation import (
    Array,
    checked_array,
    checked_number,
    checked_times,
    frozen,
    n_dimensions,
    numbers,
    read_only,
)

__all__ = ["Piecewise"]

# Series are mathematics: a step of a solver may be larger than any quantity of an arm.
_checked = partial(checked_array, largest=np.finfo(np.float64).max)
# Two times closer than this part of the span are one: a few hundred roundings of its length.
_SAME_TIME = 1e-13
# An integral below this part of what the coefficients could make it is rounding, and has no sign.
_NO_SIGN = 64 * np.finfo(np.float64).eps


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

    Attributes
    ----------
    offsets : ndarray, shape (n + 1,)
        Times of the breaks from the start of the span, s. All computing is done with these, so that a function that
        begins at 1.7e9 s (a clock that counts from 1970) is as exact as one that begins at 0; ``breaks`` are
        ``start + offsets``, rounded.

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
    offsets: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        breaks = _checked_breaks(self.breaks)
        coefficients = _checked("coefficients", self.coefficients, (None, len(breaks) - 1, None))
        if not coefficients.size:
            raise InputError(f"coefficients: at least one per interval and component, got {coefficients.shape}")
        object.__setattr__(self, "breaks", breaks)
        object.__setattr__(self, "coefficients", coefficients)
        object.__setattr__(self, "offsets", read_only(breaks - breaks[0]) if breaks[0] else breaks)

    @classmethod
    def _trusted(cls, start: float, offsets: Array, coefficients: Array) -> Piecewise:
        """From arrays that this module has just made: no copy, no check; non-finite values still surface."""
        new = object.__new__(cls)
        breaks = start + offsets if start else offsets
        for name, array in (("breaks", breaks), ("coefficients", coefficients), ("offsets", offsets)):
            array.setflags(write=False)
            object.__setattr__(new, name, array)
        return new

    def _with(self, coefficients: Array) -> Piecewise:
        """Other series on the same intervals."""
        coefficients.setflags(write=False)
        new = object.__new__(Piecewise)
        for name, array in (("breaks", self.breaks), ("coefficients", coefficients), ("offsets", self.offsets)):
            object.__setattr__(new, name, array)
        return new

    @classmethod
    def from_power(cls, breaks: ArrayLike, powers: ArrayLike) -> Piecewise:
        """From powers of ``s = (t - breaks[i]) / (breaks[i+1] - breaks[i])``.

        Parameters
        ----------
        powers : array_like, shape (degree + 1, n, m)
            ``powers[k, i, j]`` multiplies ``s**k`` on interval i in component j.
        """
        checked = _checked("powers", powers, (None, None, None))
        matrix = matrices.from_power_matrix(len(checked) - 1)
        return cls(breaks=breaks, coefficients=_apply(matrix, checked))  # type: ignore[arg-type]

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
        times = _checked_breaks(breaks)
        checked_number("tolerance", tolerance, above=0.0)
        if not callable(f):
            raise InputError(f"f: expected a function of time, got {reprlib.repr(f)}")

        def sample(intervals: Intervals, x: Array) -> Array:
            left, right, x = times[intervals.piece, None], times[intervals.piece + 1, None], intervals.points(x)
            # f may step at a break and has the right-hand value there: an interval's last instant is the one before.
            t = np.clip((left * (1 - x) + right * (1 + x)) / 2, left, np.nextafter(right, left)).ravel()
            values = numbers("the function to be fitted", f(t))
            if values.shape[:1] != t.shape:
                raise InputError(f"the function to be fitted has shape {values.shape} at {len(t)} times")
            if not np.isfinite(values).all():
                k = int(np.argwhere(~np.isfinite(values))[0, 0])
                raise PumaSepticError(f"the function to be fitted is not finite at t = {t[k]:.9g} s")
            return values.reshape(*x.shape, -1).transpose(1, 0, 2)

        start = float(times[0])
        return cls._trusted(start, *fit_series(sample, times - start, tolerance, start=start))

    def mapped(self, g: Callable[[Array], Array], *, tolerance: float = 1e-11) -> Piecewise:
        """The series of ``g(f(t))``, as `fit` makes it, on intervals of this function.

        Parameters
        ----------
        g : callable
            ``g(values)`` with values of shape (k, m) returns shape (k, p); smooth. It never sees a time, so that
            short intervals and late clocks cost no digits.
        tolerance : float
            Relative to each component's largest value.

        Raises
        ------
        PumaSepticError
            As `fit`.
        """

        def sample(intervals: Intervals, x: Array) -> Array:
            n = len(intervals.piece)
            if intervals.are_whole:
                values = _apply(matrices.basis_at(x, self.degree).T, self.coefficients[:, intervals.piece])
            else:
                piece, inside = np.repeat(intervals.piece, len(x)), intervals.points(x).ravel()
                values = _evaluated(matrices.basis_at(inside, self.degree), self.coefficients, piece)
                values = values.reshape(n, len(x), -1).transpose(1, 0, 2)
            return g(values.reshape(len(x) * n, -1)).reshape(len(x), n, -1)

        return self._trusted(self.start, *fit_series(sample, self.offsets, tolerance, start=self.start))

    @classmethod
    def concatenate(cls, functions: Sequence[Piecewise]) -> Piecewise:
        """One function with the components of all, which must share their breaks, side by side."""
        if not all(_same_intervals(f, functions[0]) for f in functions[1:]):
            raise InputError("functions whose components are to stand side by side must share their breaks")
        degree = max(f.degree for f in functions)
        return functions[0]._with(np.concatenate([_padded(f, degree) for f in functions], axis=2))

    @classmethod
    def joined(cls, functions: Sequence[Piecewise]) -> Piecewise:
        """`concatenate`, of functions of one span that have breaks of their own."""
        whole = reduce(Piecewise.aligned_with, functions)
        return cls.concatenate([f.aligned_with(whole) for f in functions])

    @classmethod
    def constant(cls, values: ArrayLike, duration: float, *, start: float = 0.0) -> Piecewise:
        """The function that has the values, shape (m,), all the time."""
        values = _checked("values", values, (None,))
        # Not by start + duration, which a late start rounds.
        return cls(breaks=np.array([0.0, duration]), coefficients=values[None, None]).shifted(start)

    @classmethod
    def sequence(cls, functions: Sequence[Piecewise]) -> Piecewise:
        """One function after the other, from time 0; each keeps its length."""
        degree = max(f.degree for f in functions)
        ends = np.cumsum([f.duration for f in functions])
        starts = np.concatenate([[0.0], ends[:-1]])
        offsets = [f.offsets[:-1] + start for f, start in zip(functions, starts, strict=True)]
        series = np.concatenate([_padded(f, degree) for f in functions], axis=1)
        return cls._trusted(0.0, np.concatenate([*offsets, ends[-1:]]), series)

    @property
    def n_components(self) -> int:
        """Number of components m."""
        return int(self.coefficients.shape[2])

    @property
    def degree(self) -> int:
        """Common degree of the series."""
        return len(self.coefficients) - 1

    @property
    def start(self) -> float:
        """Where the span begins, s."""
        return float(self.breaks[0])

    @property
    def duration(self) -> float:
        """Length of the span in s."""
        return float(self.offsets[-1])

    @property
    def lengths(self) -> Array:
        """Lengths of the intervals in s, shape (n,)."""
        return frozen(self.offsets[1:] - self.offsets[:-1])

    @property
    def middles(self) -> Array:
        """Instants in the middle of the intervals, s, shape (n,)."""
        return frozen(self.start + (self.offsets[:-1] + self.offsets[1:]) / 2)

    def __getitem__(self, components: int | slice | Sequence[int] | NDArray[np.int64]) -> Piecewise:
        """One component, or some, also repeated (``f[[0, 0, 1]]``), as a function of its own."""
        return self._with(self.coefficients[:, :, [components] if isinstance(components, int) else components])

    def combined(self, matrix: ArrayLike) -> Piecewise:
        """Linear combinations of the components, ``f(t) @ matrix`` with a matrix of shape (m, p)."""
        return self._with(self.coefficients @ _checked("matrix", matrix, (self.n_components, None)))

    def by_interval(self, factors: ArrayLike) -> Piecewise:
        """The function times a factor on each interval, shape (n,) or (n, m)."""
        factors = np.asarray(factors, dtype=np.float64)
        return self._with(self.coefficients * (factors[:, None] if factors.ndim == 1 else factors))

    def stepwise(self, values: ArrayLike) -> Piecewise:
        """The function that is constant on each interval of this one, values of shape (n, p)."""
        values = np.array(values, dtype=np.float64)
        if values.ndim != 2 or len(values) != len(self.offsets) - 1:
            raise InputError(
                f"values: shape {values.shape} is not ({len(self.offsets) - 1}, p), a row for each interval"
            )
        return self._with(values[None])

    def bounds(self) -> Array:
        """What no component's magnitude exceeds on each interval, shape (n, m): the sum of its ``|coefficients|``."""
        return np.asarray(np.abs(self.coefficients).sum(axis=0))

    def trimmed(self, part: float) -> Piecewise:
        """Without the last coefficients that are all below this part of the largest of their component."""
        size = np.abs(self.coefficients)
        kept = np.flatnonzero((size > part * size.max(axis=(0, 1))).any(axis=(1, 2)))
        return self._with(self.coefficients[: kept[-1] + 1 if len(kept) else 1])

    def aligned_with(self, other: Piecewise) -> Piecewise:
        """The same function on the breaks of `other`, which has the same span, and its own where `other` has none."""
        return self if _same(self.offsets, other.offsets) else self._on(_merged(other.offsets, self.offsets))

    def shifted(self, seconds: float) -> Piecewise:
        """The same function, later by a number of seconds: ``f(t - seconds)``."""
        later = float(_checked("seconds", seconds, (), unit="s"))
        return self._trusted(self.start + later, self.offsets, self.coefficients)

    def from_zero(self) -> Piecewise:
        """The same function on a clock that begins at 0."""
        return self if self.start == 0 else self._trusted(0.0, self.offsets, self.coefficients)

    def reversed(self) -> Piecewise:
        """The same function in reversed time, ``f(end - t)``, from time 0."""
        mirrored = self.coefficients * matrices.signs(self.degree)[:, None, None]
        return self._trusted(0.0, self.duration - self.offsets[::-1], mirrored[:, ::-1].copy())

    def stretched(self, factor: float) -> Piecewise:
        """The same values over a span longer by a factor: ``f(start + (t - start) / factor)``."""
        times = float(_checked("factor", factor, (), above=0.0))
        return self._trusted(self.start, self.offsets * times, self.coefficients)

    def __call__(self, t: ArrayLike) -> Array:
        """Values at times t: shape () gives (m,), shape (k,) gives (k, m); outside the span is an InputError."""
        times = numbers("t", t)
        flat = times.reshape(-1)
        # The end is the start plus the duration, rounded: the end that somebody gave may be a rounding beyond.
        slack = np.spacing(max(abs(self.start), abs(self.breaks[-1])))
        inside = (flat >= self.start) & (flat <= self.breaks[-1] + slack)
        if not inside.all():
            worst = flat[np.argmin(inside)]
            raise InputError(f"t = {worst:.9g} s is outside the span [{self.breaks[0]:.9g}, {self.breaks[-1]:.9g}] s")
        values = self.at_offsets(np.minimum(flat - self.start, self.duration))
        return values.reshape(*times.shape, self.n_components)

    def at_offsets(self, offsets: Array) -> Array:
        """Values (k, m) at times (k,) since the start, from 0 to the duration."""
        piece = self.offsets[1:-1].searchsorted(offsets, side="right") if len(self.offsets) > 2 else 0
        left, right = self.offsets[piece], self.offsets[piece + 1]
        x = (2 * offsets - (left + right)) / (right - left)
        return _evaluated(matrices.basis_at(x, self.degree), self.coefficients, piece)

    def at(self, piece: NDArray[np.int64], x: Array) -> Array:
        """Values (k, m) at points x (k,) in [-1, 1] of the intervals `piece` (k,): seen from the interval, also at its
        ends.
        """
        return _evaluated(matrices.basis_at(x, self.degree), self.coefficients, piece)

    def power_coefficients(self) -> Array:
        """Coefficients of powers of ``t - breaks[i]`` on each interval, ascending, shape (n, degree + 1, m).

        Meant for series of low degree: powers are ill conditioned beyond about 15.
        """
        powers = _apply(matrices.to_power_matrix(self.degree), self.coefficients)
        scale = self.lengths ** -np.arange(self.degree + 1.0)[:, None]
        return np.moveaxis(powers * scale[..., None], 0, 1)

    def derivative(self) -> Piecewise:
        """The derivative by time within the intervals; steps are left to `jumps`."""
        scale = 2 / self.lengths[:, None]
        return self._with(_apply(matrices.derivative_matrix(self.degree), self.coefficients) * scale)

    def with_derivatives(self, count: int) -> Piecewise:
        """The function and its first `count` derivatives by time, side by side as (count + 1) m components."""
        degree, n, m = self.degree, len(self.breaks) - 1, self.n_components
        series = matrices.state_matrix(degree, count) @ self.coefficients.reshape(degree + 1, -1)
        scale = (2 / self.lengths) ** np.arange(count + 1)[:, None]
        scaled = series.reshape(count + 1, degree + 1, n, m) * scale[:, None, :, None]
        return self._with(scaled.transpose(1, 2, 0, 3).reshape(degree + 1, n, -1))

    def integral(self) -> Piecewise:
        """The continuous integral from the start of the span."""
        scale = self.lengths[:, None] / 2
        series = _apply(matrices.integral_matrix(self.degree), self.coefficients) * scale
        series[0, 1:] += np.cumsum(series.sum(axis=0), axis=0)[:-1]
        return self._with(series)

    def inner(self, other: Piecewise) -> Array:
        """The integral of the product with `other` over the span, componentwise, shape (m,).

        Exact for the series, without forming the product: ``f.inner(f)`` is T times the mean square.
        """
        f, g = _aligned(self, other)
        top = max(f.degree, g.degree)
        weighted = _apply(matrices.gram_matrix(top)[: f.degree + 1, : g.degree + 1], g.coefficients)
        return np.asarray(np.einsum("dnm,dnm,n->m", f.coefficients, weighted, f.lengths / 2))

    def rms(self) -> Array:
        """Root mean square over the span, shape (m,)."""
        return np.sqrt(self.inner(self) / self.duration)

    def extrema(self) -> Extrema:
        """Least and greatest finite values, one-sided values at steps included."""
        return self.extrema_and_turns(0)[0]

    def extrema_and_turns(self, count: int) -> tuple[Extrema, tuple[Array, ...]]:
        """`extrema`, and from the same search all turning points of the first `count` components.

        Returns
        -------
        Extrema
        tuple of ndarray
            For each of them, when its slope changes its sign inside an interval, s since the start of the span.
        """
        low, high, turns = find_extrema(self.offsets, self.coefficients, count)
        start = self.start
        return Extrema(min=low[0], t_min=start + low[1], max=high[0], t_max=start + high[1]), turns

    def roots(self) -> tuple[Array, ...]:
        """Times inside the intervals at which each component changes sign, one sorted array per component.

        A zero without a change of sign (a double zero, rest) does not count, and a change of sign across a break
        needs no root: it is at the break. What is rounding of an interval's series has no sign.
        """
        found = find_sign_changes(self.offsets, self.coefficients)
        return found if self.start == 0 else tuple(self.start + times for times in found)

    def signs(self) -> Array:
        """Sign of the integral of each component over each interval, shape (n, m); 0 where that is rounding.

        It is the sign on the whole interval once the function has been split at its `roots`, also where it touches
        zero in the middle.
        """
        weights = matrices.gram_matrix(self.degree)[0]
        total = np.tensordot(weights, self.coefficients, 1)
        rounding = _NO_SIGN * self.bounds()
        return np.asarray(np.sign(total) * (np.abs(total) > rounding))

    def split_at_roots(self) -> Piecewise:
        """The function with a break at every sign change of every component, so that `signs` holds throughout."""
        return self._split_offsets([times - self.start for times in self.roots()])

    def positive_spans(self) -> tuple[Array, Array]:
        """Starts and ends of the stretches on which the only component is positive, s, each of shape (k,)."""
        if self.n_components != 1:
            raise InputError(f"positive_spans: one component is needed, the function has {self.n_components}")
        split = self.split_at_roots()
        positive = np.concatenate([[False], split.signs()[:, 0] > 0, [False]])
        first = np.flatnonzero(positive[1:] & ~positive[:-1])
        last = np.flatnonzero(positive[:-1] & ~positive[1:])
        return split.breaks[first], split.breaks[last]

    def ends(self) -> tuple[Array, Array]:
        """Values at the left and right end of each interval, each of shape (n, m)."""
        left = _apply(matrices.signs(self.degree)[None], self.coefficients)[0]
        return left, self.coefficients.sum(axis=0)

    def jumps(self) -> Jumps:
        """Steps at all interior breaks, rounding included."""
        left, right = self.ends()
        return Jumps(times=self.breaks[1:-1], sizes=left[1:] - right[:-1])

    def split(self, times: ArrayLike) -> Piecewise:
        """The same function with further breaks; times outside the span or at a break change nothing."""
        flat = _checked("times", times, () if n_dimensions(times) == 0 else (None,), unit="s").ravel()
        if self.start:  # its breaks are rounded, and no new ones beside themselves
            flat = flat[~np.isin(flat, self.breaks)]
        return self._split_offsets([flat - self.start])

    def _split_offsets(self, offsets: Sequence[Array]) -> Piecewise:
        """`split`, at times from the start."""
        merged = _merged(self.offsets, np.concatenate(offsets))
        return self if len(merged) == len(self.offsets) else self._on(merged)

    def _on(self, merged: Array) -> Piecewise:
        """The same function on intervals that divide its own, breaks that are one to rounding as `merged` has them."""
        parent = np.searchsorted(self.offsets[1:-1], (merged[:-1] + merged[1:]) / 2)
        if not self.degree:
            return self._trusted(self.start, merged, self.coefficients[:, parent])
        left, right = self.offsets[parent], self.offsets[parent + 1]
        start, stop = (2 * (end - left) / (right - left) - 1 for end in (merged[:-1], merged[1:]))
        y = matrices.nodes(self.degree)
        x = start + (stop - start) * (y[:, None] + 1) / 2
        values = _evaluated(matrices.basis_at(x.T.ravel(), self.degree), self.coefficients, np.repeat(parent, len(y)))
        at_nodes = values.reshape(len(parent), len(y), -1).transpose(1, 0, 2)
        series = _apply(matrices.coefficients_from_values(self.degree), at_nodes)
        return self._trusted(self.start, merged, series)

    def __add__(self, other: Piecewise | ArrayLike) -> Piecewise:
        """The sum, componentwise, with a function or with a constant of shape () or (m,)."""
        if not isinstance(other, Piecewise):
            moved = self.coefficients.copy()
            moved[0] += _checked("constant", other, () if n_dimensions(other) == 0 else (self.n_components,))
            return self._with(moved)
        f, g = _aligned(self, other)
        if f.degree < g.degree:
            f, g = g, f
        total = f.coefficients.copy()
        total[: g.degree + 1] += g.coefficients
        return f._with(total)

    def __sub__(self, other: Piecewise | ArrayLike) -> Piecewise:
        return self + (other * -1.0 if isinstance(other, Piecewise) else np.negative(other))

    def __mul__(self, other: Piecewise | ArrayLike) -> Piecewise:
        """The product, componentwise, with a function or with a constant of shape () or (m,)."""
        if not isinstance(other, Piecewise):
            factor = _checked("factor", other, () if n_dimensions(other) == 0 else (self.n_components,))
            return self._with(self.coefficients * factor)
        f, g = _aligned(self, other)
        degree = f.degree + g.degree
        at_nodes = [_apply(matrices.values_matrix(h.degree, degree), h.coefficients) for h in (f, g)]
        product = _apply(matrices.coefficients_from_values(degree), at_nodes[0] * at_nodes[1])
        return f._with(product)

    __radd__ = __add__
    __rmul__ = __mul__
    # An array on the left leaves the product to us, instead of multiplying element by element.
    __array_ufunc__: ClassVar[None] = None

    def __repr__(self) -> str:
        return one_line("Piecewise", self._facts())

    def _repr_html_(self) -> str:
        return card("Piecewise", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "components": self.n_components,
            "intervals": len(self.breaks) - 1,
            "degree": self.degree,
            "from": f"{self.start:g}",
            "to": f"{self.start + self.duration:g}",
        }


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


def _merged(offsets: Array, times: Array) -> Array:
    """Offsets with those times added that lie inside the span and are not a break already."""
    same = _SAME_TIME * offsets[-1]
    inside = np.sort(times[(times > same) & (times < offsets[-1] - same)])
    if not len(inside):
        return offsets
    nearest = offsets.searchsorted(inside)
    new = (inside - offsets[nearest - 1] > same) & (offsets[nearest] - inside > same)
    new[1:] &= inside[1:] - inside[:-1] > same
    return np.sort(np.concatenate([offsets, inside[new]]))


def _same_intervals(f: Piecewise, g: Piecewise) -> bool:
    return f.start == g.start and _same(f.offsets, g.offsets)


def _same(offsets: Array, others: Array) -> bool:
    return offsets is others or (len(offsets) == len(others) and bool((offsets == others).all()))


def _padded(f: Piecewise, degree: int) -> Array:
    """Coefficients up to the given degree."""
    return np.pad(f.coefficients, ((0, degree - f.degree), (0, 0), (0, 0)))


def _aligned(f: Piecewise, g: Piecewise) -> tuple[Piecewise, Piecewise]:
    """Both functions on the union of their breaks."""
    if f.n_components != g.n_components:
        raise InputError(f"functions of {f.n_components} and {g.n_components} components cannot be combined")
    if _same_intervals(f, g):
        return f, g
    if f.start != g.start or abs(f.duration - g.duration) > _SAME_TIME * f.duration:
        raise InputError(
            f"functions on [{f.breaks[0]:g}, {f.breaks[-1]:g}] s and [{g.breaks[0]:g}, {g.breaks[-1]:g}] s"
            " cannot be combined: their spans differ"
        )
    f = f._split_offsets([g.offsets])
    return f, f._with(g.aligned_with(f).coefficients)
