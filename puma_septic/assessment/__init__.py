"""A motion checked against its limits."""

from puma_septic.assessment._assessment import Assessment, assess
from puma_septic.assessment._joints import impulses
from puma_septic.assessment._limits import limit_checks, unknown_values
from puma_septic.assessment._tool import LowestPoint, SingularityReport, ToolMetrics, height_series, lowest_point
from puma_septic.limit_check import LimitCheck

__all__ = [
    "Assessment",
    "LimitCheck",
    "LowestPoint",
    "SingularityReport",
    "ToolMetrics",
    "assess",
    "height_series",
    "impulses",
    "limit_checks",
    "lowest_point",
    "unknown_values",
]
