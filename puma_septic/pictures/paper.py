"""What the paper reports of its computing times, beside what is measured here."""

from __future__ import annotations

from puma_septic.paper import PaperReport
from puma_septic.pictures._elements import Bar, Panel, Picture, bars
from puma_septic.pictures._styles import Fill, profile_line

__all__ = ["computing_times_picture"]


def computing_times_picture(report: PaperReport) -> Picture:
    """They differ by three powers of ten, so each has its own scale."""
    inputs, computing = report.evidence.inputs, report.evidence.computing
    panels = (
        _panel(f"here, median of {computing.runs} runs", "µs", 1e6 * computing.septic, 1e6 * computing.lspb),
        _panel("paper, one run with printing and plotting", "s", inputs.septic_seconds, inputs.lspb_seconds),
    )
    return Picture(name="computing-times", title="Computing times", panels=panels, columns=2)


def _panel(title: str, unit: str, *seconds: float) -> Panel:
    return bars(
        title,
        f"computing time [{unit}]",
        rows=("septic", "lspb"),
        bars=[
            Bar(row=k, length=size, fill=Fill(hue=profile_line(k).hue), text=f"{size:.3g}")
            for k, size in enumerate(seconds)
        ],
        end=max(seconds),
    )
