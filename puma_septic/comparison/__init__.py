"""All profiles on one task, side by side."""

from puma_septic.comparison.comparing import compare
from puma_septic.comparison.result import ComparedProfile, Comparison

__all__ = ["ComparedProfile", "Comparison", "compare"]
