"""Figures: drawn is what was computed, steps are steps, axes have units, nothing is shown or saved."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from helpers.moves import POINTS, TIMES
from matplotlib.figure import Figure
from PIL import ImageShow

import puma_septic as ps
from puma_septic import plots
from puma_septic.assessment import Assessment, assess
from puma_septic.errors import InputError
from puma_septic.pictures import HUES, PROFILES, assessment_pictures
from puma_septic.piecewise import sampled
from puma_septic.report.svg import picture_svg

# The eight colours of Okabe and Ito, "Color Universal Design", 2008.
OKABE_ITO = {"#000000", "#E69F00", "#56B4E9", "#009E73", "#F0E442", "#0072B2", "#D55E00", "#CC79A7"}


@pytest.fixture(scope="module")
def septic(puma: ps.Robot) -> Assessment:
    return assess(puma, ps.septic(POINTS, TIMES))


@pytest.fixture(scope="module")
def lspb(puma: ps.Robot) -> Assessment:
    return assess(puma, ps.lspb(POINTS, durations=[2, 4, 3], blend_time=1.0))


@pytest.fixture(scope="module")
def unblended(puma: ps.Robot) -> Assessment:
    return assess(puma, ps.lspb(POINTS, durations=[2, 4, 3], blend_time=0.0))


@pytest.fixture(scope="module")
def figures(septic: Assessment, lspb: Assessment, unblended: Assessment) -> dict[str, Figure]:
    both = [septic, lspb]
    return {
        "trajectory": plots.plot_trajectory([one.motion.trajectory for one in both], 3),
        "joints": plots.plot_joints(both),
        "torque": plots.plot_torque([*both, unblended]),
        "split": plots.plot_torque_split(septic),
        "workspace": plots.plot_workspace(both),
        "utilisation": plots.plot_utilisation([*both, unblended]),
    }


def test_every_axis_says_its_unit(figures: dict[str, Figure]) -> None:
    """Joint panels of `plot_joints` share their time axis, which only the lowest one labels."""
    for name, figure in figures.items():
        lowest = figure.axes[-4:] if name == "joints" else figure.axes
        assert all("[" in panel.get_xlabel() for panel in lowest), name
        if name != "utilisation":  # its other axis lists the joints
            assert all("[" in panel.get_ylabel() for panel in figure.axes), name


@pytest.mark.slow
def test_legends_lie_outside_all_panels(figures: dict[str, Figure]) -> None:
    for name, figure in figures.items():
        figure.draw_without_rendering()
        (legend,) = figure.legends
        below = legend.get_window_extent().y0
        assert legend.get_window_extent().x0 >= 0, name
        assert legend.get_window_extent().x1 <= figure.bbox.x1, name
        assert all(panel.get_tightbbox().y1 <= below for panel in figure.axes), name


def test_a_legend_of_many_long_names_stays_in_the_figure(septic: Assessment) -> None:
    labels = [f"a_long_profile_name_{k}" for k in range(12)]
    figure = plots.plot_torque([septic] * 12, labels=labels, joints="joint1")
    figure.draw_without_rendering()
    extent = figure.legends[0].get_window_extent()
    assert 0 <= extent.x0 < extent.x1 <= figure.bbox.x1


def test_an_arm_without_known_limits_has_nothing_but_a_remark(puma: ps.Robot, septic: Assessment) -> None:
    unknown = dict.fromkeys(("velocity", "acceleration", "jerk", "effort"), np.nan)
    robot = puma.with_limits(position=np.full((6, 2), np.nan), **unknown)
    figure = plots.plot_utilisation(assess(robot, septic.motion.trajectory))
    assert figure.axes == []
    assert figure.get_supxlabel().endswith("no limit is given: position, velocity, acceleration, jerk, torque.")
    assert figure._repr_png_()


@pytest.mark.slow
def test_texts_of_a_panel_do_not_overlap(figures: dict[str, Figure]) -> None:
    """The joint's name stands at the left above its panel, the remark on a far limit at the right."""
    for name, figure in figures.items():
        figure.draw_without_rendering()
        for panel in figure.axes:
            if panel.get_title("right"):
                left, right = (getattr(panel, title).get_window_extent() for title in ("_left_title", "_right_title"))
                assert left.x1 < right.x0, name


