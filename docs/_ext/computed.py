"""Directives that compute what a page shows, each time the site is built, so that no number in it can be stale."""

import ast
import contextlib
import io
import math
import tomllib
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from puma_septic import paper, profiles
from puma_septic.views.layout import laid_out
from puma_septic.views.tables import number

# Of a page's text: wider tables are set anew, as a terminal has them, instead of broken line by line.
_COLUMNS = 78


class Run(SphinxDirective):
    """Python code that is run, with what it prints below; one page's pieces share their names."""

    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {"hidden": directives.flag}

    def run(self) -> list[nodes.Node]:
        code = "\n".join(self.content)
        spaces = self.env.temp_data.setdefault("run_names", {"__name__": "page"})
        printed = io.StringIO()
        try:
            with contextlib.redirect_stdout(printed):
                exec(compile(code, f"{self.env.docname}:{self.lineno}", "exec"), spaces)
        except Exception as error:
            raise self.error(f"this example ends in {type(error).__name__}: {error}") from error
        shown = [] if "hidden" in self.options else [(code, "python")]
        if printed.getvalue():
            shown.append((laid_out(printed.getvalue().rstrip(), _COLUMNS), "text"))
        return [nodes.literal_block(text, text, language=language) for text, language in shown]


class Claims(SphinxDirective):
    """The paper's claims, judged now."""

    def run(self) -> list[nodes.Node]:
        report = paper.reproduce(runs=21)
        parts = ["| | claim | verdict |", "|---|---|---|"]
        parts += [f"| {c.number} | {_cell(c.text)} ({_cell(c.source)}) | **{c.verdict}** |" for c in report.claims]
        for c in report.claims:
            parts += ["", f"**{c.number}. {c.verdict}.** {_cell(c.explanation)}"]
        return self.parse_text_to_nodes("\n".join(parts))


class Profiles(SphinxDirective):
    """The normalised table of the profiles, computed now."""

    def run(self) -> list[nodes.Node]:
        heads = ("profile", "C_v", "C_a", "C_j", "RMS v", "RMS a", "RMS j", "power", "class", "end jerk")
        parts = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
        for row in profiles.normalised_table():
            numbers = (row.velocity, row.acceleration, row.jerk, row.rms_velocity, row.rms_acceleration, row.rms_jerk)
            cells = [row.profile, *map(_size, numbers), _size(row.power), row.continuity, _size(row.end_jerk)]
            parts.append(f"| {' | '.join(cells)} |")
        return self.parse_text_to_nodes("\n".join(parts))


class Rooms(SphinxDirective):
    """Every room with the first line of its docstring, from the roof down."""

    def run(self) -> list[nodes.Node]:
        root = Path(__file__).parents[2]
        with (root / "pyproject.toml").open("rb") as file:
            contracts = tomllib.load(file)["tool"]["importlinter"]["contracts"]
        floors = next(contract["layers"] for contract in contracts if contract["type"] == "layers")
        parts = ["| room | what it holds |", "|---|---|"]
        for room in (name.strip() for floor in floors for name in floor.split("|")):
            path = root / "puma_septic" / room
            module = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
            summary = (ast.get_docstring(ast.parse(module.read_text(encoding="utf-8"))) or "").splitlines()[0]
            parts.append(f"| `{room}` | {_cell(summary)} |")
        return self.parse_text_to_nodes("\n".join(parts))


def _size(value: float) -> str:
    """A coefficient; what is rounding beside the others, which are near 1, is 0."""
    return "∞" if math.isinf(value) else number(value if abs(value) > 1e-9 else 0.0)


def _cell(text: str) -> str:
    """Plain text in a table: nothing in it is markup."""
    return "".join(f"\\{c}" if c in "\\|*_`<>[]$^{}#" else c for c in text)


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx about the directives."""
    app.add_directive("run", Run)
    app.add_directive("paper-claims", Claims)
    app.add_directive("profile-table", Profiles)
    app.add_directive("rooms", Rooms)
    return {"parallel_read_safe": True}
