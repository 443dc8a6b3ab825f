"""Claims 1 to 4: the points, the posture, the limits."""

from __future__ import annotations

from typing import Final

import numpy as np

from puma_septic.kinematics import rtb_names
from puma_septic.paper._claim import Claim, Verdict, verdict_of
from puma_septic.paper._evidence import Evidence
from puma_septic.paper._inputs import POINTS

__all__ = ["claim_1", "claim_2", "claim_3", "claim_4"]

# Table 1 has four decimals: 5e-5 rad in each of three joints, at up to 0.9 m from the axis.
_TABLE_ROUNDING: Final = 1.5e-4


def claim_1(e: Evidence) -> Claim:
    """The unload point."""
    off = np.linalg.norm(e.tool_points - e.inputs.text_points, axis=1)
    agrees = off <= _TABLE_ROUNDING
    z_text, z_table = e.inputs.text_points[2, 2], e.tool_points[2, 2]
    others = float(np.delete(off, 2).max())
    return Claim(
        number=1,
        text=f"The unload point is at z = {z_text:g} m",
        source="section 4.1",
        measured={"z_text_m": float(z_text), "z_table_1_m": float(z_table), "distance_m": off.tolist()},
        verdict=verdict_of(bool(agrees[2])),
        explanation=f"Table 1 puts the wrist centre at z = {z_table:+.4f} m there, {off[2]:.2g} m from the text's"
        f" point; at the other points it is at most {others:.1g} m off.",
    )


def claim_2(e: Evidence) -> Claim:
    """The posture."""
    said, found = (name.split("-") for name in (e.inputs.configuration, e.branch))
    same = [a == b for a, b in zip(said, found, strict=True)]
    q1 = e.inputs.table_1[0, 0]
    miss = float(np.abs(e.table_1 - e.inputs.table_1).max())
    python, matlab = rtb_names(e.branch)
    wrong = (
        ", ".join(
            f"the {part} is {is_}, not {was}"
            for part, is_, was, ok in zip(("arm", "elbow", "wrist"), found, said, same, strict=True)
            if not ok
        )
        or "all three words are right"
    )
    return Claim(
        number=2,
        text=f"The posture is {said[0]} arm, elbow {said[1]}, wrist {said[2]}",
        source="section 4.1",
        measured={"branch": e.branch, "table_1_error_rad": miss, "q1_rad": float(q1)},
        verdict=verdict_of(*same),
        explanation=f"Table 1 (q1 = {q1:g} rad) is the branch {e.branch!r}, to {miss:.1g} rad: {wrong}. The"
        f" Robotics Toolbox calls it {matlab!r} in MATLAB and {python!r} in Python.",
    )


def claim_3(e: Evidence) -> Claim:
    """The robot's own joint limits."""
    limits, q = e.robot.limits.position, e.inputs.table_1
    beyond = np.maximum(limits[:, 0] - q, q - limits[:, 1])
    # An unknown limit is NaN, and not violated.
    beyond_limits = [(int(i), int(j)) for i, j in np.argwhere(beyond > 0)]
    worst = {j: max((i for i, k in beyond_limits if k == j), key=lambda i: beyond[i, j]) for _, j in beyond_limits}
    sentences = [
        f"{e.robot.joint_names[j]} = {np.degrees(q[i, j]):.2f} deg at {POINTS[i]} (range"
        f" {np.degrees(limits[j, 0]):.0f} to {np.degrees(limits[j, 1]):.0f} deg)"
        for j, i in sorted(worst.items())
    ]
    free = ", ".join(f"{n} at {point}" for point, n in zip(POINTS, e.branches_within_limits, strict=True))
    table = (
        f"Table 1 violates the arm's limits: {'; '.join(sentences)}"
        if beyond_limits
        else "Table 1 is within the arm's limits"
    )
    return Claim(
        number=3,
        text="A real PUMA 560 can make this move",
        source="sections 3.3 and 4.1",
        measured={
            "beyond_limit_rad": {e.robot.joint_names[j]: float(beyond[i, j]) for j, i in sorted(worst.items())},
            "branches_within_limits": list(e.branches_within_limits),
        },
        verdict=verdict_of(not beyond_limits),
        explanation=f"{table}. Of the eight branches, within the limits are {free}.",
    )


def claim_4(e: Evidence) -> Claim:
    """The constraints that are said to be kept."""
    velocity, acceleration = float(e.septic.peak_velocity.max()), float(e.septic.peak_acceleration.max())
    stated = {
        "velocity": (e.inputs.velocity_limit, velocity, "rad/s"),
        "acceleration": (e.inputs.acceleration_limit, acceleration, "rad/s^2"),
    }
    kept = [demand <= limit for limit, demand, _ in stated.values() if limit is not None]
    verdict: Verdict = verdict_of(*kept) if kept else "not stated"
    words = [
        f"no {name} limit is stated" if limit is None else f"{name} {demand:.4g} of {limit:g} {unit}"
        for name, (limit, demand, unit) in stated.items()
    ]
    used = {c.joint: c.utilisation for c in e.septic.checks if c.quantity == "velocity"}
    highest = max(used, key=lambda joint: used[joint], default="")
    arm = f" Of the arm's own speed limits it uses {100 * used[highest]:.0f} % ({highest})." if used else ""
    return Claim(
        number=4,
        text="The specified velocity and acceleration constraints are not violated",
        source="section 3.1",
        measured={
            "peak_velocity_rad_s": velocity,
            "peak_acceleration_rad_s2": acceleration,
            "arm_velocity_utilisation": used.get(highest, np.nan),
        },
        verdict=verdict,
        explanation=f"In the paper, {' and '.join(words)}. The septic reaches {velocity:.4g} rad/s and"
        f" {acceleration:.4g} rad/s^2.{arm}",
    )
