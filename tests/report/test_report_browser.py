"""The report in a real browser: ``python -m pytest -m browser``."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Frame, Page, expect

import puma_septic as ps
from puma_septic.report._charts import BOX
from puma_septic.report.page import tasks_html
from puma_septic.task import assess_task, load_task, resolve_task

pytestmark = pytest.mark.browser

LEFT, RIGHT, TOP, BOTTOM = BOX
# Value of the first curve's dot at the cursor, read back from the picture, of the chart with this title.
VALUE = """(title) => {
  const all = [...document.querySelectorAll("svg.chart")];
  const svg = all.find((one) => one.getAttribute("aria-label").startsWith(title));
  const low = Number(svg.dataset.low), high = Number(svg.dataset.high);
  const dot = svg.querySelector(".dots circle"), cursor = svg.querySelector(".cursor");
  return {
    value: low + (BOX[3] - Number(dot.getAttribute("cy"))) / (BOX[3] - BOX[2]) * (high - low),
    range: high - low,
    share: (Number(cursor.getAttribute("x1")) - BOX[0]) / (BOX[1] - BOX[0]),
    text: svg.querySelector(".readout").textContent,
  };
}"""
SETTLED = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50))))"


@pytest.fixture(scope="module")
def file(paper: tuple[ps.Assessment, ...], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page that ``puma-septic assess --out`` writes: two tasks, three profiles each."""
    turned = resolve_task(load_task("paper-turned"))
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(tasks_html([(resolve_task(load_task("paper")), paper), (turned, assess_task(turned))]), "utf-8")
    return path


def open_file(page: Page, path: Path) -> list[str]:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(path.as_uri())
    return asked


def started_replay(page: Page) -> Frame:
    """The first task's replay, which starts when it is looked at."""
    frame = page.locator("iframe").first
    frame.scroll_into_view_if_needed()
    page.wait_for_selector('iframe[data-ready="yes"]')
    inner = frame.element_handle().content_frame()
    assert inner is not None
    inner.wait_for_selector('html[data-ready="yes"]')
    return inner


def seek(page: Page, time: float) -> None:
    """Move the slider of the first task, as a hand would."""
    page.locator(".timebar input").first.evaluate(
        "(one, time) => { one.value = time; one.dispatchEvent(new Event('input', {bubbles: true})); }", time
    )
    page.evaluate(SETTLED)


def test_loads_from_disk_without_any_request_and_shows_its_verdict(page: Page, file: Path) -> None:
    asked = open_file(page, file)
    started_replay(page)
    # srcdoc is the page itself, not a place that is asked.
    assert [url for url in asked if url != "about:srcdoc"] == [file.as_uri()]
    page.evaluate("scrollTo(0, 0)")
    box = page.locator(".verdict").first.bounding_box()
    assert box is not None
    assert box["y"] + box["height"] < 700
    assert page.locator(".verdict .word").first.inner_text() == "Infeasible"
    assert page.locator(".verdict .word").nth(1).inner_text() == "Feasible"


def test_one_cursor_moves_plots_and_replay(page: Page, file: Path, paper: tuple[ps.Assessment, ...]) -> None:
    open_file(page, file)
    replay = started_replay(page)
    page.locator("svg.chart[aria-label^='joint2: torque']").first.scroll_into_view_if_needed()
    for time in (1.0, 4.5, 7.25):
        seek(page, time)
        assert replay.evaluate("replay.time") == pytest.approx(time)
        found = page.evaluate(VALUE, "joint2: torque")
        # A hundredth of a pixel of some 300, and straight lines between samples.
        assert found["share"] == pytest.approx(time / 9.0, abs=1e-4)
        torque = float(paper[0].motion.torque(time)[1])
        assert found["value"] == pytest.approx(torque, abs=5e-4 * found["range"])
        assert float(found["text"].split()[0].replace("\u2212", "-")) == pytest.approx(torque, abs=0.5)


def test_the_replay_moves_the_plots(page: Page, file: Path) -> None:
    open_file(page, file)
    replay = started_replay(page)
    replay.evaluate("replay.seek(3.25)")
    clock = page.locator(".timebar output").first
    expect(clock).to_have_text("3.25 s")
    assert float(page.locator(".timebar input").first.input_value()) == pytest.approx(3.25)
    replay.evaluate("replay.play()")
    expect(clock).to_have_text(re.compile(r"^(3\.[3-9]|[4-9])"))


