"""Vector functions of time that are smooth between breakpoints, held as Chebyshev series per interval."""

from puma_septic.piecewise.function import Piecewise
from puma_septic.piecewise.results import Extrema, Jumps
from puma_septic.piecewise.sampling import sampled

__all__ = ["Extrema", "Jumps", "Piecewise", "sampled"]
