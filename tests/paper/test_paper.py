"""The paper: its tables to the printed digits, its claims measured, and verdicts that follow the inputs."""

from __future__ import annotations

import itertools
import json
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.paper import PAPER, VERDICTS, PaperInputs, PaperReport, reproduce
from puma_septic.paper._evidence import least_duration, median_seconds, stretched
from puma_septic.plots import paper_figures


@pytest.fixture(scope="module")
def printed(reference: Path) -> dict[str, Any]:
    return tomllib.loads((reference / "paper.toml").read_text())


@pytest.fixture(scope="module")
def report() -> PaperReport:
    return reproduce(runs=3)


def measured(report: PaperReport, number: int) -> dict[str, Any]:
    return dict(report.claims[number - 1].measured)


def verdict(number: int, *, robot: ps.Robot | None = None, **changes: Any) -> str:
    """The verdict after some inputs of the paper have been changed."""
    return reproduce(robot, inputs=replace(PAPER, **changes), runs=1).claims[number - 1].verdict


def fake_clock(*durations: float) -> Callable[[], float]:
    """A clock on which the n-th timed run takes the n-th duration, over and over."""
    moments = itertools.accumulate(itertools.chain.from_iterable((0.0, d) for d in itertools.cycle(durations)))
    return lambda: next(moments)


# --- what the paper prints ---


def test_inputs_are_the_printed_ones(printed: dict[str, Any]) -> None:
    np.testing.assert_array_equal(PAPER.times, printed["task"]["times"])
    np.testing.assert_array_equal(PAPER.text_points, printed["task"]["text_points"])
    np.testing.assert_array_equal(PAPER.table_1, printed["table_1"]["angles"])
    np.testing.assert_array_equal(PAPER.table_2, printed["table_2"]["coefficients"])
    assert printed["computing_times"] == {"lspb": PAPER.lspb_seconds, "septic": PAPER.septic_seconds}


def test_table_1_from_the_cartesian_points(report: PaperReport, printed: dict[str, Any]) -> None:
    """To half of the last printed digit."""
    np.testing.assert_allclose(report.table_1, printed["table_1"]["angles"], rtol=0, atol=5e-5)


def test_all_digits_of_table_2(report: PaperReport, printed: dict[str, Any]) -> None:
    """Rounding to four decimals gives all 48 printed numbers; the unrounded Table 1 gives them as well."""
    table_2 = np.array(printed["table_2"]["coefficients"])
    np.testing.assert_array_equal(np.round(report.table_2, 4), table_2)
    from_points = ps.septic(report.table_1, PAPER.times).power_coefficients()[0]
    np.testing.assert_array_equal(np.round(from_points, 4), table_2)


def test_the_printed_coefficients_cannot_be_used(report: PaperReport) -> None:
    """With t^7 rounded to four decimals joint 1 ends at 257.9 rad instead of -0.5716."""
    powers = 9.0 ** np.arange(8)
    assert powers @ PAPER.table_2[:, 0] == pytest.approx(257.9, abs=0.05)  # printed to one decimal
    assert powers @ report.table_2[:, 0] == pytest.approx(-0.5716, abs=1e-8)  # 9^7 times rounding


def test_full_precision_coefficients(report: PaperReport, printed: dict[str, Any]) -> None:
    reference = printed["worked_out"]["septic"]
    for j, name in ((0, "joint_1_coefficients"), (4, "joint_5_coefficients")):
        # Nine decimals; of t^7 four more.
        np.testing.assert_allclose(report.table_2[:7, j], reference[name][:7], rtol=0, atol=6e-10)
        assert report.table_2[7, j] == pytest.approx(reference[name][7], abs=6e-10)


def test_profiles_to_the_printed_digits(report: PaperReport, printed: dict[str, Any]) -> None:
    evidence, reference = report.evidence, printed["worked_out"]
    for assessment, name in (
        (evidence.septic, "septic"),
        (evidence.lspb, "lspb"),
        (evidence.quintic, "quintic_segments"),
    ):
        # Printed with two to four decimals: half a unit of the last one, relative to values from 0.57 up.
        for quantity in ("velocity", "acceleration", "jerk"):
            found, expected = getattr(assessment, f"peak_{quantity}")[0], reference[name][f"max_{quantity}"]
            assert found == pytest.approx(expected, rel=6e-4), (name, quantity)
    septic, expected = evidence.septic, reference["septic"]
    found = (septic.peak_velocity[4], septic.peak_acceleration[4], septic.peak_jerk[4])
    assert found == pytest.approx(
        [expected[f"joint_5_max_{q}"] for q in ("velocity", "acceleration", "jerk")], abs=6e-5
    )
    assert septic.overshoot[4] == pytest.approx(expected["joint_5_overshoot"], abs=6e-4)
    assert evidence.lspb.motion.trajectory.via_miss[0] == pytest.approx(reference["lspb"]["via_miss"], abs=6e-4)


