"""The worst holding torque: attained by a pose, exceeded by none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers import arms

import puma_septic as ps


def test_puma_with_its_payload_needs_what_two_ways_find() -> None:
    """Joint 2 with 2.5 kg at 0.1 m from the wrist's centre, whole range: 69.665 N m found by coordinate maximisation,
    at most 69.734 by 6,900 boxes of triangles, both computed apart from this package (issue 10)."""
    robot = ps.load_robot(tool="wrist_center")
    worst = ps.worst_holding_torque(robot, payload=ps.Payload(mass=2.5, com=(0, 0, 0.1)), gap=9e-4)
    assert worst.attained[1] == pytest.approx(69.665, abs=5e-4)  # printed with three decimals
    assert worst.attained[1] <= worst.bound[1] <= 69.734
    rest = np.zeros(6)
    assert abs(ps.inverse_dynamics(worst.robot, worst.poses[1], rest, rest)[1]) == pytest.approx(worst.attained[1])


def test_a_pendulum_holds_most_where_it_is_level(tmp_path: Path) -> None:
    """m g l = 2 * 9.81 * 0.5 N m where it is level; from hanging to 30 degrees half of that."""
    robot = arms.pendulum(tmp_path)
    hanging = ps.worst_holding_torque(robot, region={robot.joint_names[0]: (0.0, np.pi / 6)})
    whole = ps.worst_holding_torque(robot)
    assert whole.attained == pytest.approx(2 * 9.81 * 0.5)
    assert hanging.attained == pytest.approx(0.5 * whole.attained)
    assert (whole.attained <= whole.bound).all()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_no_pose_of_a_branched_arm_with_sliding_joints_exceeds_the_bound(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = arms.branched_arm(tmp_path, rng, 6)
    worst = ps.worst_holding_torque(robot, gap=0.01)
    q = rng.uniform(worst.region[:, 0], worst.region[:, 1], (20_000, 6))
    torque = np.abs(ps.inverse_dynamics(robot, q, 0 * q, 0 * q, friction=False))
    assert (torque <= worst.bound + 1e-9).all()
    assert (torque.max(axis=0) <= worst.attained + 1e-9).all()
    assert (worst.bound <= 1.011 * worst.attained + 1e-3 * worst.attained.max()).all()


@pytest.mark.parametrize(
    ("region", "message"),
    [
        ({"joint2": (1.0, 0.0)}, r"region\['joint2'\] = \[1, 0\]: the lower bound comes first"),
        ({"elbow": (0.0, 1.0)}, "unknown joint 'elbow'; valid: 'joint1'"),
        ({"joint2": (0.0, float("nan"))}, r"region\['joint2'\]"),
    ],
)
def test_bounds_that_are_none_are_refused(region: dict[str, tuple[float, float]], message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.worst_holding_torque(ps.load_robot(), region=region)
