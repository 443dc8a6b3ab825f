"""Search for a local minimum of the largest of several smooth numbers, under constraints, by SciPy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, final

import numpy as np
from scipy.optimize import minimize

from puma_septic.errors import InputError
from puma_septic.limit_check import AT_LIMIT
from puma_septic.validation import Array

__all__ = ["COARSE", "FINE", "KEPT", "Found", "Problem", "search"]

# Relative change of the value at which a search ends: for what follows from the trajectory alone, and for torque and
# power, which are known to about 1e-9 and flat near their optimum.
FINE: Final = 1e-9
COARSE: Final = 1e-6
# A constraint (in rad or as a share of its limit) is kept if it is exceeded by no more than this: half of what a
# verdict tolerates, so that what is returned is at its limit there too.
KEPT: Final = AT_LIMIT / 2
# Sequential quadratic programming leaves its constraints by about its tolerance, so it aims to stay inside by this; by
# more where it missed by less than the second number.
_INSIDE: Final = 5e-7
_NEAR: Final = 1e-4
# Step of the central differences by the cube root of the tolerance, for variables of size one: 6e-6 for the fine one,
# the cube root of a double's rounding.
_STEP: Final = 6e-3
_ITERATIONS: Final = 60
# What a refused trajectory counts as, relative to the start.
_REFUSED: Final = 1e6
# The simplex method is dependable for few variables only.
_SIMPLEX_LIMIT: Final = 6
# The search is repeated while it gains this part of the value.
_WORTH: Final = 1e-5
_ROUNDS: Final = 4


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Problem:
    """What is to be made small.

    Attributes
    ----------
    evaluate : callable
        Of x (n,): the parts, of which the largest counts, and by how much each constraint is exceeded.
    lower, upper : ndarray, shape (n,)
    tolerance : float
        Relative change of the value at which a search ends.
    gradient : callable or None
        Of the only part, where its structure gives it.
    evaluate_together : callable or None
        Of several x: what `evaluate` gives of each, or None where it refuses one; where it is quicker.
    most : int or None
        Evaluations after which a search ends with the best that it has seen.
    """

    evaluate: Callable[[Array], tuple[Array, Array]]
    lower: Array
    upper: Array
    tolerance: float = FINE
    gradient: Callable[[Array], Array] | None = None
    evaluate_together: Callable[[Sequence[Array]], list[tuple[Array, Array] | None]] | None = None
    most: int | None = None


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Found:
    """Where a search ended: variables, value, largest excess of a constraint, evaluations; whether those ended it."""

    x: Array
    value: float
    excess: float
    n_evaluations: int
    is_cut: bool = False

    @property
    def rank(self) -> tuple[float, float]:
        """To be small: first the excess beyond what is tolerated, then the value."""
        return max(0.0, self.excess - KEPT), self.value


def search(problem: Problem, start: Array) -> Found:
    """Sequential quadratic programming on ``min z, parts <= z``, repeated, then a simplex where there are kinks.

    Each part is smooth where the largest of them is not: with one constraint for each, the kinks are no
    hindrance. What is left of them, where a peak moves from one extremum to another, is for the simplex
    (SciPy's SLSQP and Nelder-Mead).
    """
    memory = _Memory(problem, start)
    if not len(start):
        return memory.found(start)
    try:
        return _searched(memory, start)
    except _Spent:
        return replace(memory.best, n_evaluations=memory.count, is_cut=True)


def _searched(memory: _Memory, start: Array) -> Found:
    best = memory.found(start)
    inside = _INSIDE
    for _ in range(_ROUNDS):
        found = memory.found(_quadratic(memory, best.x, inside))
        missed = KEPT < found.excess < _NEAR
        gain = best.value - found.value
        better = found.rank < best.rank
        best = min(best, found, key=lambda one: one.rank)
        if missed:
            inside += 2 * found.excess
        elif not better or gain < _WORTH * abs(best.value):
            break
    if memory.n_parts > 1 and len(start) <= _SIMPLEX_LIMIT:
        best = min(best, memory.found(_simplex(memory, best.x)), key=lambda one: one.rank)
    return replace(best, n_evaluations=memory.count)


class _Spent(Exception):
    """All evaluations that a search may make are made."""


class _Memory:
    """Evaluations of a problem, each made once; the one place here that changes."""

    def __init__(self, problem: Problem, start: Array) -> None:
        self.problem = problem
        self.count = 0
        self._known: dict[bytes, tuple[Array, Array]] = {}
        parts, excess = self(start)
        self.n_parts, self._n_excess = len(parts), len(excess)
        self.scale = max(abs(float(parts.max())), 1e-12)
        self.best = self.found(start)

    def __call__(self, x: Array) -> tuple[Array, Array]:
        key = x.tobytes()
        if key not in self._known:
            if self.count == self.problem.most:
                raise _Spent
            self.count += 1
            self._known[key] = self.problem.evaluate(x) if self.count == 1 else self._guarded(x)
            if self.count > 1:
                self.best = min(self.best, self.found(x), key=lambda one: one.rank)
        return self._known[key]

    def look_ahead(self, several: Sequence[Array]) -> None:
        """Evaluate what will be asked for next together."""
        if self.problem.evaluate_together is None:
            return
        new = [x for x in several if x.tobytes() not in self._known]
        if self.problem.most is not None:
            new = new[: self.problem.most - self.count]
        for x, found in zip(new, self.problem.evaluate_together(new), strict=True):
            self.count += 1
            self._known[x.tobytes()] = self._or_bad(found)
            self.best = min(self.best, self.found(x), key=lambda one: one.rank)

    def _guarded(self, x: Array) -> tuple[Array, Array]:
        try:
            return self._or_bad(self.problem.evaluate(x))
        except InputError:
            return self._or_bad(None)

    def _or_bad(self, found: tuple[Array, Array] | None) -> tuple[Array, Array]:
        """Beyond the start, a trajectory that is refused is only a bad one; the number of parts stays what it was."""
        if found is None:
            return np.full(self.n_parts, _REFUSED * self.scale), np.zeros(self._n_excess)
        return _fitted(found[0], self.n_parts), _fitted(found[1], self._n_excess)

    def found(self, x: Array) -> Found:
        """What is known of x; what is refused keeps no constraint, and so is never the best."""
        parts, excess = self(x)
        value = float(parts.max())
        worst = np.inf if value >= _REFUSED * self.scale else float(excess.max(initial=-np.inf))
        return Found(x=x, value=value, excess=worst, n_evaluations=self.count)

    def slopes(self, x: Array) -> tuple[Array, Array]:
        """Derivatives of parts (n_parts, n) and excesses by central differences, or by the problem's gradient."""
        if self.problem.gradient is not None:
            return self.problem.gradient(x)[None], np.zeros((0, len(x)))
        step = _STEP * float(np.cbrt(self.problem.tolerance))
        ahead, behind = x + step * np.eye(len(x)), x - step * np.eye(len(x))
        self.look_ahead([*ahead, *behind])
        columns = [
            [(a - b) / (2 * step) for a, b in zip(self(more), self(less), strict=True)]
            for more, less in zip(ahead, behind, strict=True)
        ]
        by_parts, by_excess = zip(*columns, strict=True)
        return np.stack(by_parts, axis=1), np.stack(by_excess, axis=1)


def _fitted(values: Array, count: int) -> Array:
    """Where intervals merge, the number of parts changes: the largest stands for all."""
    return values if len(values) == count else np.full(count, values.max(initial=-np.inf))


def _quadratic(memory: _Memory, start: Array, inside: float) -> Array:
    """Sequential quadratic programming; the variables are x and, for several parts, their bound z."""
    n, many, scale = len(start), memory.n_parts > 1, memory.scale
    excess_at_start = memory(start)[1]
    constraints: list[dict[str, Any]] = []
    if many:
        constraints.append({
            "type": "ineq",
            "fun": lambda y: y[-1] - memory(y[:n])[0] / scale,
            "jac": lambda y: _with_bound(-memory.slopes(y[:n])[0] / scale, 1.0),
        })  # fmt: skip
    if len(excess_at_start):
        constraints.append({
            "type": "ineq",
            "fun": lambda y: -inside - memory(y[:n])[1],
            "jac": lambda y: _with_bound(-memory.slopes(y[:n])[1], 0.0) if many else -memory.slopes(y)[1],
        })  # fmt: skip
    value = float(memory(start)[0].max()) / scale
    bounds = list(zip(memory.problem.lower, memory.problem.upper, strict=True))
    unit = np.zeros(n + many)
    unit[-1] = 1.0
    result = minimize(
        (lambda y: float(y[-1])) if many else (lambda y: float(memory(y)[0][0]) / scale),
        np.append(start, value) if many else start,
        jac=(lambda _: unit) if many else (lambda y: memory.slopes(y)[0][0] / scale),
        method="SLSQP",
        bounds=[*bounds, (None, None)] if many else bounds,
        constraints=constraints,
        options={"ftol": memory.problem.tolerance, "maxiter": _ITERATIONS},
    )
    x = np.clip(result.x[:n], memory.problem.lower, memory.problem.upper)
    return x if np.isfinite(x).all() else start


def _with_bound(slopes: Array, by_z: float) -> Array:
    return np.column_stack([slopes, np.full(len(slopes), by_z)])


def _simplex(memory: _Memory, start: Array) -> Array:
    def merit(x: Array) -> float:
        parts, excess = memory(x)
        too_much = float(excess.max(initial=-np.inf)) - KEPT
        return float(parts.max()) / memory.scale if too_much <= 0 else _REFUSED * (1 + too_much)

    result = minimize(
        merit,
        start,
        method="Nelder-Mead",
        bounds=list(zip(memory.problem.lower, memory.problem.upper, strict=True)),
        options={"xatol": memory.problem.tolerance**0.5, "fatol": memory.problem.tolerance, "maxfev": 100 * len(start)},
    )
    return np.asarray(result.x)
