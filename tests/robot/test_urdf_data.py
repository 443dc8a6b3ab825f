"""The PUMA's data files against an independent toolbox and against print, by plain Pinocchio and tomllib.

None of this package's own code takes part: what fails here is a number in ``urdf/``.
"""

from __future__ import annotations

import json
import math
import tomllib
import xml.etree.ElementTree as ET
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from helpers.places import REFERENCE, ROOT
from numpy.typing import NDArray

Array = NDArray[np.float64]

URDF = ROOT / "urdf" / "puma560.urdf"
DRIVES: dict[str, Any] = tomllib.loads(URDF.with_name("puma560_actuators.toml").read_text(encoding="utf-8"))
PUBLISHED: dict[str, Any] = tomllib.loads((REFERENCE / "puma560_published.toml").read_text(encoding="utf-8"))
POSES = {name: np.array(q) for name, q in PUBLISHED["poses"].items()}
JOINTS = tuple(f"joint{k}" for k in range(1, 7))
SHOULDER_HEIGHT = 0.67183  # m, 26.45 in; Puma560.py


@pytest.fixture(scope="module")
def oracle() -> dict[str, Array]:
    """200 random configurations as roboticstoolbox-python 1.4.4 computes them; see reference/README.md."""
    with np.load(REFERENCE / "puma560_oracle.npz") as file:
        return {name: file[name] for name in file.files}


def drive(parameters: str, key: str) -> Array:
    """A drive value of all joints; NaN where the set has none."""
    table = DRIVES["parameters"][parameters]["joints"]
    return np.array([table[name].get(key, math.nan) for name in JOINTS])


def model_of(parameters: str = "rtb") -> pin.Model:
    """The URDF with the set's rotor inertia, and its overrides of the URDF's numbers."""
    model = pin.buildModelFromUrdf(str(URDF))
    by_rotor = drive(parameters, "rotor_inertia") * drive(parameters, "gear_ratio") ** 2
    model.armature = np.where(np.isnan(by_rotor), drive(parameters, "armature"), by_rotor)
    for joint, origin in DRIVES["parameters"][parameters].get("origins", {}).items():
        model.jointPlacements[model.getJointId(joint)].translation = np.array(origin["xyz"])
    for link, change in DRIVES["parameters"][parameters].get("links", {}).items():
        model.inertias[model.frames[model.getFrameId(link)].parentJoint].lever = np.array(change["com"])
    return model


def viscous_and_coulomb(parameters: str = "rtb") -> tuple[Array, Array]:
    """Friction at the joint: N m s/rad, shape (6,), and N m by direction, shape (6, 2)."""
    ratio = drive(parameters, "gear_ratio")
    return drive(parameters, "viscous_friction") * ratio**2, (
        drive(parameters, "coulomb_friction") * np.abs(ratio)[:, None]
    )


def friction(v: Array, parameters: str = "rtb") -> Array:
    """Friction torque of joint velocities (..., 6) by the law in the actuator file's head."""
    viscous, coulomb = viscous_and_coulomb(parameters)
    return viscous * v + np.where(v > 0, coulomb[:, 0], np.where(v < 0, coulomb[:, 1], 0.0))


def torques(model: pin.Model, q: Array, v: Array, a: Array) -> Array:
    """RNEA, without friction, of samples (n, 6)."""
    data = model.createData()
    return np.array([pin.rnea(model, data, *sample).copy() for sample in zip(q, v, a, strict=True)])


def inertia_matrix(model: pin.Model, q: Array) -> Array:
    """Joint-space inertia: Pinocchio fills the upper triangle."""
    upper = np.triu(pin.crba(model, model.createData(), q))
    return np.asarray(upper + np.triu(upper, 1).T)


def placement(model: pin.Model, q: Array, frame: str) -> pin.SE3:
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    assert model.existFrame(frame)
    return data.oMf[model.getFrameId(frame)]


def jacobian(model: pin.Model, q: Array, axes: pin.ReferenceFrame) -> Array:
    frame = model.getFrameId("wrist_center")
    return np.asarray(pin.computeFrameJacobian(model, model.createData(), q, frame, axes))


# Against the toolbox on 200 random configurations. Measured: 5e-16 for poses, 2e-14 N m and 2e-15 kg m^2; the
# bounds are what the package promises, far below what an angle written as 1.5708 costs (1e-5 m, 4e-5 N m).


def test_wrist_center_is_the_toolboxs_frame_6(oracle: dict[str, Array]) -> None:
    model = model_of()
    for q, expected in zip(oracle["q"], oracle["fkine"], strict=True):
        pose = placement(model, q, "wrist_center").homogeneous
        np.testing.assert_allclose(pose, expected, rtol=0, atol=1e-12)


