"""A motion held against its limits."""

from puma_septic.assessment.checks import LimitCheck
from puma_septic.assessment.result import Assessment, assess
from puma_septic.assessment.tool import SingularityReport, ToolMetrics

__all__ = ["Assessment", "LimitCheck", "SingularityReport", "ToolMetrics", "assess"]
