"""Duty cycles: motions and dwells in sequence, with what is picked and placed between them."""

from puma_septic.cycle._cycle import Cycle, with_return
from puma_septic.cycle._steps import Dwell

__all__ = ["Cycle", "Dwell", "with_return"]
