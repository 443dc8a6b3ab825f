"""Vector functions of time that are smooth between breakpoints, held as Chebyshev series per interval."""

from puma_septic.piecewise._piecewise import Piecewise
from puma_septic.piecewise._results import Extrema, Jumps
from puma_septic.piecewise._sampling import sampled

__all__ = ["Extrema", "Jumps", "Piecewise", "sampled"]
