"""Claims 1 to 8: points, posture and limits; jerk, overshoot, end velocity, continuity."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from puma_septic.kinematics import rtb_names
from puma_septic.paper._claim import Claim, Verdict, times_text, verdict_of
from puma_septic.paper._evidence import Evidence
from puma_septic.paper._inputs import POINTS
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = []

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
        explanation=f"Table 1 puts the wrist centre at z = {z_table:+z.4f} m there, {off[2]:.2g} m from the text's"
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
        f"{e.robot.joint_names[j]} = {np.degrees(q[i, j]):z.2f} deg at {POINTS[i]} (range"
        f" {np.degrees(limits[j, 0]):z.0f} to {np.degrees(limits[j, 1]):z.0f} deg)"
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
        explanation=f"{table}. {_turned(e, q, worst)}Of the eight branches, within the limits are {free}.",
    )


def _turned(e: Evidence, q: Array, worst: Mapping[int, int]) -> str:
    """Joints that the paper prints a whole turn away from where the same posture is nearer to their range."""
    limits, said = e.robot.limits.position, []
    for j, i in sorted(worst.items()):
        other = q[i, j] - np.copysign(2 * np.pi, q[i, j])
        given, turned = (max(limits[j, 0] - angle, angle - limits[j, 1]) for angle in (q[i, j], other))
        if turned < given:
            where = f"{np.degrees(turned):z.0f} deg beyond" if turned > 0 else "within"
            said.append(
                f"{e.robot.joint_names[j]} is printed a whole turn off: {np.degrees(other):z.2f} deg is the same"
                f" posture, {where} its range, and is what `assess paper` takes. "
            )
    return "".join(said)


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
    arm = f" Of the arm's own speed limits it uses {100 * used[highest]:z.0f} % ({highest})." if used else ""
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


# Two integrals that agree this well are one.
_SAME: Final = 1e-9


def claim_5(e: Evidence) -> Claim:
    """The septic's jerk."""
    septic = e.septic.motion.trajectory
    jumps = septic.jumps(3)
    inside = int(((jumps.times > septic.breaks[0]) & (jumps.times < septic.breaks[-1])).sum())
    from_rest = len(jumps.times) == inside
    start, end = septic(septic.breaks[[0, -1]], 3)
    peak, other_peak = (one.peak(3)[0] for one in (septic, e.spline))
    square, other = (_jerk_squared(one) for one in (septic, e.spline))
    gentler = [_name(e, j) for j in np.flatnonzero(other_peak < peak * (1 - _SAME)).tolist()]
    largest = int(np.maximum(np.abs(start), np.abs(end)).argmax())
    ends = "; ".join(f"{_name(e, j)} {start[j]:z.3f} and {end[j]:z.3f}" for j in sorted({0, largest}))
    return Claim(
        number=5,
        text="The septic's jerk is continuous and kept to a minimum",
        source="abstract, sections 4.3 and 5",
        measured={
            "jerk_steps_inside": inside,
            "jerk_at_start_rad_s3": start.tolist(),
            "jerk_at_end_rad_s3": end.tolist(),
            "peak_jerk_rad_s3": peak.tolist(),
            "peak_jerk_quintic_spline_rad_s3": other_peak.tolist(),
            "jerk_squared_integral_rad2_s5": square.tolist(),
            "jerk_squared_integral_quintic_spline_rad2_s5": other.tolist(),
        },
        verdict=verdict_of(not inside, from_rest, not gentler, bool((square <= other * (1 + _SAME)).all())),
        explanation=f"Inside it is {'not ' if inside else ''}continuous; where the arm starts and stops it"
        f" {'is so too' if from_rest else f'steps (rad/s^3 at start and end: {ends})'}. A quintic spline through"
        f" the same points at the same times has a lower peak jerk on {', '.join(gentler) or 'no joint'}, and an"
        f" integral of jerk^2 of {other.sum():.4g} against {square.sum():.4g} rad^2/s^5 over all joints.",
    )