def test_jacobian_of_wrist_center(oracle: dict[str, Array]) -> None:
    model = model_of()
    for q, world, local in zip(oracle["q"], oracle["jacob0"], oracle["jacobe"], strict=True):
        np.testing.assert_allclose(jacobian(model, q, pin.LOCAL_WORLD_ALIGNED), world, rtol=0, atol=1e-12)
        np.testing.assert_allclose(jacobian(model, q, pin.LOCAL), local, rtol=0, atol=1e-12)


def test_torques_of_rigid_body_rotors_and_friction(oracle: dict[str, Array]) -> None:
    q, v, a = oracle["q"], oracle["qd"], oracle["qdd"]
    model = model_of()
    with_rotors = torques(model, q, v, a)
    np.testing.assert_allclose(with_rotors, oracle["tau_motor"], rtol=0, atol=1e-9)
    np.testing.assert_allclose(with_rotors + friction(v), oracle["tau_full"], rtol=0, atol=1e-9)
    model.armature = np.zeros(6)
    np.testing.assert_allclose(torques(model, q, v, a), oracle["tau_rigid"], rtol=0, atol=1e-9)
    np.testing.assert_allclose(torques(model, q, 0 * v, 0 * a), oracle["gravload"], rtol=0, atol=1e-9)


def test_inertia_matrix(oracle: dict[str, Array]) -> None:
    model = model_of()
    for q, expected in zip(oracle["q"], oracle["M_motor"], strict=True):
        np.testing.assert_allclose(inertia_matrix(model, q), expected, rtol=0, atol=1e-9)


# Against published values, to the printed digits: half a unit of the last one.


def half_unit(case: dict[str, Any]) -> float:
    return float(0.5 * 10.0 ** -case["decimals"])


@pytest.mark.parametrize("case", PUBLISHED["inverse_dynamics"])
def test_published_inverse_dynamics(case: dict[str, Any]) -> None:
    model, q, v, a = model_of(), POSES[case["pose"]], np.array(case["v"]), np.array(case["a"])
    model.gravity.linear = np.array(case.get("gravity", [0.0, 0.0, -9.81]))
    wrench = np.array(case.get("wrench_on_world", np.zeros(6)))
    tau = torques(model, q[None], v[None], a[None])[0] + friction(v)
    tau += jacobian(model, q, pin.LOCAL).T @ wrench
    np.testing.assert_allclose(tau, case["torque"], rtol=0, atol=half_unit(case))


@pytest.mark.parametrize("case", PUBLISHED["forward_dynamics"])
def test_published_forward_dynamics(case: dict[str, Any]) -> None:
    model, v = model_of(), np.array(case["v"])
    q = np.array(case["q"]) if "q" in case else POSES[case["pose"]]
    if "torque_at" in case:
        at = case["torque_at"]
        v_at, a_at = np.array(at["v"]), np.array(at["a"])
        tau = torques(model, POSES[at["pose"]][None], v_at[None], a_at[None])[0] + friction(v_at)
    else:
        tau = np.array(case["torque"])
    acceleration = pin.aba(model, model.createData(), q, v, tau - friction(v))
    np.testing.assert_allclose(acceleration, case["acceleration"], rtol=0, atol=half_unit(case))


def test_published_inertia_jacobian_and_manipulability() -> None:
    model, q = model_of(), POSES["qn"]
    case = PUBLISHED["inertia"]
    mass_matrix = inertia_matrix(model, q)
    np.testing.assert_allclose(mass_matrix, case["matrix"], rtol=0, atol=half_unit(case))
    np.testing.assert_allclose(mass_matrix @ case["itorque_a"], case["itorque"], rtol=0, atol=half_unit(case))
    case = PUBLISHED["jacobian"]
    world = jacobian(model, q, pin.LOCAL_WORLD_ALIGNED)
    np.testing.assert_allclose(world, case["matrix"], rtol=0, atol=half_unit(case))
    case = PUBLISHED["manipulability"]
    for rows, expected in ((world, "all"), (world[:3], "translation"), (world[3:], "rotation")):
        assert math.sqrt(np.linalg.det(rows @ rows.T)) == pytest.approx(case[expected], abs=half_unit(case))


@pytest.mark.parametrize("name", PUBLISHED["wrist_center"])
def test_wrist_center_of_the_named_poses(name: str) -> None:
    pose = placement(model_of(), POSES[name], "wrist_center")
    # printed to 5 or 6 decimals
    np.testing.assert_allclose(pose.translation, PUBLISHED["wrist_center"][name], rtol=0, atol=5e-7)
    # Puma560.py's DH table: z6 = +z in qz and qr, turned by -90 degrees about y in qs, +x in qn
    axis = {"qz": [0, 0, 1], "qr": [0, 0, 1], "qs": [1, 0, 0], "qn": [1, 0, 0]}[name]
    np.testing.assert_allclose(pose.rotation[:, 2], axis, rtol=0, atol=1e-12)


