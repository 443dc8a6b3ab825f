"""Relations between answers: what leaves a question as it is leaves its answer, over public functions of all rooms.

No number here is known beforehand: the same motion later, an arm with a joint's axis turned round, one whose text has
its joints in another order, one that stands elsewhere.
"""

from __future__ import annotations

import math
import re
import tomllib
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from helpers.places import UR5

import puma_septic as ps
from puma_septic.pictures import assessment_pictures
from puma_septic.report import samples_csv
from puma_septic.simulation import worst_stop

TIMES = np.array([0.0, 0.9, 2.0, 3.0])
POINTS = np.array([
    [0.0, 0.6, -2.2, 0.0, 0.3, 0.0],
    [0.2, 0.9, -2.4, 0.1, 0.45, 0.05],
    [0.75, 0.9, -2.4, 0.15, 0.45, 0.25],
    [0.5, 0.6, -2.2, 0.0, 0.3, 0.0],
])  # fmt: skip
URDF = Path(__file__).parents[1] / "urdf" / "puma560.urdf"
ACTUATORS = URDF.with_name("puma560_actuators.toml")
Question = Callable[[ps.Robot, ps.Trajectory], Any]


def back_and_forth(motion: ps.Motion) -> ps.Cycle:
    return ps.cycle.with_return(motion, dwell=0.3)


QUESTIONS: dict[str, Question] = {
    "assess": lambda robot, move: ps.assess(robot, move, dwell=0.2, floor=0.1).to_dict(),
    "check_trajectory": lambda robot, move: ps.check_trajectory(robot, move).to_dict(),
    "minimum_duration": lambda robot, move: ps.minimum_duration(ps.compute_motion(robot, move)).to_dict(),
    "maximum_payload": lambda robot, move: ps.maximum_payload(ps.compute_motion(robot, move)).to_dict(),
    "least_stretch": lambda robot, move: ps.least_stretch(robot, move).assessment.to_dict(),
    "stop": lambda robot, move: stopped(ps.compute_motion(robot, move)),
    "worst_stop": lambda robot, move: worst_stop(ps.compute_motion(robot, move), instants=5).durations.tolist(),
    "assess_many": lambda robot, move: [getattr(ps.assess_many(robot, [move]), name).tolist() for name in MANY],
    "size": lambda robot, move: sized(ps.size(back_and_forth(ps.compute_motion(robot, move)))),
    "residual_vibration": lambda _robot, move: ps.residual_vibration(move, [2.0, 5.0]).tolist(),
}
MANY = ("peak_velocity", "peak_torque", "rms_torque", "peak_torque_time")
BOUNDED = ("quintic_spline", "bang_bang")


def stopped(motion: ps.Motion) -> list[Any]:
    stop = ps.stop(motion, motion.trajectory.breaks[0] + 1.4)
    return [stop.duration, *stop.distance.tolist()]


def sized(sizing: ps.Sizing) -> list[Any]:
    return [(c.joint, c.quantity, c.demand) for c in sizing.checks]


def made(robot: ps.Robot, profile: str, *, points: np.ndarray[Any, Any] = POINTS) -> ps.Trajectory:
    own = [int(name.removeprefix("joint")) - 1 for name in robot.joint_names]
    trajectory: ps.Trajectory = getattr(ps.profiles, profile)(points[:, own], TIMES, joint_names=robot.joint_names)
    return trajectory


def leaves(value: Any, where: str = "") -> Iterator[tuple[str, Any]]:
    """Every value of a document, lists of joints by their names."""
    if isinstance(value, dict):
        for key, one in value.items():
            yield from leaves(one, f"{where}.{key}")
    elif isinstance(value, (list, tuple)):
        for k, one in enumerate(value):
            yield from leaves(one, f"{where}[{label(one, k)}]")
    else:
        yield where, value


def label(one: Any, k: int) -> Any:
    if not isinstance(one, dict) or not {"joint", "name"} & set(one):
        return k
    return f"{one.get('joint', one.get('name'))} {one.get('quantity', '')}"


