"""What pages show live: a replay, a report and the notebooks, made each time the site is built."""

from __future__ import annotations

from pathlib import Path

import nbformat
from nbconvert import HTMLExporter
from sphinx.application import Sphinx

import puma_septic as ps

# The way back, as a notebook's page has no side bar.
BACK = '<p style="padding: 8px 16px"><a href="../notebooks.html">puma_septic, notebooks</a></p>'
NOTEBOOKS = Path(__file__).parents[2] / "notebooks"


def write(app: Sphinx, error: Exception | None) -> None:
    """Into the site's folder: samples/replay.html, samples/report.html, notebooks/*.html."""
    if error is not None or app.builder.format != "html":
        return
    site = Path(app.outdir)
    task = ps.resolve_task(ps.load_task("paper-turned"))
    assessments = ps.assess_task(task)
    samples = site / "samples"
    samples.mkdir(exist_ok=True)
    replay = ps.replay_html(assessments[:2], title="PUMA 560: pick and place", point_names=task.names)
    (samples / "replay.html").write_text(replay, encoding="utf-8")
    report = ps.report_html(assessments, title="PUMA 560: pick and place")
    (samples / "report.html").write_text(report, encoding="utf-8")
    pages = site / "notebooks"
    pages.mkdir(exist_ok=True)
    # Nothing is loaded from elsewhere: the notebooks have neither equations nor widgets that need it.
    exporter = HTMLExporter(require_js_url="", jquery_url="", mathjax_url="", mermaid_js_url="", widget_renderer_url="")
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        page, _ = exporter.from_notebook_node(nbformat.read(path, as_version=4))
        # Pictures are where Sphinx puts those of the pages.
        page = page.replace("<main>", f"<main>{BACK}", 1).replace("../docs/images/", "../_images/")
        (pages / f"{path.stem}.html").write_text(page, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Run when the pages are written."""
    app.connect("build-finished", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
