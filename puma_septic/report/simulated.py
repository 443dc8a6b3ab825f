"""Samples of a simulation as CSV; apart from `csv`, as simulations load SciPy."""

from __future__ import annotations

import numpy as np

from puma_septic.document import csv_text
from puma_septic.quantities import QUANTITIES
from puma_septic.simulation import Simulation

__all__ = ["simulation_csv"]


def simulation_csv(simulation: Simulation) -> str:
    """Planned and simulated position, velocity and torque of every joint at the samples of a simulation."""
    robot, planned = simulation.robot, simulation.planned
    columns = {
        "planned position": (planned.q, "position"),
        "position": (simulation.q, "position"),
        "velocity": (simulation.v, "velocity"),
        "torque": (simulation.torque, "effort"),
    }
    headers = [
        f"{label} {name} [{QUANTITIES[quantity].unit(slides)}]"
        for label, (_, quantity) in columns.items()
        for name, slides in zip(robot.joint_names, robot.is_prismatic, strict=True)
    ]
    table = np.column_stack([simulation.t, *(values for values, _ in columns.values()), simulation.tool_error])
    return csv_text(
        [["t [s]", *headers, "tool error [m]"], *([f"{value:.9g}" for value in row] for row in table.tolist())]
    )