def differences(one: Any, other: Any, *, later: float = 0.0, without: tuple[str, ...] = ()) -> list[str]:
    """What differs of two answers by more than a millionth, where instants may be later."""
    first, second = dict(leaves(one)), dict(leaves(other))
    assert first
    found = []
    for key in sorted(first.keys() | second.keys()):
        a, b = first.get(key, "nothing"), second.get(key, "nothing")
        if not any(word in key for word in without) and not same(a, b) and not (later and same(a, b, later)):
            found.append(f"{key}: {a!r:.80} and {b!r:.80}")
    return found


def same(a: Any, b: Any, later: float = 0.0) -> bool:
    if isinstance(a, str) and isinstance(b, str):
        return re.sub(r"t = \S+ s", "", a) == re.sub(r"t = \S+ s", "", b)
    if isinstance(a, float) and isinstance(b, float):
        return math.isclose(b, a + later, rel_tol=1e-6, abs_tol=1e-6) or (math.isnan(a) and math.isnan(b))
    return bool(a == b)


# ---- the same motion, later


@pytest.mark.parametrize("late", [*(pytest.param(t, marks=pytest.mark.slow) for t in (-7.0, 1e4)), 100.0])
@pytest.mark.parametrize("question", QUESTIONS)
def test_a_motion_that_begins_later_has_the_same_answers(puma: ps.Robot, question: str, late: float) -> None:
    """Law: only instants move. Bugs of this kind: friction that reversed at other instants, stops without an answer."""
    for profile in BOUNDED:
        move = made(puma, profile)
        answers = (QUESTIONS[question](puma, one) for one in (move, move.shifted(late)))
        assert not differences(*answers, later=late)


@pytest.mark.slow
@pytest.mark.parametrize("late", [-7.0, 100.0, 1.7e9])
def test_pictures_and_samples_of_a_motion_that_begins_later(puma: ps.Robot, late: float) -> None:
    """Bug: figures, reports and CSV refused such motions, as "must share their breaks"."""
    move = made(puma, "quintic_spline")
    one, other = ps.assess(puma, move), ps.assess(puma, move.shifted(late))
    first, second = (assessment_pictures([each], ["septic"]) for each in (one, other))
    assert [picture.name for picture in first] == [picture.name for picture in second]
    rows = [np.genfromtxt(samples_csv(each).splitlines()[1:], delimiter=",") for each in (one, other)]
    assert rows[0].shape == rows[1].shape
    # A clock of this century has 2e-7 s between two instants.
    np.testing.assert_allclose(rows[1][:, 0] - late, rows[0][:, 0], atol=1e-6)
    np.testing.assert_allclose(rows[1][:, 2:20], rows[0][:, 2:20], atol=1e-4)


# ---- the same arm, told otherwise


def told(folder: Path, change: Callable[[ET.Element, dict[str, Any]], None], **options: Any) -> ps.Robot:
    """The PUMA of a URDF and an actuator file that are changed."""
    root, drives = ET.parse(URDF).getroot(), tomllib.loads(ACTUATORS.read_text())
    change(root, drives)
    (folder / "arm.urdf").write_text(ET.tostring(root, encoding="unicode"))
    lines = [f'schema = 1\nrobot = "{root.get("name")}"\ntool = "flange"\ndefault_parameters = "rtb"\n']
    lines.append('default_limits = "corke"\n[parameters.rtb]\nsource = "test"\n')
    for name, one in drives["parameters"]["rtb"]["joints"].items():
        lines.append(f"[parameters.rtb.joints.{name}]\n" + "".join(f"{key} = {value}\n" for key, value in one.items()))
    limits = drives["limits"]["corke"]
    lines.append('[limits.corke]\nsource = "test"\n')
    for quantity in ("effort", "velocity"):
        each = ", ".join(f"{name} = {value}" for name, value in limits[quantity].items())
        lines.append(f"{quantity} = {{ {each} }}\n")
    (folder / "arm.toml").write_text("".join(lines))
    return ps.load_robot(folder / "arm.urdf", actuators=folder / "arm.toml", **options)


