"""The replay without a browser: what is in the page, and who may fetch it."""

from __future__ import annotations

import base64
import gzip
import http.client
import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import webbrowser
from dataclasses import replace
from pathlib import Path
from typing import Any

import coal
import numpy as np
import pinocchio as pin
import pytest
import umsgpack
from helpers.meshes import arm, dae, stl
from helpers.places import ROBOTS, SHARE
from helpers.processes import heeding_ctrl_c
from helpers.urdf_texts import ARM, load

import puma_septic as ps
from puma_septic.pictures import profile_line
from puma_septic.task import assess_task, load_task
from puma_septic.viewer._animation import ANGLE_ERROR, flags_of, key_times, utilisation
from puma_septic.viewer._colours import UTILISATION, colour_at, profile_colour
from puma_septic.viewer._server import serve_page
from puma_septic.viewer._shapes import placed_shapes, tube

HOSTILE = "<script>alert(1)</script>"


def small_move(robot: ps.Robot, duration: float = 1.0) -> ps.Motion:
    n = robot.n_joints
    return ps.compute_motion(robot, ps.quintic_segments([[0.0] * n, [0.4] * n], [0.0, duration]))


def unpacked(html: str, name: str) -> bytes:
    found = re.search(f'<script id="{name}"[^>]*>([^<]*)</script>', html)
    assert found is not None
    return gzip.decompress(base64.b64decode(found[1]))


def scene(html: str) -> list[dict[str, Any]]:
    """The commands that the viewer reads."""
    content, commands = unpacked(html, "scene"), []
    while content:
        (size,) = struct.unpack_from("<I", content)
        commands.append(umsgpack.unpackb(content[4 : 4 + size]))
        content = content[4 + size :]
    return commands


def page_data(html: str) -> dict[str, Any]:
    found = re.search('<script id="data"[^>]*>([^<]*)</script>', html)
    assert found is not None
    return json.loads(found[1])


def drawn(html: str) -> dict[str, dict[str, Any]]:
    return {one["path"]: one["object"] for one in scene(html) if one["type"] == "set_object"}


def tracks(html: str) -> dict[tuple[str, str], tuple[np.ndarray, np.ndarray]]:
    """Times and values of the key frames by object and property."""
    animations = [one for one in scene(html) if one["type"] == "set_animation"]
    assert len(animations) == 1
    return {
        (part["path"], track["name"]): (
            np.array([key["time"] for key in track["keys"]]) / part["clip"]["fps"],
            np.array([key["value"] for key in track["keys"]]),
        )
        for part in animations[0]["animations"]
        for track in part["clip"]["tracks"]
    }


def tool_from_key_frames(html: str, t: float) -> np.ndarray:
    """Where the tool is when the viewer interpolates as three.js does: straight lines, and turns at a constant rate."""
    moving = tracks(html)
    placed = {one["path"]: np.reshape(one["matrix"], (4, 4)).T for one in scene(html) if one["type"] == "set_transform"}
    path = next(name for name in placed if name.startswith("/meshcat/motion0/arm") and name.endswith("/tool"))
    whole = np.eye(4)
    names = path.split("/")
    for prefix in ("/".join(names[:k]) for k in range(2, len(names) + 1)):
        local = placed.get(prefix, np.eye(4)).copy()
        for name, (times, values) in ((name, moving[at, name]) for at, name in moving if at == prefix):
            k = int(np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 2))
            part = (t - times[k]) / (times[k + 1] - times[k])
            if name == ".position":
                local[:3, 3] = (1 - part) * values[k] + part * values[k + 1]
            else:
                first, second = (pin.Quaternion(values[n]).normalized() for n in (k, k + 1))
                local[:3, :3] = first.slerp(part, second).toRotationMatrix()
        whole = whole @ local
    return whole


# ---- key frames


