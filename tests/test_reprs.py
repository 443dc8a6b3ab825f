"""What values show of themselves in a notebook: tidy tables in which every name is text."""

from __future__ import annotations

from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from helpers.urdf_texts import ARM, DRIVES, load

import puma_septic as ps

HOSTILE = "<script>alert(1)</script>"


class Tables(HTMLParser):
    """Tags that were opened, and the cells of each row."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: set[str] = set()
        self.rows: list[list[str]] = []
        self._in_cell = False
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        assert not any(name.startswith("on") for name, _ in attrs)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self._in_cell = True
            self.rows[-1].append("")

    def handle_endtag(self, tag: str) -> None:
        if tag in ("td", "th"):
            self._in_cell = False

    def handle_data(self, data: str) -> None:
        if self._in_cell:
            self.rows[-1][-1] += data.strip()


def rows_of(html: str, first: str) -> list[list[str]]:
    return [row for row in Tables(html).rows if row and row[0] == first]


@pytest.fixture
def move() -> ps.Trajectory:
    return ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])


def test_robot_shows_joints_limits_and_drives(puma: ps.Robot) -> None:
    """Joint 2 of Corke's PUMA: gear ratio 107.815, 97 N m, 1.51 rad/s; its axis stands 26.45 inches above the base."""
    place, limits, drive = rows_of(puma._repr_html_(), "joint2")
    assert place == ["joint2", "revolute", "0, 0, 0.6718", "0, -1, 0"]
    assert limits == ["joint2", "-0.785398 to 3.92699", "1.51", "unknown", "unknown", "97"]
    assert drive[:3] == ["joint2", "107.815", "0.0002"]


def test_robot_names_the_sources_of_its_numbers(puma: ps.Robot) -> None:
    html = puma._repr_html_()
    assert "Corke, Visual Control of Robots, 1996" in html
    assert "Corke, Robotics Toolbox" in html


def test_axes_are_those_of_the_kinematics(puma: ps.Robot) -> None:
    """The angular part of each column of the Jacobian is the joint's axis."""
    axes = ps.jacobian(puma, np.zeros(6))[3:].T
    for name, axis in zip(puma.joint_names, axes, strict=True):
        shown = [float(part) for part in rows_of(puma._repr_html_(), name)[0][3].split(",")]
        np.testing.assert_allclose(shown, axis, atol=5e-5)  # four digits are shown


def test_a_robot_of_which_little_is_known(tmp_path: Path) -> None:
    limits, drive = rows_of(load(tmp_path, ARM)._repr_html_(), "shoulder")[1:]
    assert limits == ["shoulder", "±2", "3", "unknown", "unknown", "50"]
    assert drive == ["shoulder", "unknown", "unknown", "unknown", "unknown, unknown"]


def test_a_sliding_and_a_continuous_joint(tmp_path: Path) -> None:
    text = ARM.replace('name="shoulder" type="revolute"', 'name="shoulder" type="prismatic"')
    robot = load(tmp_path, text)
    assert rows_of(robot._repr_html_(), "shoulder")[0][1:] == ["prismatic", "0, 0, 0.5", "0, 1, 0"]
    assert "prismatic joints: m and N" in robot._repr_html_()
    turning = load(tmp_path, ARM.replace('name="elbow" type="revolute"', 'name="elbow" type="continuous"'))
    assert rows_of(turning._repr_html_(), "elbow")[1][1] == "unbounded"


def test_assessment_shows_verdict_peaks_and_margins(puma: ps.Robot, move: ps.Trajectory) -> None:
    assessment = ps.assess(puma, move)
    html = assessment._repr_html_()
    assert "puma560, quintic_segments, 2 s: feasible" in html
    motion, effort, margins = rows_of(html, "joint2")
    # 15/8 h / T
    assert motion[2] == f"0.4688 ({100 * 0.46875 / 1.51:.0f}\u00a0%)"
    assert effort[1].startswith(f"{assessment.peak_torque[1]:.4g} (")
    assert margins[2] == f"{100 * (1 - 0.46875 / 1.51):.0f}\u00a0%"
    assert margins[1] == f"{assessment.margins['position'][1]:.3g} rad"
    assert margins[3] == "not known"


def test_assessment_lists_what_is_broken_and_what_is_not_known(puma: ps.Robot, move: ps.Trajectory) -> None:
    html = ps.assess(puma.with_limits(velocity=0.1), move)._repr_html_()
    assert "infeasible, 6 limits violated" in html
    assert "Violated limits: joint1 velocity" in html
    assert "Not assessed: acceleration limit: unknown for all joints" in html


