"""A motion held against its limits."""

from puma_septic.assessment.result import Assessment, assess
from puma_septic.assessment.tool import SingularityReport, ToolMetrics
from puma_septic.limit_check import LimitCheck

__all__ = ["Assessment", "LimitCheck", "SingularityReport", "ToolMetrics", "assess"]
