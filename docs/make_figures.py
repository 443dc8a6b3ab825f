"""Make the figures of README and docs again: python docs/make_figures.py."""

from __future__ import annotations

from pathlib import Path

import puma_septic as ps

IMAGES = Path(__file__).parent / "images"


def main() -> None:
    """Torque of the points with the tool turned, for three profiles; jerk against overshoot of the septic."""
    assessments = ps.assess_task(ps.load_task("paper-turned"))
    IMAGES.mkdir(exist_ok=True)
    ps.plots.plot_torque(assessments).savefig(IMAGES / "torque.png", dpi=90)
    task = ps.resolve_task(ps.load_task("paper"))
    objectives = ("integral_of_squared_jerk", "overshoot")
    front = ps.pareto_front(ps.septic, task.points, task.times, objectives=objectives)
    ps.plots.plot_pareto_front(front).savefig(IMAGES / "front.png", dpi=90)


if __name__ == "__main__":
    main()