def test_an_unbounded_demand_leaves_no_margin(puma: ps.Robot) -> None:
    straight = ps.profiles.linear([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    effort = rows_of(ps.assess(puma, straight)._repr_html_(), "joint1")
    assert effort[1][1].startswith("unbounded (!)")
    assert effort[2][5] == "none"


def test_ik_solutions_show_all_branches(puma: ps.Robot) -> None:
    q = [0.3, 0.8, -2.9, 0.0, 0.7, 0.0]
    html = ps.inverse_kinematics(puma, ps.forward_kinematics(puma, q))._repr_html_()
    rows = Tables(html).rows
    assert len(rows) == 1 + 8
    assert rows[1][:8] == ["right-up-noflip", "0.3000", "0.8000", "-2.9000", "0.0000", "0.7000", "0.0000", "yes"]


def test_sizing_shows_demands_and_checks(puma: ps.Robot, move: ps.Trajectory) -> None:
    sizing = ps.size(ps.Cycle(steps=(ps.compute_motion(puma, move),)))
    html = sizing._repr_html_()
    assert "puma560, cycle of 1 steps, 2 s" in html
    assert {row[1] for row in rows_of(html, "joint2")[1:]} == {c.quantity for c in sizing.joint_checks("joint2")}


def test_names_are_text(tmp_path: Path, puma: ps.Robot, move: ps.Trajectory) -> None:
    """A robot, a joint, a source, a note and a profile that look like markup."""
    escaped = HOSTILE.replace("<", "&lt;").replace(">", "&gt;")
    text = ARM.replace("shoulder", escaped).replace('name="arm"', f'name="{escaped}"')
    robot = load(tmp_path, text)
    assert robot.joint_names[0] == robot.name == HOSTILE
    loud = replace(robot, notes=(HOSTILE,)).with_limits(replace(robot.limits, source=HOSTILE))
    steps = ps.quintic_segments([[0.0] * 2, [0.5] * 2], [0.0, 2.0])
    assessment = ps.assess(loud, replace(steps, profile=HOSTILE))
    branch = ps.inverse_kinematics(puma, ps.forward_kinematics(puma, [0.3, 0.8, -2.9, 0.0, 0.7, 0.0]))
    renamed = replace(branch, configurations=(HOSTILE, *branch.configurations[1:]))
    named = replace(puma, name=HOSTILE)
    sizing = ps.size(ps.Cycle(steps=(ps.compute_motion(named, move),)))
    for value in (loud, assessment, renamed, sizing):
        html = value._repr_html_()
        assert HOSTILE not in html
        assert escaped in html
        assert Tables(html).tags <= {
            "p",
            "strong",
            "div",
            "ul",
            "li",
            "table",
            "caption",
            "thead",
            "tbody",
            "tr",
            "th",
            "td",
        }


def test_drives_that_are_known_have_their_source(tmp_path: Path) -> None:
    (tmp_path / "arm.toml").write_text(DRIVES)
    robot = load(tmp_path, ARM, actuators=tmp_path / "arm.toml")
    html = robot._repr_html_()
    assert "catalogue" in html
    assert rows_of(html, "shoulder")[2] == ["shoulder", "-100", "0.0001", "0.001", "0.02, -0.03"]


def test_a_line_says_what_it_is() -> None:
    """Counts and spans by hand: four points from 0.5 s to 4 s, on three intervals of quintics."""
    move = ps.quintic_segments([[0.0] * 6, [1.0] * 6, [2.0] * 6, [3.0] * 6], [0.5, 1.0, 2.0, 4.0])
    facts = "joints 6, points 4, from 0.5 s, to 4 s, intervals 3>"
    assert repr(move) == f"<Trajectory: profile quintic_segments, {facts}"
    assert repr(move.position) == "<Piecewise: components 6, intervals 3, degree 5, from 0.5, to 4>"
    robot = ps.load_robot()
    for arm, payload in ((robot, "none"), (robot.with_payload(ps.Payload(mass=2.5)), "2.5 kg")):
        facts = f"profile quintic_segments, duration 3.5 s, payload {payload}, joints 6>"
        assert repr(ps.compute_motion(arm, move)) == f"<Motion: robot puma560, {facts}"
