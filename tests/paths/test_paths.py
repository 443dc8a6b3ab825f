"""Lines, arcs, circles and rounded polylines of the tool."""

from __future__ import annotations

import numpy as np
import pytest

import puma_septic as ps
from puma_septic import paths
from puma_septic.errors import InputError
from puma_septic.paths import _fitting
from puma_septic.validation import Array


def turn_z(angle: float) -> Array:
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return pose


def at(position: list[float], angle: float = 0.0) -> Array:
    pose = turn_z(angle)
    pose[:3, 3] = position
    return pose


CORNERS = np.stack([at([0, 0, 0]), at([1, 0, 0], 0.4), at([1, 1, 0.5], 1.5), at([0, 1, 1], 0.2)])
PATHS = {
    "line": paths.line(at([0, 0, 0]), at([0.3, 0.4, 0], 1.0)),
    "arc": paths.arc(at([1, 0, 0]), [0, 1, 0], at([-1, 0, 0], 0.7)),
    "tangent": paths.circle(at([1, 0, 0]), centre=[0, 0, 0], axis=[0, 0, 2], angle=-3.0, orientation="tangent"),
    "polyline": paths.polyline(CORNERS, zone=0.3),
}


def test_a_line_turns_evenly_along_the_geodesic() -> None:
    middle = PATHS["line"].frames(0.25)
    assert PATHS["line"].length == 0.5
    np.testing.assert_allclose(middle, at([0.15, 0.2, 0], 0.5), atol=1e-15)


def test_an_arc_is_part_of_its_circle_and_a_tangent_tool_turns_with_it() -> None:
    arc, circle = PATHS["arc"], PATHS["tangent"]
    s = np.linspace(0, arc.length, 50)
    assert abs(arc.length - np.pi) < 1e-15
    np.testing.assert_allclose(np.linalg.norm(arc.frames(s)[:, :3, 3], axis=1), 1, atol=1e-14)
    np.testing.assert_allclose(arc.curvature(s), 1, atol=1e-12)
    np.testing.assert_allclose(circle.frames(circle.length), at([np.cos(3), -np.sin(3), 0], -3.0), atol=1e-14)


@pytest.mark.parametrize("name", PATHS)
def test_rates_are_the_derivatives_of_the_poses(name: str) -> None:
    """Two ways: central differences over 1e-5 m, whose own error is about 1e-9 of a fifth derivative near 1e3."""
    path, h = PATHS[name], 1e-5
    s = np.linspace(0.01, path.length - 0.01, 17)
    before, here, after = (path.rates(path.pieces(s + d), s + d) for d in (-h, 0, h))
    np.testing.assert_allclose(np.linalg.norm(here.linear[0], axis=1), 1, atol=1e-13)
    np.testing.assert_allclose((after.poses - before.poses)[:, :3, 3] / (2 * h), here.linear[0], atol=1e-8)
    np.testing.assert_allclose((after.linear - before.linear)[:2] / (2 * h), here.linear[1:], atol=2e-5)
    np.testing.assert_allclose((after.angular - before.angular)[:2] / (2 * h), here.angular[1:], atol=2e-5)
    spin = (after.poses - before.poses)[:, :3, :3] / (2 * h) @ here.poses[:, :3, :3].transpose(0, 2, 1)
    seen = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
    np.testing.assert_allclose(seen, here.angular[0], atol=1e-8)


def test_a_rounded_corner_has_continuous_curvature_and_stays_in_its_zone() -> None:
    path = PATHS["polyline"]
    inner = path.breaks[1:-1]
    before, after = path.rates(path.pieces(inner) - 1, inner), path.rates(path.pieces(inner), inner)
    np.testing.assert_allclose(before.poses, after.poses, atol=1e-14)
    np.testing.assert_allclose(before.linear[:2], after.linear[:2], atol=1e-11)
    np.testing.assert_allclose(before.angular[:2], after.angular[:2], atol=1e-11)
    assert path.length < np.linalg.norm(np.diff(CORNERS[:, :3, 3], axis=0), axis=1).sum()
    nearest = np.linalg.norm(path.frames(np.linspace(0, path.length, 4001))[:, None, :3, 3] - CORNERS[:, :3, 3], axis=2)
    assert (nearest.min(axis=0) < 0.3).all()


def test_half_a_turn_goes_round_the_axis_that_is_given() -> None:
    path = paths.line(at([0, 0, 0]), at([1, 0, 0], np.pi), turn_axis=[0, 0, -1])
    np.testing.assert_allclose(path.frames(0.5), at([0.5, 0, 0], -np.pi / 2), atol=1e-15)