def untouched(_root: ET.Element, _drives: dict[str, Any]) -> None:
    pass


FLIPPED = ("joint1", "joint2", "joint4")
# Signs and bounds of the joint's own coordinate, and what a PUMA alone is told of its postures.
OF_THE_COORDINATE = ("position", "sign", "holding", "remarks", "singularities", ".q[", "checks[", "margins[")


def flipped(root: ET.Element, drives: dict[str, Any]) -> None:
    """Axes the other way round: bounds and friction swap sides."""
    for element in root.iter("joint"):
        if element.get("name") not in FLIPPED:
            continue
        axis, limit = element.find("axis"), element.find("limit")
        assert axis is not None
        assert limit is not None
        axis.set("xyz", " ".join(repr(0.0 - float(x)) for x in axis.get("xyz", "").split()))
        lower, upper = (float(limit.get(side, "nan")) for side in ("lower", "upper"))
        limit.set("lower", repr(-upper))
        limit.set("upper", repr(-lower))
    for name in FLIPPED:
        one = drives["parameters"]["rtb"]["joints"][name]
        one["gear_ratio"] *= -1
        one["coulomb_friction"] = [-x for x in reversed(one["coulomb_friction"])]


@pytest.mark.slow
@pytest.mark.parametrize("question", QUESTIONS)
def test_an_arm_whose_axes_point_the_other_way_has_the_same_answers(tmp_path: Path, question: str) -> None:
    """Law: forwards and backwards change places, and with them the two levels of Coulomb friction."""
    (tmp_path / "other").mkdir()
    arm, other = told(tmp_path, untouched), told(tmp_path / "other", flipped)
    sign = np.where(np.isin(arm.joint_names, FLIPPED), -1.0, 1.0)
    for profile in BOUNDED:
        moves = made(arm, profile), made(other, profile, points=POINTS * sign)
        answers = [QUESTIONS[question](robot, move) for robot, move in zip((arm, other), moves, strict=True)]
        assert not differences(*answers, without=OF_THE_COORDINATE)


@pytest.mark.parametrize("question", ["assess", "check_trajectory", "minimum_duration", "maximum_payload"])
def test_an_arm_whose_text_has_the_wrist_first_has_the_same_answers(tmp_path: Path, question: str) -> None:
    """Law: each joint's answer stays with its name. Bugs of this kind: chosen drives, tables of stops."""

    def wrist_first(root: ET.Element, _drives: dict[str, Any]) -> None:
        joints = root.findall("joint")
        for element in joints:
            root.remove(element)
        root.extend(reversed(joints))

    (tmp_path / "other").mkdir()
    arm, other = told(tmp_path, untouched), told(tmp_path / "other", wrist_first)
    assert other.joint_names == arm.joint_names[::-1]
    answers = [QUESTIONS[question](robot, made(robot, "bang_bang")) for robot in (arm, other)]
    assert not differences(*answers, without=("joint_names", "remarks"))


def standing(text: str, place: str, turn: str) -> str:
    """A URDF whose base is fixed to a world somewhere."""
    root = ET.fromstring(text)
    children = {child.get("link") for child in root.iter("child")}
    base = next(link.get("name", "") for link in root.findall("link") if link.get("name") not in children)
    ET.SubElement(root, "link", name="nowhere")
    mount = ET.SubElement(root, "joint", name="nowhere_mount", type="fixed")
    for tag, given in (
        ("parent", {"link": "nowhere"}),
        ("child", {"link": base}),
        ("origin", {"xyz": place, "rpy": turn}),
    ):
        ET.SubElement(mount, tag, given)
    return ET.tostring(root, encoding="unicode")


