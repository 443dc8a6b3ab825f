"""Vibration that a motion leaves behind, without a simulation: spectra, durations, shapers, natural frequencies."""

from puma_septic.vibration._durations import nulling_durations
from puma_septic.vibration._frequencies import natural_frequencies, stiffness_for
from puma_septic.vibration._shapers import SHAPERS, Shaper, input_shaper, shaped
from puma_septic.vibration._spectrum import residual_vibration

__all__ = [
    "SHAPERS",
    "Shaper",
    "input_shaper",
    "natural_frequencies",
    "nulling_durations",
    "residual_vibration",
    "shaped",
    "stiffness_for",
]
