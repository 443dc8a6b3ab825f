"""What a reader of an assessment must know to read its numbers right, a sentence each."""

from __future__ import annotations

from typing import Final

import numpy as np

from puma_septic.assessment._joints import coulomb_steps
from puma_septic.assessment._tool import LowestPoint
from puma_septic.motion import Motion
from puma_septic.quantities import QUANTITIES
from puma_septic.validation import Array

__all__ = ["below_base_remarks", "friction_step_remarks", "rest_remarks"]

# A torque below this part of the arm's largest is rounding, and is told as 0.
_NO_TORQUE: Final = 1e-12
# m; what is no lower than this stands on its base, to rounding.
_BELOW_BASE: Final = -1e-9


def below_base_remarks(lowest: LowestPoint) -> tuple[str, ...]:
    """That an arm hangs below where it stands."""
    if lowest.height >= _BELOW_BASE:
        return ()
    below = f"{-lowest.height:.3g} m below the base, at {lowest.time:z.3f} s"
    return (f"the arm hangs low: {lowest.part} comes {below}; a floor would forbid it",)


def rest_remarks(motion: Motion, peak_torque: Array, held: tuple[Array, Array] | None) -> tuple[str, ...]:
    """Joints that rest for a while, where static friction may carry any torque within its band.

    `held` is what a dwell takes, without and with the help of static friction; None without a dwell.
    """
    resting = np.asarray(motion.still.any(axis=0) | (held is not None))
    bands = [
        f"{name} [{law.band[1]:.3g}, {law.band[0]:.3g}]"
        for name, rests, law in zip(motion.robot.joint_names, resting, motion.robot.friction, strict=True)
        if rests and law.band.any()
    ]
    if not bands:
        return ()
    remark = (
        f"at rest, static friction may carry any torque within its band ({_unit(motion)}), taken as 0 here: "
        + ", ".join(bands)
    )
    return (remark,) if held is None else (remark, _dwell_remark(motion, peak_torque, held))


def _unit(motion: Motion) -> str:
    """Of a torque, as the tables beside it have it."""
    return "N m or N" if motion.robot.is_prismatic.any() else "N m"


def _dwell_remark(motion: Motion, peak_torque: Array, held: tuple[Array, Array]) -> str:
    sizes = np.abs([held[0], peak_torque])
    rounding = _NO_TORQUE * sizes[np.isfinite(sizes)].max(initial=0.0)
    torques = [np.where(np.abs(torque) > rounding, torque, 0.0) for torque in held]
    both = zip(motion.robot.joint_names, motion.robot.knows_torque, *torques, strict=True)
    return (
        "holding torque of the dwell without static friction, which counts here, and with all its help"
        f" ({_unit(motion)}): "
        + ", ".join(f"{name} {alone:.4g} ({helped:.4g})" for name, known, alone, helped in both if known)
    )


def friction_step_remarks(motion: Motion) -> tuple[str, ...]:
    """What a limited derivative of the torque leaves out."""
    rows = (QUANTITIES[name] for name in motion.robot.limits.quantities)
    known = [row.label for row in rows if row.is_torque_derivative]
    steps = coulomb_steps(motion) if known else np.zeros(0)
    if not steps.any():
        return ()
    joints = [f"{name} {size:.3g}" for name, size in zip(motion.robot.joint_names, steps, strict=True) if size]
    return (
        f"the {' and the '.join(known)} is that of the torque without Coulomb friction, which steps where a joint"
        f" starts, stops or reverses, by up to ({_unit(motion)}): {', '.join(joints)}",
    )
