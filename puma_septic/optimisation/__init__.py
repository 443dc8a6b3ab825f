"""Via times and free via values chosen well: for one objective, for several, for the least time."""

from puma_septic.optimisation._constraints import Verdict
from puma_septic.optimisation._front import ParetoFront, pareto_front
from puma_septic.optimisation._least_time import LeastTime, least_time
from puma_septic.optimisation._via_times import OptimisedTimes, optimise_via_times

__all__ = [
    "LeastTime",
    "OptimisedTimes",
    "ParetoFront",
    "Verdict",
    "least_time",
    "optimise_via_times",
    "pareto_front",
]
