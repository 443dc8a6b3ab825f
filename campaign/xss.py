"""Names and texts that would be markup or code, in every page and picture, opened in Chromium: none comes alive."""

from __future__ import annotations

import shutil
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from importlib import import_module
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from typing import Any, Final
from xml.sax.saxutils import quoteattr

import puma_septic as ps
from campaign.arms import PUMA
from campaign.moves import POINTS
from puma_septic.cli import main

_FLAGS: Final = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
# Each marks the page where it is taken for markup or code.
PAYLOADS: Final = (
    "<script>canary=1</script>", "</script><script>canary=1</script>", "<img src=x onerror=canary=1>",
    "\"><img src=x onerror=canary=1>", "'><svg onload=canary=1>", "<svg/onload=canary=1>", "javascript:canary=1",
    "</title><script>canary=1</script>", "</style><script>canary=1</script>", "<!--<script>canary=1//-->",
    "#{canary=1}", "{{canary=1}}", "<iframe srcdoc='<script>parent.canary=1</script>'>",
    "\\u003cscript\\u003ecanary=1\\u003c/script\\u003e", "&lt;script&gt;canary=1&lt;/script&gt;",
    "<a href=http://evil.example/>x</a>", "x onmouseover=canary=1 y",
)  # fmt: skip
_ALIVE: Final = """() => [
  typeof canary !== "undefined" || "canary" in document.documentElement.dataset ? "the canary was set" : "",
  ...[...document.querySelectorAll("img[src='x'], svg[onload], a[href*='evil'], [onmouseover]")]
    .map((one) => "element: " + one.outerHTML.slice(0, 200)),
].filter(Boolean)"""


def run(count: int, _seed: int) -> tuple[Counter[str], list[str]]:
    """Of so many of the payloads, every page and SVG that the commands and functions write."""
    if find_spec("playwright") is None or _chromium() is None:
        return Counter({"no Chromium and playwright here": 1}), []
    found: Counter[str] = Counter()
    offences: list[str] = []
    with _browser() as browser, redirect_stdout(StringIO()):
        Path("alive.html").write_text(f"<p>{PAYLOADS[0]}{PAYLOADS[2]}</p>", encoding="utf-8")
        if len(_opened(browser, Path("alive.html"))) < 2:
            offences.append("a page with a living canary is not found out")
        for k, payload in enumerate(PAYLOADS[:count]):
            folder = Path(f"xss{k}")
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            for path in _pages(folder, payload):
                found[f"{path.suffix[1:]} pages"] += 1
                offences += [f"{path.name} with {payload!r}: {text}" for text in _opened(browser, path)]
    return found, offences


def _pages(folder: Path, payload: str) -> list[Path]:
    """A robot, task, labels, title and notes that are all the payload; all that is written of them."""
    text = PUMA.read_text(encoding="utf-8")
    for name in ("puma560", "joint2", "link2", "flange"):
        text = text.replace(f'"{name}"', quoteattr(f"{payload}{name}"))
    (folder / "arm.urdf").write_text(text, encoding="utf-8")
    robot = ps.load_robot(folder / "arm.urdf", tool=f"{payload}flange")
    motion = ps.compute_motion(robot, ps.quintic_segments(POINTS, [0.0, 2.0], joint_names=robot.joint_names))
    assessment = ps.assess(motion)
    pages = {
        "replay.html": ps.replay_html(motion, title=payload, labels=[payload], point_names=[payload, payload]),
        "report.html": ps.report_html(assessment, title=payload, notes=[payload], made={payload: payload}),
    }
    for name, page in pages.items():
        (folder / name).write_text(page, encoding="utf-8")
    task = ps.load_task("williams").document() | {"name": payload, "description": payload}
    task |= {"robot": {"source": "arm.urdf", "tool": f"{payload}flange"}, "profiles": ["quintic"], "times": [0, 2]}
    task["points"] = [{"name": f"{payload}{k}", "joints": list(q)} for k, q in enumerate(POINTS)]
    task.pop("limits", None)
    import_module("ruamel.yaml").YAML(typ="safe", pure=True).dump(task, folder / "task.yaml")
    status = main(["assess", str(folder / "task.yaml"), "--no-png", "--out", str(folder / "out")])
    if status not in (0, 1, 2):
        raise RuntimeError(f"assess ends with {status} of {payload!r}")
    return [path for path in sorted(folder.rglob("*")) if path.suffix in (".html", ".svg")]


def _opened(browser: Any, path: Path) -> list[str]:
    """What came alive, was asked for elsewhere, or was complained of, when a page is opened and looked through."""
    wrong: list[str] = []
    context = browser.new_context(viewport={"width": 1000, "height": 700}, offline=True)
    page = context.new_page()
    page.on("pageerror", lambda error: wrong.append(f"error: {error}"))
    page.on("dialog", lambda dialog: (wrong.append(f"dialog: {dialog.message}"), dialog.dismiss()))
    page.on(
        "request",
        lambda request: (
            None
            if request.url.startswith(("file:", "data:", "blob:", "about:"))
            else wrong.append(f"asks {request.url}")
        ),
    )
    page.goto(path.resolve().as_uri())
    page.wait_for_timeout(300)
    page.evaluate("() => window.scrollTo(0, document.body ? document.body.scrollHeight : 0)")
    page.wait_for_timeout(200)
    for frame in page.frames:
        wrong += frame.evaluate(_ALIVE)
    context.close()
    return wrong


def _chromium() -> str | None:
    """Debian's chromium or another one, as the tests find it."""
    return next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


@contextmanager
def _browser() -> Iterator[Any]:
    with import_module("playwright.sync_api").sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=_chromium(), args=_FLAGS)
        yield chromium
        chromium.close()
