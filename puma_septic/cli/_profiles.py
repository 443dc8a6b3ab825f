"""``puma-septic profiles``."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from dataclasses import asdict
from inspect import Parameter
from textwrap import wrap
from typing import TYPE_CHECKING, Any, Final

from puma_septic.cli._output_arguments import add_format, add_verbose
from puma_septic.cli._parser import Answer

if TYPE_CHECKING:
    from puma_septic.profiles import Family, ProfileInfo
    from puma_septic.views.tables import Cell

__all__ = ["DESCRIPTION", "EXAMPLES", "SUMMARY", "add_arguments", "run"]

SUMMARY = "list the available profiles, or the options of one"

DESCRIPTION = """\
List the profiles: what each needs, how smooth it is, what it does at the vias. With a NAME, that profile and its
options."""

EXAMPLES = """profiles
profiles lspb
profiles --normalised"""

# Jerk at the ends below this is rounding.
_ZERO: Final = 1e-9
_NOTE: Final = (
    "Class: of the motion from rest to rest, the rest included (C0: the velocity steps, C1: the acceleration, C2: the"
    " jerk); inside: between start and end. Stated for default arguments: via velocities that are given make a profile"
    " pass its vias instead of stopping there."
)
_COEFFICIENTS: Final = (
    "One unit of movement in one unit of time, from rest to rest: peaks C_v, C_a, C_j, root mean squares, largest"
    " abs(v a), jerk at the ends. A move of h in T has max|v| = C_v h/T, max|a| = C_a h/T^2, max|jerk| = C_j h/T^3."
)


def add_arguments(parser: ArgumentParser) -> None:
    """One profile, or the form of the list."""
    parser.add_argument("name", nargs="?", metavar="NAME", help="one profile, with its options and their defaults")
    parser.add_argument(
        "--normalised", action="store_true", help="also the coefficients of one unit of movement in one unit of time"
    )
    add_verbose(parser, "what each needs, and what the columns mean")
    add_format(parser, "text", "json", "csv")


def run(arguments: Namespace) -> Answer:
    """The catalogue or one of it, and the normalised table where asked for."""
    from puma_septic.document import SCHEMAS, plain, records_csv, to_json
    from puma_septic.profiles import available, family, normalised_table
    from puma_septic.views.tables import text_table

    one = None if arguments.name is None else family(arguments.name)
    infos = available() if one is None else (one.info,)
    if arguments.format == "json":
        document: dict[str, Any] = {"schema": SCHEMAS["profiles"], "profiles": [asdict(info) for info in infos]}
        if arguments.normalised:
            rows = [{key: plain(value) for key, value in asdict(row).items()} for row in normalised_table()]
            document["normalised"] = rows
        return Answer(to_json(document), 0)
    if arguments.format == "csv":
        given = normalised_table() if arguments.normalised else infos
        return Answer(records_csv(_record(asdict(one)) for one in given), 0)
    if one is not None and not arguments.normalised:
        return Answer(_described(one), 0)
    headers = ("profile", "class", "inside", "at vias", "overshoots", "needs")
    table = [_cells(info) for info in infos]
    if not arguments.verbose and not arguments.normalised:
        short = text_table(headers[:5], [row[:5] for row in table])
        return Answer(f"{short}\nMore: -v shows what each needs; --normalised its coefficients.", 0)
    lines = [text_table(headers, table), *wrap(_NOTE, 100)]
    return Answer("\n".join([*lines, *(_normalised() if arguments.normalised else [])]), 0)


def _described(one: Family) -> str:
    """A profile in words, and its options as a task names them."""
    info, options = one.info, one.defaults
    needed = ", ".join(f"{name}: ..." for name, value in options.items() if value is Parameter.empty)
    choice = f"{{name: {info.name}, {needed}}}" if needed else info.name
    shown = (
        f"{name} ({'required' if value is Parameter.empty else 'optional' if value is None else f'default: {value}'})"
        for name, value in options.items()
    )
    vias = "stops at the vias" if info.at_vias == "stops" else f"{info.at_vias} the vias"
    swing = "may overshoot" if info.overshoots else "never overshoots"
    lines = (
        f"{info.name}: {info.continuity} from rest to rest, {info.inside} inside; {vias}; {swing}",
        f"Needs: {info.needs}",
        f"Options: {', '.join(shown) or 'none'}",
        f"Source: {info.source}",
        f"In a task: profiles: [{choice}]",
    )
    return "\n".join(line for text in lines for line in wrap(text, 100, subsequent_indent="  "))


def _record(record: dict[str, Any]) -> dict[str, Any]:
    """With "unbounded" for infinity."""
    from puma_septic.document import plain

    return {key: plain(value) if isinstance(value, float) else value for key, value in record.items()}


def _cells(info: ProfileInfo) -> list[Cell]:
    needs = "\n".join(wrap(info.needs, 29))
    return [info.name, info.continuity, info.inside, info.at_vias, "may" if info.overshoots else "never", needs]


def _normalised() -> list[str]:
    from puma_septic.profiles import normalised_table
    from puma_septic.views.tables import text_table

    headers = ("law", "class", "C_v", "C_a", "C_j", "rms v", "rms a", "rms j", "v a", "end")
    rows: list[list[Cell]] = [
        [
            "\n".join(wrap(row.profile, 26)), row.continuity,
            *(
                "--" if value == float("inf") else f"{value:.4g}" if value > _ZERO else "0"
                for value in (
                    row.velocity, row.acceleration, row.jerk, row.rms_velocity, row.rms_acceleration, row.rms_jerk,
                    row.power, row.end_jerk,
                )
            ),
        ]
        for row in normalised_table()
    ]  # fmt: skip
    return ["", text_table(headers, rows), *wrap(_COEFFICIENTS, 100)]
