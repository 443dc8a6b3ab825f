"""Joint torques against an independent toolbox, closed forms and the laws of mechanics."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from helpers.arms import DRIVE, branched_arm, joint, link, load, pendulum
from hypothesis import given, settings
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic.dynamics import (
    TERMS,
    TorqueTerms,
    check_plain_friction,
    joint_wrenches,
    mass_matrix,
    payload_torque,
    potential_energy,
)

# The toolbox prints 16 digits of torques up to 100 N m; both add up some hundred products.
ORACLE_TOLERANCE = 1e-9
# The same sums in another order: some hundred roundings of 100 N m.
ROUNDING = 1e-11


@pytest.fixture(scope="module")
def oracle(reference: Path) -> Mapping[str, Any]:
    return dict(np.load(reference / "puma560_oracle.npz"))


@pytest.fixture(scope="module")
def published(reference: Path) -> dict[str, Any]:
    with open(reference / "puma560_published.toml", "rb") as file:
        return tomllib.load(file)


def states(oracle: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return oracle["q"], oracle["qd"], oracle["qdd"]


# ---- the toolbox's 200 samples


def test_torque_without_friction_is_the_oracle_s(puma: ps.Robot, oracle: Mapping[str, Any]) -> None:
    tau = ps.inverse_dynamics(puma, *states(oracle), friction=False)
    np.testing.assert_allclose(tau, oracle["tau_motor"], rtol=0, atol=ORACLE_TOLERANCE)


def test_torque_with_friction_is_the_oracle_s(puma: ps.Robot, oracle: Mapping[str, Any]) -> None:
    np.testing.assert_allclose(
        ps.inverse_dynamics(puma, *states(oracle)), oracle["tau_full"], rtol=0, atol=ORACLE_TOLERANCE
    )


def test_gravity_and_coriolis_are_the_oracle_s(puma: ps.Robot, oracle: Mapping[str, Any]) -> None:
    terms = ps.torque_terms(puma, *states(oracle))
    np.testing.assert_allclose(terms.gravity, oracle["gravload"], rtol=0, atol=ORACLE_TOLERANCE)
    np.testing.assert_allclose(terms.coriolis, oracle["coriolis_qd"], rtol=0, atol=ORACLE_TOLERANCE)
    np.testing.assert_allclose(
        terms.viscous, oracle["tau_viscous"] - oracle["tau_motor"], rtol=0, atol=ORACLE_TOLERANCE
    )
    np.testing.assert_allclose(terms.coulomb, oracle["tau_full"] - oracle["tau_viscous"], rtol=0, atol=ORACLE_TOLERANCE)
    np.testing.assert_allclose(terms.rotor, oracle["tau_motor"] - oracle["tau_rigid"], rtol=0, atol=ORACLE_TOLERANCE)


def test_columns_of_the_mass_matrix_are_the_oracle_s(puma: ps.Robot, oracle: Mapping[str, Any]) -> None:
    q = oracle["q"]
    rest = np.zeros_like(q)
    gravity = ps.inverse_dynamics(puma, q, rest, rest)
    for j in range(6):
        a = np.broadcast_to(np.eye(6)[j], q.shape)
        column = ps.inverse_dynamics(puma, q, rest, a) - gravity
        np.testing.assert_allclose(column, oracle["M_motor"][:, :, j], rtol=0, atol=ORACLE_TOLERANCE)
    np.testing.assert_allclose(mass_matrix(puma, q), oracle["M_motor"], rtol=0, atol=ORACLE_TOLERANCE)


def test_wrench_in_tool_axes_is_the_oracle_s(oracle: Mapping[str, Any]) -> None:
    # The oracle's wrench is what the robot exerts on the world, at frame 6 in its axes.
    wrench = ps.Wrench(force=[10.0, -5.0, 8.0], torque=[1.0, 2.0, -1.5], axes="tool")
    pushing = ps.load_robot(tool="wrist_center").with_wrench(wrench)
    q, v, a = states(oracle)
    tau = ps.inverse_dynamics(pushing, q, v, a, friction=False) - pushing.armature * a
    np.testing.assert_allclose(tau, oracle["tau_fext"], rtol=0, atol=ORACLE_TOLERANCE)


def test_published_torques_come_out_to_every_printed_digit(published: dict[str, Any]) -> None:
    for case in published["inverse_dynamics"]:
        robot = ps.load_robot(tool="wrist_center", gravity=case.get("gravity", (0.0, 0.0, -9.81)))
        if "wrench_on_world" in case:
            exerted = case["wrench_on_world"]
            robot = robot.with_wrench(ps.Wrench(force=exerted[:3], torque=exerted[3:], axes="tool"))
        tau = ps.inverse_dynamics(robot, published["poses"][case["pose"]], case["v"], case["a"])
        # Half a unit of the last printed digit.
        np.testing.assert_allclose(tau, case["torque"], rtol=0, atol=0.51 * 10.0 ** -case["decimals"])


def test_published_mass_matrix_and_its_product(puma: ps.Robot, published: dict[str, Any]) -> None:
    inertia = published["inertia"]
    matrix = mass_matrix(puma, np.array([published["poses"]["qn"]]))[0]
    np.testing.assert_allclose(matrix, inertia["matrix"], rtol=0, atol=0.51e-4)
    np.testing.assert_allclose(matrix @ inertia["itorque_a"], inertia["itorque"], rtol=0, atol=0.51e-4)


# ---- laws


vectors = st.lists(st.floats(-3, 3), min_size=6, max_size=6).map(np.array)


@settings(max_examples=25)
@given(q=vectors, v=vectors, a=vectors, mass=st.floats(0.01, 10), force=vectors)
def test_terms_sum_to_the_torque(q, v, a, mass, force) -> None:  # type: ignore[no-untyped-def]
    robot = ps.load_robot().with_payload(ps.Payload(mass=mass, com=force[:3] / 10, inertia=0.01 * np.eye(3)))
    robot = robot.with_wrench(ps.Wrench(force=10 * force[:3], torque=force[3:]))
    total = ps.inverse_dynamics(robot, q, v, a)
    terms = ps.torque_terms(robot, q, v, a)
    assert isinstance(terms, TorqueTerms)
    np.testing.assert_allclose(sum(getattr(terms, name) for name in TERMS), total, rtol=0, atol=ROUNDING * 10)
    np.testing.assert_array_equal(terms.total, sum(getattr(terms, name) for name in TERMS))


@settings(max_examples=25)
@given(q=vectors, v=vectors, a=vectors, mass=st.floats(0.1, 10))
def test_a_payload_s_torque_is_linear_in_its_mass(q, v, a, mass) -> None:  # type: ignore[no-untyped-def]
    def term(kilograms: float) -> np.ndarray:
        payload = ps.Payload(mass=kilograms, com=[0.02, -0.01, 0.1])
        return ps.torque_terms(ps.load_robot().with_payload(payload), q, v, a).payload

    np.testing.assert_allclose(term(mass), mass * term(1.0), rtol=0, atol=ROUNDING * 10)


def test_a_point_payload_at_rest_weighs_on_the_joints_as_a_force_at_its_place(
    puma: ps.Robot, rng: np.random.Generator
) -> None:
    q = rng.uniform(-2, 2, (20, 6))
    rest = np.zeros_like(q)
    hanging = ps.torque_terms(puma.with_payload(ps.Payload(mass=2.0)), q, rest, rest).payload
    # Holding m g is pushing down on nothing else: the arm exerts m g upwards.
    lifting = ps.Wrench(force=[0.0, 0.0, 2.0 * 9.81], torque=[0.0, 0.0, 0.0], axes="world")
    np.testing.assert_allclose(
        hanging, ps.torque_terms(puma.with_wrench(lifting), q, rest, rest).wrench, rtol=0, atol=ROUNDING
    )


def test_a_wrench_in_world_axes_acts_through_the_transposed_jacobian(puma: ps.Robot, rng: np.random.Generator) -> None:
    q, v, a = rng.uniform(-2, 2, (3, 20, 6))
    wrench = rng.uniform(-20, 20, 6)
    pushing = puma.with_wrench(ps.Wrench(force=wrench[:3], torque=wrench[3:], axes="world"))
    added = ps.inverse_dynamics(pushing, q, v, a) - ps.inverse_dynamics(puma, q, v, a)
    np.testing.assert_allclose(added, ps.jacobian(puma, q).transpose(0, 2, 1) @ wrench, rtol=0, atol=ROUNDING * 10)


@pytest.mark.parametrize("seed", range(6))
def test_torque_is_mass_matrix_times_acceleration_plus_bias(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = branched_arm(tmp_path, rng, int(rng.integers(2, 9))).with_payload(ps.Payload(mass=1.0, com=[0.1, 0, 0]))
    q, v, a = rng.uniform(-2, 2, (3, 10, robot.n_joints))
    bias = ps.inverse_dynamics(robot, q, v, np.zeros_like(a))
    expected = np.einsum("nij,nj->ni", mass_matrix(robot, q), a) + bias
    np.testing.assert_allclose(ps.inverse_dynamics(robot, q, v, a), expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_power_is_the_change_of_energy(tmp_path: Path, seed: int) -> None:
    """Energies from Pinocchio's own reading of the text, rotors added by hand, differentiated along a motion."""
    rng = np.random.default_rng(100 + seed)
    robot = branched_arm(tmp_path, rng, int(rng.integers(2, 9)))
    plain = pin.buildModelFromUrdf(str(tmp_path / "tree.urdf"))
    data = plain.createData()
    q0, v0, a = rng.uniform(-1, 1, (3, robot.n_joints))
    order = [plain.getJointId(name) for name in robot.joint_names]

    def energy(t: float) -> float:
        q, v = pin.neutral(plain), np.zeros(plain.nv)
        for k, j in enumerate(order):
            angle = q0[k] + v0[k] * t + a[k] * t**2 / 2
            model_joint = plain.joints[j]
            q[model_joint.idx_q : model_joint.idx_q + model_joint.nq] = (
                [np.cos(angle), np.sin(angle)] if model_joint.nq == 2 else angle
            )
            v[model_joint.idx_v] = v0[k] + a[k] * t
        rotors = 0.5 * robot.armature @ (v0 + a * t) ** 2
        return float(pin.computeKineticEnergy(plain, data, q, v) + pin.computePotentialEnergy(plain, data, q) + rotors)

    h = 1e-3
    # Fourth-order differences: h^4 and rounding / h are both far below 1e-7.
    rate = (8 * (energy(h) - energy(-h)) - (energy(2 * h) - energy(-2 * h))) / (12 * h)
    power = ps.inverse_dynamics(robot, q0, v0, a, friction=False) @ v0
    assert power == pytest.approx(rate, rel=1e-7, abs=1e-7)


