"""URDF text in: bytes to an XML tree that knows the line of every element."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn, final
from xml.parsers import expat

from puma_septic.errors import ModelError

__all__ = ["UrdfText", "read_urdf", "read_utf8"]

MAX_BYTES = 5_000_000  # the largest of 69 public URDFs (example-robot-data 6) has 0.3 MB
MAX_NESTING = 100  # Pinocchio's own parser refuses more than 500 levels; a URDF needs six


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class UrdfText:
    """A parsed URDF file: its tree, and for each element where it stands.

    Attributes
    ----------
    path : Path
    root : xml.etree.ElementTree.Element
    places : dict
        Element to (line, link or joint that it belongs to).
    """

    path: Path
    root: ET.Element
    places: dict[ET.Element, tuple[int, str]]

    def line(self, element: ET.Element) -> int:
        """Line of the element's start tag."""
        return self.places[element][0]

    def fault(self, element: ET.Element, message: str) -> ModelError:
        """The error to raise about an element: file, line, element and owner before the message."""
        line, owner = self.places[element]
        return ModelError(f"{self.path}, line {line}, <{element.tag}>{owner}: {message}")


def read_utf8(path: Path, what: str, max_bytes: int) -> str:
    """Text of a file that exists, is not too large and is UTF-8.

    Raises
    ------
    ModelError
        Naming the file and the reason.
    """
    try:
        if not path.is_file():
            reason = "is not a file" if path.exists() else "does not exist"
            raise ModelError(f"{path}: this {what} {reason}")
        with path.open("rb") as stream:
            data = stream.read(max_bytes + 1)
    except OSError as error:
        raise ModelError(f"{path}: this {what} cannot be read: {error.strerror}") from error
    if len(data) > max_bytes:
        raise ModelError(f"{path}: this {what} is larger than {max_bytes / 1e6:g} MB")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise ModelError(f"{path}, line {line}: this {what} is not UTF-8 text ({error.reason})") from error


def read_urdf(path: Path) -> UrdfText:
    """Parse a URDF file; document types (and so entities) are refused.

    Raises
    ------
    ModelError
        With file and line, for anything that is not well-formed XML in UTF-8 under 5 MB.
    """
    text = read_utf8(path, "URDF", MAX_BYTES)
    if not text.strip():
        raise ModelError(f"{path}: this URDF is empty")
    parser = expat.ParserCreate("utf-8")
    builder = ET.TreeBuilder()
    places: dict[ET.Element, tuple[int, str]] = {}
    owners: list[str] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        if len(owners) > MAX_NESTING:
            raise ModelError(f"{path}, line {parser.CurrentLineNumber}: more than {MAX_NESTING} nested elements")
        named = f" {attributes['name']!r}" if "name" in attributes else ""
        owners.append(named if len(owners) < 2 else f" of {owners[1]}")
        places[builder.start(tag, attributes)] = (parser.CurrentLineNumber, owners[-1])
        if len(owners) == 2:
            owners[1] = f"{tag}{named}"

    def end(tag: str) -> None:
        owners.pop()
        builder.end(tag)

    def refuse_doctype(*_: object) -> NoReturn:
        raise ModelError(f"{path}, line {parser.CurrentLineNumber}: a document type (DOCTYPE) is not allowed in a URDF")

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.StartDoctypeDeclHandler = refuse_doctype
    try:
        parser.Parse(text.encode(), True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        raise ModelError(
            f"{path}, line {error.lineno}, column {error.offset}: not well-formed XML: {reason}"
        ) from error
    return UrdfText(path=path, root=builder.close(), places=places)
