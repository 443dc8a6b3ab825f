"""Whether the motions of a cycle stay where the joints can be: no choice of drives mends that."""

from __future__ import annotations

from puma_septic.assessment import assess
from puma_septic.cycle import Cycle
from puma_septic.motion import Motion

__all__ = ["position_remarks"]


def position_remarks(cycle: Cycle) -> tuple[str, ...]:
    """One remark that names the joints whose position limits a motion of the cycle violates; empty where none does."""
    motions = [step for step in cycle.steps if isinstance(step, Motion)]
    beyond = {check.joint for motion in motions for check in assess(motion).violations if check.quantity == "position"}
    if not beyond:
        return ()
    names = ", ".join(name for name in cycle.joint_names if name in beyond)
    return (f"whatever the drives, the motion itself violates the position limits of {names}",)