@pytest.mark.parametrize("case", PUBLISHED["ik_qn"], ids=lambda case: case["rtb_python"])
def test_the_eight_inverse_kinematics_solutions(case: dict[str, Any], oracle: dict[str, Array]) -> None:
    """They reach qn's pose, are the toolbox's to the printed digits, and bear the right names."""
    model, q = model_of(), np.array(case["q"])
    target = placement(model, POSES["qn"], "wrist_center").homogeneous
    # 6 printed decimals, lever arms below 1 m, six joints
    np.testing.assert_allclose(placement(model, q, "wrist_center").homogeneous, target, rtol=0, atol=3e-6)
    meta = json.loads(str(oracle["meta"]))
    row = meta["ik_config_order"].index(case["rtb_python"])
    computed = oracle["named_ik"][list(oracle["named_names"]).index("qn"), row]
    difference = np.angle(np.exp(1j * (q - computed)))
    np.testing.assert_allclose(difference, 0, rtol=0, atol=1e-6)
    assert case["rtb_python"][:2] == case["rtb_matlab"][:2] == case["arm"][0] + case["elbow"][0]
    assert {case["rtb_python"][2], case["rtb_matlab"][2]} == {"n", "f"}
    assert (case["rtb_python"][2] == "n") == (q[4] < 0)
    lower, upper = model.lowerPositionLimit, model.upperPositionLimit
    wraps = np.array([q - 2 * math.pi, q, q + 2 * math.pi])
    assert ((wraps >= lower) & (wraps <= upper)).any(axis=0).all() == case["within_limits"]


# Frames, limits, geometry, form.


def test_frames() -> None:
    model, q = model_of(), np.array([0.3, -0.2, 0.5, 0.7, -0.4, 1.1])
    assert placement(model, q, "base_link").isIdentity(0)
    shoulder = pin.SE3(np.eye(3), np.array([0, 0, SHOULDER_HEIGHT]))
    assert placement(model, q, "shoulder_base").isApprox(shoulder, 1e-15)
    wrist, flange = placement(model, q, "wrist_center"), placement(model, q, "flange")
    assert wrist.isApprox(placement(model, q, "link6"), 1e-15)
    # flange face: Corke 1996, Lee
    assert wrist.actInv(flange).isApprox(pin.SE3(np.eye(3), np.array([0, 0, 0.05625])), 1e-14)


def test_limits() -> None:
    """Position: mdl_puma560.m. Effort and velocity: Corke 1996, tables 2.17 and 2.21, as in set `corke`."""
    model = model_of()
    degrees = np.array([[-160, 160], [-45, 225], [-225, 45], [-110, 170], [-100, 100], [-266, 266]])
    np.testing.assert_array_equal(model.lowerPositionLimit, np.radians(degrees[:, 0]))
    np.testing.assert_array_equal(model.upperPositionLimit, np.radians(degrees[:, 1]))
    np.testing.assert_array_equal(model.upperEffortLimit, [56, 97, 52, 10, 10, 10])
    np.testing.assert_array_equal(model.upperVelocityLimit, [1.92, 1.51, 2.40, 5.34, 5.09, 5.74])
    corke = DRIVES["limits"]["corke"]
    np.testing.assert_array_equal(model.upperEffortLimit, [corke["effort"][name] for name in JOINTS])
    np.testing.assert_array_equal(model.upperVelocityLimit, [corke["velocity"][name] for name in JOINTS])


def test_limit_sets_name_only_what_their_source_prints() -> None:
    limits = DRIVES["limits"]
    assert {name: set(table) - {"source"} for name, table in limits.items()} == {
        "corke": {"effort", "velocity"},
        "akb": {"effort"},
        "benchmark": {"velocity", "acceleration", "jerk"},
    }
    assert "not manufacturer's" in limits["benchmark"]["source"]
    # Armstrong, Khatib, Burdick 1986, table 7
    assert list(limits["akb"]["effort"].values()) == [97.6, 186.4, 89.4, 24.2, 20.1, 21.3]
    degrees = {
        "velocity": [100, 95, 100, 150, 130, 110],
        "acceleration": [45, 40, 75, 70, 90, 80],
        "jerk": [60, 60, 55, 70, 75, 70],
    }
    for quantity, values in degrees.items():
        np.testing.assert_array_equal(list(limits["benchmark"][quantity].values()), np.radians(values))
        assert tuple(limits["benchmark"][quantity]) == JOINTS