def test_claims_1_to_13_in_the_papers_words(report: PaperReport, printed: dict[str, Any]) -> None:
    assert [claim.number for claim in report.claims] == list(range(1, 14))
    for number, source in printed["claims"].items():
        assert source["section"] in report.claims[int(number) - 1].source
    assert [report.claims[k].source for k in (11, 12)] == ["nowhere", "nowhere"]
    assert {claim.verdict for claim in report.claims} <= set(VERDICTS)


# --- the claims, measured ---


def test_verdicts(report: PaperReport) -> None:
    """All but claim 9's, which also depends on this machine's clock."""
    assert {claim.number: claim.verdict for claim in report.claims if claim.number != 9} == {
        1: "does not hold",
        2: "holds in part",
        3: "does not hold",
        4: "not stated",
        5: "holds in part",
        6: "does not hold",
        7: "does not hold",
        8: "holds in part",
        10: "holds",
        11: "holds in part",
        12: "does not hold",
        13: "does not hold",
    }


def test_claim_1_unload_point(report: PaperReport) -> None:
    """Table 1 puts the unload point at +0.3 m; the three other points agree to 2e-5 m per axis."""
    assert measured(report, 1)["z_table_1_m"] == pytest.approx(0.3, abs=2e-5)
    np.testing.assert_allclose(report.evidence.tool_points[[0, 1, 3]], PAPER.text_points[[0, 1, 3]], atol=2.5e-5)


def test_claim_2_posture(report: PaperReport) -> None:
    assert measured(report, 2)["branch"] == "right-down-flip"
    assert "the arm is right, not left" in report.claims[1].explanation
    assert "'rdf' in MATLAB" in report.claims[1].explanation


def test_claim_3_joint_limits(report: PaperReport) -> None:
    """q4 = -180 deg (limit -110), q5 = -114 deg (limit -100), q2 = -45.11 deg (limit -45)."""
    beyond = {name: np.degrees(value) for name, value in measured(report, 3)["beyond_limit_rad"].items()}
    assert beyond == pytest.approx({"joint2": 0.11, "joint4": 70.0, "joint5": 13.99}, abs=6e-3)
    assert measured(report, 3)["branches_within_limits"] == [0, 4, 4, 0]


def test_claim_5_jerk(report: PaperReport, printed: dict[str, Any]) -> None:
    m, reference = measured(report, 5), printed["worked_out"]
    assert m["jerk_steps_inside"] == 0
    for j, name in ((0, "jerk_at_ends"), (4, "joint_5_jerk_at_ends")):
        found = [m["jerk_at_start_rad_s3"][j], m["jerk_at_end_rad_s3"][j]]
        assert found == pytest.approx(reference["septic"][name], abs=6e-4)
    squared = [m[f"jerk_squared_integral{which}_rad2_s5"][0] for which in ("", "_quintic_spline")]
    expected = [reference[name]["jerk_squared_integral"] for name in ("septic", "quintic_spline")]
    assert squared == pytest.approx(expected, abs=6e-5)
    assert m["peak_jerk_quintic_spline_rad_s3"][0] == pytest.approx(reference["quintic_spline"]["max_jerk"], abs=6e-5)


def test_claim_6_overshoot(report: PaperReport, printed: dict[str, Any]) -> None:
    m, reference = measured(report, 6), printed["worked_out"]["septic"]
    assert m["septic_max_rad"] == pytest.approx(reference["largest"]["value"], abs=6e-5)
    assert m["septic_max_time_s"] == pytest.approx(reference["largest"]["time"], abs=6e-3)
    assert m["septic_min_rad"] == pytest.approx(reference["least"]["value"], abs=6e-5)
    assert m["septic_min_time_s"] == pytest.approx(reference["least"]["time"], abs=6e-3)
    assert m["septic_overshoot_rad"] == pytest.approx(reference["overshoot"], abs=6e-5)
    assert m["lspb_overshoot_rad"] == 0


