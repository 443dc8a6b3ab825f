"""Make the README's figure again: python docs/make_figures.py."""

from __future__ import annotations

from pathlib import Path

import puma_septic as ps

IMAGES = Path(__file__).parent / "images"


def main() -> None:
    """Torque of the paper's points with the tool turned, for its three profiles."""
    assessments = ps.assess_task(ps.load_task("paper-turned"))
    IMAGES.mkdir(exist_ok=True)
    ps.plots.plot_torque(assessments).savefig(IMAGES / "torque.png", dpi=90)


if __name__ == "__main__":
    main()