@pytest.mark.parametrize("profile", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 2))])
def test_key_frames_hold_forward_kinematics(paper: tuple[ps.Assessment, ...], profile: int) -> None:
    motion = paper[profile].motion
    html = ps.replay_html(motion)
    times = key_times(motion)
    for t in times[:: len(times) // 5]:
        expected = ps.forward_kinematics(motion.robot, motion.trajectory(t))
        # The file has single precision: 6e-8 of 1 m, through six joints, and of 9 s at 1 rad/s.
        np.testing.assert_allclose(tool_from_key_frames(html, t), expected, atol=4e-6)


@pytest.mark.slow
def test_between_key_frames_the_tool_is_where_it_should_be(paper: tuple[ps.Assessment, ...]) -> None:
    """Each joint is off by ANGLE_ERROR at most, and six levers of a PUMA are none longer than 1.2 m."""
    motion = paper[0].motion
    html = ps.replay_html(motion)
    times = key_times(motion)
    for t in ((times[:-1] + times[1:]) / 2)[:: len(times) // 7]:
        expected = ps.forward_kinematics(motion.robot, motion.trajectory(t))[:3, 3]
        assert np.abs(tool_from_key_frames(html, t)[:3, 3] - expected).max() < 6 * 1.2 * ANGLE_ERROR


def test_a_log_of_many_samples_has_as_many_key_frames_as_its_motion_takes(puma: ps.Robot) -> None:
    """It had 3,000, however slow: half of the report of 100,000 rows, and of the time to write it."""
    t = np.linspace(0.0, 4.0, 4001)
    move = ps.quintic_segments([[0.0, 0.6, -2.2, 0.0, 0.3, 0.0], [1.0, 1.2, -2.6, 0.2, 0.6, 0.1]], [0.0, 4.0])
    motion = ps.compute_motion(puma, ps.fit_trajectory(t, move(t)))
    times = key_times(motion)
    assert 120 <= len(times) < 200  # thirty a second, or as many as its acceleration asks for
    middle = motion.trajectory((times[:-1] + times[1:]) / 2)
    ends = motion.trajectory(times)
    assert np.abs(middle - (ends[:-1] + ends[1:]) / 2).max() < ANGLE_ERROR


def test_prismatic_and_continuous_joints_move(tmp_path: Path) -> None:
    slide = ARM.replace('name="elbow" type="revolute"', 'name="elbow" type="prismatic"')
    turn = slide.replace('name="shoulder" type="revolute"', 'name="shoulder" type="continuous"')
    robot = load(tmp_path, turn, tool="tip")
    motion = ps.compute_motion(robot, ps.quintic_segments([[-5.0, 0.0], [5.0, 0.3]], [1.0, 3.0]))
    html = ps.replay_html(motion)
    for t in key_times(motion)[[0, 30, -1]]:
        expected = ps.forward_kinematics(robot, motion.trajectory(t))
        # The scene's clock starts with the trajectory, at 1 s.
        np.testing.assert_allclose(tool_from_key_frames(html, t - 1.0), expected, atol=4e-6)


def test_links_are_coloured_by_utilisation(paper: tuple[ps.Assessment, ...]) -> None:
    motion = paper[0].motion
    times = key_times(motion)
    used = utilisation(motion, times)
    coloured = {path: curve for (path, name), curve in tracks(ps.replay_html(motion)).items() if name.endswith("color")}
    shapes = [shape for shape in motion.robot.visual_model.geometryObjects if shape.parentJoint > 0]
    assert len(coloured) == len(shapes) == 17
    for path, (at, colours) in coloured.items():
        assert path.endswith("/<object>")
        np.testing.assert_allclose(at, times, atol=1e-6)  # single precision of 9 s
        joint = int(re.findall(r"joint(\d+)", path)[-1])
        np.testing.assert_allclose(colours, colour_at(UTILISATION, used[:, joint - 1]), atol=1e-6)


def test_colours_run_from_grey_over_yellow_to_red() -> None:
    """Green, for little use, was the colour of the third profile's ghost: no profile has any of these."""
    grey, yellow, red = colour_at(UTILISATION, [0.0, 0.5, 1.0])
    assert np.ptp(grey) < 0.05
    for k in range(6):
        assert np.linalg.norm(np.array([grey, yellow, red]) - profile_colour(k), axis=1).min() > 0.15
    assert yellow[:2].min() > 4 * yellow[2]
    assert red.argmax() == 0
    np.testing.assert_array_equal(colour_at(UTILISATION, [1.0, 7.0]), [red, red])


def test_a_link_without_known_limit_is_grey(puma: ps.Robot) -> None:
    effort = np.array(puma.limits.effort)
    effort[1] = np.nan
    html = ps.replay_html(small_move(puma.with_limits(effort=effort)))
    coloured = {re.findall(r"joint(\d+)", path)[-1] for path, name in tracks(html) if name.endswith("color")}
    assert coloured == {"1", "3", "4", "5", "6"}
    assert page_data(html)["motions"][0]["used"][1] is None


def test_a_motion_at_rest_can_be_shown(puma: ps.Robot) -> None:
    rest = ps.compute_motion(puma, ps.quintic_segments([[0.1] * 6, [0.1] * 6], [0.0, 1.0]))
    html = ps.replay_html(rest)
    assert not [name for _, name in tracks(html) if name != ".material.color"]
    assert not [path for path in drawn(html) if path.endswith("/path")]


# ---- what is drawn


@pytest.mark.slow
def test_second_motions_are_ghosts(paper: tuple[ps.Assessment, ...]) -> None:
    things = drawn(ps.replay_html(paper))
    opacities = {
        k: {thing["materials"][0]["opacity"] for path, thing in things.items() if f"motion{k}/arm" in path}
        for k in range(3)
    }
    assert opacities[0] == {1.0}
    assert all(0 < opacity < 0.5 for k in (1, 2) for opacity in opacities[k])
    assert not re.search(r"motion1/arm/shape", " ".join(things)), "a second base in the same place"
    assert all(f"/meshcat/motion{k}/path" in things for k in range(3))


@pytest.mark.slow
def test_a_motion_has_the_colour_of_its_curves(paper: tuple[ps.Assessment, ...]) -> None:
    """The second motion was vermilion in all charts of a report and blue, the first one's colour, in its replay."""
    html = ps.replay_html(paper)
    expected = [profile_line(k).hue.light for k in range(3)]
    hues = [profile_line(k).hue for k in range(3)]
    assert [one["colours"] for one in page_data(html)["motions"]] == [[hue.light, hue.dark] for hue in hues]
    for k in (1, 2):
        arm = [thing for path, thing in drawn(html).items() if f"motion{k}/arm" in path]
        assert {f"#{thing['materials'][0]['color']:06x}" for thing in arm} == {expected[k]}


def test_path_is_a_tube_along_the_tools_way() -> None:
    t = np.linspace(0.0, 3.0, 200)
    way = np.column_stack([np.cos(3 * t), np.sin(3 * t), t])
    made = tube(way, np.full(len(way), 0.02))
    apart = np.linalg.norm(made.vertices.reshape(len(way), -1, 3) - way[:, None], axis=2)
    np.testing.assert_allclose(apart, 0.02, rtol=1e-4)  # single precision of coordinates up to 3 m
    assert made.faces.max() == len(made.vertices) - 1


def test_path_survives_turning_back_and_standing_still() -> None:
    way = np.array([[0.0, 0, 0], [1.0, 0, 0], [1.0, 0, 0], [0.0, 0, 0], [0.0, 0, 1.0]])
    assert np.isfinite(tube(way, np.full(len(way), 0.01)).vertices).all()
    assert tube(way[:1].repeat(5, axis=0), np.full(5, 0.01)) is None


def test_payload_is_a_body_at_the_tool(puma: ps.Robot) -> None:
    inertia = np.diag([0.02, 0.03, 0.04])
    box = small_move(puma.with_payload(ps.Payload(mass=2.0, com=(0, 0, 0.1), inertia=inertia)))
    ball = small_move(puma.with_payload(ps.Payload(mass=2.0)))
    ((path, thing),) = ((p, o) for p, o in drawn(ps.replay_html(box)).items() if p.endswith("/tool/payload0"))
    solid = thing["geometries"][0]
    sides = np.array([solid[name] for name in ("width", "height", "depth")])
    # A box of even density: I_x = m (b^2 + c^2) / 12 and so on.
    moments = 2.0 / 12 * ((sides**2).sum() - sides**2)
    np.testing.assert_allclose(np.sort(moments), [0.02, 0.03, 0.04], rtol=1e-6)
    place = next(o["matrix"] for o in scene(ps.replay_html(box)) if o["path"] == path and o["type"] == "set_transform")
    np.testing.assert_allclose(np.reshape(place, (4, 4)).T[:3, 3], [0, 0, 0.1], atol=1e-7)
    ball_things = drawn(ps.replay_html(ball))
    assert [o["geometries"][0]["type"] for p, o in ball_things.items() if "payload" in p] == ["SphereGeometry"]
    assert page_data(ps.replay_html(ball))["motions"][0]["payload"] == "2 kg"


def test_a_cycle_carries_what_its_steps_carry(puma: ps.Robot) -> None:
    """A payload was drawn all the way, also where the hand is empty or holds another."""
    go = ps.quintic_segments([[0.0] * 6, [0.4] * 6], [0.0, 1.0])
    back = ps.quintic_segments([[0.4] * 6, [0.0] * 6], [0.0, 2.0])
    light, heavy = (puma.with_payload(ps.Payload(mass=mass)) for mass in (1.0, 2.0))
    steps = [ps.compute_motion(light, go), ps.Dwell(duration=0.5), ps.compute_motion(puma, back),
             ps.compute_motion(heavy, go), ps.compute_motion(light, back)]  # fmt: skip
    html = ps.replay_html(ps.Cycle(steps=steps).motion)
    assert sorted(path.rsplit("/", 1)[1] for path in drawn(html) if "payload" in path) == ["payload0", "payload1"]
    seen = {
        clip["path"].rsplit("/", 1)[1]: [(key["time"], key["value"]) for key in clip["clip"]["tracks"][0]["keys"]]
        for command in scene(html)
        if command["type"] == "set_animation"
        for clip in command["animations"]
        if "payload" in clip["path"]
    }
    assert seen == {
        "payload0": [(0.0, True), (1.0, True), (1.5, False), (3.5, False), (4.5, True)],
        "payload1": [(0.0, False), (1.0, False), (1.5, False), (3.5, True), (4.5, False)],
    }


def test_an_arm_without_shapes_is_drawn_as_sticks(tmp_path: Path) -> None:
    html = ps.replay_html(small_move(load(tmp_path, ARM, tool="tip")))
    kinds = [thing["geometries"][0]["type"] for path, thing in drawn(html).items() if "/arm/" in path]
    assert kinds.count("CylinderGeometry") == 3  # to the shoulder, to the elbow, to the tip
    assert kinds.count("SphereGeometry") == 3


@pytest.mark.parametrize(
    ("solid", "kinds"),
    [
        (coal.Box(1.0, 2.0, 3.0), ["Box"]),
        (coal.Sphere(0.5), ["Sphere"]),
        (coal.Ellipsoid(0.1, 0.2, 0.3), ["Sphere"]),
        (coal.Cylinder(0.1, 1.0), ["Cylinder"]),
        (coal.Cone(0.1, 1.0), ["Cylinder"]),
        (coal.Capsule(0.1, 1.0), ["Cylinder", "Sphere", "Sphere"]),
    ],
)
def test_each_primitive_is_drawn(solid: coal.CollisionGeometry, kinds: list[str]) -> None:
    shape = pin.GeometryObject("part", 0, 0, pin.SE3.Identity(), solid)
    assert [type(geometry).__name__ for geometry, _ in placed_shapes(shape)] == kinds


def test_a_shape_that_cannot_be_drawn_is_named() -> None:
    endless = pin.GeometryObject("floor", 0, 0, pin.SE3.Identity(), coal.Halfspace(np.array([0.0, 0, 1]), 0.0))
    with pytest.raises(ps.ModelError, match="shape 'floor': a Halfspace cannot be drawn"):
        placed_shapes(endless)


@pytest.mark.parametrize(
    ("urdf", "locked", "shapes"),
    [
        ("ur_description/urdf/ur5_robot.urdf", {}, 7),
        ("panda_description/urdf/panda.urdf", {"panda_finger_joint1": 0.02, "panda_finger_joint2": 0.02}, 11),
    ],
)
@pytest.mark.slow
def test_robots_with_meshes_are_shown(urdf: str, locked: dict[str, float], shapes: int) -> None:
    robot = ps.load_robot(ROBOTS / urdf, package_dirs=[SHARE], locked=locked)
    assert robot.missing_meshes == ()
    middle = np.nan_to_num(robot.limits.position).mean(axis=1)
    motion = ps.compute_motion(robot, ps.quintic_segments([middle, middle + 0.3], [0.0, 2.0]))
    html = ps.replay_html(motion)
    meshes = [thing for path, thing in drawn(html).items() if re.search(r"/arm/.*shape\d+$", path)]
    assert [mesh["geometries"][0]["type"] for mesh in meshes] == ["BufferGeometry"] * shapes
    assert len(html) < 3_000_000


# ---- what is flagged


def test_broken_limits_are_flagged_while_they_are_broken(puma: ps.Robot) -> None:
    """A quintic from rest to rest over h in T has the velocity 30 h/T s^2 (1 - s)^2: 1.2 h/T where s (1 - s) = 0.2."""
    move = ps.quintic_segments([[0.0] * 6, [0.5, 0, 0, 0, 0, 0]], [0.0, 2.0])
    velocity = np.array(puma.limits.velocity)
    velocity[0] = 1.2 * 0.5 / 2.0
    flags = flags_of(ps.assess(puma.with_limits(velocity=velocity), move))
    (flag,) = (one for one in flags if one.kind == "limit")
    assert flag.time == pytest.approx(1.0)  # the fastest instant of a symmetric move
    early = (1 - np.sqrt(0.2)) / 2
    np.testing.assert_allclose(flag.spans, [[2 * early, 2 * (1 - early)]], atol=1e-9)
    assert re.fullmatch(r"joint1 velocity 0\.4688 rad/s at t = 1 s is 156\.2 % of 0\.3 rad/s", flag.text)


def test_position_torque_and_unbounded_jerk_are_flagged(paper: tuple[ps.Assessment, ...]) -> None:
    robot = paper[1].motion.robot
    tight = robot.with_limits(effort=0.5 * robot.limits.effort, jerk=50.0)
    paper_points = paper[1].motion.trajectory
    assessment = ps.assess(tight, ps.profiles.cubic(paper_points.points, paper_points.times))  # acceleration steps
    flags = flags_of(assessment)
    texts = [flag.text for flag in flags]
    assert [text for text in texts if re.search(r"joint5 position .* rad beyond its bound", text)]
    assert [text for text in texts if re.search(r"joint\d torque .* N m at .* is [\d.]+ % of", text)]
    assert [text for text in texts if re.search(r"joint\d jerk unbounded at .*, limit 50 rad/s\^3", text)]
    for check, flag in zip(assessment.violations, flags, strict=False):
        if check.quantity == "effort":
            middle = assessment.motion.torque([(a + b) / 2 for a, b in flag.spans])
            assert np.all(np.abs(middle[:, tight.joint_index(check.joint)]) > check.limit)


def test_singular_instants_are_flagged_and_marked(paper: tuple[ps.Assessment, ...]) -> None:
    septic = paper[0]
    singular = [flag for flag in flags_of(septic) if flag.kind == "singular"]
    crossings = sorted(t for report in septic.tool.singularities for t in report.crossings)
    assert [flag.time for flag in singular] == crossings
    html = ps.replay_html(septic)
    marks = [path for path in drawn(html) if path.startswith("/meshcat/motion0/flags/")]
    assert len(marks) == len(page_data(html)["motions"][0]["flags"]) == len(crossings) + len(septic.violations)
    assert len([path for path in drawn(html) if path.startswith("/meshcat/motion0/vias/")]) == 4


# ---- the page as a file


def test_paper_move_is_a_small_file_without_any_address(paper: tuple[ps.Assessment, ...], tmp_path: Path) -> None:
    written = ps.write_replay(tmp_path / "replay.html", paper[0])
    html = written.read_text(encoding="utf-8")
    assert written.stat().st_size < 3_000_000
    assert "://" not in html
    assert not re.search(r'(?:src|href)\s*=\s*"(?!data:)', html)
    assert "default-src 'none'" in html


def test_same_inputs_give_the_same_file(paper: tuple[ps.Assessment, ...]) -> None:
    assert ps.replay_html(paper[0]) == ps.replay_html(assess_task(load_task("paper"))[0])


def test_names_are_text_in_the_page(puma: ps.Robot) -> None:
    named = replace(puma, name=HOSTILE, missing_meshes=(f"link {HOSTILE!r}: x.stl",))
    html = ps.replay_html(small_move(named), labels=[HOSTILE], title=f"{HOSTILE} </title> @DATA@")
    assert HOSTILE not in html
    data = page_data(html)
    assert (data["motions"][0]["robot"], data["motions"][0]["label"]) == (HOSTILE, HOSTILE)
    assert data["title"].endswith("@DATA@")
    assert all(HOSTILE not in json.dumps(one, default=str) for one in scene(html))


def test_notebook_frame_is_closed_off(puma: ps.Robot) -> None:
    with ps.replay(small_move(puma), title=HOSTILE, open_browser=False) as shown:
        frame = shown._repr_html_()
    assert re.match(r'<iframe srcdoc="[^"]*" sandbox="allow-scripts allow-downloads"[^<]*></iframe>$', frame)
    assert HOSTILE not in frame


def test_missing_meshes_are_named(tmp_path: Path) -> None:
    robot = load(tmp_path, arm("package://unknown/fore.stl"), tool="tip")
    (missing,) = page_data(ps.replay_html(small_move(robot)))["motions"][0]["missing"]
    assert missing.startswith("link 'fore': package://unknown/fore.stl package 'unknown' was not found; package_dirs=")
    contact = load(tmp_path, arm("package://unknown/fore.stl", "collision"), tool="tip")
    assert contact.missing_meshes[0].startswith("collision shape of link 'fore': package://unknown/fore.stl")
    assert page_data(ps.replay_html(small_move(contact)))["motions"][0]["missing"] == []


def test_a_texture_leaks_nothing_into_the_page(tmp_path: Path) -> None:
    """Pinocchio's own MeshcatVisualizer copies whatever file a Collada mesh names; here not even its own is opened."""
    canary = b"CANARY-5f1c9e"
    home = tmp_path / "robot"
    home.mkdir()
    (home / "texture.png").write_bytes(canary)
    (tmp_path / "secret.png").write_bytes(canary)
    dae(home / "fore.dae", "texture.png")
    html = ps.replay_html(small_move(load(home, arm("fore.dae"), tool="tip")))
    content = html.encode() + unpacked(html, "scene") + unpacked(html, "viewer")
    assert any("shape" in path for path in drawn(html))
    for form in (canary, base64.b64encode(canary).rstrip(b"="), b"texture.png", b"init_from>"):
        assert form not in content.replace(unpacked(html, "viewer"), b"")
    dae(home / "fore.dae", "../secret.png")
    html = ps.replay_html(small_move(load(home, arm("fore.dae"), tool="tip")))
    (missing,) = page_data(html)["motions"][0]["missing"]
    assert "takes its texture '../secret.png' from outside the robot's folders" in missing
    assert canary not in html.encode() + unpacked(html, "scene")


def test_a_broken_mesh_is_left_out_and_named(tmp_path: Path) -> None:
    """One unreadable mesh once stopped the whole replay."""
    stl(tmp_path / "fore.stl", [[0.0, 0, 0], [np.nan, 0, 0], [0, 1.0, 0]])
    robot = load(tmp_path, arm("fore.stl"), tool="tip")
    (missing,) = page_data(ps.replay_html(small_move(robot)))["motions"][0]["missing"]
    assert missing.endswith("fore.stl has a non-finite vertex")


@pytest.mark.parametrize("name", ["none/replay.html", "taken", "file.txt/replay.html", "long" * 100])
def test_a_place_that_cannot_be_written_is_named(tmp_path: Path, puma: ps.Robot, name: str) -> None:
    (tmp_path / "taken").mkdir()
    (tmp_path / "file.txt").touch()
    end = re.escape(name[-20:])  # a long name is shortened in the middle
    with pytest.raises(ps.InputError, match=f"{end}('?: cannot be written: | exists; )"):
        ps.write_replay(tmp_path / name, small_move(puma))


def test_what_cannot_be_shown_is_refused(puma: ps.Robot) -> None:
    motion = small_move(puma)
    with pytest.raises(ps.InputError, match="there is no motion to show"):
        ps.replay_html([])
    with pytest.raises(ps.InputError, match="replay shows motions and assessments, not Trajectory"):
        ps.replay_html([motion, motion.trajectory])  # type: ignore[list-item]
    with pytest.raises(ps.InputError, match="labels: 1 for 2 motions"):
        ps.replay_html([motion, motion], labels=["a"])
    with pytest.raises(ps.InputError, match="labels: a single text for 1 motions"):
        ps.replay_html(motion, labels="a")


def test_profiles_of_one_name_are_numbered(puma: ps.Robot) -> None:
    motion = small_move(puma)
    labels = [one["label"] for one in page_data(ps.replay_html([motion, motion]))["motions"]]
    assert labels == ["quintic_segments 1", "quintic_segments 2"]


# ---- the server


def ask(port: int, headers: dict[str, str], path: str = "/", method: str = "GET") -> tuple[int, bytes]:
    """Send exactly these headers."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=5)
    connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
    for name, value in headers.items():
        connection.putheader(name, value)
    connection.endheaders()
    answer = connection.getresponse()
    status, body = answer.status, answer.read()
    connection.close()
    return status, body


def other_addresses() -> set[str]:
    """Addresses of this machine besides the one that is served."""
    found = {"127.0.0.2", "127.1.2.3", *socket.gethostbyname_ex(socket.gethostname())[2]}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing: it asks which address would be used
            found.add(probe.getsockname()[0])
        except OSError:
            pass
    return found - {"127.0.0.1"}


def test_serves_this_machine_only() -> None:
    server = serve_page("<p>arm</p>")
    try:
        host = f"127.0.0.1:{server.port}"
        assert ask(server.port, {"Host": host}) == (200, b"<p>arm</p>")
        assert ask(server.port, {"Host": host, "Origin": f"http://{host}"})[0] == 200
        assert ask(server.port, {"Host": f"localhost:{server.port}"})[0] == 200
        assert ask(server.port, {"Host": host}, method="HEAD") == (200, b"")
        assert ask(server.port, {"Host": host}, path="/etc/passwd")[0] == 404
        for address in [*other_addresses(), "::1"]:
            family = socket.AF_INET6 if ":" in address else socket.AF_INET
            with socket.socket(family) as client:
                client.settimeout(2)
                assert client.connect_ex((address, server.port)) != 0, address
    finally:
        server.close()


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Host": ""},
        {"Host": "127.0.0.1"},
        {"Host": "evil.example:PORT"},
        {"Host": "127.0.0.1.evil.example:PORT"},
        {"Host": "127.0.0.1:PORT", "Origin": "http://evil.example"},
        {"Host": "127.0.0.1:PORT", "Origin": "null"},
        {"Host": "127.0.0.1:PORT", "Origin": "https://127.0.0.1:PORT"},
        {"Host": "127.0.0.1:PORT", "Origin": "127.0.0.1:PORT"},
    ],
)
def test_foreign_host_and_origin_are_refused(headers: dict[str, str]) -> None:
    server = serve_page("<p>arm</p>")
    try:
        sent = {name: value.replace("PORT", str(server.port)) for name, value in headers.items()}
        status, body = ask(server.port, sent)
        assert status == 403
        assert b"arm" not in body
    finally:
        server.close()


def test_of_two_origins_neither_counts() -> None:
    """Of two headers the first alone was looked at."""
    server = serve_page("<p>arm</p>")
    try:
        own, foreign = f"http://127.0.0.1:{server.port}", "http://evil.example"
        for origins in ((own, foreign), (foreign, own), (own, own)):
            request = f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n"
            request += "".join(f"Origin: {origin}\r\n" for origin in origins) + "Connection: close\r\n\r\n"
            with socket.create_connection(("127.0.0.1", server.port), timeout=5) as client:
                client.sendall(request.encode())
                assert client.recv(100).split()[1] == b"403"
    finally:
        server.close()


def test_a_taken_port_is_replaced_by_another() -> None:
    first = serve_page("first")
    second = serve_page("second", port=first.port)
    try:
        assert second.port != first.port
        assert second.url == f"http://127.0.0.1:{second.port}/"
        assert ask(second.port, {"Host": f"127.0.0.1:{second.port}"})[1] == b"second"
    finally:
        first.close()
        second.close()


@pytest.mark.parametrize("port", [-1, 65536, 80.5, True, "7000"])
def test_what_is_no_port_is_refused(port: Any) -> None:
    with pytest.raises(ps.InputError, match=r"port = .*: expected a whole number from 0 to 65535"):
        serve_page("", port=port)


def test_a_closed_replay_refuses_at_once(puma: ps.Robot) -> None:
    shown = ps.replay(small_move(puma), open_browser=False)
    port = int(shown.url.rstrip("/").rpartition(":")[2])
    shown.close()
    shown.close()
    with pytest.raises(ConnectionRefusedError):
        ask(port, {"Host": f"127.0.0.1:{port}"})


@pytest.mark.slow
def test_ctrl_c_ends_a_script_cleanly() -> None:
    code = """
import puma_septic as ps
motion = ps.compute_motion(ps.load_robot(), ps.quintic_segments([[0.0] * 6, [0.3] * 6], [0.0, 1.0]))
page = ps.replay(motion, open_browser=False)
print(page.url, flush=True)
page.wait()
print("ended", flush=True)
"""
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                             start_new_session=True, preexec_fn=heeding_ctrl_c)  # fmt: skip
    assert child.stdout is not None
    port = int(child.stdout.readline().strip().rstrip("/").rpartition(":")[2])
    assert ask(port, {"Host": f"127.0.0.1:{port}"})[0] == 200
    child.send_signal(signal.SIGINT)
    out, err = child.communicate(timeout=20)
    assert (child.returncode, out, err) == (0, "ended\n", "")
    with pytest.raises(ProcessLookupError):
        os.killpg(child.pid, 0)  # nothing is left of what it started
    with pytest.raises(ConnectionRefusedError):
        ask(port, {"Host": f"127.0.0.1:{port}"})


def test_without_screen_or_browser_the_address_is_given(puma: ps.Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    motion = small_move(puma)
    asked: list[str] = []

    def browser(url: str, **_: object) -> bool:
        asked.append(url)
        return True

    def no_browser(*_: object, **__: object) -> bool:
        raise webbrowser.Error("could not locate runnable browser")

    monkeypatch.setattr(webbrowser, "open", browser)
    monkeypatch.setenv("DISPLAY", ":0")
    with ps.replay(motion, open_browser=True) as shown:
        assert (shown.browser_opened, asked) == (True, [shown.url])

    monkeypatch.setattr(webbrowser, "open", no_browser)
    with ps.replay(motion, open_browser=True) as shown:
        assert not shown.browser_opened
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with ps.replay(motion, open_browser=True) as shown:
        assert not shown.browser_opened
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/", shown.url)
