"""Trajectory families, one file each; every profile is a function that returns a Trajectory.

A new one is a module of this room, with its `ProfileInfo` beside its function, and a line in `_REGISTRY`.
"""

from puma_septic.profiles._bezier import BEZIER, bezier
from puma_septic.profiles._blends import POLYNOMIAL_BLENDS, TRAPEZOIDAL, polynomial_blends, trapezoidal
from puma_septic.profiles._bspline import BSPLINE, BSPLINE_CONTROL, bspline, bspline_control
from puma_septic.profiles._double_s import DOUBLE_S, double_s
from puma_septic.profiles._hermite import CLASSIC_SEPTIC, CUBIC, classic_septic, cubic
from puma_septic.profiles._info import ProfileInfo
from puma_septic.profiles._linear import LINEAR, linear
from puma_septic.profiles._mstraj import LSPB, lspb, mstraj
from puma_septic.profiles._normalised import NormalisedRow, normalised_table
from puma_septic.profiles._poly_434_353 import POLY_353, POLY_434, poly_353, poly_434
from puma_septic.profiles._quintic import QUINTIC, QUINTIC_SEGMENTS, quintic, quintic_segments
from puma_septic.profiles._registry import Family, Registry
from puma_septic.profiles._rest_to_rest import (
    BANG_BANG,
    CYCLOIDAL,
    HARMONIC,
    MODIFIED_SINE,
    MODIFIED_TRAPEZOIDAL,
    bang_bang,
    cycloidal,
    harmonic,
    modified_sine,
    modified_trapezoidal,
)
from puma_septic.profiles._single_polynomial import SEPTIC, SINGLE_POLYNOMIAL, septic, single_polynomial
from puma_septic.profiles._splines import (
    CUBIC_SPLINE,
    CUBIC_SPLINE_FREE_KNOTS,
    QUINTIC_SPLINE,
    SEPTIC_SPLINE,
    cubic_spline,
    cubic_spline_free_knots,
    quintic_spline,
    septic_spline,
)
from puma_septic.profiles._trigonometric import TRIGONOMETRIC_SPLINE, trigonometric_spline
from puma_septic.profiles._vias import Vias

__all__ = [
    "Family",
    "NormalisedRow",
    "ProfileInfo",
    "Vias",
    "available",
    "bang_bang",
    "bezier",
    "bspline",
    "bspline_control",
    "classic_septic",
    "cubic",
    "cubic_spline",
    "cubic_spline_free_knots",
    "cycloidal",
    "double_s",
    "family",
    "harmonic",
    "linear",
    "lspb",
    "make",
    "modified_sine",
    "modified_trapezoidal",
    "mstraj",
    "names",
    "normalised_table",
    "poly_353",
    "poly_434",
    "polynomial_blends",
    "quintic",
    "quintic_segments",
    "quintic_spline",
    "septic",
    "septic_spline",
    "single_polynomial",
    "trapezoidal",
    "trigonometric_spline",
]

# From the least to the most continuous.
_REGISTRY = Registry(
    families=(
        Family(info=LINEAR, function=linear),
        Family(info=BANG_BANG, function=bang_bang),
        Family(info=TRAPEZOIDAL, function=trapezoidal),
        Family(info=CUBIC, function=cubic),
        Family(info=HARMONIC, function=harmonic),
        Family(info=CUBIC_SPLINE, function=cubic_spline),
        Family(info=CUBIC_SPLINE_FREE_KNOTS, function=cubic_spline_free_knots),
        Family(info=CYCLOIDAL, function=cycloidal),
        Family(info=MODIFIED_TRAPEZOIDAL, function=modified_trapezoidal),
        Family(info=MODIFIED_SINE, function=modified_sine),
        Family(info=DOUBLE_S, function=double_s),
        Family(info=LSPB, function=lspb),
        Family(info=POLYNOMIAL_BLENDS, function=polynomial_blends),
        Family(info=POLY_434, function=poly_434),
        Family(info=POLY_353, function=poly_353),
        Family(info=QUINTIC, function=quintic),
        Family(info=QUINTIC_SEGMENTS, function=quintic_segments),
        Family(info=QUINTIC_SPLINE, function=quintic_spline),
        Family(info=SEPTIC, function=septic),
        Family(info=SINGLE_POLYNOMIAL, function=single_polynomial),
        Family(info=BEZIER, function=bezier),
        Family(info=CLASSIC_SEPTIC, function=classic_septic),
        Family(info=TRIGONOMETRIC_SPLINE, function=trigonometric_spline),
        Family(info=SEPTIC_SPLINE, function=septic_spline),
        Family(info=BSPLINE, function=bspline),
        Family(info=BSPLINE_CONTROL, function=bspline_control),
    ),
    aliases={"mstraj": "lspb"},
)
available, family, make, names = _REGISTRY.available, _REGISTRY.family, _REGISTRY.make, _REGISTRY.names
