"""The time-optimal motion along the same path, as a yardstick."""

from puma_septic.optimum._time_optimal import TimeOptimal, time_optimal

__all__ = ["TimeOptimal", "time_optimal"]