def test_claim_8_parabolic_blends(report: PaperReport) -> None:
    """Joint 1 changes its velocity by pi / 4 rad/s within 1 s."""
    assert measured(report, 8)["parabolic_acceleration_step_rad_s2"] == pytest.approx(3.1416 / 4)
    assert measured(report, 8)["acceleration_steps"] == 0


def test_claim_9_durations_in_closed_form(report: PaperReport, puma: ps.Robot) -> None:
    """The septic is held up by joint 1's speed limit: its duration is 9 s times peak over limit."""
    septic = report.evidence.septic
    expected = 9.0 * septic.peak_velocity[0] / puma.limits.velocity[0]
    assert measured(report, 9)["septic_least_duration_s"] == pytest.approx(expected, rel=1e-6)  # the bisection's width
    governing = report.evidence.least_durations["septic"].governing
    assert governing is not None
    assert (governing.joint, governing.quantity) == ("joint1", "velocity")


def test_claim_9_lspb_is_faster_with_long_blends_only(report: PaperReport) -> None:
    """Joint 2's torque in the first blend holds mstraj up, so that its duration depends on the blend time."""
    m = measured(report, 9)
    longest = m["lspb_longest_blends_least_duration_s"]
    assert longest < m["septic_least_duration_s"] < m["lspb_least_duration_s"]
    governing = report.evidence.least_durations["lspb"].governing
    assert governing is not None
    assert (governing.joint, governing.quantity) == ("joint2", "effort")


def test_claim_10_excursion(report: PaperReport) -> None:
    """115 % of the lift on the joints that the points hold still between the vias."""
    excess = np.array(measured(report, 10)["excursion_over_lift"])
    np.testing.assert_allclose(excess[[1, 2, 4]], 1.15, atol=6e-3)
    assert not excess[[0, 3, 5]].any()


def test_claim_12_path(report: PaperReport, printed: dict[str, Any]) -> None:
    m, reference = measured(report, 12), printed["worked_out"]["septic"]
    assert m["highest_z_m"] == pytest.approx(reference["highest_z"], abs=6e-4)
    assert m["above_points_m"] == pytest.approx(0.27, abs=6e-3)
    for kind in ("shoulder", "wrist"):
        # The reference gives "about", from a grid.
        assert m["crossings_s"][kind] == pytest.approx(reference[f"{kind}_singularity"], abs=0.02)


def test_claim_13_torque(report: PaperReport) -> None:
    """Joint 2 carries weight, about 43 N m of it, and joint 1 overcomes friction; little is left for the profile."""
    m = measured(report, 13)
    assert m["peak_gravity_joint_2_Nm"] == pytest.approx(43, abs=0.5)
    assert min(m["gravity_share_joint_2"].values()) > 0.8
    assert min(m["friction_share_joint_1"].values()) > 0.98
    assert m["largest_dynamic_share"] < 0.05


# --- verdicts follow the inputs ---


@pytest.mark.slow
def test_claim_1_follows_the_text() -> None:
    corrected = PAPER.text_points.copy()
    corrected[2, 2] = 0.3
    assert verdict(1, text_points=corrected) == "holds"


@pytest.mark.slow
def test_claim_2_follows_the_words() -> None:
    assert verdict(2, configuration="right-down-flip") == "holds"
    assert verdict(2, configuration="left-up-noflip") == "does not hold"


@pytest.mark.slow
def test_claim_3_follows_the_limits(puma: ps.Robot) -> None:
    free = puma.with_limits(position=np.tile([-4.0, 4.0], (6, 1)))
    assert verdict(3, robot=free) == "holds"


@pytest.mark.slow
def test_claim_4_follows_stated_constraints() -> None:
    assert verdict(4, velocity_limit=1.4, acceleration_limit=1.1) == "holds"
    assert verdict(4, velocity_limit=1.0) == "does not hold"
    assert verdict(4, velocity_limit=1.0, acceleration_limit=1.1) == "holds in part"


@pytest.mark.slow
def test_claims_5_6_and_10_follow_the_points() -> None:
    """An arm that is to stay where it is has no jerk, no overshoot, and stands still at the vias."""
    still = np.tile(PAPER.table_1[1], (4, 1))
    report = reproduce(inputs=replace(PAPER, table_1=still), runs=1)
    verdicts = {claim.number: claim.verdict for claim in report.claims}
    assert verdicts[5] == "holds"
    assert verdicts[6] == "holds in part"
    assert verdicts[10] == "does not hold"
    assert verdicts[12] == "holds"


