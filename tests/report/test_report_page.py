"""The report without a browser: what is in the page, and that it asks nobody for anything."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.urdf_texts import ARM, load
from hypothesis import given
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic.assessment import Assessment
from puma_septic.errors import ModelError
from puma_septic.pictures import Curve, Panel, assessment_pictures, chart, profile_line
from puma_septic.report import page
from puma_septic.report._charts import BOX, Chart, ticks
from puma_septic.report._sections import reason
from puma_septic.report.svg import picture_svg
from puma_septic.task import ResolvedTask, load_task, make_task, resolve_task
from puma_septic.views import profiles

HOSTILE = "<script>alert(1)</script>"
LEFT, RIGHT, TOP, BOTTOM = BOX
Assessed = tuple[ResolvedTask, tuple[Assessment, ...]]


@pytest.fixture(scope="module")
def html(paper_task: Assessed) -> str:
    return page.tasks_html([paper_task])


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """No replay, which most tests do not look at."""
    monkeypatch.setattr(page, "replay_html", lambda *_, **__: "<p>replay</p>")


def move(n: int = 6) -> ps.Trajectory:
    return ps.quintic_segments([[0.0] * n, [0.5] * n], [0.0, 2.0])


class Page(HTMLParser):
    """Tags with their attributes, and the text outside of scripts and styles."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self._skipped = 0
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self._skipped += tag in ("script", "style")

    def handle_endtag(self, tag: str) -> None:
        self._skipped -= tag in ("script", "style")

    def handle_data(self, data: str) -> None:
        if not self._skipped:
            self.text += f" {data}"


def words(html: str) -> str:
    return " ".join(Page(html).text.split())


def inputs_of(html: str) -> Any:
    found = re.search("<pre>(.*?)</pre>", html, re.DOTALL)
    assert found is not None
    return json.loads(unescape(found[1]))


# ---- what it says


def test_the_verdict_comes_first_in_one_sentence(html: str) -> None:
    text = words(html)
    sentence = (
        "None of the 3 profiles keeps the limits; governing: joint5 position -1.989 rad at t = 0 s is 0.2441 rad beyond"
        " its bound -1.745 rad (septic)."
    )
    assert text.index("Infeasible") < text.index(sentence) < text.index("Limit utilisation")
    assert "All 8 branches of the inverse kinematics violate the position limit of joint5 at take and place" in text


def test_it_has_every_part(html: str) -> None:
    headings = re.findall("<(?:h3|summary)[^>]*>([^<]*)<", html)
    assert headings == [
        "Limit utilisation", "Torque", "Torque by cause: septic", "Torque by cause: lspb",
        "Torque by cause: quintic_segments", "Torque-speed plane", "Tool", "Distance to singular postures", "Position",
        "Velocity", "Acceleration", "Jerk", "Numbers", "Assumptions and sources", "Reproduce this report", "Inputs",
    ]  # fmt: skip
    text = words(html)
    assert f"puma-septic {ps.__version__}" in text
    assert "acceleration limit: unknown for all joints" in text
    assert "Corke, Visual Control of Robots, 1996" in text
    assert "Margins: what is left of the limit" in text


def test_its_inputs_repeat_it(html: str, paper_task: Assessed) -> None:
    again = make_task(inputs_of(html), origin=paper_task[0].task.origin)
    assert resolve_task(again).points.tolist() == paper_task[0].points.tolist()


@pytest.mark.usefixtures("quick")
def test_a_report_of_a_motion_has_the_inputs_of_its_profile(puma: ps.Robot) -> None:
    html = ps.report_html(ps.assess(puma, move()), title="shelf")
    inputs = inputs_of(html)
    assert inputs[0]["points"] == move().points.tolist()
    assert inputs[0]["times"] == [0.0, 2.0]
    assert "keeps every known limit" in words(html)


def test_verdicts_of_several_profiles(puma: ps.Robot) -> None:
    good, bad = ps.assess(puma, move()), ps.assess(puma.with_limits(velocity=0.1), move())
    assert profiles.sentence([good.to_dict()] * 2, ["a", "b"]).startswith(
        "All 2 profiles keep every known limit; governing: "
    )
    mixed = profiles.sentence([good.to_dict(), bad.to_dict()], ["a", "b"])
    assert mixed == (
        "a keeps every known limit, b not; governing: joint1 velocity 0.4688 rad/s at t = 1 s is 468.8 % of 0.1 rad/s"
        " (b)."
    )


