"""Joints that mimic another one, and joints that are locked: one coordinate, both torques at the master."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from helpers.arms import joint, link, load
from helpers.places import PANDA
from hypothesis import given, settings
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic.dynamics import mass_matrix
from puma_septic.robot._mimic import Mimic, followed, visiting_order
from puma_septic.validation import Array

BODY = np.diag([0.02, 0.02, 0.01])


def mimicking(text: str, master: str, *, multiplier: float = 1.0, offset: float = 0.0) -> str:
    tag = f'<mimic joint="{master}" multiplier="{multiplier!r}" offset="{offset!r}"/></joint>'
    return text.replace("</joint>", tag)


def chain(*links: str) -> str:
    return "".join(link(name, 2.0, [0.0, 0.05, 0.15], BODY) for name in links)


def parallelogram(names: tuple[str, str] = ("lever", "rod")) -> str:
    """Three axes; a lever on the first link follows the third joint, and a rod on the lever turns back."""
    one, two = names
    return (
        chain("base", "l1", "l2", "l3", "lever", "rod")
        + joint("j1", "revolute", "base", "l1", [0, 0, 0.3], [0, 0, 1])
        + joint("j2", "revolute", "l1", "l2", [0, 0, 0.3], [0, 1, 0])
        + joint("j3", "revolute", "l2", "l3", [0, 0, 0.3], [0, 1, 0])
        + mimicking(joint(one, "revolute", "l1", "lever", [0, 0, 0.3], [0, 1, 0]), "j3")
        + mimicking(joint(two, "revolute", "lever", "rod", [0, 0, 0.2], [0, 1, 0]), "j3", multiplier=-1.0)
    )


def in_the_chain() -> str:
    """The third joint turns half as far as the second, from an offset, as in an IRB 5400's wrist."""
    return (
        chain("base", "l1", "l2", "l3", "l4")
        + joint("j1", "revolute", "base", "l1", [0, 0, 0.3], [0, 0, 1])
        + joint("j2", "revolute", "l1", "l2", [0, 0, 0.3], [0, 1, 0], [0.1, 0, 0])
        + mimicking(joint("j3", "revolute", "l2", "l3", [0, 0, 0.3], [0, 0.6, 0.8]), "j2", multiplier=-0.5, offset=0.3)
        + joint("j4", "prismatic", "l3", "l4", [0, 0, 0.3], [1, 0, 0])
    )


