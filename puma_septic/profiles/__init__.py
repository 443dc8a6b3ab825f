"""Trajectory families, one file each; every profile is a function that returns a Trajectory."""

from puma_septic.profiles.bernstein import bezier
from puma_septic.profiles.blends import polynomial_blends, trapezoidal
from puma_septic.profiles.bsplines import bspline, bspline_control
from puma_septic.profiles.catalogue import ProfileInfo, available
from puma_septic.profiles.fifth_degree import quintic_segments
from puma_septic.profiles.hermite import classic_septic, cubic, quintic
from puma_septic.profiles.high_degree import single_polynomial
from puma_septic.profiles.mixed_degrees import poly_353, poly_434
from puma_septic.profiles.mstraj import lspb
from puma_septic.profiles.normalised import NormalisedRow, normalised_table
from puma_septic.profiles.rest_to_rest import (
    bang_bang,
    cycloidal,
    harmonic,
    modified_sine,
    modified_trapezoidal,
)
from puma_septic.profiles.seven_phase import double_s
from puma_septic.profiles.seventh_degree import septic
from puma_septic.profiles.splines import (
    cubic_spline,
    cubic_spline_free_knots,
    quintic_spline,
    septic_spline,
)
from puma_septic.profiles.straight import linear
from puma_septic.profiles.trigonometric import trigonometric_spline

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
