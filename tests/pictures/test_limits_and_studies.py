"""Pictures of payload over duration and of studies."""

from __future__ import annotations

import numpy as np
import pytest

import puma_septic as ps
from puma_septic import plots
from puma_septic.limits import MotionLimits
from puma_septic.pictures.limits import payload_picture
from puma_septic.pictures.study import map_picture
from puma_septic.study import StudyMap


@pytest.fixture(scope="module")
def found() -> MotionLimits:
    """Limits of one quick motion."""
    move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 1.0])
    return ps.motion_limits(ps.compute_motion(ps.load_robot(), move))


def test_the_curve_is_the_payload_and_the_point_the_motion_as_given(found: MotionLimits) -> None:
    picture = payload_picture([found], ["quick"])
    curve, mark = picture.panels[0].curves[0], picture.panels[0].marks[0]
    assert curve.x.tolist() == found.durations.tolist()
    assert curve.y.tolist() == found.masses[:, 1].tolist()
    assert found.heaviest is not None
    assert (mark.x, mark.y) == (1.0, found.heaviest.mass)
    assert picture.legend[0].label == "quick"


def test_matplotlib_draws_the_same(found: MotionLimits) -> None:
    figure = plots.plot_payload([found])
    line = figure.axes[0].lines[0]
    assert np.asarray(line.get_ydata()) == pytest.approx(found.masses[:, 1])


def test_where_nothing_can_be_carried_it_is_said() -> None:
    outside = ps.quintic_segments([[0.0] * 6, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]], [0.0, 1.0])
    none = ps.motion_limits(ps.compute_motion(ps.load_robot(), outside))
    assert none.fastest is None
    assert "whatever is carried" in none.why_not_heaviest
    assert "No payload keeps the limits" in payload_picture([none], ["x"]).panels[0].message.replace("\n", " ")


def test_lines_of_a_map_cross_where_the_values_do() -> None:
    """Known answer: x + y crosses 1 on the straight line y = 1 - x."""
    x, y = np.linspace(0, 1, 5), np.linspace(0, 2, 9)
    found = StudyMap(x_name="duration", y_name="payload", column="utilisation", x=x, y=y, values=x + y[:, None])
    panel = map_picture(found).panels[0]
    line = next(curve for curve in panel.curves if curve.label == "100 % used")
    assert line.y == pytest.approx(1 - line.x)
    assert (panel.x_label, panel.y_label) == ("duration [s]", "payload [kg]")
    flat = StudyMap(x_name="a", y_name="b", column="feasible", x=x, y=y, values=np.ones((9, 5)))
    assert "crosses none of the levels" in map_picture(flat).panels[0].message.replace("\n", " ")