def projected(robot: ps.Robot, text: str, q: Array, v: Array, a: Array) -> tuple[Array, Array]:
    """Torque and tool by the model of all joints with the coupling written out: ``q = A u + b``, ``tau = A^T tau``."""
    full = pin.buildModelFromXML(f'<robot name="full">{text}</robot>')
    data, names = full.createData(), list(full.names)[1:]
    A, b = np.zeros((len(names), robot.n_joints)), np.zeros(len(names))
    for row, name in enumerate(names):
        mimic = robot.mimics.get(name, Mimic(master=name))
        A[row, robot.joint_index(mimic.master)], b[row] = mimic.multiplier, mimic.offset
    tau = A.T @ pin.rnea(full, data, A @ q + b, A @ v, A @ a)
    pin.framesForwardKinematics(full, data, A @ q + b)
    return tau, data.oMf[full.getFrameId(robot.tool, pin.FrameType.BODY)].homogeneous


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
@pytest.mark.parametrize("text", [parallelogram(), parallelogram(("a_lever", "a_rod")), in_the_chain()])
def test_torque_and_tool_are_those_of_the_coupled_model(
    tmp_path_factory: pytest.TempPathFactory, text: str, seed: int
) -> None:
    """Also where Pinocchio's order of siblings would visit a lever before the joint that it follows."""
    robot = load(tmp_path_factory.mktemp("arm"), "mimic", text)
    assert robot.model.nv == robot.n_joints == 3
    q, v, a = np.random.default_rng(seed).uniform(-1, 1, (3, 3))
    torque, tool = projected(robot, text, q, v, a)
    assert ps.inverse_dynamics(robot, q, v, a) == pytest.approx(torque, rel=1e-12, abs=1e-12)  # rounding of 20 N m
    assert ps.forward_kinematics(robot, q) == pytest.approx(tool, abs=1e-14)
    step = 1e-6
    for j in range(3):
        moved = [ps.forward_kinematics(robot, q + sign * step * np.eye(3)[j])[:3, 3] for sign in (1, -1)]
        slope = (moved[0] - moved[1]) / (2 * step)
        assert ps.jacobian(robot, q)[:3, j] == pytest.approx(slope, abs=1e-8)  # of a central difference
    bias = ps.inverse_dynamics(robot, q, v, np.zeros(3))
    assert mass_matrix(robot, q[None])[0] @ a + bias == pytest.approx(torque, rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("kinds", ["continuous revolute", "revolute continuous", "continuous continuous",
                                   "prismatic revolute", "revolute prismatic"])  # fmt: skip
def test_joints_of_any_kind_follow_each_other(tmp_path: Path, kinds: str) -> None:
    """Pinocchio refuses a revolute joint that mimics a continuous one, and the other way round."""
    master, follower = kinds.split()
    text = (
        chain("base", "l1", "l2", "l3")
        + joint("j1", master, "base", "l1", [0, 0, 0.3], [0, 0.6, 0.8])
        + mimicking(joint("j2", follower, "l1", "l2", [0, 0, 0.3], [0, 1, 0]), "j1", multiplier=-0.5, offset=0.2)
        + joint("j3", "revolute", "l2", "l3", [0, 0, 0.3], [0, 1, 0])
    )
    robot = load(tmp_path, "mixed", text)
    q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, 2))
    torque, tool = projected(robot, text.replace("continuous", "revolute"), q, v, a)
    assert ps.inverse_dynamics(robot, q, v, a) == pytest.approx(torque, rel=1e-12, abs=1e-12)
    assert ps.forward_kinematics(robot, q) == pytest.approx(tool, abs=1e-14)
    assert robot.is_continuous.tolist() == [master == "continuous", False]


@pytest.mark.parametrize("text", [parallelogram(), in_the_chain()])
def test_many_samples_are_computed_as_one(tmp_path: Path, text: str) -> None:
    """Of mimicking joints Pinocchio's crba adds to the matrix that a Data object holds from the call before."""
    robot = load(tmp_path, "mimic", text)
    q, v, a = np.random.default_rng(2).uniform(-1, 1, (3, 40, 3))
    alone = [ps.inverse_dynamics(robot, *row) for row in zip(q, v, a, strict=True)]
    assert ps.inverse_dynamics(robot, q, v, a) == pytest.approx(np.array(alone), rel=1e-13, abs=1e-13)
    matrices = [mass_matrix(robot, row[None])[0] for row in q]
    assert mass_matrix(robot, q) == pytest.approx(np.array(matrices), rel=1e-14, abs=1e-14)


def test_the_tool_moves_as_its_positions_do(tmp_path: Path) -> None:
    robot = load(tmp_path, "mimic", in_the_chain())
    q, v, a = np.random.default_rng(1).uniform(-1, 1, (3, 3))
    motion, step = ps.tool_motion(robot, q, v, a), 1e-4
    places = [ps.forward_kinematics(robot, q + t * v + t * t / 2 * a)[:3, 3] for t in (-step, 0.0, step)]
    assert motion.velocity == pytest.approx((places[2] - places[0]) / (2 * step), abs=1e-7)
    assert motion.acceleration == pytest.approx((places[2] - 2 * places[1] + places[0]) / step**2, abs=1e-6)


def test_inverse_kinematics_knows_the_coupling(tmp_path: Path) -> None:
    robot = load(tmp_path, "mimic", in_the_chain())
    target = ps.forward_kinematics(robot, [0.3, 0.5, 0.2])
    found = ps.inverse_kinematics(robot, target)
    assert found.q.shape[1] == 3
    for q in found.q:
        assert ps.forward_kinematics(robot, q) == pytest.approx(target, abs=1e-8)


