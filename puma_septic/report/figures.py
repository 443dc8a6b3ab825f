"""Figures drawn by matplotlib, one after the other, and written to files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from matplotlib import rc_context
from matplotlib.figure import Figure

from puma_septic.assessment import Assessment
from puma_septic.paper import PaperReport
from puma_septic.plots import plot_joints, plot_torque, plot_torque_split, plot_utilisation, plot_workspace
from puma_septic.plots.paper import paper_figures as drawn
from puma_septic.report.documents import profile_labels

__all__ = ["assessment_figures", "paper_figures", "save_figure", "save_png"]


def assessment_figures(assessments: Sequence[Assessment]) -> Iterator[tuple[str, Figure]]:
    """File name without suffix and figure, made when they are asked for."""
    labels = profile_labels(assessments)
    yield "joints", plot_joints(assessments, labels=labels)
    yield "torque", plot_torque(assessments, labels=labels)
    for label, assessment in zip(labels, assessments, strict=True):
        yield f"torque-split-{label}", plot_torque_split(assessment)
    yield "utilisation", plot_utilisation(assessments, labels=labels)
    yield "workspace", plot_workspace(assessments, labels=labels)


def paper_figures(report: PaperReport) -> Iterator[tuple[str, Figure]]:
    """File name without suffix and figure."""
    yield from drawn(report).items()


def save_figure(figure: Figure, path: Path) -> None:
    """Write PNG and SVG; the same figure gives the same bytes."""
    # matplotlib otherwise writes the date, and random names for the SVG's elements.
    with rc_context({"svg.hashsalt": "puma-septic"}):
        figure.savefig(path.with_name(f"{path.name}.png"))
        # Laying out costs more than drawing, and the result is the same.
        figure.set_layout_engine("none")
        figure.savefig(path.with_name(f"{path.name}.svg"), metadata={"Date": None})


def save_png(figure: Figure, path: Path) -> None:
    """Write one PNG file."""
    figure.savefig(path, format="png")
