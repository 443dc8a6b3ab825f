"""Descriptions of pictures: what is in them is what was computed, whoever draws them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from helpers.urdf_texts import ARM, load

import puma_septic as ps
from puma_septic import dynamics
from puma_septic.assessment import Assessment
from puma_septic.pictures import (
    HUES,
    PROFILES,
    Bar,
    Curve,
    Dot,
    Fill,
    Mark,
    Picture,
    Samples,
    _styles,
    assessment_pictures,
    bars,
    cause_lines,
    chart,
    derivative_picture,
    motion_pictures,
    profile_line,
    samples_of,
    torque_picture,
    torque_split_picture,
    track_of,
    utilisation_picture,
)
from puma_septic.piecewise import Piecewise, sampled


@pytest.fixture(scope="module")
def septic(paper: tuple[Assessment, ...]) -> Samples:
    return samples_of(paper[0], "septic")


@pytest.fixture(scope="module")
def linear(puma: ps.Robot) -> Assessment:
    """Its velocity steps at both ends, so that acceleration and torque are unbounded."""
    return ps.assess(puma, ps.profiles.linear([[0.0] * 6, [0.5] * 6], [0.0, 2.0]))


def move(n: int) -> ps.Trajectory:
    return ps.quintic_segments([[0.0] * n, [0.5] * n], [0.0, 2.0])


def line(*y: float) -> Curve:
    return Curve(x=np.arange(len(y), dtype=float), y=np.array(y), line=profile_line(0))


def panel(picture: Picture, title: str) -> ps.pictures.Panel:
    (found,) = [one for one in picture.panels if one.title == title]
    return found


# ---- samples


def test_samples_have_both_sides_of_a_break() -> None:
    step = Piecewise(breaks=[0.0, 1.0, 3.0], coefficients=[[[0.0], [2.0]]])
    t, values = sampled(step, samples=6, least=3)
    assert t.tolist() == [0.0, 0.5, 1.0, 1.0, 1.0 + 2 / 3, 1.0 + 4 / 3, 3.0]
    assert values[:, 0].tolist() == [0.0] * 3 + [2.0] * 4


def test_samples_are_the_motion(septic: Samples) -> None:
    motion = septic.assessment.motion
    for order, signal in enumerate(septic.track.signals):
        exact = motion.trajectory(septic.t, order)
        np.testing.assert_allclose(signal, exact, atol=1e-12 * np.abs(exact).max())  # the same numbers, another order
    # At a jump of the friction the instant occurs twice, where the function has its right-hand value.
    once = np.append(np.diff(septic.t) > 0, True)
    np.testing.assert_allclose(septic.torque[once], motion.torque(septic.t)[once], atol=1e-9)


# ---- axes


def test_limits_near_are_lines_and_far_ones_are_words() -> None:
    near = chart("time", [line(-1.0, 1.0)], title="j", y_label="v [rad/s]", limits=(-1.5, 1.5))
    assert ([rule.at for rule in near.levels], near.remark) == ([-1.5, 1.5], "")
    assert near.y_range[0] < -1.5 < 1.5 < near.y_range[1]
    far = chart("time", [line(-1.0, 1.0)], title="j", y_label="v [rad/s]", limits=(-100.0, 100.0))
    assert (far.levels, far.remark) == ((), "limit ±100")
    one_side = chart("time", [line(-1.0, 1.0)], title="j", y_label="q [rad]", limits=(-100.0, 1.5))
    assert ([rule.at for rule in one_side.levels], one_side.remark) == ([1.5], "limit −100")
    unknown = chart("time", [line(-1.0, 1.0)], title="j", y_label="v [rad/s]")
    assert (unknown.levels, unknown.remark) == ((), "")


def test_a_still_joint_is_a_level_line_in_the_middle() -> None:
    """Its rounding must not be blown up to the panel's height."""
    still = chart("time", [line(1.0, 1.0 + 1e-15)], title="j", y_label="q [rad]")
    assert still.y_range == pytest.approx((0.5, 1.5))


def test_a_path_has_one_scale() -> None:
    path = chart("path", [line(0.0, 1.0, 0.0, 1.0)], title="p", y_label="y [m]", x_label="x [m]")
    (left, right), (low, high) = path.x_range, path.y_range
    assert (right - left) / (high - low) == pytest.approx(ps.pictures.ASPECT)
    assert ((left + right) / 2, (low + high) / 2) == pytest.approx((1.5, 0.5))


def test_marks_are_in_view_and_arrowheads_do_not_count() -> None:
    via = chart("time", [line(0.0, 1.0)], title="j", y_label="q", marks=[Mark(x=0.0, y=9.0, dot=Dot(shape="via"))])
    up = chart("time", [line(0.0, 1.0)], title="j", y_label="q", marks=[Mark(x=0.0, y=9.0, dot=Dot(shape="up"))])
    assert via.y_range[1] > 9.0 > 2.0 > up.y_range[1]


def test_bars_are_cut_and_tell_what_is_beyond() -> None:
    fill = Fill(hue=PROFILES[0])
    values = (50.0, 649.0, np.inf, np.nan)
    drawn = bars(
        "a", "use [%]", rows="abcd", end=125.0, limit=100.0,
        bars=[Bar(row=k, length=value, fill=fill, text=f"{value}") for k, value in enumerate(values)],
    )  # fmt: skip
    assert [bar.length for bar in drawn.bars] == [50.0, 125.0, 125.0, 0.0]
    assert [bar.text for bar in drawn.bars] == ["50.0", "649.0", "inf", "nan"]
    assert [rule.at for rule in drawn.uprights] == [100.0]


