"""Simulated execution: an arm under a controller follows a trajectory, or is stopped. Samples, and labelled so."""

from puma_septic.simulation._controller import LAWS, Controller, Gains
from puma_septic.simulation._elasticity import ElasticJoints
from puma_septic.simulation._integration import Divergence
from puma_septic.simulation._metrics import METRICS, SETTLED, Metrics
from puma_septic.simulation._simulate import LARGEST_STEP, REST_SPEED, simulate, simulate_all
from puma_septic.simulation._simulation import EnergyBalance, Simulation

__all__ = [
    "LARGEST_STEP",
    "LAWS",
    "METRICS",
    "REST_SPEED",
    "SETTLED",
    "Controller",
    "Divergence",
    "ElasticJoints",
    "EnergyBalance",
    "Gains",
    "Metrics",
    "Simulation",
    "simulate",
    "simulate_all",
]
