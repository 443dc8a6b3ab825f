"""Studies: a task varied along axes, every case a row of a table."""

from puma_septic.study._definition import COLUMNS, Study, load_study, make_study
from puma_septic.study._running import LARGE, StudyRun, run_study
from puma_septic.study._summary import StudyMap, StudySummary, study_map, summarise_study

__all__ = [
    "COLUMNS",
    "LARGE",
    "Study",
    "StudyMap",
    "StudyRun",
    "StudySummary",
    "load_study",
    "make_study",
    "run_study",
    "study_map",
    "summarise_study",
]
