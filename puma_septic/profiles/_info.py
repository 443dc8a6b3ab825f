"""What is said of a profile; it stands beside the profile's function."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, final

__all__ = ["BIAGIOTTI", "PAPER", "SMOOTH", "ProfileInfo"]

BIAGIOTTI = "Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots"
PAPER = "Raji, Asaolu and Akano, Joint Space Robot Arm Trajectory Planning Using Septic Function"
SMOOTH = "C-infinity"


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
