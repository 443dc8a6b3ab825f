"""Claims 5 to 8: jerk, overshoot, end velocity, continuity."""

from __future__ import annotations

from typing import Final

import numpy as np

from puma_septic.paper._claim import Claim, times_text, verdict_of
from puma_septic.paper._evidence import Evidence
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["claim_5", "claim_6", "claim_7", "claim_8"]

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
    ends = "; ".join(f"{_name(e, j)} {start[j]:.3f} and {end[j]:.3f}" for j in sorted({0, largest}))
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
        f"{septic.max[0]:.4f} rad at {septic.t_max[0]:.2f} s and {septic.min[0]:.4f} rad at {septic.t_min[0]:.2f} s"
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
        f" {past_septic:.4f} rad past them; LSPB reaches {lspb.max[0]:.4f} rad, {past_lspb:.4f} rad past them.",
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
