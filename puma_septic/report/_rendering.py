"""Templates filled in; what comes from a user is always escaped."""

from __future__ import annotations

import json
import re
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from puma_septic.pictures import HUES
from puma_septic.report._charts import BOX, SIZE, Chart

__all__ = ["render"]


def render(template: str, **values: Any) -> str:
    """Fill in one of the package's templates."""
    return _environment().get_template(template).render(**values)


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("puma_septic.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    environment.filters["breakable"] = _breakable
    environment.globals |= {
        "box": BOX,
        "size": SIZE,
        "chart": lambda panel: Chart(panel=panel),
        "chart_css": _hues() + _own("chart.css"),
        "figure_css": Markup(_on_paper(_hues() + _own("chart.css"))),
        "page_css": _own("page.css"),
        "page_js": Markup(f"const BOX = {json.dumps(BOX)}, SIZE = {json.dumps(SIZE)};\n") + _own("page.js"),
    }
    return environment


def _breakable(name: str) -> Markup:
    """A joint's name that may be broken after its underscores, as names of twenty letters stand in narrow columns."""
    return escape(name).replace("_", Markup("_<wbr>"))


def _own(name: str) -> Markup:
    """A file of ours, with nothing of a user's in it, to stand in the page as it is."""
    return Markup(files("puma_septic.report").joinpath("templates", name).read_text(encoding="utf-8"))


def _hues() -> Markup:
    """The colours of all pictures: variables, and a class for each."""
    light = " ".join(f"--{hue.name}: {hue.light};" for hue in HUES)
    dark = " ".join(f"--{hue.name}: {hue.dark};" for hue in HUES)
    classes = " ".join(f".{hue.name} {{ color: var(--{hue.name}); }}" for hue in HUES)
    return Markup(
        f":root {{ {light} }}\n@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n{classes}\n"
    )


def _on_paper(css: str) -> str:
    """The style sheet with the colours of its light page in place of variables, which drawing programs do not know."""
    light = re.sub(r"@media[^{]*\{\s*:root \{[^}]*\}\s*\}", "", css)
    colours = dict(re.findall(r"--([\w-]+): ([^;]+);", light))
    plain = re.sub(r":root \{[^}]*\}", "", light)
    while "var(" in plain:  # a variable may stand for another one
        plain = re.sub(r"var\(--([\w-]+)\)", lambda match: colours[match[1]], plain)
    return plain.strip()
