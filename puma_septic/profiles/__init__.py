"""Trajectory families, one file each; every profile is a function that returns a Trajectory."""

from puma_septic.profiles.mstraj import lspb
from puma_septic.profiles.quintic import quintic_segments
from puma_septic.profiles.septic import septic

__all__ = ["lspb", "quintic_segments", "septic"]