def test_panda_with_hand_is_pinocchios_own_mimic_model() -> None:
    """Refused until now: 94 of 666 public arm files have such joints."""
    robot = ps.load_robot(PANDA)
    assert robot.joint_names[-1] == "panda_finger_joint1"
    assert dict(robot.mimics)["panda_finger_joint2"].master == "panda_finger_joint1"
    assert robot.tool == "panda_hand_tcp"
    model = pin.buildModelFromUrdf(str(PANDA), mimic=True)
    q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, 8))
    expected = pin.rnea(model, model.createData(), q, v, a)
    assert ps.inverse_dynamics(robot, q, v, a, friction=False) == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_a_lever_that_follows_itself_and_one_that_follows_nothing(tmp_path: Path) -> None:
    ring = parallelogram().replace('joint="j3"', 'joint="rod"', 1).replace('joint="j3"', 'joint="lever"', 1)
    with pytest.raises(ps.ModelError, match="joint 'lever' mimics itself in the end"):
        load(tmp_path, "ring", ring)
    robot = load(tmp_path, "lost", parallelogram().replace('joint="j3"', 'joint="j9"'))
    assert robot.n_joints == 5
    assert any("it mimics 'j9', which is no joint here" in note for note in robot.notes)


def test_a_joint_follows_one_that_follows_nothing(tmp_path: Path) -> None:
    """The rod mimics the lever, and the lever a joint that is not there: the rod lost what it follows, too."""
    text = parallelogram().replace('joint="j3"', 'joint="lever"').replace('joint="lever"', 'joint="j9"', 1)
    robot = load(tmp_path, "lost", text)
    assert robot.n_joints == 4
    assert {name: one.master for name, one in robot.mimics.items()} == {"rod": "lever"}
    assert [note for note in robot.notes if "which is no joint here" in note and "j9" in note]


def test_a_lever_that_turns_beyond_all_bounds_is_refused(tmp_path: Path) -> None:
    """1e308 times as fast: the joint-space inertia overflowed, and no torque was known for a reason that was none."""
    with pytest.raises(ps.ModelError, match=r"'lever' follows 'j3' by a multiplier of 1e\+308 .* at most 1e\+06"):
        load(tmp_path, "wild", parallelogram().replace('multiplier="1.0"', 'multiplier="1e308"'))


def test_chains_of_mimics_are_followed_to_their_end() -> None:
    given = {"b": Mimic(master="a", multiplier=2.0, offset=0.1), "c": Mimic(master="b", multiplier=-3.0, offset=0.2)}
    end = followed("c", given)
    assert end is not None
    assert (end.master, end.multiplier) == ("a", -6.0)
    assert end.offset == pytest.approx(-0.1)  # 0.2 - 3 * 0.1
    assert followed("a", {"a": Mimic(master="b"), "b": Mimic(master="a")}) is None


def test_branches_that_follow_each_other_have_no_order() -> None:
    tree = ({"base": ["a1", "b1"], "A": ["a2"], "B": ["b2"]}, {"a1": "A", "b1": "B", "a2": "A2", "b2": "B2"})
    assert visiting_order(tree, "base", {"b2": Mimic(master="a1")}) == ["a1", "a2", "b1", "b2"]
    assert visiting_order(tree, "base", {"a2": Mimic(master="b1")}) == ["b1", "b2", "a1", "a2"]
    assert visiting_order(tree, "base", {"a2": Mimic(master="b1"), "b2": Mimic(master="a1")}) is None


# Locked joints.


def gripper() -> str:
    """An arm of two axes; five fingers follow the sixth, as of a Robotiq; a wheel on the base."""
    text = (
        chain("base", "l1", "l2", "wheel", "f0", "f1", "f2", "f3", "f4", "f5")
        + joint("j1", "revolute", "base", "l1", [0, 0, 0.3], [0, 1, 0])
        + joint("j2", "revolute", "l1", "l2", [0, 0, 0.3], [0, 1, 0])
        + joint("spin", "continuous", "base", "wheel", [0, 1, 0], [0, 1, 0])
        + joint("f", "revolute", "l2", "f0", [0, 0.1, 0.1], [0, 1, 0])
    )
    for k in range(1, 6):
        text += mimicking(joint(f"m{k}", "revolute", "l2", f"f{k}", [0, 0.1, 0.1], [0, 1, 0]), "f")
    return text


