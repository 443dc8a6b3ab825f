"""Comparison: every metric against the assessment and known values, honesty of notes, marks, forms and messages."""

from __future__ import annotations

import csv
import io
import json

import numpy as np
import pytest
from helpers.moves import POINTS, TIMES
from helpers.sampled import refined_peak
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import puma_septic as ps
from puma_septic.objectives import OBJECTIVES, Candidate, interval_extremes, non_dominated
from puma_septic.optimum import TimeOptimal
from puma_septic.validation import Array

# Joint 1 of the paper's task by exact integration of the definitions: class, integral of jerk^2, overshoot, end jerk
# (the larger of both ends), to the digits shown.
JOINT_1 = {
    "septic": ("C2", 1.1294, 0.2089, 0.894),
    "quintic_spline": ("C2", 1.0584, 0.1583, 0.560),
    "poly_434": ("C2", 1.5712, 0.1110, 0.376),
    "cubic_spline": ("C1", np.inf, 0.1939, np.inf),
    "septic_spline": ("C3", 1.2702, 0.1190, 0.0),
    "quintic": ("C2", 6.9396, 0.0, None),
    "classic_septic": ("C3", 10.795, 0.0, 0.0),
}


@pytest.fixture(scope="module")
def comparison() -> ps.Comparison:
    return ps.compare(ps.load_robot(), POINTS, TIMES)


@pytest.mark.parametrize(("name", "row"), JOINT_1.items())
def test_joint_1_of_the_papers_task(comparison: ps.Comparison, name: str, row: tuple[object, ...]) -> None:
    continuity, integral, overshoot, end_jerk = row
    compared = comparison[name]
    assert compared.continuity == continuity
    # Half a unit of the last digit shown (three decimals from 10 on).
    tolerance = 5e-4 if name == "classic_septic" else 5e-5
    np.testing.assert_allclose(compared.integral_of_squared_jerk[0], integral, rtol=0, atol=tolerance)
    np.testing.assert_allclose(compared.trajectory.overshoot[0], overshoot, rtol=0, atol=5e-5)
    if end_jerk is not None:
        np.testing.assert_allclose(compared.end_jerk[0], end_jerk, rtol=0, atol=5e-4)


def test_the_paper_s_lspb_misses_its_vias_as_in_closed_form(comparison: ps.Comparison) -> None:
    """A via is missed by (3/32) tacc dv: joint 1 changes its velocity by 3.1416/4 rad/s at both vias, tacc is 1 s."""
    miss = comparison["lspb"].trajectory.via_miss
    assert miss[0] == pytest.approx(3 / 32 * 3.1416 / 4, abs=1e-12)
    assert "misses its vias by 0.074 rad" in " ".join(comparison["lspb"].notes)


def test_profiles_that_stop_miss_or_overshoot_say_so(comparison: ps.Comparison) -> None:
    for info in ps.profiles.available():
        if info.name not in [row.name for row in comparison.profiles]:
            continue
        row = comparison[info.name]
        notes = " ".join(row.notes)
        assert row.stops_at_vias == (info.at_vias == "stops") == ("stops at its vias" in notes), info.name
        assert row.trajectory.via_miss.any() == (info.at_vias == "misses") == ("misses" in notes), info.name
        assert row.trajectory.overshoot.any() <= info.overshoots, info.name
        assert row.trajectory.overshoot.any() == ("overshoots" in notes), info.name
        assert min(info.continuity, "C3") == row.continuity, info.name


def test_all_catalogued_profiles_are_accounted_for(comparison: ps.Comparison) -> None:
    compared = [row.name for row in comparison.profiles]
    assert sorted([*compared, *comparison.unsuitable]) == sorted(info.name for info in ps.profiles.available())
    assert comparison.unsuitable["single_polynomial"] == "here the same motion as septic"
    assert comparison.unsuitable["quintic_segments"] == "here the same motion as quintic"
    assert "max_acceleration" in comparison.unsuitable["double_s"]


def test_limits_that_are_known_let_double_s_take_part(puma: ps.Robot) -> None:
    robot = puma.with_limits(acceleration=3.0, jerk=20.0)
    row = ps.compare(robot, POINTS, TIMES, profiles=["double_s"])["double_s"]
    assert row.stops_at_vias
    assert (row.assessment.peak_jerk <= 20 * (1 + 1e-12)).all()
    assert row.duration != pytest.approx(9.0)


def test_options_reach_the_profile(puma: ps.Robot) -> None:
    options = {"lspb": {"blend_time": 0.5}, "trigonometric_spline": {"angle": 1.5}}
    row = ps.compare(puma, POINTS, TIMES, profiles=["lspb", "trigonometric_spline"], options=options)["lspb"]
    assert row.trajectory.via_miss[0] == pytest.approx(3 / 32 * 0.5 * 3.1416 / 4, abs=1e-12)


def test_rows_are_the_assessments(comparison: ps.Comparison, puma: ps.Robot) -> None:
    alone = ps.assess(puma, ps.septic(POINTS, TIMES))
    row = comparison["septic"].assessment
    np.testing.assert_array_equal(row.peak_torque, alone.peak_torque)
    np.testing.assert_array_equal(row.rms_torque, alone.rms_torque)


