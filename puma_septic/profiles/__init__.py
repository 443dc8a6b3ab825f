"""Trajectory families, one file each; every profile is a function that returns a Trajectory."""

from puma_septic.profiles._bezier import bezier
from puma_septic.profiles._blends import polynomial_blends, trapezoidal
from puma_septic.profiles._bspline import bspline, bspline_control
from puma_septic.profiles._double_s import double_s
from puma_septic.profiles._hermite import classic_septic, cubic
from puma_septic.profiles._linear import linear
from puma_septic.profiles._mstraj import lspb
from puma_septic.profiles._normalised import NormalisedRow, normalised_table
from puma_septic.profiles._poly_434_353 import poly_353, poly_434
from puma_septic.profiles._quintic import quintic, quintic_segments
from puma_septic.profiles._registry import ProfileInfo, available
from puma_septic.profiles._rest_to_rest import (
    bang_bang,
    cycloidal,
    harmonic,
    modified_sine,
    modified_trapezoidal,
)
from puma_septic.profiles._septic import septic
from puma_septic.profiles._single_polynomial import single_polynomial
from puma_septic.profiles._splines import (
    cubic_spline,
    cubic_spline_free_knots,
    quintic_spline,
    septic_spline,
)
from puma_septic.profiles._trigonometric import trigonometric_spline

__all__ = [
    "NormalisedRow",
    "ProfileInfo",
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
    "harmonic",
    "linear",
    "lspb",
    "modified_sine",
    "modified_trapezoidal",
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