def claim_6(e: Evidence) -> Claim:
    """Overshoot of joint 1."""
    trajectories = e.trajectories[:2]
    septic, lspb = (one.extrema(0) for one in trajectories)
    past_septic, past_lspb = (float(one.overshoot[0]) for one in trajectories)
    low, high = e.inputs.table_1[:, 0].min(), e.inputs.table_1[:, 0].max()
    septic_range = (
        f"{septic.max[0]:z.4f} rad at {septic.t_max[0]:z.2f} s and {septic.min[0]:z.4f} rad at {septic.t_min[0]:z.2f} s"
    )
    return Claim(
        number=6,
        text="Joint 1: LSPB overshoots to 2.6 rad, the septic stays at 1.6 rad",
        source="section 4.3",
        measured={
            "septic_max_rad": float(septic.max[0]),
            "septic_max_time_s": float(septic.t_max[0]),
            "septic_min_rad": float(septic.min[0]),
            "septic_min_time_s": float(septic.t_min[0]),
            "lspb_max_rad": float(lspb.max[0]),
            "lspb_min_rad": float(lspb.min[0]),
            "septic_overshoot_rad": past_septic,
            "lspb_overshoot_rad": past_lspb,
        },
        verdict=verdict_of(past_lspb > 0, past_septic == 0),
        explanation=f"The points span {low:g} to {high:g} rad. The septic reaches {septic_range},"
        f" {past_septic:z.4f} rad past them; LSPB reaches {lspb.max[0]:z.4f} rad, {past_lspb:z.4f} rad past them.",
    )


def claim_7(e: Evidence) -> Claim:
    """LSPB's velocity at its end."""
    lspb = e.lspb.motion.trajectory
    jumps = lspb.jumps(1)
    at_end = np.abs(jumps.sizes[jumps.times == lspb.breaks[-1]]).max(initial=0.0)
    blend = e.inputs.blend_time
    return Claim(
        number=7,
        text="LSPB does not reach zero velocity at its end",
        source="section 4.3",
        measured={"end_velocity_rad_s": float(at_end), "blend_time_s": blend},
        verdict=verdict_of(bool(at_end > 0)),
        explanation=f"With a blend time of {blend:g} s it ends at {at_end:.4g} rad/s"
        + (": without a last blend, the velocity steps to rest." if at_end else ": mstraj's last blend leads to rest."),
    )


def claim_8(e: Evidence) -> Claim:
    """LSPB's acceleration and jerk."""
    lspb, blend = e.lspb.motion.trajectory, e.inputs.blend_time
    steps = lspb.jumps(2)
    bounded = bool(np.isfinite(e.lspb.peak_jerk).all())
    speeds = np.diff(e.inputs.table_1, axis=0) / np.diff(e.inputs.times)[:, None]
    rest = np.zeros((1, speeds.shape[1]))
    change = float(np.abs(np.diff(np.vstack([rest, speeds, rest]), axis=0)).max())
    parabolic = change / blend if blend else np.inf
    continuity = f"steps at {times_text(steps.times)}" if len(steps.times) else "is continuous"
    largest = np.abs(lspb.jumps(3).sizes).max(initial=0.0)
    function = (
        f"The paper's function, mstraj, blends with quintics: its acceleration {continuity}, its jerk stays within"
        f" {e.lspb.peak_jerk.max():.4g} rad/s^3 and steps by up to {largest:.4g} rad/s^3"
        if bounded
        else f"With a blend time of {blend:g} s mstraj's own velocity steps, and its jerk is unbounded"
    )
    return Claim(
        number=8,
        text="LSPB's acceleration is discontinuous and its jerk infinite",
        source="abstract, sections 2.3 and 5",
        measured={
            "acceleration_steps": len(steps.times),
            "peak_jerk_rad_s3": float(e.lspb.peak_jerk.max()),
            "parabolic_acceleration_step_rad_s2": parabolic,
        },
        verdict=verdict_of(parabolic > 0, not bounded),
        explanation=f"{function}. With parabolic blends as long the acceleration would step, by up to"
        f" {parabolic:.4g} rad/s^2.",
    )


def _jerk_squared(trajectory: Trajectory) -> Array:
    jerk = trajectory.derivative(3)
    return jerk.inner(jerk)


def _name(e: Evidence, j: int) -> str:
    return e.robot.joint_names[j]
