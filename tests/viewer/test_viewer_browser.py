"""The replay in a real browser: ``python -m pytest -m browser``, with Debian's chromium or another Chromium."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, Page

import puma_septic as ps
from puma_septic.pictures import profile_line
from puma_septic.viewer._animation import ANGLE_ERROR, key_times, utilisation
from puma_septic.viewer._colours import UTILISATION, colour_at

pytestmark = pytest.mark.browser

HOSTILE = "<script>alert(1)</script>"

TOOL = """k => {
  let tool = null;
  replay.viewer.scene_tree.find(["meshcat", `motion${k}`, "arm"]).object.traverse((o) => {
    if (o.name === "tool") tool = o;
  });
  const scene = replay.viewer.scene;
  scene.updateMatrixWorld(true);
  return scene.matrixWorld.clone().invert().multiply(tool.matrixWorld).transpose().toArray();
}"""

# Pixels of the picture in the middle of a patch of one link, and that link's joint; the thin path may run across some.
PATCHES = """() => {
  const {viewer} = replay, THREE = MeshCat.THREE, pane = document.getElementById("pane");
  const width = pane.clientWidth, height = pane.clientHeight, caster = new THREE.Raycaster();
  viewer.scene.updateMatrixWorld(true);
  const all = [];
  viewer.scene_tree.find(["meshcat", "motion0", "arm"]).object.traverse((o) => { if (o.isMesh) all.push(o); });
  const first = (x, y) => {
    caster.setFromCamera({x: 2 * x / width - 1, y: 1 - 2 * y / height}, viewer.camera);
    const hit = caster.intersectObjects(all)[0];
    return hit ? hit.object : null;
  };
  const patches = [];
  for (let x = 12; x < width; x += 11) for (let y = 12; y < height; y += 11) {
    const seen = first(x + 0.5, y + 0.5);
    if (!seen || !seen.parent.name.startsWith("shape")) continue;
    if ([[3, 0], [-3, 0], [0, 3], [0, -3]].some(([a, b]) => first(x + a + 0.5, y + b + 0.5) !== seen)) continue;
    patches.push([x, y, seen.parent.parent.name]);
  }
  return patches;
}"""


@pytest.fixture(scope="module")
def file(paper: tuple[ps.Assessment, ...], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return ps.write_replay(tmp_path_factory.mktemp("replay") / "septic.html", paper[0])


def open_file(page: Page, path: Path) -> list[str]:
    """Load from disk, wait until the arm is drawn, and return the addresses that were asked for."""
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(path.as_uri())
    page.wait_for_selector('html[data-ready="yes"]')
    return asked


def picture(page: Page) -> np.ndarray:
    """What the browser shows, without the labels over the scene, (height, width, 3)."""
    page.add_style_tag(content="#labels, #hint, #tools, #corner { display: none }")
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB"), dtype=float)


def test_loads_from_disk_without_any_request(page: Page, file: Path) -> None:
    asked = open_file(page, file)
    page.evaluate("replay.seek(4.5)")
    assert asked == [file.as_uri()]
    assert page.locator("#problem").is_hidden()


def test_policy_of_the_page_refuses_requests(page: Page, file: Path, complaints: list[str]) -> None:
    open_file(page, file)
    blocked = page.evaluate(
        """() => new Promise((done) => {
          document.addEventListener("securitypolicyviolation", (event) => done(event.violatedDirective));
          new Image().src = "http://127.0.0.1:9/";
        })"""
    )
    assert blocked == "img-src"
    assert len(complaints) == 1
    assert "Content Security Policy" in complaints.pop()


@pytest.mark.parametrize("t", [1.234, 4.5, 8.9])
def test_tool_is_where_forward_kinematics_says(page: Page, file: Path, paper: Any, t: float) -> None:
    motion = paper[0].motion
    open_file(page, file)
    page.locator("#time").evaluate("(slider, t) => { slider.value = t; slider.dispatchEvent(new Event('input')); }", t)
    seen = np.reshape(page.evaluate(TOOL, 0), (4, 4))
    expected = ps.forward_kinematics(motion.robot, motion.trajectory(t))
    # Six joints, each off by ANGLE_ERROR at most between key frames, none with a lever above 1.2 m.
    np.testing.assert_allclose(seen[:3], expected[:3], atol=6 * 1.2 * ANGLE_ERROR)


def test_a_payload_is_seen_while_it_is_carried(page: Page, tmp_path: Path) -> None:
    """paper-straight carries 1 kg for 9 s and comes back with an empty hand."""
    whole = ps.resolve_cycle(ps.load_task("paper-straight")).assess().whole
    open_file(page, ps.write_replay(tmp_path / "cycle.html", whole))
    seen = """() => {
      let found = null;
      replay.viewer.scene_tree.find(["meshcat", "motion0"]).object.traverse((o) => {
        if (o.name === "payload0") found = o;
      });
      return found.visible;
    }"""
    for t, there in ((0.0, True), (8.9, True), (9.1, False), (17.0, False), (3.0, True)):
        page.evaluate(f"replay.seek({t})")
        assert page.evaluate(seen) == there, t


def test_ghosts_move_on_their_own_profiles(page: Page, paper: Any, tmp_path: Path) -> None:
    open_file(page, ps.write_replay(tmp_path / "three.html", paper))
    page.evaluate("replay.seek(3.7)")
    for k, assessment in enumerate(paper):
        robot, trajectory = assessment.motion.robot, assessment.motion.trajectory
        seen = np.reshape(page.evaluate(TOOL, k), (4, 4))
        expected = ps.forward_kinematics(robot, trajectory(3.7))
        np.testing.assert_allclose(seen[:3], expected[:3], atol=6 * 1.2 * ANGLE_ERROR)


def test_pixels_have_the_colours_of_utilisation(page: Page, paper: Any, tmp_path: Path) -> None:
    """Light changes how bright a link is, not its hue: red, green and blue keep their proportions."""
    robot = paper[0].motion.robot
    tight = robot.with_limits(effort=np.array(robot.limits.effort) * [1.0, 0.6, 0.6, 1.0, 1.0, 1.0])
    motion = ps.compute_motion(tight, paper[0].motion.trajectory)
    open_file(page, ps.write_replay(tmp_path / "tight.html", motion))
    hues = []
    for t in (0.0, 1.2, 3.0):
        t = key_times(motion)[np.argmin(np.abs(key_times(motion) - t))]
        used = utilisation(motion, np.array([t]))[0]
        page.evaluate("t => replay.seek(t)", float(t))
        pixels = picture(page)
        patches = page.evaluate(PATCHES)
        for joint in (1, 2, 3):
            seen = [pixels[y, x] for x, y, name in patches if name == f"joint{joint}"]
            if len(seen) < 8:  # hidden behind another link
                continue
            hue = np.median([colour / colour.max() for colour in seen], axis=0)
            expected = colour_at(UTILISATION, used[joint - 1])
            # A pixel has 256 steps, about 100 of them in the shade.
            np.testing.assert_allclose(hue, expected / expected.max(), atol=0.03)
            hues.append(expected)
    assert len(hues) > 5
    assert np.ptp(hues, axis=0)[1:].min() > 0.3, "all links looked the same: nothing was tested"


def test_plays_at_true_speed_pauses_and_ends(page: Page, file: Path) -> None:
    page.clock.install(time=0)
    open_file(page, file)
    page.clock.pause_at(100)

    def after(milliseconds: int) -> float:
        page.clock.fast_forward(milliseconds)  # one frame, as when a machine is slow
        return page.evaluate("replay.time")

    frame = 0.034  # two frames of a browser, s
    page.dispatch_event("#repeat", "click")  # it loops unless asked not to
    assert after(500) == 0.0
    page.dispatch_event("#play", "click")
    assert after(2000) == pytest.approx(2.0, abs=frame)
    page.dispatch_event("#play", "click")
    stopped = page.evaluate("replay.time")
    assert after(1000) == stopped
    page.select_option("#speed", "0.25")
    page.dispatch_event("#play", "click")
    assert after(2000) == pytest.approx(stopped + 0.5, abs=frame)
    page.select_option("#speed", "4")
    assert after(3000) == 9.0
    assert not page.evaluate("replay.playing")
    page.dispatch_event("#play", "click")
    assert after(500) == pytest.approx(2.0, abs=4 * frame)
    page.dispatch_event("#repeat", "click")
    assert after(3000) < 9.0
    assert page.evaluate("replay.playing")


def test_bars_and_flags_say_what_happens(page: Page, file: Path, paper: Any) -> None:
    motion = paper[0].motion
    open_file(page, file)
    page.evaluate("replay.seek(3.0)")
    shown = page.locator("#bars .bar span").all_inner_texts()
    used = utilisation(motion, np.array([3.0]))[0]
    assert [int(text.removesuffix("%")) for text in shown] == [round(100 * one) for one in used]
    assert page.locator(".motion .bad").inner_text().startswith("infeasible")
    wrist = page.locator("#flags button", has_text="wrist singularity").first
    wrist.click()
    report = next(one for one in paper[0].tool.singularities if one.kind == "wrist")
    assert page.evaluate("replay.time") == pytest.approx(report.crossings[0])
    assert page.locator("#flags button", has_text="joint5 position").count() == 1


def test_names_are_shown_as_text(page: Page, paper: Any, tmp_path: Path) -> None:
    open_file(page, ps.write_replay(tmp_path / "x.html", paper[0], title=HOSTILE, labels=[f"<b>{HOSTILE}</b>"]))
    assert page.title() == f"{HOSTILE} - replay"
    assert page.locator("h1").inner_text() == HOSTILE
    assert page.locator(".motion label").inner_text() == f"<b>{HOSTILE}</b>"


@pytest.mark.parametrize("width", [390, 1100])
def test_fits_on_a_phone_and_on_a_desk(page: Page, file: Path, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 844})
    open_file(page, file)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    for part in ("#play", "#time", "#speed", "#pane canvas"):
        box = page.locator(part).bounding_box()
        assert box is not None
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= width
    pixels = picture(page)
    box = page.locator("#pane").bounding_box()
    assert box is not None
    scene = pixels[: int(box["height"]), : int(box["width"])]
    colourful = (np.ptp(scene, axis=2) > 60).any(axis=1)
    # The coloured arm with its path takes a good part of the picture, and none of it is cut off above or below.
    assert colourful.mean() > 0.4
    assert not colourful[[0, -1]].any()


def test_a_frame_around_it_shares_its_time(page: Page, paper: Any) -> None:
    """What a notebook and a report do: the page in a closed frame, driven by messages."""
    with ps.replay(paper[0], open_browser=False) as shown:
        frame = shown._repr_html_()
    page.set_content(f"<script>var told = []; onmessage = (e) => told.push(e.data);</script>{frame}")
    inner = page.frames[1]
    inner.wait_for_selector('html[data-ready="yes"]')
    page.evaluate("document.querySelector('iframe').contentWindow.postMessage({replay: 'seek', time: 2.5}, '*')")
    page.wait_for_function("told.some((one) => one.replay === 'time' && one.time === 2.5)")
    assert inner.evaluate("replay.time") == 2.5
    page.evaluate("document.querySelector('iframe').contentWindow.postMessage({replay: 'seek', time: 'x'}, '*')")
    page.evaluate("document.querySelector('iframe').contentWindow.postMessage(null, '*')")
    assert inner.evaluate("replay.time") == 2.5


def test_live_page_shows_the_arm_and_outlives_its_server(browser: Browser, paper: Any) -> None:
    context = browser.new_context()
    page = context.new_page()
    with ps.replay(paper[0], open_browser=False) as shown:
        page.goto(shown.url)
        page.wait_for_selector('html[data-ready="yes"]')
    page.evaluate("replay.seek(2.0)")
    seen = np.reshape(page.evaluate(TOOL, 0), (4, 4))
    motion = paper[0].motion
    context.close()
    expected = ps.forward_kinematics(motion.robot, motion.trajectory(2.0))
    np.testing.assert_allclose(seen[:3], expected[:3], atol=6 * 1.2 * ANGLE_ERROR)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_paths_and_swatches_have_the_colours_of_the_curves(page: Page, paper: Any, tmp_path: Path, scheme: Any) -> None:
    """All paths were the same blue; two ghosts of six were alike, and the scene stayed white on a dark screen."""
    page.emulate_media(color_scheme=scheme, reduced_motion="reduce")
    open_file(page, ps.write_replay(tmp_path / "three.html", paper, point_names=["take", "lift", "unload", "place"]))
    seen = picture(page)
    for k in range(3):
        hue = profile_line(k).hue
        expected = np.array(list(bytes.fromhex((hue.dark if scheme == "dark" else hue.light)[1:])))
        assert (np.abs(seen - expected).max(axis=2) <= 2).sum() > 30, f"no path in the colour of profile {k}"
        swatch = page.locator(".motion .swatch").nth(k).evaluate("(one) => getComputedStyle(one).backgroundColor")
        assert swatch == f"rgb({', '.join(map(str, expected))})"
    corner = seen[5, 5].mean()
    assert corner < 80 if scheme == "dark" else corner > 200


def test_keys_and_buttons_move_the_camera_and_the_time(page: Page, file: Path) -> None:
    page.emulate_media(reduced_motion="reduce")
    open_file(page, file)
    eye = "replay.viewer.camera.position.toArray()"
    seen = {page.evaluate(f"{eye}.map((x) => x.toFixed(3)).join()")}
    for key in "234":
        page.keyboard.press(key)
        seen.add(page.evaluate(f"{eye}.map((x) => x.toFixed(3)).join()"))
    assert len(seen) == 4
    page.keyboard.press("1")
    page.keyboard.press("ArrowRight")
    assert page.evaluate("replay.time") == pytest.approx(9.0 / 200)
    page.keyboard.press("End")
    assert page.evaluate("replay.time") == 9.0
    page.keyboard.press("Home")
    page.keyboard.press("t")
    assert page.get_attribute("#follow", "aria-pressed") == "true"
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    before = page.evaluate(eye)
    page.evaluate("replay.seek(4.0)")
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    assert not np.allclose(page.evaluate(eye), before, atol=0.05)
    page.keyboard.press("d")
    assert page.get_attribute("html", "data-theme") == "dark"
    page.keyboard.press("l")
    assert not page.is_checked("#repeat")
    page.keyboard.press(" ")
    assert page.evaluate("replay.playing")


def test_a_picture_and_a_video_are_files(page: Page, tmp_path: Path, puma: ps.Robot) -> None:
    """For the slide and the mail: one picture of what is seen, one run as video."""
    short = ps.assess(puma, ps.quintic_segments([[0.0] * 6, [0.3] * 6], [0.0, 0.4]))
    page.set_viewport_size({"width": 900, "height": 500})
    open_file(page, ps.write_replay(tmp_path / "short.html", short))
    with page.expect_download() as picture_of_it:
        page.click("#png")
    image = Image.open(picture_of_it.value.path())
    assert image.size[0] > 400
    assert np.asarray(image.convert("RGB")).std() > 5, "an empty picture"
    with page.expect_download(timeout=60_000) as video:
        page.click("#video")
    assert video.value.suggested_filename.endswith((".webm", ".mp4"))
    assert video.value.path().stat().st_size > 1000