def test_locking_a_joint_locks_what_follows_it(tmp_path: Path) -> None:
    """One message a finger: a Gen3 with a 2F-85 took five rounds, a PR2 ten."""
    robot = load(tmp_path, "gripper", gripper(), tool="l2", locked={"f": 0.4})
    assert robot.joint_names == ("j1", "j2", "spin")
    assert robot.mimics == {}
    both = load(tmp_path, "gripper", gripper(), tool="l2", locked={"f": 0.4, "m1": 0.4})
    assert both.joint_names == robot.joint_names
    assert ps.forward_kinematics(robot, [0.0] * 3, frame="f3")[0, 0] == pytest.approx(np.cos(0.4))


@pytest.mark.parametrize("locked", ["others", {"others": None}, {"f": 0.4, "others": None}])
def test_others_are_locked_in_one_go(tmp_path: Path, locked: object) -> None:
    robot = load(tmp_path, "gripper", gripper(), locked=locked)
    assert robot.tool == "l2"  # not a finger
    assert robot.joint_names == ("j1", "j2")
    assert any(note.startswith("locked, as they do not carry the tool 'l2': spin at 0") for note in robot.notes)


def test_levers_of_an_arm_are_not_among_the_others(tmp_path: Path) -> None:
    """Locking the lever's master froze an axis of the arm, as a message advised."""
    robot = load(tmp_path, "arm", parallelogram(), locked="others")
    assert robot.joint_names == ("j1", "j2", "j3")
    assert set(robot.mimics) == {"lever", "rod"}
    alone = load(tmp_path, "arm", parallelogram(), locked={"lever": 0.0, "rod": 0.0})
    assert alone.joint_names == ("j1", "j2", "j3")


def test_a_follower_in_the_tools_chain_is_not_locked_alone(tmp_path: Path) -> None:
    """Whoever did that with an IRB 5400 got a tool that was off by 23 mm and 0.5 rad, silently."""
    with pytest.raises(
        ps.InputError, match=r"locked\['j3'\]: it carries the tool 'l4' and follows 'j2'.*lock that joint"
    ):
        load(tmp_path, "arm", in_the_chain(), locked={"j3": 0.0})
    with pytest.raises(ps.InputError, match=r"follows 'j2', which puts it at 0.1"):
        load(tmp_path, "arm", in_the_chain(), locked={"j2": 0.4, "j3": 0.2})
    free, locked = load(tmp_path, "arm", in_the_chain()), load(tmp_path, "arm", in_the_chain(), locked={"j2": 0.4})
    expected = ps.forward_kinematics(free, [0.2, 0.4, 0.1])
    assert ps.forward_kinematics(locked, [0.2, 0.1]) == pytest.approx(expected, abs=1e-14)


def test_a_joint_that_carries_the_one_it_follows_is_refused(tmp_path: Path) -> None:
    """Pinocchio must have seen a joint before those that follow it."""
    body = (
        chain("base", "l1", "l2")
        + mimicking(joint("j1", "revolute", "base", "l1", [0, 0, 0.3], [0, 1, 0]), "j2")
        + joint("j2", "revolute", "l1", "l2", [0, 0, 0.3], [0, 1, 0])
    )
    with pytest.raises(ps.ModelError, match=r"'j1' one carries the joint that it follows, .*lock them: locked=\{'j1'"):
        load(tmp_path, "arm", body)


def test_what_is_no_text_for_locked(tmp_path: Path) -> None:
    with pytest.raises(ps.InputError, match="unknown text for locked 'all'; valid: 'others'"):
        load(tmp_path, "arm", parallelogram(), locked="all")


def test_certified_bounds_refuse_what_they_do_not_know(tmp_path: Path) -> None:
    """They take the torque to be affine in the sine and cosine of each joint, which a follower's motion breaks."""
    robot = load(tmp_path, "arm", parallelogram())
    with pytest.raises(
        ps.InputError, match="holding torque does not know joints that mimic another one: 'lever', 'rod'"
    ):
        ps.worst_holding_torque(robot)
    with pytest.raises(ps.InputError, match="bound of accelerations does not know joints that mimic another one"):
        ps.acceleration_limits(robot)


