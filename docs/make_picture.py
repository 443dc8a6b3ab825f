"""Make the moving picture of the README from the replay: ``python docs/make_picture.py [FILE]``.

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
from puma_septic.task import assess_task, load_task

WIDTH, HEIGHT = 960, 600
PER_SECOND = 10
FLAGS = ["--no-sandbox", "--disable-background-networking", "--use-gl=angle", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader"]  # fmt: skip


def main(target: Path) -> None:
    """The paper's move with the septic, and LSPB beside it as a ghost, at true speed."""
    assessments = assess_task(load_task("paper"))[:2]
    duration = assessments[0].motion.trajectory.duration
    with tempfile.TemporaryDirectory() as folder:
        page = ps.write_replay(Path(folder) / "replay.html", assessments, title="PUMA 560: pick and place")
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
        view.add_style_tag(content="#hint { display: none } #controls { display: none !important }")
        frames = []
        for t in times:
            view.evaluate("t => replay.seek(t)", float(t))
            view.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
            frames.append(Image.open(io.BytesIO(view.screenshot())).convert("RGB"))
        browser.close()
    return frames


if __name__ == "__main__":
    default = Path(__file__).parent / "images" / "replay.webp"
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else default)
