"""Vector functions of time that are smooth between breakpoints, held as Chebyshev series per interval."""

from puma_septic.piecewise._piecewise import Piecewise
from puma_septic.piecewise._results import Extrema, Jumps
from puma_septic.piecewise._sampling import sampled
from puma_septic.piecewise._search import sign_changes

__all__ = ["Extrema", "Jumps", "Piecewise", "sampled", "sign_changes"]