def with_limits(text: str, lower: float, upper: float, velocity: float) -> str:
    return text.replace('lower="-4" upper="4" velocity="20"', f'lower="{lower}" upper="{upper}" velocity="{velocity}"')


def fingers(multiplier: float, offset: float, lower: float, upper: float, velocity: float) -> str:
    """A slide of -4 to 4 m at up to 20 m/s, and one that follows it with limits of its own."""
    tip = joint("two", "prismatic", "hand", "b", [0, -0.1, 0], [0, 1, 0])
    return (
        '<link name="hand"/>'
        + link("a", 0.2, [0, 0, 0.1], 1e-3 * np.eye(3))
        + link("b", 0.2, [0, 0, 0.1], 1e-3 * np.eye(3))
        + joint("one", "prismatic", "hand", "a", [0, 0.1, 0], [0, 1, 0])
        + mimicking(with_limits(tip, lower, upper, velocity), "one", multiplier=multiplier, offset=offset)
    )


def test_a_joint_keeps_the_limits_of_those_that_follow_it(tmp_path: Path) -> None:
    """Bug: the limits of a joint that mimics another one were forgotten without a word.

    two = 0.5 - 2 one within -1 and 2: one within -0.75 and 0.75; at 6 m/s of two one moves at 3 m/s.
    """
    arm = load(tmp_path, "mimic", fingers(-2.0, 0.5, -1.0, 2.0, 6.0), tool="a")
    assert arm.limits.position.tolist() == [[-0.75, 0.75]]
    assert arm.limits.velocity.tolist() == [3.0]
    assert arm.limits.effort.tolist() == [500.0]
    assert (
        "joint 'one' is followed by 'two': its range is -0.75 to 0.75, in which that joint keeps its own" in arm.notes
    )
    assert "joint 'one' is followed by 'two': its velocity limit is 3, at which that joint keeps its own" in arm.notes
    free = load(tmp_path, "both", fingers(-2.0, 0.5, -1.0, 2.0, 6.0).replace("<mimic", "<!-- <mimic").replace(
        'offset="0.5"/>', 'offset="0.5"/> -->'), tool="a")  # fmt: skip
    for end in (0.74, 0.76):
        alone = ps.assess(arm, ps.quintic_segments([[0.0], [end]], [0.0, 1.0])).is_feasible
        both = ps.assess(free, ps.quintic_segments([[0.0, 0.5], [end, 0.5 - 2 * end]], [0.0, 1.0])).is_feasible
        assert alone == both == (end < 0.75)


def test_limits_of_a_follower_that_leave_nothing_are_told_and_not_used(tmp_path: Path) -> None:
    """As in the gripper of the PR2: the other finger mirrors the first, and has its range without the sign."""
    arm = load(tmp_path, "mimic", fingers(-1.0, 0.0, 0.0, 4.0, 50.0).replace('lower="-4"', 'lower="0"'), tool="a")
    assert arm.limits.position.tolist() == [[0.0, 4.0]]
    assert arm.limits.velocity.tolist() == [20.0]
    assert any("the position limits of that joint leave it no range and are not used" in note for note in arm.notes)
    unknown = fingers(-1.0, 0.0, -3.0, 4.0, 5.0).replace('lower="-4" upper="4" velocity="20"', "", 1)
    led = load(tmp_path, "led", unknown, tool="a")  # what is not known of the first is known of the other
    assert (led.limits.position.tolist(), led.limits.velocity.tolist()) == ([[-4.0, 3.0]], [5.0])
    for lower, upper in ((-3.0, 9.0), (-9.0, 3.0)):  # one side alone is narrower
        side = load(tmp_path, "side", fingers(1.0, 0.0, lower, upper, 20.0), tool="a")
        assert side.limits.position.tolist() == [[max(lower, -4.0), min(upper, 4.0)]]
    wide = load(tmp_path, "wide", fingers(-1.0, 0.0, -4.0, 4.0, 20.0), tool="a")
    assert not any("followed" in note for note in wide.notes)
