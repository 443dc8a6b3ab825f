"""What a report looks like on a phone, a desk, a wide screen and on paper, and what answers to a hand."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

import puma_septic as ps
from puma_septic.report.page import optimised_html

pytestmark = pytest.mark.browser

# Pairs of parts that overlap by more than two pixels, and tables that are wider than the box that they scroll in.
OVERLAPS = """() => {
  const kinds = "header > *, .contents, .verdict, .first > *, h3, .chart, .bars table, .tables > *";
  const parts = [...document.querySelectorAll(kinds)]
    .filter((one) => one.offsetParent !== null || one.ownerSVGElement !== undefined)
    .map((one) => [one, one.getBoundingClientRect()]).filter(([, box]) => box.width > 0 && box.height > 0);
  const found = [];
  for (const [k, [a, p]] of parts.entries()) for (const [b, q] of parts.slice(k + 1)) {
    if (a.contains(b) || b.contains(a) || a.matches(".contents") || b.matches(".contents")) continue;
    const width = Math.min(p.right, q.right) - Math.max(p.left, q.left);
    const height = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
    const names = [a, b].map((one) => one.className || one.tagName).join(" on ");
    if (width > 2 && height > 2) found.push(`${names}: ${width} x ${height}`);
  }
  return found;
}"""
CUT = """() => [...document.querySelectorAll("table")].filter((table) => {
  if (table.getBoundingClientRect().width === 0) return false;
  let box = table.parentElement;
  while (box !== document.body && getComputedStyle(box).overflowX === "visible") box = box.parentElement;
  const scrolls = ["auto", "scroll"].includes(getComputedStyle(box).overflowX);
  return !scrolls && table.getBoundingClientRect().right > document.documentElement.clientWidth + 1;
}).map((table) => table.caption ? table.caption.textContent : "a table")"""


# Words of tables that do not stand on one line.
BROKEN = """() => {
  const found = [], range = document.createRange();
  for (const cell of document.querySelectorAll("table td, table thead th")) {
    for (const text of cell.childNodes) {
      if (text.nodeType !== Node.TEXT_NODE) continue;
      for (const word of text.data.matchAll(/[^\\s-]+/g)) {
        range.setStart(text, word.index);
        range.setEnd(text, word.index + word[0].length);
        const heights = [...range.getClientRects()].map((box) => Math.round(box.top));
        if (new Set(heights).size > 1) found.push(word[0]);
      }
    }
  }
  return found;
}"""
# Charts that take no room, whatever their reason.
UNSEEN = """() => [...document.querySelectorAll("svg.chart")].filter((one) => one.getBoundingClientRect().height < 40)
  .map((one) => one.getAttribute("aria-label"))"""
OPENED = "document.querySelectorAll('details').forEach((one) => { one.open = true; })"


def _page(kind: str) -> str:
    """A report of each kind that differs in its parts."""
    robot = ps.load_robot()
    task = ps.resolve_task(ps.load_task("paper-turned"))
    septic = task.trajectories[0]
    if kind == "compared":
        return ps.report_html(ps.compare(robot, septic.points, septic.times), title=kind)
    if kind == "front":
        objectives = ("integral_of_squared_jerk", "peak_jerk")
        found = ps.pareto_front(ps.septic, septic.points, septic.times, objectives=objectives, size=4)
        return optimised_html(found, robot, title=kind)
    if kind == "executed":
        return ps.report_html(ps.execute(robot, {"septic": septic}, settle=0.5), title=kind)
    cycle = ps.cycle.with_return(ps.compute_motion(robot, septic), dwell=0.5)
    return ps.report_html(ps.size(cycle, catalogue=ps.built_in_catalogue("example")), title=kind)


KINDS = ("compared", "front", "executed", "chosen")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """The file of a kind of report, written once."""
    folder = tmp_path_factory.mktemp("kinds")

    def path(kind: str) -> Path:
        file = folder / f"{kind}.html"
        if not file.exists():
            file.write_text(_page(kind), encoding="utf-8")
        return file

    return path


@pytest.fixture(scope="module")
def file(paper: tuple[ps.Assessment, ...], tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("screens") / "report.html"
    made = {"made": "2026-01-02 03:04 UTC", "command": "puma-septic assess paper"}
    path.write_text(ps.report_html(paper, title="cell", made=made), encoding="utf-8")
    return path


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 1280, 2560])
def test_nothing_overlaps_and_no_table_is_cut(page: Page, file: Path, width: int, scheme: Any) -> None:
    """At 2560 px more than half of the screen was empty, on paper the load table lost three columns."""
    page.set_viewport_size({"width": width, "height": 900 if width < 2000 else 1440})
    page.emulate_media(color_scheme=scheme)
    page.goto(file.as_uri())
    page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate(OVERLAPS) == []
    assert page.evaluate(CUT) == []
    body = page.locator("body").bounding_box()
    assert body is not None
    assert body["width"] > 0.8 * width


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("width", [390, 1280])
def test_every_chart_of_every_report_is_seen(page: Page, made: Callable[[str], Path], kind: str, width: int) -> None:
    """Charts without a time cursor shared a class with the arm's picture for paper, which screens do not show: motor
    torque over speed, winding temperatures, ratio sweeps, tracking errors and fronts were headings with nothing below.
    """
    page.set_viewport_size({"width": width, "height": 900})
    page.goto(made(kind).as_uri())
    page.evaluate(OPENED)
    assert page.locator("svg.chart.still").count() > 0 or kind == "compared"
    assert page.evaluate(UNSEEN) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate(OVERLAPS) == []
    assert page.evaluate(CUT) == []


@pytest.mark.parametrize("kind", KINDS)
def test_on_paper_words_are_whole(page: Page, made: Callable[[str], Path], kind: str) -> None:
    """Columns of numbers were broken inside their numbers and heads ("joint / 1", "380. / 0") to fit the paper."""
    page.set_viewport_size({"width": 703, "height": 1000})
    page.goto(made(kind).as_uri())
    page.emulate_media(media="print")
    page.evaluate(OPENED)
    assert page.evaluate(UNSEEN) == []
    assert page.evaluate(OVERLAPS) == []
    assert page.evaluate(CUT) == []
    assert page.evaluate(BROKEN) == []


def test_the_first_screen_answers(page: Page, file: Path) -> None:
    """Verdict, arm, what is used of the limits and the charts of what governs, without scrolling."""
    page.set_viewport_size({"width": 1280, "height": 900})
    page.goto(file.as_uri())
    for part in (".verdict", ".scene iframe", ".matrix > table"):
        box = page.locator(part).first.bounding_box()
        assert box is not None
        assert box["y"] + box["height"] < 850
    top = page.locator(".governing").first.bounding_box()
    assert top is not None
    assert top["y"] < 720
    assert page.locator(".governing").count() == 3
    assert page.locator(".matrix td.over").count() == 3  # joints 2, 4 and 5 are beyond their positions
    assert "puma-septic assess paper" in page.locator(".made").inner_text()


def test_on_paper_nothing_is_cut(page: Page, file: Path) -> None:
    page.set_viewport_size({"width": 703, "height": 1000})  # 186 mm at 96 dpi
    page.goto(file.as_uri())
    page.wait_for_selector('iframe[data-ready="yes"]')
    expect(page.locator(".snapshot")).to_have_attribute("src", re.compile("^data:image/png;base64,"), timeout=20_000)
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator(".snapshot").is_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= 703
    assert page.evaluate(CUT) == []
    pages = page.pdf(format="A4", prefer_css_page_size=True).count(b"/Type /Page\n")
    assert pages != 1


def test_a_table_is_sorted_by_its_head(page: Page, file: Path) -> None:
    page.goto(file.as_uri())
    table = page.locator(".scroll table").first
    jerk = table.locator("th", has_text="jerk")
    jerk.click()
    column = "(one) => [...one.tBodies[0].rows].map((row) => Number(row.cells[5].textContent))"
    assert table.evaluate(column) == sorted(table.evaluate(column))
    jerk.click()
    assert table.evaluate(column) == sorted(table.evaluate(column), reverse=True)
    assert jerk.get_attribute("aria-sort") == "descending"


def test_a_profile_is_switched_off_everywhere(page: Page, file: Path) -> None:
    page.goto(file.as_uri())
    page.wait_for_selector('iframe[data-ready="yes"]')
    inner = page.frames[1]
    inner.wait_for_selector('html[data-ready="yes"]')
    page.click('.series button[data-profile="1"]')
    lines = page.locator('.charts:not(.own) polyline[data-profile="1"]')
    assert lines.count() > 10
    assert lines.first.is_hidden()
    toggle = inner.locator(".motion input").nth(1)
    expect(toggle).not_to_be_checked()
    assert not inner.evaluate("replay.viewer.scene_tree.find(['meshcat', 'motion1']).object.visible")
    page.click('.series button[data-profile="1"]')
    expect(toggle).to_be_checked()


def test_a_chart_tells_its_values_and_opens_large(page: Page, file: Path) -> None:
    page.goto(file.as_uri())
    chart = page.locator(".charts .chart.time").first
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert "septic" in page.locator(".value").inner_text()
    page.mouse.dblclick(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    large = page.locator("dialog.zoom svg")
    wide = large.bounding_box()
    assert wide is not None
    assert wide["width"] > 2 * box["width"]
    large.hover()
    page.mouse.wheel(0, -400)
    assert float((large.get_attribute("viewBox") or "").split()[2]) < 300
    page.keyboard.press("Escape")
    assert large.is_hidden()


def test_legend_and_curves_have_one_colour(page: Page, file: Path) -> None:
    page.goto(file.as_uri())
    for k in range(3):
        curve = page.locator(f'.charts:not(.own) polyline[data-profile="{k}"]').first
        sample = page.locator(f'.series button[data-profile="{k}"] line')
        bar = page.locator(f'.bar[data-profile="{k}"] i').first
        colours = {
            curve.evaluate("(one) => getComputedStyle(one).stroke"),
            sample.evaluate("(one) => getComputedStyle(one).stroke"),
            bar.evaluate("(one) => getComputedStyle(one).backgroundColor"),
        }
        assert len(colours) == 1


def test_the_replay_runs_from_the_page(page: Page, file: Path) -> None:
    page.goto(file.as_uri())
    page.wait_for_selector('iframe[data-ready="yes"]')
    page.click(".timebar .play")
    expect(page.locator(".timebar .play")).to_have_attribute("aria-label", "pause")
    expect(page.locator(".timebar output")).not_to_have_text("0.00 s")
    page.click(".timebar .play")
    expect(page.locator(".timebar .play")).to_have_attribute("aria-label", "play")
