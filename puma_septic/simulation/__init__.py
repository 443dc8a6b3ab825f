"""Simulated execution: an arm under a controller follows a trajectory, or is stopped. Samples, and labelled so."""

from puma_septic.simulation._controller import LAWS, Controller, Gains
from puma_septic.simulation._elasticity import ElasticJoints
from puma_septic.simulation._execute import Execution, execute
from puma_septic.simulation._integration import Divergence
from puma_septic.simulation._simulate import LARGEST_STEP, REST_SPEED, simulate, simulate_all
from puma_septic.simulation._simulation import METRICS, SETTLED, EnergyBalance, Metrics, Simulation
from puma_septic.simulation._stop import CATEGORIES, NOT_A_SAFETY_FUNCTION, Stop, WorstStop, stop, worst_stop
from puma_septic.simulation._stop_table import FRACTIONS, StopRow, StopTable, stop_table

__all__ = [
    "CATEGORIES",
    "FRACTIONS",
    "LARGEST_STEP",
    "LAWS",
    "METRICS",
    "NOT_A_SAFETY_FUNCTION",
    "REST_SPEED",
    "SETTLED",
    "Controller",
    "Divergence",
    "ElasticJoints",
    "EnergyBalance",
    "Execution",
    "Gains",
    "Metrics",
    "Simulation",
    "Stop",
    "StopRow",
    "StopTable",
    "WorstStop",
    "execute",
    "simulate",
    "simulate_all",
    "stop",
    "stop_table",
    "worst_stop",
]
