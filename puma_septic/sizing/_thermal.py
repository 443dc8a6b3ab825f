"""Winding temperature: a chain of heat capacities from the winding to the ambient, solved in Chebyshev series.

With the winding's excess over ambient ``theta[0]``, the copper loss ``P = loss (1 + copper (theta[0] + ambient -
reference))`` and ``C[i] = time_constants[i] / resistances[i]``,

``C[0] theta'[0] = P - (theta[0] - theta[1]) / resistances[0]`` and so on outwards, the ambient at 0.

It is linear in theta with coefficients that vary in time, as the resistance grows with the temperature, so the state
after a cycle is an affine function of the state before it: the steady cycle is the fixed point of that function.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from puma_septic.errors import NoSolution, PumaSepticError
from puma_septic.piecewise import Piecewise, matrices
from puma_septic.validation import Array, checked_number

__all__ = ["heating", "overload_time", "steady_cycle", "thermal_equation"]

# Collocation degrees in turn; then the interval is halved. The tail of the series decides, relative to its largest or
# to what the whole cycle's heat would do to the winding alone: an interval that adds only rounding to that is done.
_DEGREES: Final = (16, 32, 64, 128)
_TOLERANCE: Final = 1e-13
# Pieces per interval of the loss, which bound the work. One piece spans about a hundred of the shortest time constant.
_MOST_PIECES: Final = 256


def overload_time(overload: float, time_constant: float) -> float:
    """How long a cold one-node winding of constant resistance bears `overload` times its continuous current, s.

    ``time_constant ln(K^2 / (K^2 - 1))``; infinite up to K = 1.

    Examples
    --------
    >>> overload_time(2.0, 1.0)
    0.287682...
    """
    times = checked_number("overload", overload, at_least=0.0)
    constant = checked_number("time_constant", time_constant, unit="s", above=0.0)
    return np.inf if times <= 1 else float(-constant * np.log1p(-(times**-2.0)))


def thermal_equation(
    loss: Piecewise, resistances: Array, time_constants: Array, *, copper: float = 0.0, excess: float = 0.0
) -> tuple[Piecewise, Piecewise]:
    """Matrix (k * k components, row by row) and source (k) of ``theta' = matrix theta + source``.

    Parameters
    ----------
    loss : Piecewise
        Copper loss at the reference temperature, W, one component.
    resistances, time_constants : ndarray, shape (k,)
        K/W and s, from the winding outwards.
    copper : float
        Relative growth of the resistance per K.
    excess : float
        Ambient less reference temperature, K.
    """
    k = len(resistances)
    capacity = time_constants / resistances
    outward = 1 / resistances
    exchange = np.zeros((k, k))
    for i in range(k):
        exchange[i, i] -= outward[i] / capacity[i]
        if i:
            exchange[i, i - 1] = outward[i - 1] / capacity[i]
            exchange[i, i] -= outward[i - 1] / capacity[i]
            exchange[i - 1, i] = outward[i - 1] / capacity[i - 1]
    zero, constant = loss * 0.0, loss.stepwise(np.tile(exchange.ravel(), (len(loss.lengths), 1)))
    matrix = Piecewise.concatenate([loss * (copper / capacity[0]), *[zero] * (k * k - 1)]) + constant
    return matrix, Piecewise.concatenate([loss * ((1 + copper * excess) / capacity[0]), *[zero] * (k - 1)])


def steady_cycle(matrix: Piecewise, source: Piecewise) -> Piecewise:
    """The solution of ``theta' = matrix theta + source`` that repeats itself.

    The temperature runs away where the mean matrix already lets it: as heat only flows outwards and back, the growth is
    a convex function of the diagonal (a theorem of J. Cohen; Nussbaum, "Convexity and log convexity for the spectral
    radius", section 1, proves it), so that a loss that varies grows at least as fast as its mean.

    Raises
    ------
    NoSolution
        If each cycle adds more heat than it loses: the temperature runs away.
    PumaSepticError
        If loss, time constants and cycle are too far out of proportion to be resolved.
    """
    k = source.n_components
    _relative_growth(matrix.integral()(matrix.breaks[-1]).reshape(k, k))
    pieces = _pieces(matrix, source)
    # State after less state before, ``change theta + gain``: differences keep their digits where a cycle is short.
    change, gain = np.zeros((k, k)), np.zeros(k)
    with np.errstate(over="ignore", invalid="ignore"):
        for _, series in pieces:
            end = series.sum(axis=0)
            gain = gain + end[:, 0] + end[:, 1:] @ gain
            change = change + end[:, 1:] + end[:, 1:] @ change
    if not (np.isfinite(change).all() and np.isfinite(gain).all()):
        raise PumaSepticError("the winding's temperature swings too far within one cycle to be resolved")
    if _relative_growth(change) >= -_TOLERANCE:
        raise PumaSepticError("the winding's temperature comes too little nearer to its steady state in one cycle")
    return _assembled(pieces, np.asarray(np.linalg.solve(change, -gain))).shifted(source.start)


def _relative_growth(change: Array) -> float:
    """Of the fastest growing state, beside the largest entry; a NoSolution where it grows by more than rounding."""
    growth = float(np.linalg.eigvals(change).real.max() / np.abs(change).max())
    if growth > _TOLERANCE:
        raise NoSolution(
            "the winding's temperature runs away: as its resistance grows, each cycle adds more heat than it loses",
            residual=growth,
            q=np.empty(0),
        )
    return growth


def heating(matrix: Piecewise, source: Piecewise, start: Array) -> Piecewise:
    """The solution of ``theta' = matrix theta + source`` from a given state, shape (k,)."""
    return _assembled(_pieces(matrix, source), start).shifted(source.start)


Piece = tuple[tuple[float, float], Array]


def _pieces(matrix: Piecewise, source: Piecewise) -> list[Piece]:
    """Intervals, in seconds from the start, and on each the series of the response to the source and of the growth of
    each unit state, shape (degree + 1, k, 1 + k).
    """
    n, k = len(source.lengths), source.n_components
    given = np.concatenate([source.coefficients[..., None], matrix.coefficients.reshape(-1, n, k, k)], axis=3)
    floor = np.zeros(1 + k)
    floor[0] = np.abs(source.integral()(source.breaks[-1])).max()
    done: list[Piece] = []
    for i, (start, stop) in enumerate(zip(source.offsets[:-1].tolist(), source.offsets[1:].tolist(), strict=True)):
        done += _interval(given[:, i], start, stop, floor)
    return done


def _interval(given: Array, start: float, stop: float, floor: Array) -> list[Piece]:
    """The pieces of one interval, on which source and matrix have the series `given`, shape (degree + 1, k, 1 + k).

    Places are kept on the interval's own scale, -1 to 1, on which halving is exact: an instant is rounded to the clock,
    and a short piece far from its zero would see that as noise.
    """
    half = (stop - start) / 2
    pending, done = [(-1.0, 1.0)], []
    while pending:
        a, b = pending.pop()
        left, right = start + half * (a + 1), stop if b == 1 else start + half * (b + 1)
        series = _solved(given, a, b, half, floor)
        if series is not None:
            done.append(((left, right), series))
            continue
        middle = (a + b) / 2
        if len(done) + len(pending) + 2 > _MOST_PIECES or not left < start + half * (middle + 1) < right:
            raise PumaSepticError(
                f"the winding's temperature cannot be resolved at t = {left:.6g} s: its loss and time constants are out"
                " of proportion to the motion"
            )
        pending += [(middle, b), (a, middle)]
    return done


def _solved(given: Array, a: float, b: float, half: float, floor: Array) -> Array | None:
    """The series on one piece by collocation; None where no degree resolves them."""
    for degree in _DEGREES:
        try:
            series = _collocated(given, a, b, half, degree)
        except np.linalg.LinAlgError:  # singular to rounding, as any change of the state would do
            return None
        tail = matrices.tail(series).max(axis=0)
        largest = np.abs(series).max(axis=(0, 1))
        if np.isfinite(largest).all() and (tail <= _TOLERANCE * np.maximum(largest, floor)).all():
            return series
    return None


def _collocated(given: Array, a: float, b: float, half: float, degree: int) -> Array:
    """Coefficients (degree + 1, k, 1 + k) that satisfy the equation at the nodes but the first, where all are zero.

    The growth w of a unit state e solves ``w' = matrix (w + e)``; the slope is by the place in the piece, -1 to 1.
    """
    k = given.shape[1]
    y = matrices.nodes(degree)
    basis = matrices.basis_at(a + (b - a) * (y + 1) / 2, len(given) - 1)
    right = np.einsum("dn,dkc->nkc", basis, given) * (half * (b - a) / 2)
    values = matrices.values_matrix(degree, degree)
    slopes = values[:, :degree] @ matrices.derivative_matrix(degree)
    system = slopes[:, None, :, None] * np.eye(k)[None, :, None, :] - right[:, :, None, 1:] * values[:, None, :, None]
    system[0] = values[0][None, :, None] * np.eye(k)[:, None, :]
    right[0] = 0.0
    size = (degree + 1) * k
    solution = np.linalg.solve(system.reshape(size, size), right.reshape(size, 1 + k))
    return np.asarray(solution.reshape(degree + 1, k, 1 + k))


def _assembled(pieces: list[Piece], start: Array) -> Piecewise:
    """The solution from a state at the beginning, on a clock that begins at 0."""
    degree = max(len(series) for _, series in pieces) - 1
    coefficients = np.zeros((degree + 1, len(pieces), len(start)))
    state = np.asarray(start, dtype=np.float64)
    for i, (_, series) in enumerate(pieces):
        own = series[:, :, 0] + series[:, :, 1:] @ state
        own[0] += state
        coefficients[: len(series), i] = own
        state = own.sum(axis=0)
    breaks = np.array([interval[0] for interval, _ in pieces] + [pieces[-1][0][1]])
    return Piecewise(breaks=breaks, coefficients=coefficients)
