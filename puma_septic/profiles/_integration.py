"""From the highest derivative to the position: integrating loses no digits, differentiating does."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import PumaSepticError
from puma_septic.piecewise import Piecewise, matrices
from puma_septic.validation import Array

__all__ = ["integrated", "smooth_series"]


def integrated(highest: Piecewise, *starts: ArrayLike) -> Piecewise:
    """The function whose derivative of order ``len(starts)`` is `highest`.

    `starts` are the start values of its derivatives, of the highest order first, its own last.
    Differentiating the result gives back the series that were integrated, to rounding.
    """
    function = highest
    for start in starts:
        series = function.integral().coefficients.copy()
        series[0] += start
        function = Piecewise(breaks=function.breaks, coefficients=series)
    return function


def smooth_series(f: Callable[[Array], Array], left: float, right: float) -> Array:
    """Chebyshev coefficients, shape (degree + 1, ...), of a smooth function on one interval.

    The degree is the first at which the last coefficients are rounding; a fit of higher degree would only add
    noise, and work for everything that is computed from the trajectory.
    """
    for degree in range(4, 130, 2):
        x = matrices.nodes(degree)
        series = matrices.coefficients_from_values(degree) @ f((left * (1 - x) + right * (1 + x)) / 2)
        if np.abs(series[-2:]).max() <= 4 * np.finfo(np.float64).eps * np.abs(series).max():
            return np.asarray(series)
    raise PumaSepticError(f"no Chebyshev series of degree 128 converges on [{left:g}, {right:g}] s")
