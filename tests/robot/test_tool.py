"""Which frame is taken for the tool where nobody names one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.arms import joint, link, load

import puma_septic as ps

BODY = np.diag([0.02, 0.02, 0.01])
SLIDES = joint("finger_joint", "prismatic", "l2", "finger", [0, 0, 0.3], [0, 1, 0])


def chain(*names: str) -> str:
    return "".join(link(name, 1.0, [0.0, 0.0, 0.1], BODY) for name in ("base", "l1", "l2", *names))


def arm(*names: str) -> str:
    """Two axes; links with these names."""
    return (
        chain(*names)
        + joint("j1", "revolute", "base", "l1", [0, 0, 0.3], [0, 0, 1])
        + joint("j2", "revolute", "l1", "l2", [0, 0, 0.3], [0, 1, 0])
    )


def fixed(name: str, parent: str = "l2") -> str:
    return f'<joint name="to_{name}" type="fixed"><parent link="{parent}"/><child link="{name}"/></joint>'


@pytest.mark.parametrize(
    ("names", "more", "tool"),
    [
        (["tool0", "ee_link", "finger"], [fixed("tool0"), fixed("ee_link"), SLIDES], "tool0"),
        (["palm_tcp", "finger"], [fixed("palm_tcp"), SLIDES], "palm_tcp"),
        (["end_effector", "flange"], [fixed("end_effector"), fixed("flange")], "end_effector"),
        (["flange", "camera"], [fixed("camera"), fixed("flange")], "flange"),
        (["finger"], [SLIDES], "l2"),
        (["thumb", "other"], [joint("g", "revolute", "l2", "thumb", [0, 0, 1], [0, 1, 0]), fixed("other")], "other"),
        (["quill"], [joint("z", "prismatic", "l2", "quill", [0, 0, 0], [0, 0, -1])], "quill"),
        (["tool0", "l3"], [fixed("tool0", "base"), joint("j3", "revolute", "l2", "l3", [0, 0, 1], [1, 0, 0])], "l3"),
    ],
    ids=["tool0", "tcp", "end effector", "flange", "no finger", "no thumb", "quill of a SCARA", "not on the base"],
)
def test_the_tool_is_where_a_tool_is_mounted(tmp_path: Path, names: list[str], more: list[str], tool: str) -> None:
    """It was the finger of Fetch, Jaco, Panda, YuMi, Baxter and PR2: payload and inverse kinematics were a finger's."""
    robot = load(tmp_path, "arm", arm(*names) + "".join(more))
    assert robot.tool == tool
    assert robot.tool_is_chosen
    assert any(note.startswith(f"tool frame {tool!r}: ") and "tool=... names another" in note for note in robot.notes)
    named = load(tmp_path, "arm", arm(*names) + "".join(more), tool="l1")
    assert (named.tool, named.tool_is_chosen) == ("l1", False)
    assert not robot.with_tool("l2").tool_is_chosen


@pytest.mark.parametrize("first", ["hand", "probe"])
def test_an_arm_on_a_rail_is_none_that_slides_its_tool(tmp_path: Path, first: str) -> None:
    """Of two ends as far out the one behind a sliding joint is not the tool; the rail below both does not matter."""
    ends = {
        "hand": joint("j3", "revolute", "l2", "hand", [0, 0, 0.3], [1, 0, 0]),
        "probe": joint("z", "prismatic", "l2", "probe", [0, 0, 0.3], [0, 0, 1]),
    }
    names = sorted(ends, key=lambda name: name != first)
    rail = arm(*names).replace('name="j1" type="revolute"', 'name="j1" type="prismatic"')
    assert rail != arm(*names)
    assert load(tmp_path, "arm", rail + "".join(ends[name] for name in names)).tool == "hand"


@pytest.mark.parametrize(
    ("name", "tool"),
    [("panda", "panda_hand_tcp"), ("kinova", "j2s6s200_end_effector"), ("ur5", "tool0"), ("so100", "gripper"),
     ("baxter", "right_gripper"), ("xarm7", "link_eef"), ("z1", "gripperStator")],
)  # fmt: skip
def test_tools_of_public_robots(name: str, tool: str) -> None:
    assert ps.load_robot(name).tool == tool


def test_a_locked_arm_of_two_has_not_the_tool(tmp_path: Path) -> None:
    two = (
        chain("r1", "r2")
        + joint("j1", "revolute", "base", "l1", [0, 0, 0.3], [0, 0, 1])
        + joint("j2", "revolute", "l1", "l2", [0, 0, 0.3], [0, 1, 0])
        + joint("k1", "revolute", "base", "r1", [0, 1, 0.3], [0, 0, 1])
        + joint("k2", "revolute", "r1", "r2", [0, 0, 0.3], [0, 1, 0])
    )
    assert load(tmp_path, "two", two).tool == "r2"
    robot = load(tmp_path, "two", two, locked={"k1": 0.0, "k2": 0.0})
    assert (robot.tool, robot.joint_names) == ("l2", ("j1", "j2"))


def test_links_that_are_as_good_are_named(tmp_path: Path) -> None:
    """Of ends equally far out the last of the text is taken; the others are told, whatever their names."""
    for first, last in (("a_end", "b_end"), ("b_end", "a_end")):
        robot = load(tmp_path, "ends", arm(first, last) + fixed(first) + fixed(last))
        assert robot.tool == last
        note = f"tool frame {last!r}: the last link of the longest chain (as good: {first}); tool=... names another"
        assert note in robot.notes
