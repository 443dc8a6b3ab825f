"""Arms whose URDF lacks inertia: all that needs none is answered, and torque is never told as zero."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.urdf_texts import ARM, INERTIAL, load, replaced

import puma_septic as ps
from puma_septic.report import samples_csv
from puma_septic.report.page import report_html

VIAS, TIMES = [[0.0, 0.0], [0.6, -0.4], [1.0, 0.5]], [0.0, 1.0, 2.0]
LAST = '<link name="fore">'


def move() -> ps.Trajectory:
    return ps.profiles.quintic(VIAS, TIMES)


@pytest.fixture
def bare(tmp_path: Path) -> ps.Robot:
    """No link has an inertia, as in half of all public arm files (ros-industrial's Fanuc, Motoman, most ABB)."""
    return load(tmp_path, ARM.replace(INERTIAL, ""))


@pytest.fixture
def last_bare(tmp_path: Path) -> ps.Robot:
    """Only the last link lacks it, as in the vendor's Gen3 lite and cuRobo's fingers."""
    return load(tmp_path, replaced(LAST + INERTIAL, LAST))


def test_all_but_torque_is_assessed(bare: ps.Robot, tmp_path: Path) -> None:
    """`assess` once refused such an arm altogether, though position to jerk and the tool need no inertia."""
    result, whole = ps.assess(bare, move(), dwell=0.5), ps.assess(load(tmp_path), move(), dwell=0.5)
    for name in ("peak_velocity", "peak_acceleration", "peak_jerk", "rms_velocity"):
        np.testing.assert_array_equal(getattr(result, name), getattr(whole, name))
    assert result.tool.peak_speed == whole.tool.peak_speed
    for name in ("peak_torque", "peak_torque_time", "rms_torque", "peak_power", "energy_in", "holding_torque"):
        assert np.isnan(getattr(result, name)).all()
    assert result.not_assessed[0] == (
        "torque (the URDF has no usable inertia for what the joint moves): unknown for all joints"
    )
    assert {check.quantity for check in result.checks} == {"position", "velocity"}
    assert np.isnan(result.margins["effort"]).all()
    effort = next(line for line in str(result).splitlines() if line.startswith("shoulder") and "--" in line)
    assert effort.split() == ["shoulder", "--", "--", "--", "--", "--"]


def test_a_limit_broken_without_inertia_is_broken(bare: ps.Robot) -> None:
    result = ps.assess(bare.with_limits(velocity=0.1), move())
    assert not result.is_feasible
    assert result.violations[0].quantity == "velocity"


def test_only_the_joint_that_moves_nothing_is_left_out(last_bare: ps.Robot, tmp_path: Path) -> None:
    """The others' torque is exact: that of the same arm with a link that weighs nothing."""
    result = ps.assess(last_bare, move())
    light = INERTIAL.replace('"3"', '"1e-300"').replace("0.1", "1e-300").replace("0.05", "1e-300")
    rigid = load(tmp_path, replaced(LAST + INERTIAL, LAST + light))
    q, v, a = (move()(result.peak_torque_time[:1], order) for order in range(3))
    assert np.isnan(result.peak_torque).tolist() == [False, True]
    expected = np.abs(ps.torque_terms(replace_missing(rigid), q, v, a).total[0, 0])
    assert result.peak_torque[0] == pytest.approx(expected, rel=1e-12)  # rounding of the series' extremum
    assert [c.joint for c in result.checks if c.quantity == "effort"] == ["shoulder"]
    assert result.not_assessed[0].endswith("unknown for elbow")


def replace_missing(robot: ps.Robot) -> ps.Robot:
    """The arm, taken for complete."""
    from dataclasses import replace

    return replace(robot, missing_inertia=())


def test_compare_report_and_samples_leave_torque_out(bare: ps.Robot, last_bare: ps.Robot) -> None:
    text = str(ps.compare(bare, VIAS, TIMES, profiles=["quintic", "quintic_spline"]))
    assert "energy" not in text.partition("Over:")[0]
    assert "torque (the URDF has no usable inertia" in text
    partly = str(ps.compare(last_bare, VIAS, TIMES, profiles=["quintic", "quintic_spline"]))
    assert "not known" in partly  # the energy of the whole arm
    assert "torque not known" in report_html(ps.assess(bare, move()))
    header, first = samples_csv(ps.assess(last_bare, move())).splitlines()[:2]
    columns = dict(zip(header.split(","), first.split(","), strict=True))
    assert columns["torque elbow [N m]"] == ""
    assert float(columns["torque shoulder [N m]"]) != 0.0


def test_what_needs_every_torque_refuses(bare: ps.Robot) -> None:
    motion = ps.compute_motion(bare, move())
    for needs in (
        lambda: ps.cycle.with_return(motion),
        lambda: ps.inverse_dynamics(bare, [0.0] * 2, [0.0] * 2, [0.0] * 2),
        lambda: ps.compare(bare, VIAS, TIMES, profiles=["quintic"], objectives=["energy"]),
    ):
        with pytest.raises(ps.ModelError, match=r"no mass or inertia beyond joint 'shoulder', 'elbow'.*<inertial>"):
            needs()
