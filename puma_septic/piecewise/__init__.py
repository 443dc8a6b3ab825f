"""Vector functions of time that are smooth between breakpoints, held as Chebyshev series per interval."""

from puma_septic.piecewise.function import Extrema, Jumps, Piecewise

__all__ = ["Extrema", "Jumps", "Piecewise"]
