"""Figures of comparisons and fronts: what is drawn is what was computed."""

from __future__ import annotations

import numpy as np
import pytest

import puma_septic as ps

POINTS = np.array([[0.0, 0.1, 0.2, 0.0, 0.3, 0.0], [0.4, 0.3, 0.1, 0.0, 0.5, 0.2], [0.5, 0.2, 0.4, 0.0, 0.1, 0.6],
                   [0.9, 0.8, 0.0, 0.0, 0.2, 0.1]])  # fmt: skip
TIMES = [0.0, 1.0, 2.5, 4.0]


@pytest.fixture(scope="module")
def comparison() -> ps.Comparison:
    names = ["cubic", "quintic", "quintic_spline", "lspb"]
    return ps.compare(ps.load_robot(), POINTS, TIMES, profiles=names)


def test_comparison_has_a_panel_for_each_quantity_and_a_bar_for_each_profile(comparison: ps.Comparison) -> None:
    figure = ps.plots.plot_comparison(comparison)
    panels = {panel.get_title(loc="left"): panel for panel in figure.axes}
    assert list(panels) == [
        "velocity", "acceleration", "jerk", "integral of jerk²", "overshoot", "via miss", "torque", "energy",
    ]  # fmt: skip
    widths = [bar.get_width() for bar in panels["velocity"].patches]
    np.testing.assert_allclose(widths, [row.assessment.peak_velocity.max() for row in comparison.profiles])
    assert [text.get_text() for text in panels["velocity"].get_yticklabels()] == [
        row.name for row in comparison.profiles
    ]
    assert "unbounded" in [text.get_text() for text in panels["jerk"].texts]
    assert all(panel.get_xlabel() for panel in figure.axes)


def test_comparison_colours_the_pareto_optimal(comparison: ps.Comparison) -> None:
    bars = ps.plots.plot_comparison(comparison).axes[0].patches
    best = [row.name in comparison.pareto_optimal for row in comparison.profiles]
    colours = {
        good: {bar.get_facecolor() for bar, one in zip(bars, best, strict=True) if one is good}
        for good in (True, False)
    }
    assert any(best)
    assert len(colours[True]) == 1
    assert not colours[True] & colours[False]


@pytest.mark.parametrize("objectives", [("peak_jerk", "overshoot"), ("peak_jerk", "peak_velocity", "overshoot")])
@pytest.mark.slow
def test_front_is_drawn_pair_by_pair_with_its_via_times(objectives: tuple[str, ...]) -> None:
    front = ps.pareto_front(ps.septic, POINTS, TIMES, objectives=objectives, size=3)
    figure = ps.plots.plot_pareto_front(front)
    pairs = len(objectives) * (len(objectives) - 1) // 2
    assert len(figure.axes) == pairs + 1
    np.testing.assert_array_equal(figure.axes[0].lines[0].get_xdata(), front.values[:, 0])
    np.testing.assert_array_equal(figure.axes[0].lines[0].get_ydata(), front.values[:, 1])
    np.testing.assert_array_equal(figure.axes[-1].lines[0].get_ydata(), front.times[:, 1])
