"""``puma-septic paper``."""

from __future__ import annotations

from argparse import Namespace
from importlib import import_module

from puma_septic.cli.arguments import Answer
from puma_septic.paper import reproduce
from puma_septic.report import new_folder, to_json

__all__ = ["run"]


def run(arguments: Namespace) -> Answer:
    """Reproduce the paper and judge its claims; what the verdicts are does not change the exit code."""
    report = reproduce()
    document = to_json(report.to_dict())
    if arguments.out is not None:
        with new_folder(arguments.out) as folder:
            (folder / "paper.json").write_text(document, encoding="utf-8")
            (folder / "paper.txt").write_text(f"{report}\n", encoding="utf-8")
            # Templates, the replay and matplotlib take longer to load than everything else takes to compute.
            html = import_module("puma_septic.report.page").report_html(report)
            (folder / "report.html").write_text(html, encoding="utf-8")
            figures = import_module("puma_septic.report.figures")
            for name, figure in figures.paper_figures(report):
                figures.save_figure(figure, folder / name)
    return Answer(document if arguments.format == "json" else str(report), 0)
