"""All profiles on one task, side by side."""

from puma_septic.comparison._compare import compare
from puma_septic.comparison._comparison import ComparedProfile, Comparison

__all__ = ["ComparedProfile", "Comparison", "compare"]