def test_verdict_without_a_known_limit(tmp_path: Path) -> None:
    robot = load(tmp_path, ARM).with_limits(
        position=np.full((2, 2), np.nan), velocity=np.nan, effort=np.nan, acceleration=np.nan, jerk=np.nan
    )
    sentence = profiles.sentence([ps.assess(robot, move(2)).to_dict()], ["quintic"])
    assert sentence == "quintic keeps every known limit; no limit of this robot is known."


def test_an_unbounded_demand_governs(puma: ps.Robot) -> None:
    straight = ps.profiles.linear([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    assert "joint1 acceleration unbounded at t = 0 s" in profiles.sentence(
        [ps.assess(puma, straight).to_dict()], ["linear"]
    )


def test_no_reason_where_a_branch_fits() -> None:
    assert reason(resolve_task(load_task("paper-turned"))) == ""


# ---- what it may not do


def test_no_outside_address_is_in_it(html: str) -> None:
    # Names of XML vocabularies are not addresses that anything is fetched from.
    addresses = set(re.findall(r"[a-z]+://[^\s\"'<>\\)]*", html)) - {"http://www.w3.org/2000/svg"}
    assert addresses == set()
    for tag, attributes in Page(html).tags:
        assert tag not in ("object", "embed", "base", "form")
        for name in ("src", "href"):
            assert (attributes.get(name) or "#").startswith(("#", "data:"))


def test_its_policy_forbids_requests(html: str) -> None:
    (policy,) = [one["content"] for tag, one in Page(html).tags if one.get("http-equiv") == "Content-Security-Policy"]
    assert policy is not None
    assert policy.startswith("default-src 'none';")
    assert "http" not in policy


def test_it_is_small(html: str) -> None:
    assert len(html.encode()) < 6e6


def test_the_same_assessment_is_the_same_page(paper_task: Assessed, html: str) -> None:
    assert page.tasks_html([paper_task]) == html


def test_names_are_text(tmp_path: Path) -> None:
    """Robot, joint, tool, task, point, description, profile, source and note that look like markup; with the replay."""
    escaped = HOSTILE.replace("<", "&lt;").replace(">", "&gt;")
    text = ARM
    for name in ("shoulder", "tip"):
        text = text.replace(f'"{name}"', f'"{escaped}{name}"')
    (tmp_path / "arm.urdf").write_text(text.replace('name="arm"', f'name="{escaped}"'))
    task = make_task(
        {
            "name": HOSTILE,
            "description": HOSTILE,
            "robot": {"source": str(tmp_path / "arm.urdf"), "tool": f"{HOSTILE}tip"},
            "points": [{"name": HOSTILE, "joints": [0.0, 0.0]}, {"name": "</title>", "joints": [0.5, 3.0]}],
            "times": [0.0, 1.0],
            "profiles": ["quintic_segments"],
        }
    )
    resolved = resolve_task(task)
    robot = replace(resolved.robot, notes=(HOSTILE,)).with_limits(replace(resolved.robot.limits, source=HOSTILE))
    trajectory = replace(resolved.trajectories[0], profile=HOSTILE)
    html = page.tasks_html([(resolved, [ps.assess(robot, trajectory)])])
    assert HOSTILE not in html
    tags = Counter(tag for tag, _ in Page(html).tags)
    assert tags["script"] == 3  # the replay's text, the instants, and the page's own
    assert HOSTILE in Page(html).text
    assert all("<script" not in svg for svg in figures([ps.assess(robot, trajectory)], [HOSTILE]).values())


def test_an_arm_that_cannot_be_drawn_is_still_reported(puma: ps.Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any, **__: Any) -> str:
        raise ModelError("mesh 'arm.stl' cannot be read")

    monkeypatch.setattr(page, "replay_html", refuse)
    html = ps.report_html(ps.assess(puma, move()))
    assert "Not drawn: mesh &#39;arm.stl&#39; cannot be read" in html
    assert "<iframe" not in html


# ---- of other answers


@pytest.mark.usefixtures("quick")
def test_report_of_a_comparison_has_all_profiles_and_draws_the_best(puma: ps.Robot) -> None:
    comparison = ps.compare(puma, [[0.0] * 6, [0.2] * 6, [0.5] * 6, [0.6] * 6], [0.0, 1.0, 2.0, 3.0])
    html = ps.report_html(comparison)
    names = [row.name for row in comparison.profiles]
    assert len(names) > 6
    assert all(f"<td>{name}" in html for name in names)
    drawn = re.findall("<h4>([^<]*)</h4>", html)
    assert len(drawn) == 6
    assert set(drawn) >= set(comparison.recommended)
    assert drawn[2:] == [name for name in comparison.ranking if name not in drawn[:2]][:4]
    assert "Drawn, of " in words(html)
    assert f"Feasible {comparison.advice}" in words(html)


@pytest.mark.usefixtures("quick")
def test_reports_of_comparisons_and_sizings_have_their_charts(puma: ps.Robot) -> None:
    """They were drawn by matplotlib alone, so that a report had tables of them only."""
    points = [[0.0] * 6, [0.2] * 6, [0.5] * 6, [0.6] * 6]
    compared = charts_of(ps.report_html(ps.compare(puma, points, [0.0, 1.0, 2.0, 3.0], profiles=["quintic", "septic"])))
    # After the charts of the three limits that are used most.
    assert compared[3:5] == [("velocity: peak [rad/s]", "chart bars"), ("acceleration: peak [rad/s²]", "chart bars")]
    sized = charts_of(ps.report_html(ps.size(ps.Cycle(steps=[ps.compute_motion(puma, move())]))))
    # What has nothing to do with the motion's time has no dots that follow it.
    assert sized[3] == ("joint1: motor torque [N m] vs. motor speed [1/min]", "chart still")
    assert ("joint1: limit utilisation [%]", "chart bars") in sized


def charts_of(html: str) -> list[tuple[str | None, str | None]]:
    found = [given for tag, given in Page(html).tags if tag == "svg" and "aria-label" in given]
    return [(given["aria-label"], given["class"]) for given in found]


@pytest.mark.usefixtures("quick")
def test_report_of_a_sizing_has_its_own_verdict(puma: ps.Robot) -> None:
    sizing = ps.size(ps.cycle.with_return(ps.compute_motion(puma, move()), dwell=0.5))
    text = words(ps.report_html(sizing, title="shelf"))
    assert "Feasible The drives are strong enough as far as is known; governing limit: joint" in text
    # The cycle as it is, and not its two ways as two motions that begin together.
    assert re.findall("<h4>([^<]*)</h4>", ps.report_html(sizing))[0] == "cycle"


@pytest.mark.slow
@pytest.mark.usefixtures("quick")
def test_report_of_the_paper_has_its_claims() -> None:
    report = ps.paper.reproduce(runs=1)
    text = words(ps.report_html(report))
    assert text.startswith("The paper's claims - report The paper's claims Claims judged Of the paper's 13 claims")
    for claim in report.claims:
        assert f"{claim.number} {claim.text}" in text
        assert " ".join(claim.explanation.split()) in text


# ---- bad input


@pytest.mark.usefixtures("quick")
def test_written_once_and_never_overwritten(tmp_path: Path, puma: ps.Robot) -> None:
    target = tmp_path / "report.html"
    assert ps.write_report(target, ps.assess(puma, move())) == target
    before = target.read_bytes()
    with pytest.raises(ps.InputError, match=r"report\.html exists; nothing is overwritten"):
        ps.write_report(target, ps.assess(puma, move()))
    assert target.read_bytes() == before


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("missing/report.html", "cannot be written: .*missing is not a folder"),
        ("file/report.html", "cannot be written: .*file is not a folder"),
        ("x" * 300, "cannot be written: File name too long"),
        ("a\0b", "cannot be written: .*embedded null"),
    ],
)
def test_a_place_that_cannot_be_written(tmp_path: Path, puma: ps.Robot, name: str, message: str) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ps.InputError, match=message):
        ps.write_report(tmp_path / name, ps.assess(puma, move()))


