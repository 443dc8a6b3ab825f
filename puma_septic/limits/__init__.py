"""How fast, how heavy: what of time and mass a motion's limits allow."""

from puma_septic.limits._diagram import PayloadPolygon, payload_diagram, payload_polygon
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
from puma_septic.limits._motion_limits import MotionLimits, motion_limits, payload_over_duration
from puma_septic.limits._payload import Load, MaximumPayload, maximum_payload
from puma_septic.limits._stretching import stretched
from puma_septic.limits._sweeps import (
    LoadedTorque,
    Sweep,
    duration_sweep,
    payload_and_duration,
    payload_duration_map,
    payload_sweep,
)
from puma_septic.limits._uncertainty import TorqueUncertainty, torque_uncertainty
from puma_septic.limits._within_limits import within_limits

__all__ = [
    "AT_REST",
    "Answer",
    "Certificate",
    "FeasibleRates",
    "Load",
    "LoadedTorque",
    "MaximumPayload",
    "MinimumDuration",
    "MotionLimits",
    "PayloadPolygon",
    "Sweep",
    "TorqueUncertainty",
    "assessed_at",
    "duration_sweep",
    "feasible_rates",
    "maximum_payload",
    "minimum_duration",
    "motion_limits",
    "payload_and_duration",
    "payload_diagram",
    "payload_duration_map",
    "payload_over_duration",
    "payload_polygon",
    "payload_sweep",
    "stretched",
    "torque_uncertainty",
    "within_limits",
]
