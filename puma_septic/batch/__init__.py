"""Many motions at once: the assessment of each, without a Python loop over them."""

from puma_septic.batch._many import ManyAssessments, assess_many

__all__ = ["ManyAssessments", "assess_many"]
