"""Uncontrolled stops (category 0): power off, and brakes that grip after a reaction time.

Brakes and dry friction are forces of a set: their full torque against the motion, or whatever holds a joint still.
The time-stepping scheme of Moreau takes them so, without regularisation: over a step h,
``M (v+ - v) + h bias + h viscous v+ + p = 0`` with impulses ``p`` within ``h (brake + Coulomb)``, at their bound where
the joint slides; solved by projected Gauss-Seidel iterations (Moreau, "Unilateral contact and dry friction in finite
freedom dynamics", CISM 302, 1988). A joint sticks exactly; the order of the step is 1.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from puma_septic.dynamics import mass_matrix, rigid_torque
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["BRAKE_STEP", "Braking", "brake"]

BRAKE_STEP: Final = 5e-4
"""Step of a braked stop, s."""

# An arm that moves longer than this is not held by its brakes.
_LONGEST: Final = 5.0
_SWEEPS: Final = 200
# Changes of velocity below this part of the largest are solved.
_SOLVED: Final = 1e-10


class Braking(NamedTuple):
    """Samples of several rows, (n,), (n, n_rows, n_joints); durations (n_rows,), infinite where brakes do not hold."""

    t: Array
    q: Array
    v: Array
    durations: Array


def brake(robot: Robot, q: Array, v: Array, torque: Array, reaction_time: float) -> Braking:
    """Let rows of arms, at q and v (n_rows, n_joints), come to rest under brakes of a torque (n_joints,)."""
    h = BRAKE_STEP
    shape = (len(q), robot.n_joints)
    samples_q, samples_v, times = [q], [v], [0.0]
    durations = np.full(len(q), np.inf)
    impulse = np.zeros(shape)
    fastest = float(np.abs(v).max(initial=0.0))
    for k in range(1, round(_LONGEST / h) + 1):
        gripping = torque * ((k - 1) * h >= reaction_time * (1 - 1e-12))
        new, impulse = _step(robot, q, v, h, gripping, impulse)
        q, v = q + h / 2 * (v + new), new
        fastest = max(fastest, float(np.abs(v).max()))
        samples_q.append(q)
        samples_v.append(v)
        times.append(k * h)
        # Once at rest under gripping brakes an arm stays so.
        resting = (np.abs(v).max(axis=1) <= 1e-9 * max(fastest, 1e-9)) & bool((gripping == torque).all())
        durations = np.where(resting & np.isinf(durations), k * h, durations)
        if resting.all():
            break
    return Braking(np.array(times), np.array(samples_q), np.array(samples_v), durations)


def _step(robot: Robot, q: Array, v: Array, h: float, torque: Array, impulse: Array) -> tuple[Array, Array]:
    """Velocities after a step, and the impulses of brakes and dry friction in it."""
    inertia = mass_matrix(robot, q)
    bias = rigid_torque(robot, q, v, np.zeros_like(q))
    mobility = np.linalg.inv(inertia + h * np.diag(robot.viscous_friction))
    free = np.einsum("rij,rj->ri", mobility, np.einsum("rij,rj->ri", inertia, v) - h * bias)
    high, low = h * (torque + robot.coulomb_friction[:, 0]), h * (-torque + robot.coulomb_friction[:, 1])
    impulse = np.clip(impulse, low, high)
    new = free - np.einsum("rij,rj->ri", mobility, impulse)
    scale = max(float(np.abs(free).max()), 1e-12)
    for _ in range(_SWEEPS):
        change = 0.0
        for j in range(q.shape[1]):
            own = mobility[:, j, j]
            wanted = np.clip(impulse[:, j] + new[:, j] / own, low[j], high[j])
            step = wanted - impulse[:, j]
            impulse[:, j] = wanted
            new = new - mobility[:, :, j] * step[:, None]
            change = max(change, float(np.abs(step * own).max()))
        if change <= _SOLVED * scale:
            break
    # A joint whose impulse is inside its bounds is held, to the rounding of the solver.
    held = (impulse > low) & (impulse < high) & (np.abs(new) <= 10 * _SOLVED * scale)
    return np.where(held, 0.0, new), impulse