# ---- other joints, other trees


def test_a_pendulum_has_the_torque_of_the_textbook(tmp_path: Path) -> None:
    """``tau = m l^2 a + m g l sin q``, m = 2 kg, l = 0.5 m."""
    q, v, a = np.array([[0.3], [-2.0]]), np.array([[1.0], [-3.0]]), np.array([[0.5], [4.0]])
    expected = 2 * 0.25 * a + 2 * 9.81 * 0.5 * np.sin(q)
    for kind in ("revolute", "continuous"):
        tau = ps.inverse_dynamics(pendulum(tmp_path, kind=kind), q, v, a)
        np.testing.assert_allclose(tau, expected, rtol=0, atol=1e-14)


def test_a_continuous_joint_turns_any_number_of_times(tmp_path: Path) -> None:
    arm = pendulum(tmp_path, kind="continuous")
    once, often = (ps.inverse_dynamics(arm, [0.3 + turns], [1.0], [1.0]) for turns in (0.0, 20 * np.pi))
    np.testing.assert_allclose(often, once, rtol=0, atol=1e-12)


def test_a_lift_carries_its_weight_and_what_accelerates_it(tmp_path: Path) -> None:
    """A vertical prismatic joint: ``F = m (g + a) + N^2 J a + B N^2 v + N Tc``, N in rad/m."""
    body = '<link name="base"/>' + link("cabin", 3.0, [0.1, 0.0, 0.0], 0.1 * np.eye(3))
    body += joint("lift", "prismatic", "base", "cabin", [0, 0, 0], [0, 0, 1])
    drives = DRIVE.format(name="lift", ratio=-100.0, rotor=1e-4, viscous=2e-3, positive=0.05, negative=-0.07)
    arm = load(tmp_path, "lift", body, drives)
    assert arm.is_prismatic.tolist() == [True]
    up, down, still = ps.inverse_dynamics(arm, [[0.2]] * 3, [[0.5], [-0.5], [0.0]], [[2.0]] * 3)[:, 0]
    inertial = 3.0 * (9.81 + 2.0) + 1.0 * 2.0
    np.testing.assert_allclose([up, down, still], [inertial + 10 + 5, inertial - 10 - 7, inertial], rtol=1e-14)


