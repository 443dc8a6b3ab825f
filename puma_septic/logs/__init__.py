"""Motions made elsewhere: samples and files of them become trajectories, with what they leave unknown."""

from puma_septic.logs._file import JointLog, read_csv_trajectory, read_log
from puma_septic.logs._fit import FitResidual, LogFit, fit_log, fit_residual, fit_samples, fit_trajectory
from puma_septic.logs._rests import stops
from puma_septic.logs._spread import unresolved

__all__ = [
    "FitResidual", "JointLog", "LogFit", "fit_log", "fit_residual", "fit_samples", "fit_trajectory",
    "read_csv_trajectory", "read_log", "stops", "unresolved",
]  # fmt: skip
