"""URDF text in: bytes to an XML tree that knows the line of every element, and what is found wrong in it."""

from __future__ import annotations

import stat
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NoReturn, final
from xml.parsers import expat

from puma_septic.errors import ModelError
from puma_septic.files import kind_of, why

__all__ = ["Finding", "UrdfText", "read_urdf", "read_utf8"]

MAX_BYTES = 5_000_000  # the largest of 69 public URDFs (example-robot-data 6) has 0.3 MB
MAX_NESTING = 100  # Pinocchio's own parser refuses more than 500 levels; a URDF needs six
MOST_TOLD = 20  # faults in one message; a reader mends no more at once


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Finding:
    """Something odd or wrong in a URDF.

    Attributes
    ----------
    text : str
        Where it is, what it is, and what would be valid.
    kind : {"note", "ignored", "fault", "refusal"}
        Odd but usable; of no meaning here (`text` is "elements" or "attributes", `attribute` the name); wrong, which
        stops only what depends on it where its part can be left out; or what stops all the same, such as a misspelt
        attribute.
    part : Element or None
        The part of a link or joint that is left out for a fault; None where nothing can be read without it.
    attribute : str
        The one attribute of the part that is left out; "" for the whole part.
    """

    text: str
    kind: Literal["note", "ignored", "fault", "refusal"] = "fault"
    part: ET.Element | None = None
    attribute: str = ""

    @property
    def stops(self) -> bool:
        """Whether the robot cannot be loaded."""
        return self.kind == "refusal" or (self.kind == "fault" and self.part is None)


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

    def at(self, element: ET.Element, message: str) -> str:
        """Line, element and owner before a message about an element."""
        line, owner = self.places[element]
        return f"line {line}, <{element.tag}>{owner}: {message}"

    def fault(self, element: ET.Element, message: str) -> Finding:
        """What is wrong about an element without which nothing can be read."""
        return Finding(text=self.at(element, message))

    def complaint(self, message: str) -> ModelError:
        """The error to raise about the file as a whole."""
        return ModelError(f"{self.path}: {message}")

    def error(self, findings: Sequence[Finding]) -> ModelError:
        """The error that tells all that stops the file from being read, at once."""
        texts = list(dict.fromkeys(finding.text for finding in findings))
        if len(texts) == 1:
            return ModelError(f"{self.path}, {texts[0]}" if texts[0].startswith("line") else f"{self.path}: {texts[0]}")
        told = "".join(f"\n  ({k}) {text}" for k, text in enumerate(texts[:MOST_TOLD], start=1))
        more = f"\n  and {len(texts) - MOST_TOLD} more" if len(texts) > MOST_TOLD else ""
        return ModelError(f"{self.path}: {len(texts)} faults:{told}{more}")


def read_utf8(path: Path, what: str, max_bytes: int) -> str:
    """Text of a file that exists, is not too large and is UTF-8.

    Raises
    ------
    ModelError
        Naming the file and the reason.
    """
    data = _read(path, what, max_bytes)
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
        With file and line, for anything that is not well-formed XML under 5 MB, in UTF-8 or the encoding that it
        declares.
    """
    data = _read(path, "URDF", MAX_BYTES)
    if not data.strip():
        raise ModelError(f"{path}: this URDF is empty")
    parser = expat.ParserCreate()
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
    parser.CharacterDataHandler = builder.data
    parser.StartDoctypeDeclHandler = refuse_doctype
    try:
        parser.Parse(data, True)
    except (expat.ExpatError, LookupError) as error:  # LookupError: an encoding that Python does not know
        raise ModelError(f"{path}, {_why_no_xml(data, error)}") from error
    return UrdfText(path=path, root=builder.close(), places=places)


def _read(path: Path, what: str, max_bytes: int) -> bytes:
    try:
        kind = kind_of(path)
        if not stat.S_ISREG(kind):
            raise ModelError(f"{path}: this {what} {'is not a file' if kind else 'does not exist'}")
        with path.open("rb") as stream:
            data = stream.read(max_bytes + 1)
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        raise ModelError(f"{path}: this {what} cannot be read: {why(error)}") from error
    if len(data) > max_bytes:
        raise ModelError(f"{path}: this {what} is larger than {max_bytes / 1e6:g} MB")
    return data


def _why_no_xml(data: bytes, error: expat.ExpatError | LookupError) -> str:
    """Line and reason; bytes that are no UTF-8 are told as that, not as what the parser makes of them."""
    if isinstance(error, LookupError):
        return f"line 1: this URDF's encoding is not known: {error}; save it as UTF-8"
    reason = expat.ErrorString(error.code) or "unknown reason"
    place = f"line {error.lineno}, column {error.offset}: not well-formed XML: {reason}"
    if error.code == expat.errors.codes[expat.errors.XML_ERROR_MISPLACED_XML_PI]:
        return f"{place}; remove what stands before <?xml"
    try:
        data.decode("utf-8-sig")
    except UnicodeDecodeError as other:
        line = data.count(b"\n", 0, other.start) + 1
        if line == error.lineno:
            return (
                f"line {line}: this URDF is not UTF-8 text ({other.reason}); save it as UTF-8, or declare its"
                ' encoding: <?xml version="1.0" encoding="ISO-8859-1"?>'
            )
    return place