def test_the_second_task_has_its_own_time(page: Page, file: Path) -> None:
    open_file(page, file)
    seek(page, 4.0)
    times = page.evaluate("[...document.querySelectorAll('section.case')].map((one) => one.dataset.time)")
    assert times[0] == "4"
    assert times[1] is None or float(times[1]) == 0.0


def test_a_finger_on_a_plot_moves_the_cursor(page: Page, file: Path) -> None:
    open_file(page, file)
    chart = page.locator("svg.chart[aria-label^='joint1: velocity']").first
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    assert box is not None
    middle = (LEFT + RIGHT) / 2 / 360
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.4 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + middle * box["width"], box["y"] + 0.4 * box["height"])
    page.mouse.up()
    # A pixel is 9 s / 300.
    assert float(page.locator("section.case").first.get_attribute("data-time") or "nan") == pytest.approx(4.5, abs=0.04)


def test_a_time_asked_for_before_the_replay_starts_is_kept(page: Page, file: Path) -> None:
    open_file(page, file)
    seek(page, 5.0)
    replay = started_replay(page)
    page.evaluate(SETTLED)
    assert replay.evaluate("replay.time") == pytest.approx(5.0)
    assert page.locator(".timebar output").first.inner_text() == "5.00 s"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_and_curves_are_legible(page: Page, file: Path, scheme: Any) -> None:
    """Contrast as WCAG 2.1 defines it: text at least 4.5, curves at least 2 beside their dashes and labels."""
    page.emulate_media(color_scheme=scheme)
    open_file(page, file)
    colours = page.evaluate(
        """() => {
          const of = (selector, name) => getComputedStyle(document.querySelector(selector))[name];
          return {
            back: of("body", "backgroundColor"),
            text: [
              of("body", "color"), of(".quiet", "color"), of(".chart text", "fill"), of(".broken .number", "color"),
            ],
            curves: [".blue", ".vermilion", ".green", ".ink"].map((one) => of("polyline" + one, "stroke")),
          };
        }"""
    )
    back = luminance(colours["back"])
    assert (back < 0.1) == (scheme == "dark")
    assert min(contrast(back, luminance(one)) for one in colours["text"]) >= 4.5
    assert min(contrast(back, luminance(one)) for one in colours["curves"]) >= 2


def luminance(colour: str) -> float:
    share = np.array([float(part) for part in colour[4:-1].split(",")]) / 255
    linear = np.where(share <= 0.03928, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def contrast(one: float, other: float) -> float:
    return (max(one, other) + 0.05) / (min(one, other) + 0.05)


@pytest.mark.parametrize("width", [320, 390, 768])
def test_a_phone_shows_it_without_scrolling_sideways(page: Page, file: Path, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 844})
    open_file(page, file)
    page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate("document.querySelector('.chart').getBoundingClientRect().width") > 0.8 * min(width, 360)


def test_long_hostile_names_are_text_and_do_not_widen_a_phone(
    page: Page, tmp_path: Path, paper: tuple[ps.Assessment, ...]
) -> None:
    """An alert would be a complaint, which fails the test."""
    title = "<script>alert(1)</script><img src=x onerror=alert(2)>" + "a" * 60
    path = ps.write_report(tmp_path / "report.html", paper[0], title=title)
    page.set_viewport_size({"width": 390, "height": 844})
    open_file(page, path)
    assert page.locator("h1").inner_text() == title
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert started_replay(page).locator("#title").inner_text() == title


def test_printed_it_shows_everything_and_no_controls(page: Page, file: Path) -> None:
    open_file(page, file)
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator("iframe").first.is_hidden()
    assert page.locator(".timebar input").first.is_hidden()
    assert page.evaluate("[...document.querySelectorAll('details')].every((one) => one.open)")
    assert page.pdf().startswith(b"%PDF")


def test_without_scripts_it_still_reads(browser: Browser, file: Path) -> None:
    context = browser.new_context(java_script_enabled=False, offline=True)
    page = context.new_page()
    page.goto(file.as_uri())
    assert page.locator(".verdict .word").first.inner_text() == "Infeasible"
    assert "need JavaScript" in page.locator("body").inner_text()
    context.close()
