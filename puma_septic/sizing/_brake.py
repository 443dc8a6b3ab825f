"""A holding brake in the motor: whether it holds, what one emergency stop costs it, and how many it bears."""

from __future__ import annotations

import numpy as np

from puma_septic.drives import Drivetrain
from puma_septic.sizing._loads import JointLoad

__all__ = ["holding_torque", "stop_energy"]


def holding_torque(load: JointLoad, ratio: float) -> tuple[float, float]:
    """Largest torque that gravity, payload and wrench have at the motor in any posture of the cycle, and its instant.

    N m and s. The gears are taken as lossless, as what they lose of a load that hangs cannot be counted on.

    Returns
    -------
    tuple of float
    """
    found = load.gravity.extrema()
    return float(found.peak[0]) / ratio, float(found.t_peak[0])


def stop_energy(load: JointLoad, train: Drivetrain) -> float:
    """What the brake turns into heat when it stops the joint at the worst instant, J; infinite where it cannot.

    ``J w^2 / 2  T_b / (T_b - T_l)``: the kinetic energy of the joint alone at its largest, and the work of the load
    that goes on driving, at its largest, against the brake's torque (NORD, "Projektierung", W_B; Tsubakimoto, "Brake
    life and braking distance calculation formula").

    Returns
    -------
    float
    """
    moved = load.velocity * load.velocity
    own = train.inertia * train.ratio**2
    energy = 0.5 * float(((load.inertia * moved) + moved * own).extrema().max[0])
    brake, driving = train.motor.brake_torque, holding_torque(load, train.ratio)[0]
    if np.isnan(brake):
        return np.nan
    return energy * brake / (brake - driving) if brake > driving else np.inf