def test_what_is_no_assessment(puma: ps.Robot, tmp_path: Path) -> None:
    with pytest.raises(ps.InputError, match="made of one assessment or a sequence of them, got"):
        ps.report_html([])
    with pytest.raises(ps.InputError, match="made of one assessment or a sequence of them, got"):
        ps.report_html([move()])  # type: ignore[list-item]
    with pytest.raises(ps.InputError, match="a report is of one arm; got joints"):
        ps.report_html([ps.assess(puma, move()), ps.assess(load(tmp_path, ARM), move(2))])
    with pytest.raises(ps.InputError, match="at least one task"):
        page.tasks_html([])


# ---- charts


def figures(assessments: Sequence[Assessment], labels: Sequence[str]) -> dict[str, str]:
    return {picture.name: picture_svg(picture) for picture in assessment_pictures(assessments, labels)}


def drawn(title: str, *, y_label: str = "q [rad]", remark: str = "") -> Chart:
    curve = Curve(x=np.array([0.0, 1.0]), y=np.array([0.0, 1.0]), line=profile_line(0))
    return Chart(panel=chart("time", [curve], title=title, y_label=y_label, remark=remark))


def test_curves_are_where_their_values_are(paper_task: Assessed) -> None:
    """Read back from the picture; a hundredth of a pixel is 1/14,000 of its height."""
    (velocity,) = [one for one in assessment_pictures(paper_task[1][:1], ["septic"]) if one.name == "velocity"]
    for j, panel in enumerate(velocity.panels):
        x, y = points_of(panel).T
        t = 9.0 * (x - LEFT) / (RIGHT - LEFT)
        low, high = panel.y_range
        v = low + (BOTTOM - y) / (BOTTOM - TOP) * (high - low)
        exact = paper_task[1][0].motion.trajectory(np.clip(t, 0, 9), order=1)[:, j]
        np.testing.assert_allclose(v, exact, atol=3e-4 * (high - low))


