"""How fast, how heavy: what of time and mass a motion's limits allow."""

from puma_septic.limits._duration import (
    AT_REST,
    Answer,
    FeasibleRates,
    MinimumDuration,
    assessed_at,
    feasible_rates,
    minimum_duration,
)
from puma_septic.limits._feasible import Certificate
from puma_septic.limits._payload import Load, MaximumPayload, maximum_payload
from puma_septic.limits._stretching import stretched

__all__ = [
    "AT_REST",
    "Answer",
    "Certificate",
    "FeasibleRates",
    "Load",
    "MaximumPayload",
    "MinimumDuration",
    "assessed_at",
    "feasible_rates",
    "maximum_payload",
    "minimum_duration",
    "stretched",
]
