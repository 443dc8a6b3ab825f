"""What is handed out: documents, CSV tables, figures, and folders of them."""

from puma_septic.document import to_json
from puma_septic.outputs import new_folder
from puma_septic.report._documents import assess_document, numbered, profile_labels, reserve_document, unmet_document
from puma_septic.report.csv import metrics_csv, named_metrics_csv, samples_csv

__all__ = [
    "assess_document",
    "metrics_csv",
    "named_metrics_csv",
    "new_folder",
    "numbered",
    "profile_labels",
    "reserve_document",
    "samples_csv",
    "to_json",
    "unmet_document",
]
