"""Accelerations that torque limits allow: never broken by what they guarantee, broken beyond what is attained."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from helpers.places import ROBOTS
from ruamel.yaml import YAML

import puma_septic as ps


@cache
def puma(speed: float = 0.0) -> ps.AccelerationLimits:
    return ps.acceleration_limits(ps.load_robot(), speeds=speed)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "payload", "scanned"),
    [("ur5", 0.0, 15.5), ("ur5", 5.0, 3.4), ("ur10", 0.0, 14.1), ("ur10", 10.0, 1.8)],
)
def test_the_same_acceleration_of_all_joints_is_just_below_what_a_random_scan_finds(
    name: str, payload: float, scanned: float
) -> None:
    """A random scan over the whole range of example-robot-data's UR5 and UR10, apart from this package (issue 10),
    finds no pose that allows less; a search must find one that allows a little less, and the bound lies below."""
    robot = ps.load_robot(ROBOTS / "ur_description" / "urdf" / f"{name}_robot.urdf")
    equal = dict.fromkeys(robot.joint_names, 1.0)
    limits = ps.acceleration_limits(robot, payload=ps.Payload(mass=payload), shares=equal, gap=0.02)
    assert np.ptp(limits.guaranteed) == 0
    assert limits.guaranteed[0] < limits.attained[0] <= scanned + 0.05  # printed with one decimal
    assert limits.attained[0] > 0.97 * (scanned - 0.05)
    assert limits.gap < 0.021


@pytest.mark.parametrize("speed", [0.0, pytest.param(0.5, marks=pytest.mark.slow)])
def test_random_states_never_break_what_is_guaranteed(speed: float) -> None:
    limits, rng = puma(speed), np.random.default_rng(3)
    n = 50_000
    q = rng.uniform(limits.region[:, 0], limits.region[:, 1], (n, 6))
    a = limits.guaranteed * rng.choice([-1.0, 1.0], (n, 6))
    v = speed * rng.uniform(-1, 1, (n, 6))
    assert (np.abs(ps.inverse_dynamics(limits.robot, q, v, a)) <= limits.robot.limits.effort).all()


def test_a_little_more_than_is_attained_breaks_the_governing_limit_at_its_pose() -> None:
    """Without friction at rest, which is within its band either way, the demand is that of the best signs."""
    limits = puma()
    row = limits.robot.joint_names.index(limits.joint)
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 6)).reshape(6, -1).T
    q = np.tile(limits.pose, (len(signs), 1))
    tau = ps.inverse_dynamics(limits.robot, q, 0 * q, signs * limits.attained, friction=False)[:, row]
    band = float(np.abs(limits.robot.friction[row].known.band).max())
    assert np.abs(tau).max() + band == pytest.approx(limits.robot.limits.effort[row], rel=1e-9)
    assert limits.gap < 0.05
    assert (limits.guaranteed < limits.typical[0]).all()


def test_an_arm_that_cannot_be_held_is_guaranteed_nothing_and_no_file() -> None:
    """A violated limit is an answer: 60 kg at the PUMA's tool."""
    limits = ps.acceleration_limits(ps.load_robot(), payload=ps.Payload(mass=60.0))
    assert (limits.guaranteed == 0).all()
    assert (limits.attained == 0).all()
    with pytest.raises(ps.InputError, match="joint 'joint3' cannot hold the arm at every pose"):
        limits.moveit_yaml()


def test_joints_without_a_torque_limit_are_listed_and_none_at_all_is_refused() -> None:
    robot = ps.load_robot()
    effort = robot.limits.effort.copy()
    effort[3:] = np.nan
    region = dict.fromkeys(robot.joint_names, (-0.1, 0.1))
    limits = ps.acceleration_limits(robot.with_limits(effort=effort), region=region)
    assert limits.not_assessed == ("joint4", "joint5", "joint6")
    assert "not assessed, without a torque limit: joint4, joint5, joint6" in str(limits)
    with pytest.raises(ps.InputError, match="'puma560' has no effort limits"):
        ps.acceleration_limits(robot.with_limits(effort=[np.nan] * 6))


def test_moveit_reads_the_file_and_its_numbers_are_no_larger() -> None:
    text = puma().moveit_yaml()
    document: Any = YAML(typ="safe").load(text)
    for j, (name, entry) in enumerate(document["joint_limits"].items()):
        assert name == puma().robot.joint_names[j]
        assert entry["has_acceleration_limits"] is True
        assert puma().guaranteed[j] * (1 - 1e-5) <= entry["max_acceleration"] <= puma().guaranteed[j]
        assert entry["max_velocity"] == puma().robot.limits.velocity[j]


def test_shares_are_asked_of_every_joint() -> None:
    with pytest.raises(ps.InputError, match="no number for joint2, joint3"):
        ps.acceleration_limits(ps.load_robot(), shares=dict.fromkeys(["joint1", "joint4", "joint5", "joint6"], 1.0))