def test_stops_is_measured_on_both_sides_of_a_via(puma: ps.Robot) -> None:
    """A straight line that halts at its second via still runs into the first one."""
    points = np.array([[0.0] * 6, [0.3] * 6, [0.6] * 6, [0.6] * 6])
    assert not ps.compare(puma, points, [0.0, 1.0, 2.0, 3.0], profiles=["linear"])["linear"].stops_at_vias


def test_the_table_fits_100_columns_and_names_every_profile(comparison: ps.Comparison) -> None:
    text = str(comparison)
    assert max(map(len, text.splitlines())) <= 100
    for row in comparison.profiles:
        assert text.count(f"\n{row.name} ") >= 2
    for name in comparison.unsuitable:
        assert f"\n  {name}: " in text
    assert "shoulder 2 times, wrist 2 times: poly_353, septic" in text


def test_json_is_json(comparison: ps.Comparison) -> None:
    document = json.loads(json.dumps(comparison.to_dict(), allow_nan=False))
    rows = {row["name"]: row for row in document["profiles"]}
    assert rows["cubic"]["overall"]["peak_jerk"] == "unbounded"
    assert rows["septic"]["joints"]["overshoot"][4] == pytest.approx(1.590, abs=5e-4)
    assert document["pareto_optimal"] == list(comparison.pareto_optimal)


def test_csv_has_a_line_for_all_joints_and_one_for_each(comparison: ps.Comparison) -> None:
    rows = list(csv.DictReader(io.StringIO(comparison.to_csv())))
    assert len(rows) == 7 * len(comparison.profiles)
    septic = [row for row in rows if row["profile"] == "septic"]
    total = sum(float(row["integral_of_squared_jerk"]) for row in septic[1:])
    assert float(septic[0]["integral_of_squared_jerk"]) == pytest.approx(total, rel=1e-12)
    assert septic[5]["joint"] == "joint5"


def test_html_escapes_and_lists(comparison: ps.Comparison) -> None:
    html = comparison._repr_html_()
    assert html.count("<table>") == 2
    assert "<li>single_polynomial: here the same motion as septic</li>" in html


def test_marks_follow_the_named_objectives(puma: ps.Robot) -> None:
    names = ["cubic", "quintic", "quintic_spline"]
    by_velocity = ps.compare(puma, POINTS, TIMES, profiles=names, objectives=["peak_velocity"])
    peaks = {row.name: row.assessment.peak_velocity.max() for row in by_velocity.profiles}
    assert by_velocity.pareto_optimal == (min(peaks, key=peaks.__getitem__),)
    assert set(ps.compare(puma, POINTS, TIMES, profiles=names).pareto_optimal) == {"quintic", "quintic_spline"}


@given(arrays(np.float64, st.tuples(st.integers(1, 12), st.integers(1, 3)), elements=st.integers(0, 4).map(float)))
@settings(max_examples=60)
def test_nobody_beats_a_pareto_optimal_row_and_somebody_beats_the_others(values: Array) -> None:
    best = non_dominated(values)
    assert best.any()
    for k, row in enumerate(values):
        beaten = any((other <= row).all() and (other < row).any() for other in values)
        assert best[k] == (not beaten)


def test_unbounded_rows_are_beaten_by_bounded_ones() -> None:
    assert non_dominated([[np.inf, 0.0], [1.0, 0.0], [2.0, -1.0]]).tolist() == [False, True, True]


def test_objectives_against_samples(puma: ps.Robot) -> None:
    """Trapezoids over 200,000 samples: their error is far below 1e-6 for smooth motions."""
    candidate = Candidate(trajectory=ps.septic(POINTS, TIMES), robot=puma, dwell=1.0)
    trajectory = candidate.trajectory
    t = np.linspace(0.0, 9.0, 200_001)
    for name, order in (("integral_of_squared_acceleration", 2), ("integral_of_squared_jerk", 3)):
        sampled = np.trapezoid((trajectory(t, order) ** 2).sum(axis=1), t)
        assert OBJECTIVES[name].value(candidate) == pytest.approx(sampled, rel=1e-6)
    for name, order in (("peak_velocity", 1), ("peak_acceleration", 2), ("peak_jerk", 3)):
        peak = refined_peak(lambda t, order=order: trajectory(t, order), trajectory.breaks).max()
        assert OBJECTIVES[name].value(candidate) == pytest.approx(peak, rel=1e-12)
    assessment = ps.assess(puma, trajectory, dwell=1.0)
    assert OBJECTIVES["rms_torque"].value(candidate) == pytest.approx(np.linalg.norm(assessment.rms_torque), rel=1e-14)
    assert OBJECTIVES["energy"].value(candidate) == pytest.approx(assessment.energy_in.sum(), rel=1e-14)
    used = (assessment.peak_torque / puma.limits.effort).max()
    assert OBJECTIVES["peak_torque_utilisation"].value(candidate) == pytest.approx(used, rel=1e-12)
    assert OBJECTIVES["duration"].value(candidate) == 9.0