@pytest.mark.parametrize("number", [7, 8])
@pytest.mark.slow
def test_claims_7_and_8_hold_without_blends(number: int) -> None:
    assert verdict(number, blend_time=0.0) == "holds"


@pytest.mark.slow
def test_claim_9_follows_the_clock_and_the_blends() -> None:
    """The first three runs that are timed are the septic's, the next three LSPB's."""
    slow_septic = reproduce(runs=3, clock=fake_clock(9, 9, 9, 1, 1, 1)).claims[8]
    assert slow_septic.verdict == "does not hold"
    assert slow_septic.measured["computing_ratio"] == pytest.approx(1 / 9)
    slow_lspb = reproduce(runs=3, clock=fake_clock(1, 1, 1, 2, 2, 2)).claims[8]
    assert slow_lspb.verdict == "holds in part"
    assert slow_lspb.measured["computing_ratio"] == 2


@pytest.mark.slow
def test_claim_9_follows_the_limits(puma: ps.Robot) -> None:
    """Where speed is free and torque is scarce, smooth starts win over quick blends."""
    fast = puma.with_limits(velocity=100.0)
    found = reproduce(fast, runs=3, clock=fake_clock(1, 1, 1, 2, 2, 2)).claims[8]
    assert found.verdict == "holds"
    assert found.measured["septic_least_duration_s"] < found.measured["lspb_longest_blends_least_duration_s"]


def test_claim_11_is_measured_on_the_simulated_arm(report: PaperReport) -> None:
    """The septic leaves less vibration at every frequency and duration; it tracks no better where PD control with
    gravity compensation lags by the speed, and far better where LSPB's torque ends at its limit, in half the time."""
    found = measured(report, 11)
    assert found["share_with_less_residual_vibration"] == 1.0
    assert found["largest_residual_vibration_rad"][0] < 0.05 * found["largest_residual_vibration_rad"][1]
    slow, fast = found["tool_rms_error_pd_gravity_m"]
    assert slow[0] > slow[1]
    assert fast[0] < fast[1]
    slow, fast = found["tool_rms_error_feedforward_m"]
    assert max(slow) < 3e-5  # under 0.03 mm, whichever profile
    assert fast[1] > 10 * fast[0]


def test_claim_11_follows_given_tracking_errors() -> None:
    assert verdict(11, tracking_errors=(0.001, 0.002)) == "holds"
    assert verdict(11, tracking_errors=(0.002, 0.001)) == "does not hold"


def test_claim_13_follows_the_times() -> None:
    """Three times as fast, the torque of accelerating is nine times as large."""
    assert verdict(13, times=PAPER.times / 3, blend_time=PAPER.blend_time / 3) == "holds"


def test_via_times_change_the_numbers() -> None:
    """Vias at 2.901 and 6.099 s lower the septic's largest jerk by 61 %; the verdict on the jerk stays."""
    report = reproduce(inputs=replace(PAPER, times=np.array([0.0, 2.901, 6.099, 9.0])), runs=1)
    largest = max(report.claims[4].measured["peak_jerk_rad_s3"])
    assert 1 - largest / 2.7960 == pytest.approx(0.61, abs=6e-3)
    assert report.claims[4].verdict == "holds in part"


# --- the parts ---


def test_stretching_divides_the_derivatives(report: PaperReport) -> None:
    trajectory = report.evidence.septic.motion.trajectory
    slow = stretched(trajectory, 2.0)
    assert slow.duration == 18.0
    for order in range(4):
        np.testing.assert_allclose(slow(8.0, order) * 2**order, trajectory(4.0, order), atol=1e-12)


def test_least_duration_keeps_the_limits_and_no_shorter_one_does(puma: ps.Robot, report: PaperReport) -> None:
    trajectory = report.evidence.lspb.motion.trajectory
    factor = least_duration(puma, trajectory).duration / trajectory.duration
    for stretch, fits in ((factor, True), (factor * (1 - 1e-5), False)):
        checks = ps.assess(puma, stretched(trajectory, stretch)).checks
        assert all(not c.is_violated for c in checks if c.quantity != "position") is fits


def test_least_duration_of_a_motion_too_fast(puma: ps.Robot, report: PaperReport) -> None:
    """From above or from below, the same duration."""
    trajectory = report.evidence.septic.motion.trajectory
    found = least_duration(puma, stretched(trajectory, 0.01))
    assert found.duration == pytest.approx(least_duration(puma, trajectory).duration, rel=1e-6)


