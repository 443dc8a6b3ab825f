"""The code that README.md and the documentation show, in the order of the page."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from helpers.places import DOCS, ROOT

# README.md, and every page of the site.
PAGES = tuple(
    path.relative_to(ROOT).as_posix() for path in (ROOT / "README.md", *sorted(DOCS.rglob("*.md")))
)  # fmt: skip
_BLOCK = re.compile(r"^```(\{run\}|\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_OPTION = re.compile(r"\A(?::\w+:.*\n)+")


class Block(NamedTuple):
    """A block of code: python (run while the site is built, or not), sh, yaml, toml, csv, text."""

    language: str
    text: str


def blocks(page: str) -> Iterator[Block]:
    """All blocks of a page; a directive's options are left out."""
    for found in _BLOCK.finditer((ROOT / page).read_text(encoding="utf-8")):
        language = "python" if found[1] == "{run}" else found[1]
        yield Block(language, _OPTION.sub("", found[2]))


def commands(page: str) -> list[str]:
    """The command lines of a page's shell blocks, without comments."""
    lines = [
        line.partition(" #")[0].strip() for b in blocks(page) if b.language == "sh" for line in b.text.splitlines()
    ]
    return [line for line in lines if line]


def example_files(folder: Path, page: str) -> None:
    """The files that the page shows, under the names by which it calls them."""
    for language, text in blocks(page):
        if language == "yaml" and (name := re.match(r"name: (\w+)$", text, re.MULTILINE)):
            (folder / f"{name[1]}.yaml").write_text(text, encoding="utf-8")
        if language == "csv":
            # A first line may name the file; without it, gearboxes have a ratio.
            named = re.match(r"# ([\w-]+\.csv)\b", text)
            name_of = named[1] if named else "gears.csv" if ",ratio," in text else "motors.csv"
            (folder / name_of).write_text(text, encoding="utf-8")
        if language == "toml" and 'robot = "arm"' in text:
            (folder / "arm.toml").write_text(text, encoding="utf-8")