def test_objectives_are_unbounded_where_a_lower_derivative_steps(puma: ps.Robot) -> None:
    cubic = Candidate(trajectory=ps.profiles.cubic(POINTS, TIMES))
    linear = Candidate(trajectory=ps.profiles.linear(POINTS, TIMES), robot=puma)
    assert OBJECTIVES["peak_jerk"].value(cubic) == np.inf
    assert np.isfinite(OBJECTIVES["peak_acceleration"].value(cubic))
    assert OBJECTIVES["peak_torque_utilisation"].value(linear) == np.inf


def test_interval_extremes_are_those_of_each_interval() -> None:
    jerk = ps.profiles.quintic(POINTS, TIMES).derivative(3)
    extremes = interval_extremes(jerk).reshape(2, 3, 6)
    for i, (left, right) in enumerate(zip(jerk.breaks[:-1], jerk.breaks[1:], strict=True)):
        values = jerk(np.linspace(left, np.nextafter(right, left), 10_001))
        # A parabola's top lies between samples by at most half a step.
        np.testing.assert_allclose(extremes[0, i], values.max(axis=0), rtol=1e-6, atol=1e-12)
        np.testing.assert_allclose(extremes[1, i], -values.min(axis=0), rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"profiles": ["septik"]}, "unknown profile 'septik'; valid: 'linear'"),
        ({"objectives": ["jerk"]}, "unknown objective 'jerk'; valid: 'duration'"),
        ({"objectives": []}, "at least 1 are needed, got 0"),
        ({"objectives": ["overshoot", "overshoot"]}, "each can be named only once"),
        ({"options": {"spline": {}}}, "unknown profile in options 'spline'"),
        ({"profiles": ["lspb"], "options": {"lspb": {"blend": 1.0}}}, "no profile suits .* unknown option 'blend'"),
        ({"profiles": ["double_s"]}, "no profile suits .* double_s needs max_acceleration .*unknown for all joints"),
        ({"dwell": -1.0}, "dwell = -1 s must be at least 0"),
        ({"times": [0.0, 2.0, 2.0, 9.0]}, "must increase strictly"),
        ({"times": [0.0, 9.0]}, r"times: shape \(2,\) is not \(4,\)"),
        ({"points": POINTS[:, :5]}, r"points: shape \(4, 5\)"),
        ({"points": POINTS[:1], "times": [0.0]}, "at least 2 points, got 1"),
    ],
)
def test_bad_input(puma: ps.Robot, changes: dict[str, object], message: str) -> None:
    arguments: dict[str, object] = {"points": POINTS, "times": TIMES, **changes}
    with pytest.raises(ps.InputError, match=message):
        ps.compare(puma, **arguments)  # type: ignore[arg-type]


def test_an_unknown_effort_limit_is_named(puma: ps.Robot) -> None:
    unknown = puma.with_limits(effort=[50.0, np.nan, 50.0, 10.0, 10.0, 10.0])
    with pytest.raises(ps.InputError, match=r"unknown for: joint2; give it by robot\.with_limits"):
        ps.compare(unknown, POINTS, TIMES, profiles=["septic"], objectives=["peak_torque_utilisation"])


def test_a_row_that_is_not_compared_is_named(comparison: ps.Comparison) -> None:
    with pytest.raises(ps.InputError, match="unknown compared profile 'double_s'"):
        comparison["double_s"]


def test_the_gap_to_the_quickest_motion_along_the_same_path(puma: ps.Robot) -> None:
    """Two ways: least duration and reference of the motion alone; why there is none is told, in every form."""
    move, times = [[0.0] * 6, [0.5, -0.4, 0.3, 0.2, 0.1, 0.4]], [0.0, 2.0]

    def reference(motion: ps.Motion) -> TimeOptimal:
        if motion.trajectory.profile == "cycloidal":
            raise ps.InputError("none for cycloids")
        return ps.time_optimal(motion)

    found = ps.compare(puma, move, times, profiles=["quintic", "trapezoidal", "cycloidal"], reference=reference)
    alone = ps.time_optimal(ps.compute_motion(puma, found["quintic"].trajectory))
    gap = found["quintic"].gap
    assert gap is not None
    assert gap.ratio == alone.gap
    assert gap.least_duration == ps.minimum_duration(ps.compute_motion(puma, found["quintic"].trajectory)).duration
    trapezoidal = found["trapezoidal"].gap
    assert trapezoidal is not None
    assert 1 < trapezoidal.ratio < gap.ratio
    document = found.to_dict()
    rows = {row["name"]: row["gap"] for row in document["profiles"]}
    assert rows["cycloidal"] == {
        "least_duration": None,
        "reference_duration": None,
        "ratio": None,
        "reason": "none for cycloids",
    }
    assert rows["quintic"]["ratio"] == gap.ratio
    assert "cycloidal: none for cycloids" in str(found)
    assert "gap" in str(found)
    table = list(csv.DictReader(io.StringIO(found.to_csv())))
    assert float(table[0]["ratio"] or 0) >= 1 or table[0]["profile"] == "cycloidal"
    assert ps.compare(puma, move, times, profiles=["quintic"])["quintic"].gap is None
