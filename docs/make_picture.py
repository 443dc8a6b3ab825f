"""Make the moving picture of the README from the replay, and pictures of reports: ``python docs/make_picture.py``.

Needs the test extra (Playwright) and a Chromium. It is drawn in software, so it needs no screen.
"""

from __future__ import annotations

import io
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import sync_playwright

import puma_septic as ps
from puma_septic.task import assess_task, load_task, resolve_task

WIDTH, HEIGHT = 960, 600
PER_SECOND = 10
FLAGS = ["--no-sandbox", "--disable-background-networking", "--use-gl=angle", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader"]  # fmt: skip


def main(target: Path) -> None:
    """The paper's points with the tool turned: the septic, and LSPB beside it as a ghost, at true speed."""
    task = resolve_task(load_task("paper-turned"))
    assessments = assess_task(task)[:2]
    duration = assessments[0].motion.trajectory.duration
    with tempfile.TemporaryDirectory() as folder:
        title = "PUMA 560: pick and place"
        page = ps.write_replay(Path(folder) / "replay.html", assessments, title=title, point_names=task.names)
        frames = photographed(page, np.linspace(0.0, duration, round(PER_SECOND * duration) + 1))
    # The last one stays for a while before it starts again.
    waits = [round(1000 / PER_SECOND)] * (len(frames) - 1) + [1500]
    frames[0].save(target, save_all=True, append_images=frames[1:], duration=waits, loop=0, quality=62, method=6)
    sys.stdout.write(f"{target}: {target.stat().st_size / 1e6:.2f} MB, {len(frames)} frames\n")


def photographed(page: Path, times: np.ndarray) -> list[Image.Image]:
    """The page at each of the times."""
    found = shutil.which("chromium") or shutil.which("google-chrome")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=FLAGS)
        view = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT}, reduced_motion="reduce")
        view.goto(page.as_uri())
        view.wait_for_selector('html[data-ready="yes"]')
        view.add_style_tag(content="#hint, #tools { display: none } #controls { display: none !important }")
        frames = []
        for t in times:
            view.evaluate("t => replay.seek(t)", float(t))
            view.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
            frames.append(Image.open(io.BytesIO(view.screenshot())).convert("RGB"))
        browser.close()
    return frames


def pictured(page: Path, target: Path) -> None:
    """The first screen of a report, with its replay drawn."""
    found = shutil.which("chromium") or shutil.which("google-chrome")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=FLAGS)
        view = browser.new_page(viewport={"width": 1280, "height": 860}, reduced_motion="reduce")
        view.goto(page.as_uri())
        view.wait_for_selector('iframe[data-ready="yes"]')
        view.frames[1].wait_for_selector('html[data-ready="yes"]')
        view.locator(".timebar input").first.evaluate(
            "(one) => { one.value = 3.6; one.dispatchEvent(new Event('input', {bubbles: true})); }"
        )
        view.wait_for_timeout(4000)
        Image.open(io.BytesIO(view.screenshot())).convert("RGB").save(target, optimize=True)
        browser.close()


def reports(images: Path) -> None:
    """Of an assessed task, and of profiles compared."""
    task = resolve_task(load_task("paper-turned"))
    own = [choice.name for choice in task.task.profiles]
    compared = ps.compare(task.robot, task.points, task.times, own=own)
    with tempfile.TemporaryDirectory() as folder:
        for name, what in (("report", assess_task(task)), ("compared", compared)):
            pictured(ps.write_report(Path(folder) / f"{name}.html", what, title=name), images / f"{name}.png")


if __name__ == "__main__":
    images = Path(__file__).parent / "images"
    reports(images)
    main(images / "replay.webp")