def points_of(panel: Panel) -> np.ndarray:
    ((_, points),) = Chart(panel=panel).lines
    return np.array([pair.split(",") for pair in points.split()], dtype=float)


def test_steps_of_the_jerk_are_upright_lines(paper_task: Assessed) -> None:
    """mstraj's jerk steps at the ends of its blends, here at 1.5 s; and at both ends of the motion, from rest."""
    (jerk,) = [one for one in assessment_pictures(paper_task[1][1:2], ["lspb"]) if one.name == "jerk"]
    x, y = points_of(jerk.panels[1]).T
    upright = x[:-1][(np.diff(x) == 0) & (np.abs(np.diff(y)) > 1)]
    times = 9.0 * (upright - LEFT) / (RIGHT - LEFT)
    for expected in (0.0, 0.5, 1.5, 2.5, 9.0):
        assert np.abs(times - expected).min() < 1e-3  # a hundredth of a pixel is 0.3 ms


def test_a_long_title_is_cut_where_it_would_run_into_something() -> None:
    assert drawn("a" * 40).short_title == "a" * 40
    assert drawn("a" * 60).short_title == "a" * 44 + "…"
    assert drawn("a" * 60).panel.title == "a" * 60
    beside = drawn("a" * 30, remark="b" * 20)
    assert (beside.short_title, beside.short_remark) == ("a" * 24 + "…", "b" * 20)
    long = drawn("joint1", remark="unbounded: " + ", ".join(["profile"] * 9))
    assert long.short_title == "joint1"
    assert len(long.short_title + long.short_remark + long.panel.y_label) == 52


@given(st.floats(-1e6, 1e6), st.floats(1e-6, 1e6))
def test_ticks_are_few_round_and_inside(low: float, size: float) -> None:
    high = low + size
    if high - low < 1e-9 * max(abs(low), abs(high)):
        return
    found = [value for value, _ in ticks(low, high)]
    assert 2 <= len(found) <= 7
    # Rounding of the values, which may be a million times the span.
    slack = 1e-6 * (high - low)
    assert low - slack <= found[0] < found[-1] <= high + slack


# ---- SVG files


def test_figures_stand_alone(paper_task: Assessed) -> None:
    """Without variables in the style sheet, which drawing programs do not know, and well-formed."""
    found = figures(paper_task[1][:1], ["septic"])
    assert set(found) == {
        "utilisation", "torque", "torque-split-septic", "torque-speed", "tool", "singularity",
        "position", "velocity", "acceleration", "jerk",
    }  # fmt: skip
    for name, svg in found.items():
        assert "var(" not in svg
        tags = [tag for tag, _ in Page(svg).tags]
        assert tags[0] == "svg"
        assert ("rect" if name == "utilisation" else "polyline") in tags
