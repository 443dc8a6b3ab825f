"""The paper's task, tables and claims, reproduced and judged.

Raji, Asaolu and Akano, Joint Space Robot Arm Trajectory Planning Using Septic Function.
"""

from puma_septic.paper._claim import VERDICTS, Claim
from puma_septic.paper._evidence import ComputingTimes, Evidence, LeastDuration
from puma_septic.paper._inputs import PAPER, POINTS, PaperInputs
from puma_septic.paper._report import PaperReport, reproduce

__all__ = [
    "PAPER",
    "POINTS",
    "VERDICTS",
    "Claim",
    "ComputingTimes",
    "Evidence",
    "LeastDuration",
    "PaperInputs",
    "PaperReport",
    "reproduce",
]