HALF = at([1, 0, 0], np.pi)
REFUSED = {
    "equal points": (lambda: paths.line(at([0, 0, 1]), at([0, 0, 1], 0.5)), "same position, .* joint move"),
    "half a turn": (lambda: paths.line(np.eye(4), HALF), r"half a turn .* give turn_axis, near \[0"),
    "wrong axis": (lambda: paths.line(np.eye(4), HALF, turn_axis=[1, 0, 0]), "does not turn one orientation"),
    "collinear": (lambda: paths.arc(np.eye(4), [1, 0, 0], [2, 0, 0]), "lie on a line, .* use line"),
    "closed arc": (lambda: paths.arc(np.eye(4), [1, 0, 0], [0, 0, 0]), "same point .* use circle"),
    "point for a geodesic": (lambda: paths.arc(np.eye(4), [1, 1, 0], [2, 0, 0]), "needs a pose"),
    "not tangent": (
        lambda: paths.arc(np.eye(4), [1, 1, 0], at([2, 0, 0]), orientation="tangent"), "arrives 3.14159 rad off"
    ),
    "no radius": (lambda: paths.circle(np.eye(4), centre=[0, 0, 1], axis=[0, 0, 1]), "lies on the axis"),
    "long zone": (lambda: paths.polyline(CORNERS, zone=0.6), "segment 2: its zones take 1.2 m of 1.118"),
    "no zone": (lambda: paths.polyline(CORNERS, zone=[0.1, 0]), r"poses\[2\]: zone = 0 m must be greater"),
    "back": (lambda: paths.polyline(CORNERS[[0, 1, 0]], zone=0.1), r"turns back on itself at poses\[1\]"),
    "no speed": (lambda: paths.at_speed(PATHS["line"], speed=0, acceleration=1), "speed = 0 m/s must be greater"),
    "no acceleration": (lambda: paths.at_speed(PATHS["line"], speed=1, acceleration=-1), "acceleration = -1"),
    "not rigid": (lambda: paths.line(2 * np.eye(4), np.eye(4)), "T_from"),
    "far from rigid": (lambda: paths.line(np.diag([3.0, 1, 1, 1]), np.eye(4)), "T_from: not a rigid transf.* by 8 "),
    "no axis": (lambda: paths.circle(np.eye(4), centre=[1, 0, 0], axis=[0, 0, 0]), "^axis: expected three"),
    "no angle": (
        lambda: paths.circle(np.eye(4), centre=[1, 0, 0], axis=[0, 0, 1], angle=0), "angle = 0 rad must be greater"
    ),
    "many turns": (
        lambda: paths.circle(np.eye(4), centre=[1, 0, 0], axis=[0, 0, 1], angle=1e5),
        "angle = 100000 rad: more turns than one path can hold",
    ),
    "no turn axis": (
        lambda: paths.line(np.eye(4), HALF, turn_axis=[0, 0, 0]), "turn_axis: expected three numbers, not all 0"
    ),
    "two poses": (lambda: paths.polyline(CORNERS[:2], zone=0.1), "at least 3 poses, got 2; for 2 use line"),
    "twice": (
        lambda: paths.polyline(CORNERS[[0, 1, 1]], zone=0.1),
        r"poses\[1\] and poses\[2\] have the same position, \[1.0, 0.0, 0.0\] m",
    ),
    "beyond": (lambda: PATHS["line"].frames(0.6), r"s = 0.6 m is outside the path, \[0, 0.5\] m"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_bad_input_is_refused_with_what_would_be_valid(case: str) -> None:
    make, message = REFUSED[case]
    with pytest.raises(InputError, match=message):
        make()


def test_a_fit_that_does_not_end_says_where(monkeypatch: pytest.MonkeyPatch) -> None:
    """Corners that turn back and laws with steps are refused before; here the fit may halve no interval."""
    robot = ps.load_robot()
    pose = ps.forward_kinematics(robot, [0, 0.5, -2.5, 0, 0.7, 0])
    way = paths.follow(robot, paths.line(pose, pose[:3, 3] + [0, 0.3, 0]))
    monkeypatch.setattr(_fitting, "_SMALLEST", 4.0)
    with pytest.raises(ps.PumaSepticError, match=r"the blend of a corner is not smooth at s = 0 m"):
        paths.polyline(CORNERS, zone=0.3)
    law = ps.septic([[0.0], [0.1], [0.2], [0.3]], [0.0, 1.0, 2.0, 3.0])
    with pytest.raises(ps.PumaSepticError, match="the law of time is not smooth at t = 0 s and needs a break there"):
        paths.timed(way, law)


def test_laws_of_speed_have_ramps_and_a_cruise_or_two_ramps() -> None:
    way = ps.paths.line(np.eye(4), [1.0, 0, 0])
    assert abs(paths.at_speed(way, speed=0.5, acceleration=1).duration - 2.5) < 1e-15
    assert paths.at_speed(way, speed=5, acceleration=1).duration == 2.0
    smooth = paths.at_speed(way, speed=0.5, acceleration=1, jerk=4)
    assert smooth.extrema(1).max[0] == pytest.approx(0.5, abs=1e-12)
    assert smooth.extrema(3).max[0] == pytest.approx(4, abs=1e-12)