@pytest.mark.parametrize("name", ["qz", "qr", "qs"])
def test_no_link_touches_another(name: str) -> None:
    """All pairs of shapes on different links, neighbours included."""
    model = model_of()
    shapes = pin.buildGeomFromUrdf(model, str(URDF), pin.GeometryType.COLLISION)
    shapes.addAllCollisionPairs()  # none within one body
    data = shapes.createData()
    assert {shape.parentJoint for shape in shapes.geometryObjects} == set(range(7))
    assert len(shapes.collisionPairs) > 100
    pin.computeCollisions(model, model.createData(), shapes, data, POSES[name], False)
    touching = [
        (shapes.geometryObjects[pair.first].name, shapes.geometryObjects[pair.second].name)
        for pair, result in zip(shapes.collisionPairs, data.collisionResults, strict=True)
        if result.isCollision()
    ]
    assert touching == []


def test_what_is_drawn_is_what_is_checked_for_collision() -> None:
    for link in ET.parse(URDF).getroot().findall("link"):
        drawn, checked = (
            [[ET.tostring(part).strip() for part in shape if part.tag != "material"] for shape in link.findall(kind)]
            for kind in ("visual", "collision")
        )
        assert drawn == checked


def test_the_urdf_is_spelled_out() -> None:
    """Pinocchio takes a misspelt or missing attribute for a default, silently: everything is written down."""
    root = ET.parse(URDF).getroot()
    expected = {
        "origin": {"xyz", "rpy"},
        "axis": {"xyz"},
        "limit": {"lower", "upper", "effort", "velocity"},
        "inertia": {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"},
        "mass": {"value"},
    }
    for element in root.iter():
        assert set(element.attrib) == expected.get(element.tag, set(element.attrib)), element.tag
    for joint in root.findall("joint"):
        moving = {"axis", "limit"} if joint.get("type") == "revolute" else set()
        assert {child.tag for child in joint} == {"parent", "child", "origin"} | moving
    assert root.get("name") == DRIVES["robot"] == "puma560"
    assert DRIVES["schema"] == 1
    assert model_of().existFrame(DRIVES["tool"])


# The AKB set: Armstrong, Khatib, Burdick 1986.


def test_akb_gravity_constants() -> None:
    """Their equation for joint 2's gravity torque holds exactly, and its constants are their table A3.

    In the toolbox's angles (q_akb = q + (pi, pi, pi, 0, 0, pi)):
    tau_2 = -g1 c2 + g2 s23 - g3 s2 + g4 c23 + g5 (s23 c5 + c23 c4 s5).
    The sign of link 4's centre of mass shows in g2: as RTB has it, g2 would be -8.760.
    """
    model = model_of("akb")
    data = model.createData()
    q = np.random.default_rng(1986).uniform(-math.pi, math.pi, (40, 6))
    tau_2 = np.array([pin.computeGeneralizedGravity(model, data, sample)[1] for sample in q])
    s23, c23 = np.sin(q[:, 1] + q[:, 2]), np.cos(q[:, 1] + q[:, 2])
    wrist = s23 * np.cos(q[:, 4]) + c23 * np.cos(q[:, 3]) * np.sin(q[:, 4])
    terms = np.column_stack([-np.cos(q[:, 1]), s23, -np.sin(q[:, 1]), c23, wrist])
    g, *_ = np.linalg.lstsq(terms, tau_2)
    np.testing.assert_allclose(terms @ g, tau_2, rtol=0, atol=1e-11)  # rounding of 40 N m
    case = PUBLISHED["akb_gravity"]
    assert (np.abs(g - case["from_tables"]) <= [5e-4, 5e-4, 5e-5, 5e-6, 5e-6]).all()  # half of the last digit
    # The printed ones fit 9.8 m/s^2, to half of the last digit but for g2: -8.4456, printed -8.44.
    error = np.abs(g * 9.8 / 9.81 - case["printed"])
    assert (error <= [0.05, 0.006, 0.005, 5e-4, 5e-5]).all()


def test_akb_drives() -> None:
    model = model_of("akb")
    # I_motor, joint 3 as in table A3
    np.testing.assert_array_equal(model.armature, [1.14, 4.71, 0.827, 0.200, 0.179, 0.193])
    # d4 of table A1; link 4's centre of mass lies 19 mm from the wrist centre, towards the elbow
    wrist = model.jointPlacements[model.getJointId("joint5")].translation
    np.testing.assert_array_equal(wrist, [0, 0, 0.4331])
    np.testing.assert_allclose(wrist - model.inertias[4].lever, [0, 0, 0.019], rtol=0, atol=1e-15)
    assert np.sign(drive("akb", "gear_ratio")).tolist() == np.sign(drive("rtb", "gear_ratio")).tolist()


def test_akb_friction_is_the_toolboxs_at_the_joint() -> None:
    for akb, rtb in zip(viscous_and_coulomb("akb"), viscous_and_coulomb("rtb"), strict=True):
        np.testing.assert_allclose(akb, rtb, rtol=1e-14)  # 17 digits, a few roundings
    assert "friction is RTB's" in DRIVES["parameters"]["akb"]["note"]
