"""A robot's data examined: what is impossible, doubtful or missing, and which answers rest on it."""

from puma_septic.doctor._examination import Examination, doubts, examine
from puma_septic.doctor._finding import ANSWERS, CODES, Finding

__all__ = ["ANSWERS", "CODES", "Examination", "Finding", "doubts", "examine"]