def test_a_lift_passes_on_its_force_along_and_across_its_axis(tmp_path: Path) -> None:
    """Two lifts in series, 3 and 2 kg: each bears what is above it, and the eccentric cabin tilts it by m (g + a) r."""
    body = '<link name="base"/>' + link("cabin", 3.0, [0.1, 0.0, 0.0], np.zeros((3, 3)))
    body += link("top", 2.0, [0.0, 0.0, 0.0], np.zeros((3, 3)))
    body += joint("lift", "prismatic", "base", "cabin", [0, 0, 0], [0, 0, 1])
    body += joint("second", "prismatic", "cabin", "top", [0, 0, 0], [0, 0, 1])
    arm = load(tmp_path, "lifts", body)
    wrench = joint_wrenches(arm, np.array([[0.3, 0.2]]), np.zeros((1, 2)), np.array([[1.5, 0.5]]))[0]
    np.testing.assert_allclose(wrench[:, 2], [3 * (9.81 + 1.5) + 2 * (9.81 + 2.0), 2 * (9.81 + 2.0)], rtol=1e-14)
    np.testing.assert_allclose(wrench[:, :2], 0.0, atol=1e-14)
    tilt = np.linalg.norm(wrench[:, 3:5], axis=1)
    np.testing.assert_allclose(tilt, [3 * (9.81 + 1.5) * 0.1, 0.0], rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(wrench[:, 5], 0.0, atol=1e-13)


def test_energy_is_weight_times_height(tmp_path: Path) -> None:
    """``m g l (1 - cos q)`` above the lowest point, m = 2 kg, l = 0.5 m; for a continuous joint as well."""
    q = np.array([[0.0], [0.3], [np.pi]])
    for kind in ("revolute", "continuous"):
        energy = potential_energy(pendulum(tmp_path, kind=kind), q)
        np.testing.assert_allclose(energy - energy[0], 2 * 9.81 * 0.5 * (1 - np.cos(q[:, 0])), rtol=0, atol=1e-13)


def test_a_payload_by_its_parameters_is_the_payload(puma: ps.Robot, rng: np.random.Generator) -> None:
    """Two ways: the term of a robot that carries it, and its ten parameters, whatever the robot carries already."""
    q, v, a = rng.uniform(-2, 2, (3, 10, 6))
    centre, about_centre = np.array([0.02, -0.01, 0.1]), np.diag([0.01, 0.02, 0.025])
    loaded = puma.with_payload(ps.Payload(mass=2.0, com=centre, inertia=about_centre))
    about = about_centre + 2.0 * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    parameters = np.array([2.0, *(2.0 * centre), *about[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]])
    expected = ps.torque_terms(loaded, q, v, a).payload
    for robot in (puma, loaded):
        found = payload_torque(robot, parameters)(q, v, a)
        np.testing.assert_allclose(found, expected, rtol=0, atol=ROUNDING)


def test_siblings_keep_the_order_of_the_file(tmp_path: Path) -> None:
    """Pinocchio sorts the branches of a tree by name; ours are in the order of the file, so torque must follow."""
    body = '<link name="base"/>' + link("one", 1.0, [0.5, 0, 0], np.zeros((3, 3)))
    body += link("two", 4.0, [0.5, 0, 0], np.zeros((3, 3)))
    body += joint("zulu", "revolute", "base", "one", [0, 0, 0], [0, -1, 0])
    body += joint("alpha", "continuous", "base", "two", [0, 0, 0], [0, -1, 0])
    arm = load(tmp_path, "twins", body)
    assert arm.joint_names == ("zulu", "alpha")
    q = np.array([0.2, 1.0])
    expected = np.array([1.0, 4.0]) * 9.81 * 0.5 * np.cos(q)
    np.testing.assert_allclose(ps.inverse_dynamics(arm, q, [0, 0], [0, 0]), expected, rtol=1e-14)
    np.testing.assert_allclose(
        ps.inverse_dynamics(arm, q, [0, 0], [0, 2.0]) - expected, [0.0, 2 * 4 * 0.25], rtol=0, atol=1e-14
    )
    np.testing.assert_allclose(mass_matrix(arm, q[None])[0], np.diag([0.25, 1.0]), rtol=0, atol=1e-15)


def test_one_sample_and_many_agree(puma: ps.Robot, rng: np.random.Generator) -> None:
    q, v, a = rng.uniform(-2, 2, (3, 50, 6))
    rows = [ps.inverse_dynamics(puma, *state) for state in zip(q, v, a, strict=True)]
    np.testing.assert_array_equal(ps.inverse_dynamics(puma, q, v, a), rows)
    assert ps.torque_terms(puma, q[0], v[0], a[0]).gravity.shape == (6,)


def test_friction_opposes_each_direction_with_its_own_size_and_vanishes_at_rest(puma: ps.Robot) -> None:
    speed = np.array([[1e-300], [-1e-300], [0.0]]) * np.ones(6)
    coulomb = ps.torque_terms(puma, np.zeros((3, 6)), speed, np.zeros((3, 6))).coulomb
    np.testing.assert_array_equal(coulomb, [*puma.coulomb_friction.T, np.zeros(6)])
    # Joint 1 by hand: 62.6111 * 0.395 and 62.6111 * 0.435 N m.
    np.testing.assert_allclose(coulomb[:2, 0], [24.7313845, -27.2358285], rtol=1e-12)


def test_an_unknown_drive_adds_no_torque(tmp_path: Path) -> None:
    arm = pendulum(tmp_path)
    terms = ps.torque_terms(arm, [0.5], [1.0], [1.0])
    assert [terms.rotor[0], terms.viscous[0], terms.coulomb[0]] == [0.0, 0.0, 0.0]


# ---- what is refused


def test_a_robot_without_inertia_is_refused_by_the_joint_s_name(tmp_path: Path) -> None:
    body = '<link name="base"/><link name="ghost"/>' + joint("swing", "revolute", "base", "ghost", [0, 0, 0], [0, 1, 0])
    arm = load(tmp_path, "massless", body)
    for torque in (ps.inverse_dynamics, ps.torque_terms):
        with pytest.raises(ps.ModelError, match=r"'massless'.*'swing'.*<inertial>"):
            torque(arm, [0.0], [0.0], [0.0])


def test_shapes_and_numbers_are_checked_with_the_joint_s_name(puma: ps.Robot) -> None:
    rest = np.zeros(6)
    with pytest.raises(ps.InputError, match=r"q, v and a must have one shape, got \(2, 6\), \(6,\), \(6,\)"):
        ps.inverse_dynamics(puma, np.zeros((2, 6)), rest, rest)
    with pytest.raises(ps.InputError, match="joint1, joint2, joint3, joint4, joint5, joint6"):
        ps.inverse_dynamics(puma, np.zeros(5), np.zeros(5), np.zeros(5))
    with pytest.raises(ps.InputError, match=r"joint 'joint3': v\[2\] = nan"):
        ps.inverse_dynamics(puma, rest, [0, 0, np.nan, 0, 0, 0], rest)


# --- the other way, and gears that lose a part of their load --------------------------------------


@pytest.mark.parametrize("friction", [True, False])
def test_forward_dynamics_undoes_inverse_dynamics(puma: ps.Robot, rng: np.random.Generator, friction: bool) -> None:
    """With payload, wrench, rotors and friction; one sample and many."""
    robot = puma.with_payload(ps.Payload(mass=2.0, com=[0.0, 0.05, 0.1]))
    robot = robot.with_wrench(ps.Wrench(force=[3.0, -20.0, 5.0], torque=[0.5, 0.0, 1.0]))
    q, v, a = (rng.uniform(-1, 1, (5, 6)) for _ in range(3))
    tau = ps.inverse_dynamics(robot, q, v, a, friction=friction)
    np.testing.assert_allclose(ps.forward_dynamics(robot, q, v, tau, friction=friction), a, rtol=0, atol=1e-9)
    one = ps.forward_dynamics(robot, q[0], v[0], tau[0], friction=friction)
    np.testing.assert_allclose(one, a[0], rtol=0, atol=1e-9)


def lossy(robot: ps.Robot, share: float) -> ps.Robot:
    """The robot with gears that lose this share of their load, and no friction beside it."""
    law = ps.Friction(viscous=0.0, coulomb=[0.0, 0.0], load_share=share)
    return robot.with_drivetrains(replace(train, measured_friction=law) for train in robot.drivetrains)


def test_gears_lose_their_share_of_what_passes_them_and_nothing_of_the_rotor_s(
    puma: ps.Robot, rng: np.random.Generator
) -> None:
    """The motor accelerates its own rotor; all else passes the gears: a tenth more to drive, a tenth less to brake."""
    robot = lossy(puma, 0.1)
    q, v, a = (rng.uniform(-1, 1, (40, 6)) for _ in range(3))
    whole = ps.inverse_dynamics(puma, q, v, a, friction=False)
    through = whole - puma.armature * a
    expected = whole + 0.1 * np.abs(through) * np.sign(v)
    np.testing.assert_allclose(ps.inverse_dynamics(robot, q, v, a), expected, rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(
        ps.inverse_dynamics(robot, q, 0 * v, a), ps.inverse_dynamics(puma, q, 0 * v, a), rtol=0, atol=ROUNDING
    )


def test_what_scales_in_time_takes_only_plain_friction(puma: ps.Robot) -> None:
    check_plain_friction(puma, "this")
    with pytest.raises(ps.InputError, match=r"this knows viscous and Coulomb friction alone; 'joint1', .* of robot"):
        check_plain_friction(lossy(puma, 0.1), "this")
    with pytest.raises(ps.InputError, match="forward dynamics knows no gears that lose a part of their load"):
        ps.forward_dynamics(lossy(puma, 0.1), [0.0] * 6, [0.1] * 6, [0.0] * 6)
