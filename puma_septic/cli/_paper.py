"""``puma-septic paper``."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from puma_septic.cli._output_arguments import add_format, add_out, add_verbose, asked_units, origin, with_report
from puma_septic.cli._parser import Answer

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "the paper's tables, figures and claims, reproduced and judged"

DESCRIPTION = """\
Reproduce the paper's tables, figures and computing times, and judge each of its claims by measured numbers."""

EXAMPLES = """paper --out paper"""


def add_arguments(parser: ArgumentParser) -> None:
    """Only the form."""
    add_verbose(parser, "tables, computing times and the reason of each verdict")
    add_format(parser, "text", "json", "csv")
    add_out(parser, "report.html, JSON, text and figures")


def run(arguments: Namespace) -> Answer:
    """Reproduce the paper and judge its claims; what the verdicts are does not change the exit code."""
    from puma_septic.document import records_csv
    from puma_septic.paper import reproduce
    from puma_septic.report import new_folder, to_json

    report = reproduce()
    document = to_json(report.to_dict())
    if arguments.out is not None:
        # Templates and matplotlib take longer to load than everything else takes to compute.
        from puma_septic.plots import paper_figures
        from puma_septic.report.figures import save_figure
        from puma_septic.report.page import report_html

        with new_folder(arguments.out, overwrite=arguments.force) as folder:
            (folder / "paper.json").write_text(document, encoding="utf-8")
            (folder / "paper.txt").write_text(f"{report}\n", encoding="utf-8")
            (folder / "report.html").write_text(
                report_html(report, made=origin(arguments), units=asked_units(arguments)), encoding="utf-8"
            )
            for name, figure in ({} if arguments.no_png else paper_figures(report)).items():
                save_figure(figure, folder / name)
    if arguments.format == "csv":
        return Answer(records_csv(report.to_dict()["claims"]), 0)
    text = str(report) if arguments.verbose else report.summary
    return Answer(document if arguments.format == "json" else with_report(text, arguments), 0)
