"""Many motions at once: the assessment of each, without a Python loop over them."""

from puma_septic.batch._many import ManyAssessments, assess_many, torque_spans
from puma_septic.batch._verdicts import ManyVerdicts, judge_many

__all__ = ["ManyAssessments", "ManyVerdicts", "assess_many", "judge_many", "torque_spans"]
