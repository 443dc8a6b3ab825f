"""Least cycle time and largest payload of given drives, against what a pendulum's equation says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.arms import pendulum
from helpers.urdf_texts import load

import puma_septic as ps
from puma_septic.sizing import Conditions, largest_payload, least_cycle_time

RATIO, TOLERANCE = 50.0, 1e-4
# 2 kg, 0.5 m from its axis.
INERTIA, GRAVITY = 2.0 * 0.5**2, 9.81


def sizing(arm: ps.Robot, margin: float = 0.0, **motor: float) -> ps.Sizing:
    move = ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0], joint_names=arm.joint_names)
    train = ps.Drivetrain(
        motor=ps.Motor(rotor_inertia=0.0, **motor), gearbox=ps.Gearbox(ratio=RATIO, efficiency=1.0, inertia=0.0)
    )
    cycle = ps.cycle.with_return(ps.compute_motion(arm, move), dwell=0.3)
    return ps.size(cycle, drivetrains=[train], conditions=Conditions(margins=margin))


def test_least_cycle_time_of_pure_inertia(tmp_path: Path) -> None:
    """Torque goes with 1 / T^2: from half the limit to all of it the moves become faster by the root of two."""
    arm = pendulum(tmp_path, gravity=(0.0, 0.0, 0.0))
    peak = INERTIA * 10 / np.sqrt(3)  # the quintic's largest acceleration is 10 / sqrt(3) h / T^2
    fastest = least_cycle_time(sizing(arm, peak_torque=2 * peak / RATIO), tolerance=TOLERANCE)
    assert fastest.value == pytest.approx(2 / np.sqrt(2) + 0.6, rel=2 * TOLERANCE)
    assert fastest.sizing.is_feasible
    assert fastest.governing.quantity == "motor torque"
    slower = least_cycle_time(sizing(arm, margin=0.2, peak_torque=0.5 * peak / RATIO), tolerance=TOLERANCE)
    assert slower.value == pytest.approx(2 * np.sqrt(2 / 0.8) + 0.6, rel=2 * TOLERANCE)


def test_means_end_a_cycle_too(tmp_path: Path) -> None:
    """The RMS torque over the whole cycle, rests as they are: c^2 k^-3 T_1 / (k T_1 + rest) at the limit."""
    arm = pendulum(tmp_path, gravity=(0.0, 0.0, 0.0))
    own = sizing(arm, continuous_torque=1.0).demands[0].rms_torque
    fastest = least_cycle_time(sizing(arm, continuous_torque=1.5 * own), tolerance=TOLERANCE)
    k = (fastest.value - 0.6) / 2.0
    assert own**2 * 2.6 / k**3 / (2.0 * k + 0.6) == pytest.approx((1.5 * own) ** 2, rel=1e-3)
    assert fastest.governing.quantity == "RMS motor torque at mean speed"


def test_largest_payload_of_a_held_load(tmp_path: Path) -> None:
    """Held still the torque is ``g (m_bob + m) r sin(q)``: the mass where it is the limit."""
    arm = pendulum(tmp_path).with_payload(ps.Payload(mass=1.0, com=(0.0, 0.0, -0.5)))
    still = ps.quintic_segments([[1.5], [1.5]], [0.0, 1.0], joint_names=arm.joint_names)
    train = ps.Drivetrain(
        motor=ps.Motor(rotor_inertia=0.0, peak_torque=0.5), gearbox=ps.Gearbox(ratio=RATIO, efficiency=1.0, inertia=0.0)
    )
    held = ps.size(ps.Cycle(steps=(ps.compute_motion(arm, still),)), drivetrains=[train])
    heaviest = largest_payload(held, tolerance=TOLERANCE)
    assert heaviest.value == pytest.approx(0.5 * RATIO / (GRAVITY * 0.5 * np.sin(1.5)) - 2.0, rel=2 * TOLERANCE)


@pytest.mark.parametrize("inertia", [0.0, 0.1])
def test_a_payload_s_inertia_grows_with_its_mass(tmp_path: Path, inertia: float) -> None:
    """Without gravity: ``(0.5 + m (0.25 + I / m_0)) a`` in kg m^2, to the default tolerance of a part in a thousand."""
    body = ps.Payload(mass=2.0, com=(0.0, 0.0, -0.5), inertia=2.0 * inertia * np.eye(3))
    arm = pendulum(tmp_path, gravity=(0.0, 0.0, 0.0)).with_payload(body)
    move = ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0], joint_names=arm.joint_names)
    train = ps.Drivetrain(
        motor=ps.Motor(rotor_inertia=0.0, peak_torque=1.0), gearbox=ps.Gearbox(ratio=RATIO, efficiency=1.0, inertia=0.0)
    )
    # The payload held in a dwell is that of the motion; it has no torque to hold here.
    cycle = ps.Cycle(steps=(ps.compute_motion(arm, move), ps.Dwell(duration=0.5, payload=body)))
    heaviest = largest_payload(ps.size(cycle, drivetrains=[train]))
    expected = (RATIO / (10 / np.sqrt(3)) - INERTIA) / (0.25 + inertia)
    assert expected / (1 + 1e-3) <= heaviest.value <= expected
    assert heaviest.tolerance == 1e-3
    carried = [heaviest.sizing.cycle.steps[0].robot.payload, heaviest.sizing.cycle.steps[1].payload]
    for payload in carried:
        assert payload.mass == heaviest.value
        assert payload.inertia == pytest.approx(heaviest.value * inertia * np.eye(3))


def test_where_nothing_is_carried_a_point_mass_is(tmp_path: Path) -> None:
    """At rest, level and stretched out: links of 3 kg at 0.2 and 0.6 m, the tool at 0.7 m from the shoulder."""
    arm = load(tmp_path, tool="tip")
    still = ps.quintic_segments([[np.pi / 2, 0.0]] * 2, [0.0, 1.0], joint_names=arm.joint_names)
    gearbox = ps.Gearbox(ratio=RATIO, efficiency=1.0, inertia=0.0)
    shoulder = ps.Drivetrain(motor=ps.Motor(rotor_inertia=0.0, peak_torque=1.0), gearbox=gearbox)
    elbow = ps.Drivetrain(motor=ps.Motor(rotor_inertia=0.0), gearbox=gearbox)
    held = ps.size(ps.Cycle(steps=(ps.compute_motion(arm, still),)), drivetrains=[shoulder, elbow])
    heaviest = largest_payload(held, tolerance=TOLERANCE)
    assert heaviest.value == pytest.approx((RATIO - GRAVITY * 3.0 * 0.8) / (GRAVITY * 0.7), rel=2 * TOLERANCE)
    assert (heaviest.governing.joint, heaviest.governing.quantity) == ("shoulder", "motor torque")
    assert heaviest.to_dict()["governing"]["joint"] == "shoulder"
    with pytest.raises(ps.InputError, match="tolerance = 0 must be greater than 0"):
        largest_payload(held, tolerance=0.0)


def test_drives_that_are_too_weak_are_told(tmp_path: Path) -> None:
    with pytest.raises(ps.NoSolution, match="even slower moves are too much: swing motor torque"):
        least_cycle_time(sizing(pendulum(tmp_path), peak_torque=1e-3), tolerance=0.1)
    with pytest.raises(ps.InputError, match="no known limit is reached up to"):
        least_cycle_time(sizing(pendulum(tmp_path)), tolerance=0.1)
