"""Which profiles there are, what they need and what they promise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, final

__all__ = ["ProfileInfo", "available"]


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileInfo:
    """One profile family.

    Attributes
    ----------
    name : str
        Of the function in `puma_septic.profiles`.
    continuity : str
        Class of the whole motion from rest to rest, the rest before and after included: C0 the velocity
        steps, C1 the acceleration, C2 the jerk, C3 none of them.
    inside : str
        Class between start and end.
    needs : str
        What it takes beside the points.
    at_vias : str
        "passes" them at their times, "stops" there, or "misses" them.
    overshoots : bool
        Whether it may leave the hull of the points.
    source : str
        Where it comes from.
    """

    name: str
    continuity: str
    inside: str
    needs: str
    at_vias: Literal["passes", "stops", "misses"]
    overshoots: bool
    source: str


_BM = "Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots"
_PAPER = "Raji, Asaolu and Akano, Joint Space Robot Arm Trajectory Planning Using Septic Function"
_SMOOTH = "C-infinity"

# In columns: name, continuity, inside, needs, at vias, overshoots, source.
_ROWS: tuple[tuple[str, str, str, str, Literal["passes", "stops", "misses"], bool, str], ...] = (
    ("linear", "C0", "C0", "times", "passes", False, f"{_BM}, 2.1.1"),
    ("bang_bang", "C1", "C1", "times", "stops", False, f"{_BM}, 2.1.2"),
    ("trapezoidal", "C1", "C1", "times, blend time or (2 points) cruise velocity", "misses", False,
     "Craig, Introduction to Robotics, 7.3"),
    ("cubic", "C1", "C1", "times, optionally via velocities", "stops", False, f"{_BM}, 2.1.3"),
    ("harmonic", "C1", "C1", "times", "stops", False, f"{_BM}, 2.2.1"),
    ("cubic_spline", "C1", "C2", "times", "passes", True, f"{_BM}, 4.4.1"),
    ("cubic_spline_free_knots", "C2", "C2", "times, at least 3 points", "passes", True,
     "Lin, Chang and Luh 1983"),
    ("cycloidal", "C2", "C2", "times", "stops", False, f"{_BM}, 2.2.2"),
    ("modified_trapezoidal", "C2", "C2", "times", "stops", False, f"{_BM}, 3.7"),
    ("modified_sine", "C2", "C2", "times", "stops", False, "Norton, Cam Design and Manufacturing Handbook, 3"),
    ("double_s", "C2", "C2", "limits of velocity, acceleration and jerk (no times)", "stops", False,
     f"{_BM}, 3.4"),
    ("lspb", "C2", "C2", "durations or speed limits, blend time", "misses", False,
     "Corke, Robotics Toolbox, mstraj"),
    ("polynomial_blends", "C2", "C2", "times, blend time; class by degree", "misses", False, f"{_BM}, 3.3"),
    ("poly_434", "C2", "C2", "times, exactly 4 points", "passes", True, "Fu, Gonzalez and Lee, Robotics, 4.3.1"),
    ("poly_353", "C2", "C2", "times, exactly 4 points", "passes", True, "Fu, Gonzalez and Lee, Robotics, 4.3.1"),
    ("quintic", "C2", "C2", "times, optionally via velocities and accelerations", "stops", False,
     f"{_BM}, 2.1.4"),
    ("quintic_segments", "C2", "C2", "times; the same motion as quintic", "stops", False, f"{_BM}, 2.1.4"),
    ("quintic_spline", "C2", "C4", "times", "passes", True, "Flash and Hogan 1985"),
    ("septic", "C2", _SMOOTH, "times, exactly 4 points", "passes", True, _PAPER),
    ("single_polynomial", "C2", _SMOOTH, "times, up to about 30 points", "passes", True, _PAPER),
    ("bezier", "C2", _SMOOTH, "times (only the first and last count)", "misses", False, f"{_BM}, appendix B"),
    ("classic_septic", "C3", "C3", "times, optionally via velocities, accelerations and jerks", "stops", False,
     f"{_BM}, 2.1.5"),
    ("trigonometric_spline", "C3", "C3", "times, an angle up to pi", "stops", False, "Simon and Isik 1993"),
    ("septic_spline", "C3", "C6", "times", "passes", True, "Mellinger and Kumar 2011"),
    ("bspline", "C3", "C4", "times; degree 5 (C2 with degree 3)", "passes", True, "Gasparetto and Zanotto 2007"),
    ("bspline_control", "C4", "C4", "times; degree 5 (C2 with degree 3)", "misses", False, f"{_BM}, 4.5"),
)  # fmt: skip


def available() -> tuple[ProfileInfo, ...]:
    """All profiles, from the least to the most continuous.

    Stated for default arguments; via velocities that are given make a profile pass the vias instead of
    stopping, and may make it overshoot.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> [info.name for info in profiles.available() if info.at_vias == "passes" and info.continuity == "C3"]
    ['septic_spline', 'bspline']
    """
    names = ("name", "continuity", "inside", "needs", "at_vias", "overshoots", "source")
    return tuple(ProfileInfo(**dict(zip(names, row, strict=True))) for row in _ROWS)  # type: ignore[arg-type]