@pytest.mark.slow
def test_a_notebook_displays_the_figure_900_pixels_wide(figures: dict[str, Figure]) -> None:
    for figure in figures.values():
        png = figure._repr_png_()
        assert png[:8] == b"\x89PNG\r\n\x1a\n"
        assert int.from_bytes(png[16:20]) == 900  # the width in the header


def test_nothing_is_shown_or_saved(septic: Assessment, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    plots.plot_torque(septic)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_pyplot_is_never_loaded() -> None:
    """Pyplot costs 0.35 s to import and keeps every figure alive until it is closed."""
    code = "import sys, puma_septic.plots; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_palette_is_colour_blind_safe() -> None:
    colours = {hue.light.upper() for hue in PROFILES}
    assert colours <= OKABE_ITO
    assert len(colours) == len(PROFILES)
    assert len({hue.name for hue in HUES}) == len(HUES)


def test_each_profile_has_its_colour_in_all_figures(figures: dict[str, Figure]) -> None:
    for name in ("trajectory", "joints", "torque", "workspace"):
        entries = figures[name].legends[0].get_lines()
        assert [entries[0].get_color(), entries[1].get_color()] == [hue.light for hue in PROFILES[:2]], name


def test_curves_are_the_trajectory(septic: Assessment) -> None:
    trajectory = septic.motion.trajectory
    figure = plots.plot_trajectory(trajectory, 1)
    assert len(figure.axes) == 6
    for j, panel in enumerate(figure.axes):
        # The first and the last point are rest, before and after the motion.
        t, v = (np.asarray(data)[1:-1] for data in panel.lines[0].get_data())
        np.testing.assert_allclose(v, trajectory(t, 1)[:, j], rtol=0, atol=1e-14)  # the same numbers, another order


def test_a_step_is_a_vertical_line(lspb: Assessment) -> None:
    """Joint 1 of mstraj: at 1.5 s the jerk steps from 0 to 6 dv / tacc^2 = -4.7124 rad/s^3."""
    figure = plots.plot_trajectory(lspb.motion.trajectory, 3)
    t, jerk = (np.asarray(data) for data in figure.axes[0].lines[0].get_data())
    at = np.flatnonzero(t == 1.5)
    assert len(at) == 2
    assert at[1] == at[0] + 1
    np.testing.assert_allclose(jerk[at], [0.0, 6 * (-0.5716 - 2.57) / 4], atol=1e-12)  # rounding of the series


def test_the_step_from_rest_is_drawn(septic: Assessment) -> None:
    """The septic's jerk steps at both ends: joint 1 by 0.563 rad/s^3 at its start."""
    t, jerk = plots.plot_trajectory(septic.motion.trajectory, 3).axes[0].lines[0].get_data()
    assert list(t[:2]) == [0.0, 0.0]
    assert jerk[0] == 0.0
    assert jerk[1] == pytest.approx(6 * 0.093777194, abs=1e-8)  # six times the coefficient of t^3, nine digits
    assert jerk[-1] == 0.0


def test_an_unbounded_derivative_is_marked(unblended: Assessment, lspb: Assessment) -> None:
    """Without blends the velocity steps, the acceleration is an impulse; joint 1 moves from 2 s to 6 s."""
    marked = plots.plot_trajectory(unblended.motion.trajectory, 2).axes[0]
    impulses = [line for line in marked.lines if line.get_gid() == "impulse"]
    assert [float(line.get_xdata()[0]) for line in impulses] == [2.0, 6.0]
    assert [line.get_marker() for line in impulses] == ["v", "^"]
    smooth = plots.plot_trajectory(lspb.motion.trajectory, 2)
    assert not any(line.get_gid() == "impulse" for panel in smooth.axes for line in panel.lines)


def test_a_joint_at_rest_is_a_line_in_the_middle(septic: Assessment) -> None:
    """Joint 4 keeps still; its rounding must not be blown up to the panel's height."""
    panel = plots.plot_trajectory(septic.motion.trajectory, 0).axes[3]
    assert panel.get_ylim() == pytest.approx((-3.1416 - 0.5, -3.1416 + 0.5))


def test_via_points_and_limits_are_drawn(septic: Assessment, puma: ps.Robot) -> None:
    figure = plots.plot_joints(septic, orders=(0, 1))
    position, velocity = figure.axes[:2]
    assert len(figure.axes) == 12
    assert any(np.array_equal(line.get_ydata(), septic.motion.trajectory.points[:, 0]) for line in position.lines)
    speeds = {float(line.get_ydata()[0]) for line in velocity.lines if len(line.get_ydata()) == 2}
    assert speeds == {-puma.limits.velocity[0], puma.limits.velocity[0]}


def test_a_broken_limit_is_in_view(septic: Assessment, puma: ps.Robot) -> None:
    """Joint 4 rests 1.22 rad below its range: both the joint and the bound must be seen."""
    panel = plots.plot_joints(septic, orders=(0,)).axes[3]
    low, high = panel.get_ylim()
    assert low < -3.1416 < puma.limits.position[3, 0] < high


def test_a_far_limit_is_written(septic: Assessment) -> None:
    """Joint 6 turns at 1.1 rad/s and may turn at 5.74: drawn, the limit would flatten the curve."""
    panel = plots.plot_joints(septic, orders=(1,)).axes[5]
    assert panel.get_title("right") == "limit ±5.74"
    assert panel.get_ylim()[1] < 5


def test_unknown_limits_are_left_out(septic: Assessment) -> None:
    """No acceleration limit of the PUMA is known."""
    panel = plots.plot_joints(septic, orders=(2,)).axes[0]
    assert len(panel.lines) == 1
    assert panel.get_title("right") == ""


def test_peak_torque_is_marked_where_it_is(septic: Assessment) -> None:
    figure = plots.plot_torque(septic)
    for j, panel in enumerate(figure.axes):
        (mark,) = [line for line in panel.lines if line.get_marker() == "D"]
        assert float(mark.get_xdata()[0]) == septic.peak_torque_time[j]
        assert abs(float(mark.get_ydata()[0])) == septic.peak_torque[j]
        _, tau = panel.lines[0].get_data()
        # The curve's 480 samples come near the exact peak, to 0.1 %, and never exceed it.
        assert np.abs(tau).max() == pytest.approx(septic.peak_torque[j], rel=1e-3)
        assert np.abs(tau).max() <= septic.peak_torque[j] * (1 + 1e-9)


def test_coulomb_friction_steps_in_the_torque(septic: Assessment, puma: ps.Robot) -> None:
    """Joint 1 reverses at 1.43 s and its torque steps by both friction values."""
    t, tau = plots.plot_torque(septic).axes[0].lines[0].get_data()
    steps = np.flatnonzero(np.diff(t) == 0)
    step = tau[steps[0] + 1] - tau[steps[0]]
    assert t[steps[0]] == pytest.approx(1.43, abs=0.005)  # printed to two digits
    positive, negative = puma.coulomb_friction[0]
    assert step == pytest.approx(negative - positive, abs=1e-9)  # the rest of the torque is continuous


def test_unbounded_torque_is_said(unblended: Assessment) -> None:
    panel = plots.plot_torque(unblended).axes[1]
    assert panel.get_title("right") == "lspb unbounded at 0 s"
    assert not any(line.get_marker() == "D" for line in panel.lines)


def test_causes_sum_to_the_total(septic: Assessment) -> None:
    figure = plots.plot_torque_split(septic)
    t = np.linspace(0.01, 8.99, 50)
    for j, panel in enumerate(figure.axes):
        *causes, total = (np.interp(t, *line.get_data()) for line in panel.lines)
        size = np.abs(total).max()
        # Straight lines between 480 instants: their error is about (9 s / 480)^2 / 8 times the curvature.
        np.testing.assert_allclose(np.sum(causes, axis=0), total, atol=2e-3 * size, err_msg=f"joint {j + 1}")


def test_split_names_only_the_causes_there_are(puma: ps.Robot, septic: Assessment) -> None:
    def names(assessment: Assessment) -> list[str]:
        return [text.get_text() for text in plots.plot_torque_split(assessment).legends[0].get_texts()]

    assert names(septic) == ["inertia", "coriolis", "gravity", "rotor", "viscous", "coulomb", "total"]
    loaded = assess(puma.with_payload(ps.Payload(mass=2.5)), ps.septic(POINTS, TIMES))
    assert names(loaded)[-2:] == ["payload", "total"]


def test_workspace_goes_through_the_via_points(septic: Assessment, puma: ps.Robot) -> None:
    space, height = plots.plot_workspace(septic).axes
    path = np.array(space.lines[0].get_data_3d()).T
    vias = ps.forward_kinematics(puma, septic.motion.trajectory.points)[:, :3, 3]
    np.testing.assert_allclose(path[[0, -1]], vias[[0, -1]], atol=1e-12)  # the same positions
    np.testing.assert_allclose(np.array(space.lines[1].get_data_3d()).T, vias, atol=1e-12)
    assert np.asarray(height.lines[0].get_ydata()).max() == pytest.approx(septic.tool.height_range[1], abs=1e-4)


def test_utilisation_bars(septic: Assessment, unblended: Assessment) -> None:
    figure = plots.plot_utilisation([septic, unblended])
    position, velocity, acceleration, torque = figure.axes
    used = [bar.get_width() for bar in velocity.containers[0]]
    np.testing.assert_allclose(used, 100 * (1 - septic.margins["velocity"]))
    assert [text.get_text() for text in torque.texts[6:]] == ["unbounded !"] * 6
    # An infinite acceleration breaks a limit that is not known, too; joint 4 is still.
    assert [text.get_text() for text in acceleration.texts[6:]].count("unbounded !") == 5
    assert [text.get_text().endswith("!") for text in position.texts[:6]] == [
        False,
        True,
        False,
        True,
        True,
        False,
    ]
    assert "acceleration, jerk" in figure.get_supxlabel()


def test_sampled_takes_both_sides_of_a_break() -> None:
    steps = ps.Piecewise.from_power([0.0, 1.0, 3.0], [[[1.0], [2.0]]])
    t, values = sampled(steps)
    assert list(t[[0, -1]]) == [0.0, 3.0]
    at = np.flatnonzero(t == 1.0)
    assert values[at, 0].tolist() == [1.0, 2.0]


@pytest.mark.slow
def test_matplotlib_and_svg_draw_the_same(septic: Assessment, lspb: Assessment) -> None:
    """Two descriptions of one picture had grown apart in their limits, ranges and names."""
    for picture in assessment_pictures([septic, lspb], ["septic", "lspb"]):
        panels = plots.draw(picture).axes
        svg = picture_svg(picture)
        lows = [float(low) for low in re.findall(r'data-low="([^"]+)"', svg)]
        assert [panel.get_title(loc="left") for panel in panels] == [panel.title for panel in picture.panels]
        assert [panel.get_ylim()[0] for panel in panels] == lows
        curves = [len(panel.curves) for panel in picture.panels]
        assert svg.count("<polyline") == sum(curves)
        drawn = [[line for line in panel.lines if line.get_linestyle() != "None"] for panel in panels]
        # A limit is a line of two points.
        assert [sum(len(line.get_xdata()) > 2 for line in lines) for lines in drawn] == curves


def test_axes_of_ones_own_are_drawn_on(septic: Assessment, lspb: Assessment) -> None:
    mine = Figure()
    left, right = mine.subplots(1, 2)
    assert plots.plot_torque([septic, lspb], joints="joint2", ax=left) is mine
    plots.plot_trajectory(septic.motion.trajectory, 1, joints="joint 2", ax=right)
    assert [panel.get_ylabel() for panel in mine.axes] == ["torque [N m]", "velocity [rad/s]"]
    assert [text.get_text() for text in left.get_legend().get_texts()] == ["septic", "lspb", "peak", "limit"]
    assert mine.legends == []


def test_a_grid_of_axes_is_taken_row_by_row(septic: Assessment) -> None:
    grid = Figure().subplots(2, 2)
    plots.plot_joints(septic, orders=(0, 1), joints=["joint1", "joint3"], ax=grid)
    assert [panel.get_title(loc="left") for panel in grid.ravel()] == ["joint1", "joint1", "joint3", "joint3"]


def test_axes_of_a_subfigure_are_drawn_on(septic: Assessment) -> None:
    mine = Figure()
    part = mine.subfigures(1, 2)[1]
    assert plots.plot_torque(septic, joints="joint1", ax=part.subplots()) is mine


def test_names_are_text_not_mathematics() -> None:
    names = ["$x$", "a_b", "$", "<b>", "^", "joint6"]
    move = ps.quintic_segments(np.outer([0, 1], np.ones(6)), [0.0, 1.0], joint_names=names)
    figure = plots.plot_trajectory(move, labels=["$q$"])
    assert figure._repr_png_()
    assert figure.axes[0].get_title("left") == "$x$"
    assert not figure.legends[0].get_texts()[0].get_parse_math()


def test_equal_profiles_are_numbered(septic: Assessment) -> None:
    legend = plots.plot_torque([septic, septic]).legends[0]
    assert [text.get_text() for text in legend.get_texts()[:2]] == ["septic 1", "septic 2"]
    legend = plots.plot_torque([septic, septic], labels=["empty", "loaded"]).legends[0]
    assert [text.get_text() for text in legend.get_texts()[:2]] == ["empty", "loaded"]


def test_sliding_joints_have_their_units(tmp_path: Path) -> None:
    (tmp_path / "slide.urdf").write_text(
        """<robot name="slide"><link name="base"/><link name="tool"><inertial><mass value="2"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="lift" type="prismatic"><parent link="base"/><child link="tool"/><axis xyz="0 0 1"/>
        <limit lower="0" upper="1" effort="50" velocity="2"/></joint></robot>"""
    )
    robot = ps.load_robot(tmp_path / "slide.urdf", tool="tool")
    result = assess(robot, ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0]))
    labels = [panel.get_ylabel() for panel in plots.plot_joints(result).axes]
    assert labels == ["position [m]", "velocity [m/s]", "acceleration [m/s²]", "jerk [m/s³]"]
    assert plots.plot_torque(result).axes[0].get_ylabel() == "force [N]"
    assert plots.plot_torque_split(result).axes[0].get_ylabel() == "force [N]"


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (lambda _: plots.plot_torque([]), r"expected one Assessment or a sequence of them, got \[\]"),
        (lambda _: plots.plot_torque("septic"), "expected one Assessment"),
        (lambda a: plots.plot_trajectory(a), "expected one Trajectory"),
        (lambda a: plots.plot_torque_split([a, a]), "expected one Assessment"),
        (lambda a: plots.plot_trajectory(a.motion.trajectory, 4), r"order = 4 is not one of 0 \(position\)"),
        (lambda a: plots.plot_joints(a, orders=()), "orders: at least one of 0"),
        (lambda a: plots.plot_torque(a, joints="elbow"), "joints: 'elbow' is not one of joint1, joint2, joint3"),
        (lambda a: plots.plot_torque(a, joints=[]), "joints: at least one of joint1"),
        (lambda a: plots.plot_torque(a, ax=Figure().subplots(1, 2)), "ax: 6 axes are needed, one for each of joint1"),
        (lambda a: plots.plot_torque(a, joints="joint1", ax=[1]), "ax: 1 axes are needed, one for each of joint1"),
        (lambda a: plots.plot_joints([a, a], labels=["one"]), "labels: 2 texts are needed"),
        (
            lambda a: plots.plot_trajectory([a.motion.trajectory, ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0])]),
            r"must have the same joints; got \[1, 6\] joints",
        ),
    ],
)
def test_bad_input_is_refused(septic: Assessment, draw, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        draw(septic)


def test_a_script_shows_a_figure(monkeypatch: pytest.MonkeyPatch, figures: dict[str, Figure]) -> None:
    """As the last line of a script a plot showed nothing, and `show` of a figure without pyplot was an error."""
    shown = []
    monkeypatch.setattr(ImageShow, "show", lambda picture: bool(shown.append(picture.size)) or True)
    next(iter(figures.values())).show()
    assert shown[0][0] == 900
    monkeypatch.setattr(ImageShow, "show", lambda _: False)
    with pytest.raises(InputError, match=r"no program here shows pictures; write a file instead"):
        next(iter(figures.values())).show()


def test_bars_have_no_frame_and_charts_half_of_one(figures: dict[str, Figure]) -> None:
    """Four black spines around each chart: correct, not beautiful."""
    assert not any(spine.get_visible() for spine in figures["utilisation"].axes[0].spines.values())
    seen = {side for side, spine in figures["torque"].axes[0].spines.items() if spine.get_visible()}
    assert seen == {"left", "bottom"}