def test_an_arm_that_stands_elsewhere_under_gravity_that_is_turned_with_it(tmp_path: Path) -> None:
    """Law: torque, heights against gravity, the stops of its table and the poses that it reaches go with the arm."""
    turn = pin.rpy.rpyToMatrix(0.7, -0.4, 1.1)
    (tmp_path / "moved.urdf").write_text(standing(UR5.read_text(), "0.3 -0.2 0.7", "0.7 -0.4 1.1"))
    arm = ps.load_robot(UR5)
    other = ps.load_robot(tmp_path / "moved.urdf", tool=arm.tool, gravity=turn @ [0.0, 0.0, -9.81])
    move = ps.profiles.quintic_spline(POINTS, TIMES, joint_names=arm.joint_names)
    one, moved = ps.assess(arm, move), ps.assess(other, move)
    np.testing.assert_allclose(moved.peak_torque, one.peak_torque, rtol=1e-9)
    np.testing.assert_allclose(moved.tool.peak_speed, one.tool.peak_speed, rtol=1e-9)
    up = turn @ [0.0, 0.0, 1.0] @ [0.3, -0.2, 0.7]
    np.testing.assert_allclose(np.array(moved.tool.height_range) - up, one.tool.height_range, atol=1e-9)
    assert moved.lowest.height - up == pytest.approx(one.lowest.height, abs=1e-9)
    pose = ps.forward_kinematics(arm, POINTS[1])
    there = np.eye(4)
    there[:3, :3], there[:3, 3] = turn, [0.3, -0.2, 0.7]
    found, also = ps.inverse_kinematics(arm, pose), ps.inverse_kinematics(other, there @ pose)
    assert found.configurations == also.configurations
    np.testing.assert_allclose(also.q, found.q, atol=1e-9)
    tables = [ps.simulation.stop_table(robot, load=2.0, fractions=(0.5, 1.0)) for robot in (arm, other)]
    assert tables[1].reach == pytest.approx(tables[0].reach, rel=1e-6)


def larger(k: float) -> Callable[[ET.Element, dict[str, Any]], None]:
    """An arm of k times the lengths and k^3 times the masses, that takes sqrt(k) times as long."""

    def change(root: ET.Element, drives: dict[str, Any]) -> None:
        powers = {"mass": ("value", 3.0), "origin": ("xyz", 1.0), "box": ("size", 1.0), "limit": ("effort", 4.0)}
        for element in root.iter():
            if element.tag in powers and powers[element.tag][0] in element.attrib:
                name, power = powers[element.tag]
                element.set(name, " ".join(repr(float(x) * k**power) for x in element.get(name, "").split()))
            if element.tag == "inertia":
                element.attrib.update({name: repr(float(x) * k**5) for name, x in element.attrib.items()})
            if "velocity" in element.attrib:
                element.set("velocity", repr(float(element.get("velocity", "nan")) / k**0.5))
        for one in drives["parameters"]["rtb"]["joints"].values():
            one["rotor_inertia"] *= k**5
            one["viscous_friction"] *= k**4.5
            one["coulomb_friction"] = [x * k**4 for x in one["coulomb_friction"]]
        limits = drives["limits"]["corke"]
        for quantity, power in (("effort", 4.0), ("velocity", -0.5)):
            limits[quantity] = {name: x * k**power for name, x in limits[quantity].items()}

    return change


