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

from puma_septic.checks import Array
from puma_septic.errors import NoSolution, PumaSepticError
from puma_septic.piecewise import Piecewise, matrices

__all__ = ["heating", "overload_time", "steady_cycle", "thermal_equation"]

# Collocation degrees in turn; then the interval is halved. The tail of the series decides, relative to its largest.
_DEGREES: Final = (16, 32, 64, 128)
_TOLERANCE: Final = 1e-13
# Halvings; a boundary layer of 1e-9 of an interval is resolved with 30.
_DEEPEST: Final = 40


def overload_time(overload: float, time_constant: float) -> float:
    """How long a cold one-node winding of constant resistance bears `overload` times its continuous current, s.

    ``time_constant ln(K^2 / (K^2 - 1))``; infinite up to K = 1.

    Examples
    --------
    >>> overload_time(2.0, 1.0)
    0.287682...
    """
    return np.inf if overload <= 1 else float(-time_constant * np.log1p(-(overload**-2.0)))


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
    matrix = np.zeros((loss.degree + 1, len(loss.breaks) - 1, k * k))
    matrix[:, :, 0] = loss.coefficients[:, :, 0] * copper / capacity[0]
    matrix[0] += exchange.ravel()
    source = np.zeros((loss.degree + 1, len(loss.breaks) - 1, k))
    source[:, :, 0] = loss.coefficients[:, :, 0] * (1 + copper * excess) / capacity[0]
    return Piecewise(breaks=loss.breaks, coefficients=matrix), Piecewise(breaks=loss.breaks, coefficients=source)


def steady_cycle(matrix: Piecewise, source: Piecewise) -> Piecewise:
    """The solution of ``theta' = matrix theta + source`` that repeats itself.

    Raises
    ------
    NoSolution
        If each cycle adds more heat than it loses: the temperature runs away.
    """
    pieces = _pieces(matrix, source)
    k = source.n_components
    # State after less state before, ``change theta + gain``: differences keep their digits where a cycle is short.
    change, gain = np.zeros((k, k)), np.zeros(k)
    for _, series in pieces:
        end = series.sum(axis=0)
        gain = gain + end[:, 0] + end[:, 1:] @ gain
        change = change + end[:, 1:] + end[:, 1:] @ change
    growth = float(np.linalg.eigvals(change).real.max())
    if not growth < 0:
        raise NoSolution(
            "the winding's temperature runs away: as its resistance grows, each cycle adds more heat than it loses",
            residual=growth,
            q=np.empty(0),
        )
    return _assembled(pieces, np.asarray(np.linalg.solve(change, -gain)))


def heating(matrix: Piecewise, source: Piecewise, start: Array) -> Piecewise:
    """The solution of ``theta' = matrix theta + source`` from a given state, shape (k,)."""
    return _assembled(_pieces(matrix, source), start)


Piece = tuple[tuple[float, float], Array]


def _pieces(matrix: Piecewise, source: Piecewise) -> list[Piece]:
    """Intervals and, on each, series (degree + 1, k, 1 + k): response to the source, and growth of each unit state."""
    pending = [(float(a), float(b), 0) for a, b in zip(matrix.breaks[:-1], matrix.breaks[1:], strict=True)][::-1]
    done: list[Piece] = []
    while pending:
        left, right, depth = pending.pop()
        series = _solved(matrix, source, left, right)
        if series is not None:
            done.append(((left, right), series))
        elif depth == _DEEPEST:
            raise PumaSepticError(f"the winding's temperature does not converge on [{left:.9g}, {right:.9g}] s")
        else:
            middle = (left + right) / 2
            pending += [(middle, right, depth + 1), (left, middle, depth + 1)]
    return done


def _solved(matrix: Piecewise, source: Piecewise, left: float, right: float) -> Array | None:
    """The series on one interval by collocation; None where no degree resolves them."""
    for degree in _DEGREES:
        series = _collocated(matrix, source, left, right, degree)
        tail = np.abs(series[-max(2, degree // 8) :]).max(axis=(0, 1))
        largest = np.abs(series).max(axis=(0, 1))
        if (tail <= _TOLERANCE * largest).all():
            return series
    return None


def _collocated(matrix: Piecewise, source: Piecewise, left: float, right: float, degree: int) -> Array:
    """Coefficients (degree + 1, k, 1 + k) that satisfy the equation at the nodes but the first, where all are zero.

    The growth w of a unit state e solves ``w' = matrix (w + e)``.
    """
    k = source.n_components
    x = matrices.nodes(degree)
    times = np.clip((left * (1 - x) + right * (1 + x)) / 2, left, np.nextafter(right, left))
    at_nodes = matrix(times).reshape(-1, k, k)
    values = matrices.values_matrix(degree, degree)
    slopes = values[:, :degree] @ matrices.derivative_matrix(degree) * (2 / (right - left))
    system = slopes[:, None, :, None] * np.eye(k)[None, :, None, :] - at_nodes[:, :, None, :] * values[:, None, :, None]
    given = np.concatenate([source(times)[:, :, None], at_nodes], axis=2)
    system[0] = values[0][None, :, None] * np.eye(k)[:, None, :]
    given[0] = 0.0
    size = (degree + 1) * k
    solution = np.linalg.solve(system.reshape(size, size), given.reshape(size, 1 + k))
    return np.asarray(solution.reshape(degree + 1, k, 1 + k))


def _assembled(pieces: list[Piece], start: Array) -> Piecewise:
    """The solution from a state at the beginning."""
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
