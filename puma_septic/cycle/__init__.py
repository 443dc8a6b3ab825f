"""Duty cycles: motions and dwells in sequence, with what is picked and placed between them."""

from puma_septic.cycle._assessed import CycleAssessment, assess_cycle
from puma_septic.cycle._cycle import Cycle, way_back, with_return
from puma_septic.cycle._steps import Dwell

__all__ = ["Cycle", "CycleAssessment", "Dwell", "assess_cycle", "way_back", "with_return"]