@pytest.mark.parametrize("k", [0.05, 30.0])
def test_an_arm_of_another_size_uses_as_much_of_its_limits(tmp_path: Path, k: float) -> None:
    """Law: lengths k, masses k^3 and times sqrt(k) have torques of k^4 under the same gravity (equal Froude numbers).

    No floor, tolerance or start of a search is a length, a mass or a torque: 4 cm or 26 m of reach, 1e-7 or 1e8 N m.
    """
    (tmp_path / "other").mkdir()
    arm, other = told(tmp_path, untouched), told(tmp_path / "other", larger(k))
    for profile in BOUNDED:
        move = made(arm, profile)
        slower = made(other, profile).stretched(k**0.5)
        motions = ps.compute_motion(arm, move), ps.compute_motion(other, slower)
        one, two = (ps.assess(motion, dwell=0.2 * t) for motion, t in zip(motions, (1.0, k**0.5), strict=True))
        np.testing.assert_allclose(two.peak_torque, one.peak_torque * k**4, rtol=1e-9)
        np.testing.assert_allclose(two.rms_torque, one.rms_torque * k**4, rtol=1e-9)
        used = [[(c.joint, c.quantity, c.utilisation) for c in each.checks if not c.is_range] for each in (one, two)]
        assert used[1] == [(joint, quantity, pytest.approx(share, rel=1e-9)) for joint, quantity, share in used[0]]
        fastest, same = (ps.minimum_duration(motion).duration for motion in motions)
        assert same == pytest.approx(fastest * k**0.5, rel=1e-9)
        most, equal = (ps.maximum_payload(motion).mass for motion in motions)
        assert equal == pytest.approx(most * k**3, rel=1e-9)
        shares = [[c.utilisation for c in ps.size(back_and_forth(m)).checks] for m in motions]
        np.testing.assert_allclose(shares[1], shares[0], rtol=1e-9)
    found, also = (ps.inverse_kinematics(one, ps.forward_kinematics(one, POINTS[1])) for one in (arm, other))
    assert also.configurations == found.configurations
    np.testing.assert_allclose(also.q, found.q, atol=1e-9)


# ---- backwards, and divided


def test_backwards_a_motion_takes_the_same_torque_but_for_its_friction(puma: ps.Robot) -> None:
    """Law: velocities change their sign, accelerations do not."""
    motion = ps.compute_motion(puma, made(puma, "quintic_spline"))
    back = ps.cycle.way_back(motion)
    t = np.linspace(0.01, 2.99, 200)
    ahead, behind = (
        one.torque(at) - one.torque_terms.viscous(at) - one.torque_terms.coulomb(at)
        for one, at in ((motion, t), (back, 3.0 - t))
    )
    np.testing.assert_allclose(behind, ahead, atol=1e-9)
    np.testing.assert_allclose(back.torque_terms.viscous(3.0 - t), -motion.torque_terms.viscous(t), atol=1e-9)


def test_two_parts_of_a_motion_one_after_the_other_are_the_whole(puma: ps.Robot) -> None:
    """Law: of a motion that rests at its points, whatever clock each part is on."""
    whole = ps.assess(puma, ps.profiles.bang_bang(POINTS, TIMES))
    parts = [ps.profiles.bang_bang(POINTS[:3], TIMES[:3] + 50.0), ps.profiles.bang_bang(POINTS[2:], TIMES[2:] - 9.0)]
    cycle = ps.Cycle(steps=tuple(ps.compute_motion(puma, part) for part in parts))
    joined = ps.assess_cycle(cycle).whole
    for name in ("peak_velocity", "peak_acceleration", "peak_torque", "peak_torque_time", "rms_torque"):
        np.testing.assert_allclose(getattr(joined, name), getattr(whole, name), rtol=1e-9)
    assert [str(check) for check in joined.checks] == [str(check) for check in whole.checks]


@pytest.mark.parametrize("factor", [0.5, 3.0])
def test_stretched_is_made_in_other_times(puma: ps.Robot, factor: float) -> None:
    """Law: and after the minimum duration nothing is left of the governing limit."""
    for profile in BOUNDED:
        move = made(puma, profile)
        again = getattr(ps.profiles, profile)(POINTS, TIMES * factor, joint_names=puma.joint_names)
        assert not differences(*(ps.assess(puma, one).to_dict() for one in (move.stretched(factor), again)))
        fastest = ps.minimum_duration(ps.compute_motion(puma, move))
        at_it = ps.assess(puma, move.stretched(fastest.duration / 3.0))
        used = max(check.utilisation for check in at_it.checks if not check.is_range)
        assert used == pytest.approx(1.0, abs=1e-9)
