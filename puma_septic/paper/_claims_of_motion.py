"""Claims 9 to 13: speed, via points, tracking, the tool's path, torque."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from puma_septic.assessment import Assessment
from puma_septic.paper._claim import Claim, Verdict, times_text, verdict_of
from puma_septic.paper._evidence import FREQUENCIES, Evidence, Executed, execute_profiles
from puma_septic.validation import Array

__all__ = ["claim_9", "claim_10", "claim_11", "claim_12", "claim_13"]

# "Hardly": under a tenth. Joints whose RMS torque is under a tenth of the largest are left out.
_HARDLY: Final = 0.1
# A joint that holds its value between two vias does so to this part of its lift; a tool keeps its height to 1 mm.
_HELD: Final = 1e-3
_CONTROL: Final = {"pd_gravity": "PD with gravity compensation", "feedforward": "the planned torque fed forward"}
# Tracking errors that differ by less than this part are no difference.
_NO_DIFFERENCE: Final = 0.01
# Slower than this at a via, a joint stands still: rounding of a series of degree 7.
_STILL: Final = 1e-9


def claim_9(e: Evidence) -> Claim:
    """Which of the two is quicker."""
    least = {name: found.duration for name, found in e.least_durations.items()}
    computing, inputs = e.computing, e.inputs
    ratio = computing.lspb / computing.septic
    printed = inputs.lspb_seconds / inputs.septic_seconds
    best, total = min(least["lspb"], least["lspb, longest blends"]), float(inputs.times[-1])
    return Claim(
        number=9,
        text=f"The septic is quicker than LSPB ({inputs.septic_seconds:z.3f} s against {inputs.lspb_seconds:z.3f} s)",
        source="abstract, section 4.3, figures 6 and 7",
        measured={
            "septic_computing_s": computing.septic,
            "lspb_computing_s": computing.lspb,
            "computing_ratio": ratio,
            "printed_ratio": printed,
            "duration_s": total,
            "septic_least_duration_s": least["septic"],
            "lspb_least_duration_s": least["lspb"],
            "lspb_longest_blends_least_duration_s": least["lspb, longest blends"],
        },
        verdict=verdict_of(ratio > 1, least["septic"] < best),
        explanation=f"The paper timed one run of each, printing and plotting included: LSPB took {printed:z.2f} times"
        f" as long. Here it takes {ratio:z.2f} times as long (medians of {computing.runs} runs,"
        f" {1e6 * computing.septic:z.0f} and {1e6 * computing.lspb:z.0f} us). The motion takes {total:g} s either way."
        " Stretched in time until the arm's limits on speed and torque are just kept, the septic needs"
        f" {least['septic']:.3g} s, LSPB {least['lspb']:.3g} s with a blend time of {inputs.blend_time / total:.3g} of"
        f" the duration, and {least['lspb, longest blends']:.3g} s with the longest blends that fit.",
    )


def claim_10(e: Evidence) -> Claim:
    """No stop at the vias, and its price."""
    trajectory, points = e.septic.motion.trajectory, e.inputs.table_1
    speed = np.abs(trajectory(e.inputs.times[1:3], 1)).max(axis=1)
    lift = np.abs(points[1] - points[0])
    held = (lift > 0) & (np.abs(points[2] - points[1]) <= _HELD * lift)
    excess = np.where(held, trajectory.overshoot / np.where(held, lift, 1.0), 0.0)
    joints = [
        f"{e.robot.joint_names[j]} {trajectory.overshoot[j]:z.3f} rad ({100 * excess[j]:z.0f} %)"
        for j in np.flatnonzero(held).tolist()
    ]
    price = (
        " The joints that the points hold still in between pay for it: they overshoot the held value by"
        f" {', '.join(joints)} of their lift."
        if joints
        else ""
    )
    return Claim(
        number=10,
        text="The arm does not have to stop at the via points",
        source="section 5",
        measured={
            "via_speed_rad_s": speed.tolist(),
            "excursion_rad": np.where(held, trajectory.overshoot, 0.0).tolist(),
            "excursion_over_lift": excess.tolist(),
        },
        verdict=verdict_of(bool((speed > _STILL).all())),
        explanation=f"The septic passes them with joints at up to {speed[0]:z.3f} and {speed[1]:z.3f} rad/s.{price}",
    )


def claim_11(e: Evidence) -> Claim:
    """Tracking and resonance."""
    steps = {one.profile: float(np.abs(one.jumps(3).sizes).max(initial=0.0)) for one in e.trajectories[:2]}
    jerk = (
        f"The largest step of the jerk, which may excite it, is {steps['septic']:.3g} rad/s^3 for the septic and"
        f" {steps['lspb']:.3g} rad/s^3 for LSPB with a blend time of {e.inputs.blend_time:g} s."
    )
    given = e.inputs.tracking_errors
    if given is not None:
        said = f"Tracking errors of {given[0]:g} rad (septic) and {given[1]:g} rad (LSPB) are given."
        return _claim_11(verdict_of(given[0] < given[1]), f"{said} {jerk}", {"largest_jerk_step_rad_s3": steps})
    executed = execute_profiles(e.robot, e.trajectories[:2])
    tracking = np.array([errors[:, 0] < (1 - _NO_DIFFERENCE) * errors[:, 1] for errors in executed.tool_rms.values()])
    residual = executed.residual
    least = float((residual[..., 0] < residual[..., 1]).mean())
    measured = {
        "largest_jerk_step_rad_s3": steps,
        "duration_s": executed.durations.tolist(),
        **{f"tool_rms_error_{law}_m": errors.tolist() for law, errors in executed.tool_rms.items()},
        "largest_residual_vibration_rad": residual.max(axis=(0, 1)).tolist(),
        "share_with_less_residual_vibration": least,
    }
    return _claim_11(
        verdict_of(*tracking.ravel().tolist(), least == 1), _executed_text(executed, least, jerk), measured
    )


def _claim_11(verdict: Verdict, explanation: str, measured: dict[str, Any]) -> Claim:
    return Claim(
        number=11,
        text="Tracking improves and no resonance is induced",
        source="abstract, section 4.3",
        measured=measured,
        verdict=verdict,
        explanation=explanation,
    )


def _executed_text(executed: Executed, least: float, jerk: str) -> str:
    lasting = " and ".join(f"{duration:g} s" for duration in executed.durations)
    said = []
    for law, name in _CONTROL.items():
        pairs = " and ".join(
            f"{1e3 * septic:.3g} (septic) against {1e3 * lspb:.3g}" for septic, lspb in executed.tool_rms[law]
        )
        said.append(f"under {name} {pairs}")
    low, high = FREQUENCIES[[0, -1]]
    worst = 1e3 * executed.residual.max(axis=(0, 1))
    return (
        "The paper follows neither trajectory with a controlled arm and shows no vibration. On the simulated arm the"
        f" tool is off its plan, in {lasting}, by a root mean square in mm: {'; '.join(said)}. In an undamped"
        f" spring-mass of {low:g} to {high:g} Hz on the joint that shakes it most, a third to the whole of the duration"
        f" leaves up to {worst[0]:.3g} mrad after the septic and {worst[1]:.3g} mrad after LSPB; the septic leaves less"
        f" in {100 * least:.3g} % of all pairs of frequency and duration. {jerk}"
    )


def claim_12(e: Evidence) -> Claim:
    """The tool between the points."""
    tool = e.septic.tool
    top, points = tool.height_range[1] - e.base_height, e.inputs.points[:, 2].max()
    above = top - points
    crossings = {report.kind: report.crossings for report in tool.singularities if len(report.crossings)}
    singular = "; ".join(f"the {kind} singularity at {times_text(times)}" for kind, times in crossings.items())
    return Claim(
        number=12,
        text="Not mentioned, taken for granted: between the points the tool keeps its height and the arm stays"
        " clear of singular postures",
        source="nowhere",
        measured={
            "highest_z_m": float(top),
            "above_points_m": float(above),
            "crossings_s": {kind: times.tolist() for kind, times in crossings.items()},
        },
        verdict=verdict_of(bool(above <= _HELD), not crossings),
        explanation=f"The septic lifts the tool to z = {top:z.3f} m, {100 * above:z.1f} cm above the highest point,"
        f" and passes {singular or 'no singularity'}.",
    )


def claim_13(e: Evidence) -> Claim:
    """What the profile changes about the torque."""
    assessments = {"septic": e.septic, "lspb": e.lspb, "quintic_segments": e.quintic}
    peaks = {name: one.peak_torque for name, one in assessments.items()}
    unbounded = [name for name, peak in peaks.items() if np.isinf(peak).any()]
    shares = {name: _mean_square_shares(one) for name, one in assessments.items()}
    loaded = np.flatnonzero(e.septic.rms_torque >= _HARDLY * e.septic.rms_torque.max())
    dynamic = max(float(np.abs(share["dynamics"][loaded]).max()) for share in shares.values())
    widest = np.inf if unbounded else _largest_spread(np.array(list(peaks.values()))[:, loaded])
    heaviest = float(e.septic.motion.torque_terms.gravity.extrema().peak[1])
    gravity, friction = (
        f"{e.robot.joint_names[j]}: {100 * min(of):z.0f} to {100 * max(of):z.0f} % {cause}"
        for j, cause in ((1, "gravity"), (0, "friction"))
        for of in [[share[cause][j] for share in shares.values()]]
    )
    said = (
        f"the torque of {' and '.join(unbounded)} is unbounded, because a velocity steps"
        if unbounded
        else f"their peak torques differ by up to {100 * widest:z.0f} %"
    )
    return Claim(
        number=13,
        text="Not mentioned, taken for granted: the choice of the profile matters to the motors",
        source="nowhere",
        measured={
            "peak_torque_Nm": {name: peak.tolist() for name, peak in peaks.items()},
            "rms_torque_Nm": {name: one.rms_torque.tolist() for name, one in assessments.items()},
            "peak_gravity_joint_2_Nm": heaviest,
            "gravity_share_joint_2": {name: float(share["gravity"][1]) for name, share in shares.items()},
            "friction_share_joint_1": {name: float(share["friction"][0]) for name, share in shares.items()},
            "largest_dynamic_share": dynamic,
            "peak_spread": widest,
        },
        verdict=verdict_of(dynamic > _HARDLY or bool(unbounded)),
        explanation=f"In {e.inputs.times[-1]:g} s, accelerating the arm makes up at most {100 * dynamic:z.1f} % of a"
        f" loaded joint's mean square torque ({gravity}, up to {heaviest:z.1f} N m; {friction}), whichever of the three"
        f" profiles it runs; {said}.",
    )


def _largest_spread(peaks: Array) -> float:
    """Largest difference between rows, relative to the largest row, over the columns that are not all zero."""
    most = peaks.max(axis=0)
    return float(((most - peaks.min(axis=0)) / np.where(most > 0, most, 1.0)).max())


def _mean_square_shares(assessment: Assessment) -> dict[str, Array]:
    """How much of each joint's mean square torque goes with each group of causes; they sum to 1."""
    motion = assessment.motion
    terms, total = motion.torque_terms, motion.torque
    square = total.inner(total)
    known = np.where(square > 0, square, 1.0)
    groups = {
        "gravity": terms.gravity + terms.payload + terms.wrench,
        "friction": terms.viscous + terms.coulomb,
        "dynamics": terms.inertia + terms.coriolis + terms.rotor,
    }
    return {name: group.inner(total) / known for name, group in groups.items()}