# ---- motions


def test_every_axis_has_its_unit(paper: tuple[Assessment, ...]) -> None:
    for picture in assessment_pictures(paper, ["a", "b", "c"]):
        for one in picture.panels:
            assert re.search(r"\[.+\]$", one.x_label), (picture.name, one.title)
            assert one.rows or re.search(r"\[.+\]$", one.y_label), (picture.name, one.title)


def test_a_sliding_joint_has_its_own_units(tmp_path: Path) -> None:
    text = ARM.replace('name="shoulder" type="revolute"', 'name="shoulder" type="prismatic"')
    one = samples_of(ps.assess(load(tmp_path, text), move(2)), "move")
    labels = {one.title: one.y_label for one in derivative_picture([one.track], 2, one.assessment.motion.robot).panels}
    assert labels == {"shoulder": "acceleration [m/s²]", "elbow": "acceleration [rad/s²]"}
    assert [one.y_label for one in torque_picture([one]).panels] == ["force [N]", "torque [N m]"]


def test_a_trajectory_alone_has_no_limits() -> None:
    picture = derivative_picture([track_of(move(2), "move")], 1)
    assert [one.title for one in picture.panels] == ["joint 1", "joint 2"]
    assert not any(one.levels or one.remark for one in picture.panels)
    assert [entry.label for entry in picture.legend] == ["move"]
    with pytest.raises(ps.InputError, match=r"order = 4 is not one of 0 \(position\)"):
        derivative_picture([track_of(move(2), "move")], 4)


def test_an_impulse_is_an_arrowhead(linear: Assessment) -> None:
    one = samples_of(linear, "linear")
    marks = derivative_picture([one.track], 2, linear.motion.robot).panels[0].marks
    assert [(mark.dot.shape, mark.x) for mark in marks] == [("up", 0.0), ("down", 2.0)]


def test_unbounded_torque_is_said(linear: Assessment) -> None:
    """Of one profile with its instant, of several by their names, which is what fits above a panel."""
    one, two = samples_of(linear, "a"), samples_of(linear, "b")
    assert torque_picture([one]).panels[0].remark == "a unbounded at 0 s"
    assert torque_picture([one, two]).panels[0].remark == "unbounded: a, b"
    assert torque_picture([one]).panels[0].marks == ()


def test_causes_sum_to_the_total(septic: Samples) -> None:
    picture = torque_split_picture(septic)
    assert [entry.label for entry in picture.legend] == [
        "inertia", "coriolis", "gravity", "rotor", "viscous", "coulomb", "total",
    ]  # fmt: skip
    *causes, total = picture.panels[1].curves
    t = np.linspace(0.1, 8.9, 50)
    parts = sum(np.interp(t, curve.x, curve.y) for curve in causes)
    # Straight lines between 200 samples of curves of some 60 N m.
    np.testing.assert_allclose(parts, np.interp(t, total.x, total.y), atol=0.02)


def test_a_cause_without_a_colour_of_its_own_is_drawn(septic: Samples, monkeypatch: pytest.MonkeyPatch) -> None:
    """A new term of the torque was a crash until someone gave it a colour: both were zipped strictly."""
    monkeypatch.setattr(_styles, "_CAUSES", {"gravity": HUES[0]})
    styles = {entry.label: entry.style for entry in torque_split_picture(septic).legend}
    assert list(styles) == ["inertia", "coriolis", "gravity", "rotor", "viscous", "coulomb", "total"]
    assert len(set(styles.values())) == len(styles)


def test_lines_of_profiles_and_causes_are_all_different() -> None:
    assert len({profile_line(k) for k in range(30)}) == 30
    causes = [*dynamics.TERMS, "stribeck", "load", "ripple"]
    assert list(cause_lines(causes)) == causes
    assert len(set(cause_lines(causes).values())) == len(causes)
    assert len({hue.light for hue in HUES}) == len({hue.dark for hue in HUES}) == len(HUES)


def test_each_profile_has_its_line_in_all_pictures(paper: tuple[Assessment, ...]) -> None:
    group = [samples_of(one, f"p{k}") for k, one in enumerate(paper)]
    for picture in motion_pictures(group):
        if not picture.has_own_colours:
            assert [entry.style for entry in picture.legend[:3]] == [profile_line(k) for k in range(3)]
            for one in picture.panels:
                assert all(curve.line == profile_line(curve.profile) for curve in one.curves)


# ---- utilisation


def test_bars_tell_unknown_violated_and_unbounded(linear: Assessment, tmp_path: Path) -> None:
    unbounded = panel(utilisation_picture([linear], ["linear"]), "torque")
    assert unbounded.row_bars(0)[0].text == "unbounded !"
    assert unbounded.row_bars(0)[0].is_violated
    robot = load(tmp_path, ARM).with_limits(velocity=[0.3, np.nan])
    picture = utilisation_picture([ps.assess(robot, move(2))], ["a"])
    assert [bar.text for bar in panel(picture, "velocity").bars] == ["156 % !", "not known"]
    assert [bar.length for bar in panel(picture, "velocity").bars] == [125.0, 0.0]


def test_quantities_without_a_known_limit_are_named(linear: Assessment) -> None:
    """An infinite acceleration violates a limit that is not known, too: it is drawn, and it is named."""
    picture = utilisation_picture([linear], ["linear"])
    assert "acceleration" in [one.title for one in picture.panels]
    assert picture.footnote == "Not assessed, because no limit is given: acceleration, jerk."
