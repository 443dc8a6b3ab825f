"""``puma-septic study``."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from puma_septic.cli._arguments import count
from puma_septic.cli._output_arguments import add_format
from puma_septic.cli._parser import Answer

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "a task varied along axes, every case a row of a table"

DESCRIPTION = """\
STUDY.yaml: carry a study out, or go on with one that was ended; cases that differ in duration and payload alone share
one pass of the dynamics. summarise FOLDER: feasible share, what governs, the front. plot FOLDER: the feasible share
over two axes, as SVG.

Exit code: 0 done, 2 bad input (a case that fails is a row with its error), 130 interrupted: run it again to go on."""

EXAMPLES = """study reach.yaml --out reach
study reach.yaml --out reach --scheduler tcp://127.0.0.1:8786
study summarise reach
study plot reach --x duration --y payload"""

_ACTIONS = ("summarise", "plot")


def add_arguments(parser: ArgumentParser) -> None:
    """What to do, and where."""
    parser.add_argument("what", nargs="+", metavar="WHAT", help="STUDY.yaml, summarise FOLDER or plot FOLDER")
    parser.add_argument("--out", metavar="DIR", help="the study's folder (default: the file's name without .yaml)")
    parser.add_argument("--workers", type=count, metavar="N", help="processes (default: one for each processor)")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers compute instead")
    parser.add_argument("--yes", action="store_true", help="more than two million cases are meant")
    parser.add_argument("--x", metavar="AXIS", default="duration", help="of a plot (default: duration)")
    parser.add_argument("--y", metavar="AXIS", default="payload", help="of a plot (default: payload)")
    parser.add_argument(
        "--column", choices=("feasible", "utilisation"), default="feasible", help="of a plot: share, or the least"
    )
    add_format(parser, "text", "json")


def run(arguments: Namespace) -> Answer:
    """Carry out, summarise or plot."""
    from puma_septic.errors import InputError

    what = arguments.what
    if what[0] in _ACTIONS:
        if len(what) != 2:
            raise InputError(f"study {what[0]}: expected one folder, got {' '.join(what[1:]) or 'none'}")
        return _summarised(arguments, what[1]) if what[0] == "summarise" else _plotted(arguments, Path(what[1]))
    if len(what) != 1:
        raise InputError(f"study: expected one study file, summarise FOLDER or plot FOLDER, got {' '.join(what)}")
    return _carried_out(arguments, Path(what[0]))


def _carried_out(arguments: Namespace, path: Path) -> Answer:
    from puma_septic.study import load_study, run_study

    study = load_study(path)
    folder = arguments.out or path.with_suffix("")
    with _progress() as progress:
        done = run_study(
            study,
            folder,
            workers=arguments.workers,
            scheduler=arguments.scheduler,
            confirmed=arguments.yes,
            progress=progress,
        )
    text = f"{study.name}: {done.n_cases:,} cases in {done.folder}, {done.n_computed:,} of them now"
    return Answer(text, 0) if arguments.format == "text" else _summarised(arguments, str(folder))


def _summarised(arguments: Namespace, folder: str) -> Answer:
    from puma_septic.document import to_json
    from puma_septic.study import summarise_study

    summary = summarise_study(folder)
    return Answer(to_json(summary.to_dict()) if arguments.format == "json" else str(summary), 0)


def _plotted(arguments: Namespace, folder: Path) -> Answer:
    from puma_septic.pictures.study import map_picture
    from puma_septic.report.svg import write_svg
    from puma_septic.study import study_map

    picture = map_picture(study_map(folder, arguments.x, arguments.y, column=arguments.column))
    write_svg(folder, [picture])
    return Answer(f"Figure: {folder / picture.name}.svg", 0)


@contextmanager
def _progress() -> Iterator[Any]:
    """Rate and time left on stderr, where that is a terminal."""
    import sys

    from tqdm import tqdm

    bar = tqdm(file=sys.stderr, disable=None, leave=False, unit="case", unit_scale=True)

    def progress(done: int, total: int) -> None:
        if bar.total is None:
            bar.initial = bar.n = done
        bar.total = total
        bar.update(done - bar.n)

    try:
        yield progress
    finally:
        bar.close()
