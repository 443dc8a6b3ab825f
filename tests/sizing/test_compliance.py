"""Wind-up, backlash and natural frequencies of elastic gears, against other formulas and searches."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
from helpers.duty import paper_motion
from scipy.linalg import eigh

import puma_septic as ps
from puma_septic.dynamics import mass_matrix
from puma_septic.sizing import _compliance
from puma_septic.sizing._compliance import windup

# Dense samples miss a peak by this at most.
SAMPLED = 1e-5
STIFF = {"stiffness": [6.7e3, 1.1e4, 1.2e4], "stiffness_torques": [14.0, 40.0]}


@cache
def cycle() -> ps.Cycle:
    return ps.cycle.with_return(paper_motion(loaded=True), dwell=1.0)


def elastic(**changes: object) -> ps.sizing.Compliance:
    gearbox = ps.Gearbox(**({"ratio": 100.0, "backlash": 3e-4, **STIFF} | changes))  # type: ignore[arg-type]
    trains = [ps.Drivetrain(gearbox=gearbox) for _ in range(6)]
    return ps.sizing.compliance(cycle(), ps.size(cycle(), drivetrains=trains).demands)


def test_the_published_torsion_angle() -> None:
    """Harmonic Drive, CSD-2A p. 23: HFUC-32-100-2UH, 60 N m; T1 29, T2 108 N m; 7.15e-4 rad, 2.5 arc minutes."""
    gearbox = ps.Gearbox(stiffness=[6.7e4, 1.1e5, 1.2e5], stiffness_torques=[29.0, 108.0])
    angle = gearbox.torsion(60.0)
    assert f"{angle:.2e}" == "7.15e-04"
    assert round(angle * 180 * 60 / np.pi, 1) == 2.5
    # The other two branches, by hand.
    assert gearbox.torsion(-20.0) == pytest.approx(-20 / 6.7e4, rel=1e-15)
    assert gearbox.torsion(150.0) == pytest.approx(29 / 6.7e4 + 79 / 1.1e5 + 42 / 1.2e5, rel=1e-15)
    assert np.isnan(ps.Gearbox().torsion(1.0))


def test_windup_is_the_torsion_at_every_instant() -> None:
    gearbox = ps.Gearbox(**STIFF)  # type: ignore[arg-type]
    torque = ps.sizing.joint_load(cycle(), 1).torque
    t = np.linspace(0, cycle().duration, 3001)
    found, expected = windup(gearbox, torque)(t)[:, 0], [gearbox.torsion(x) for x in torque(t)[:, 0].tolist()]
    assert np.abs(torque(t)).max() > 40
    assert found == pytest.approx(expected, abs=1e-12)


def test_the_tool_s_shift_by_wind_up_and_by_backlash() -> None:
    found = elastic()
    t = np.linspace(0, cycle().duration, 20_001)
    jacobian = ps.jacobian(ps.load_robot(), cycle().trajectory(t))[:, :3]
    phi = np.stack([one(t)[:, 0] for one in found.windups if one is not None], axis=1)
    shift = np.linalg.norm(np.einsum("nij,nj->ni", jacobian, phi), axis=1)
    assert found.tool_windup.size == pytest.approx(shift.max(), rel=SAMPLED)
    corners = np.array(list(product((-1.5e-4, 1.5e-4), repeat=6)))
    reach = np.linalg.norm(np.einsum("nij,sj->nsi", jacobian[::4], corners), axis=2).max()
    assert found.tool_backlash.size == pytest.approx(reach, rel=SAMPLED)


def test_the_lowest_frequency_is_the_least_eigenvalue_anywhere_on_the_way() -> None:
    found = elastic()
    t = np.linspace(0, cycle().duration, 4001)
    robot = ps.load_robot().with_payload(paper_motion(loaded=True).robot.payload)
    masses = mass_matrix(robot.with_actuators((ps.Actuator(),) * 6), cycle().trajectory(t))
    lowest = min(eigh(6.7e3 * np.eye(6), m, eigvals_only=True)[0] for m in masses)
    assert found.lowest_frequency.size == pytest.approx(np.sqrt(lowest) / 2 / np.pi, rel=SAMPLED)
    assert found.lowest_frequency.size <= np.sqrt(lowest) / 2 / np.pi * (1 + 1e-12)
    alone = [np.sqrt(6.7e3 / masses[:, j, j].max()) / 2 / np.pi for j in range(6)]
    assert found.joint_frequencies == pytest.approx(alone, rel=SAMPLED)
    # Coupled joints swing more slowly than the slowest alone.
    assert found.lowest_frequency.size < min(alone)


def test_what_is_not_known_of_one_joint_leaves_no_number_for_the_arm() -> None:
    trains = [ps.Drivetrain(gearbox=ps.Gearbox(ratio=100.0, stiffness=[1e4], backlash=0.0)) for _ in range(6)]
    trains[3] = ps.Drivetrain(gearbox=ps.Gearbox(ratio=100.0))
    found = ps.sizing.compliance(cycle(), ps.size(cycle(), drivetrains=trains).demands)
    assert found.unknown_stiffness == found.unknown_backlash == ("joint4",)
    assert np.isnan([found.tool_windup.size, found.lowest_frequency.size, found.tool_backlash.size]).all()
    assert found.checks(max_tool_error=1e-3, min_frequency=5.0) == ()


def test_accuracy_and_stiffness_that_are_asked_for() -> None:
    found = elastic()
    tight = found.checks(max_tool_error=0.5 * found.tool_backlash.size, min_frequency=2 * found.lowest_frequency.size)
    assert [check.quantity for check in tight] == ["wind-up at the tool", "backlash at the tool", "natural frequency"]
    assert [check.is_violated for check in tight[1:]] == [True, True]
    assert tight[1].utilisation == pytest.approx(2.0)
    assert tight[2].utilisation == pytest.approx(2.0)
    document = found.to_dict()
    assert document["lowest_frequency"] == found.lowest_frequency.size
    assert [joint["name"] for joint in document["joints"]] == list(cycle().joint_names)


def test_a_sizing_tells_of_its_elastic_gears() -> None:
    gearbox = ps.Gearbox(ratio=100.0, backlash=3e-4, **STIFF)  # type: ignore[arg-type]
    sizing = ps.size(cycle(), drivetrains=[ps.Drivetrain(gearbox=gearbox)] * 6)
    document = sizing.to_dict()["compliance"]
    assert document["tool_windup"] == sizing.compliance.tool_windup.size == elastic().tool_windup.size
    assert "wind-up [mm]" in str(sizing)
    assert ps.size(cycle()).to_dict()["compliance"] is None


def test_no_backlash_is_no_shift() -> None:
    assert elastic(backlash=0.0).tool_backlash.size == 0.0


def test_more_corners_than_can_be_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_compliance, "_MOST_JOINTS", 5)
    with pytest.raises(ps.InputError, match="6 joints have backlash: more than 5 are too many corners to try"):
        elastic().tool_backlash  # noqa: B018


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"stiffness": [1e4, 2e4]}, "expected one stiffness, or K1, K2, K3"),
        ({"stiffness": [1e4, 2e4, 3e4], "stiffness_torques": [20.0, 10.0]}, "rising torques T1, T2"),
        ({"stiffness": [-1e4]}, r"stiffness\[0\] = -10000 N m/rad must be greater than 0"),
        ({"backlash": -1.0}, "backlash = -1 rad"),
    ],
)
def test_a_stiffness_that_no_gear_has_is_refused(values: dict, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        replace(ps.Gearbox(), **values)