def test_no_duration_helps_against_gravity(puma: ps.Robot, report: PaperReport) -> None:
    weak = puma.with_limits(effort=1.0)
    assert least_duration(weak, report.evidence.septic.motion.trajectory).duration == np.inf


def test_median_is_of_the_counted_runs() -> None:
    assert median_seconds(lambda: None, 3, fake_clock(1.0, 5.0, 2.0)) == 2.0


def test_text_names_every_claim_and_table(report: PaperReport) -> None:
    text = str(report)
    for claim in report.claims:
        assert f"\n{claim.number}. " in text
    for words in ("Table 1", "Table 2", "medians of 3 runs", "DOES NOT HOLD", "0.380144"):
        assert words in text
    assert max(map(len, text.splitlines())) < 140


def test_document_is_json(report: PaperReport) -> None:
    document = json.loads(json.dumps(report.to_dict(), allow_nan=False))
    assert document["schema"] == "puma-septic/paper/1"
    assert len(document["claims"]) == 13
    assert [one["profile"] for one in document["assessments"]] == ["septic", "lspb", "quintic_segments"]


@pytest.mark.slow
def test_unbounded_values_are_json_too() -> None:
    """Without blends, jerk and torque are infinite; JSON has no infinity."""
    report = reproduce(inputs=replace(PAPER, blend_time=0.0), runs=1)
    document = json.loads(json.dumps(report.to_dict(), allow_nan=False))
    assert document["claims"][7]["measured"]["peak_jerk_rad_s3"] == "unbounded"
    assert "the torque of lspb is unbounded" in report.claims[12].explanation
    assert report.claims[12].verdict == "holds"


@pytest.mark.slow
def test_figures_are_the_papers(report: PaperReport) -> None:
    figures = paper_figures(report)
    assert {"figure_3", "figure_4", "figure_5", "figure_6_7", "jerk", "torque", "comparison"} <= set(figures)
    assert len(figures["figure_4"].axes) == 18
    labels = [text.get_text() for text in figures["torque"].legends[0].get_texts()]
    assert labels[:3] == ["septic", "lspb", "quintic_segments"]
    bars = [bar.get_width() for bar in figures["figure_6_7"].axes[1].patches]
    assert bars == [PAPER.septic_seconds, PAPER.lspb_seconds]


def test_report_is_frozen(report: PaperReport) -> None:
    with pytest.raises(AttributeError):
        report.claims = ()  # type: ignore[misc]
    with pytest.raises(TypeError):
        report.claims[0].measured["z_text_m"] = 0.3  # type: ignore[index]
    with pytest.raises(ValueError, match="read-only"):
        report.evidence.inputs.table_1[0, 0] = 0.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"points": np.zeros((3, 3))}, r"points: shape \(3, 3\) is not \(4, 3\)"),
        ({"table_1": np.full((4, 6), np.nan)}, r"table_1\[0, 0\] = nan"),
        ({"times": np.array([0.0, 2.0, 2.0, 9.0])}, "times: must increase strictly"),
        ({"times": np.array([1.0, 2.0, 6.0, 9.0])}, "starts at 0 s, not at 1 s"),
        ({"configuration": "left"}, "unknown configuration 'left'; valid: 'right-up-noflip'"),
        ({"blend_time": -1.0}, "blend_time = -1 s must be at least 0 s"),
        ({"septic_seconds": 0.0}, "septic_seconds = 0 s must be greater than 0 s"),
        ({"velocity_limit": 0.0}, "velocity_limit = 0 must be greater than 0"),
        ({"tracking_errors": (1.0,)}, r"tracking_errors: shape \(1,\) is not \(2,\)"),
    ],
)
def test_bad_inputs_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        replace(PAPER, **changes)


def test_bad_runs_and_blends_are_refused() -> None:
    with pytest.raises(ps.InputError, match="runs = 0 must be at least 1"):
        reproduce(runs=0)
    with pytest.raises(ps.InputError, match=r"blend_time = 2\.5 s is longer than segment 1"):
        reproduce(inputs=replace(PAPER, blend_time=2.5), runs=1)


def test_points_out_of_reach_are_refused() -> None:
    with pytest.raises(ps.NoSolution, match="out of reach"):
        reproduce(inputs=replace(PAPER, points=3 * PAPER.points), runs=1)


def test_inputs_are_a_value() -> None:
    assert isinstance(PAPER, PaperInputs)
    assert not hasattr(PAPER, "__dict__")
