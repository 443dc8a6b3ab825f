"""Files that others wrote, read within bounds: bytes, UTF-8 text, YAML as plain values."""

from __future__ import annotations

import hashlib
import io
import os
import reprlib
import stat
from collections.abc import Iterable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Final, final

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import AliasEvent, CollectionEndEvent, CollectionStartEvent, NodeEvent
from ruamel.yaml.nodes import MappingNode, SequenceNode

from puma_septic.errors import InputError

__all__ = [
    "YamlPlaces",
    "checked_path",
    "decoded",
    "kind_of",
    "read_bytes",
    "read_text",
    "sha256_of",
    "why",
    "yaml_documents",
    "yaml_places",
    "yaml_text",
]

_BLOCK: Final = 1 << 20


def kind_of(path: Path) -> int:
    """What lies there, as `stat.S_IFMT` has it, 0 for nothing; an OSError or ValueError where no such path can be.

    `Path.exists` and `is_file` take too long a name and a circle of links for nothing, from Python 3.14 on.
    """
    try:
        return stat.S_IFMT(path.stat().st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return 0


def why(error: Exception) -> str:
    """The system's own words for an error, without its number and the path."""
    return (isinstance(error, OSError) and error.strerror) or str(error)


def read_bytes(path: Path, *, what: str, at_most: int) -> bytes:
    """All bytes of a file, which must exist and have no more than `at_most`.

    Raises
    ------
    InputError
        Naming the file, as `what`, and the reason.
    """
    try:
        kind = kind_of(path)
        reason = "" if stat.S_ISREG(kind) else "is not a file" if kind else "does not exist"
        data = b"" if reason else _start_of(path, at_most + 1)
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        raise InputError(f"{path}: cannot read this {what}: {error}") from error
    if reason:
        raise InputError(f"{path}: this {what} {reason}")
    if len(data) > at_most:
        raise InputError(f"{path}: larger than the {at_most:,} bytes that a {what} may have")
    return data


def decoded(data: bytes, origin: str | Path) -> str:
    """UTF-8 text, without a byte order mark; `origin` is what the message calls it."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{origin}: not UTF-8 text: {error.reason} at byte {error.start}") from error


def read_text(path: str | PathLike[str], *, what: str, at_most: int) -> str:
    """`decoded` text of a file that `read_bytes` reads.

    Raises
    ------
    InputError
        Naming the file, as `what`, and the reason.
    """
    place = checked_path(path, what)
    return decoded(read_bytes(place, what=what, at_most=at_most), place)


def checked_path(path: str | PathLike[str], what: str) -> Path:
    """The path; an integer, which `open` takes for a descriptor of the process, is none.

    Raises
    ------
    InputError
        For what is no path, as the path of `what`.
    """
    if not isinstance(path, (str, PathLike)) or not isinstance(os.fspath(path), str):
        raise InputError(f"expected the path of a {what}, got {reprlib.repr(path)}")
    return Path(path)


def yaml_documents(text: str, origin: str, *, max_depth: int) -> list[Any]:
    """Every document of a YAML 1.2 text as plain values; without anchors, which let a kilobyte grow to millions.

    Raises
    ------
    InputError
        With line and column: for what is not YAML, has anchors or duplicate keys, or is nested deeper than `max_depth`.
    """
    try:
        _refuse_growth(text, origin, max_depth)
        return list(YAML(typ="safe", pure=True).load_all(text))
    except MarkedYAMLError as error:
        reason = " ".join(str(error.problem or error.context).split())
        raise InputError(f"{origin}, {_line(error.problem_mark)}: not valid YAML: {reason}") from error
    except (YAMLError, ValueError, TypeError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        # ValueError: an impossible date or a number of thousands of digits; TypeError: a list as a key.
        raise InputError(f"{origin}: not valid YAML: {' '.join(str(error).split())}") from error


@final
@dataclass(frozen=True, slots=True, eq=False)
class YamlPlaces:
    """Where the parts of a YAML document stand in its text."""

    root: Any

    def line(self, location: Iterable[str | int]) -> int:
        """The line of a key or an entry, from 1; of the last part of its way that the document has."""
        node, mark = self.root, self.root.start_mark
        for part in location:
            if isinstance(node, MappingNode):
                found = [(key, value) for key, value in node.value if key.value == str(part)]
                if not found:
                    break
                mark, node = found[0][0].start_mark, found[0][1]
            elif isinstance(node, SequenceNode) and isinstance(part, int) and part < len(node.value):
                node = node.value[part]
                mark = node.start_mark
            else:
                break
        return int(mark.line) + 1


def yaml_places(text: str) -> YamlPlaces | None:
    r"""The places of a text that `yaml_documents` has read; None where it has no document.

    Returns
    -------
    YamlPlaces or None

    Examples
    --------
    >>> yaml_places("name: a\npoints:\n  - {x: 1}\n").line(["points", 0, "x"])
    3
    """
    root = YAML(typ="safe", pure=True).compose(text)
    return None if root is None else YamlPlaces(root)


def yaml_text(data: Any) -> str:
    """Plain values as YAML, lists of numbers on one line.

    Returns
    -------
    str
    """
    stream = io.StringIO()
    writer = YAML(typ="safe", pure=True)
    writer.default_flow_style, writer.width = None, 120
    writer.representer.sort_base_mapping_type_on_output = False
    writer.dump(data, stream)
    return stream.getvalue()


def sha256_of(path: Path) -> str:
    """SHA-256 of a file's bytes, in hexadecimal digits."""
    digest = hashlib.sha256()
    try:
        with path.open("rb") as stream:
            while block := stream.read(_BLOCK):
                digest.update(block)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    return digest.hexdigest()


def _start_of(path: Path, count: int) -> bytes:
    with path.open("rb") as stream:
        return stream.read(count)


def _refuse_growth(text: str, origin: str, max_depth: int) -> None:
    """Walk through the parser's events, before anything is built, for anchors and for depth."""
    depth = 0
    for event in YAML(typ="safe", pure=True).parse(text):
        if isinstance(event, NodeEvent) and (isinstance(event, AliasEvent) or event.anchor):
            raise InputError(f"{origin}, {_line(event.start_mark)}: anchors and aliases (& and *) are not allowed")
        depth += isinstance(event, CollectionStartEvent) - isinstance(event, CollectionEndEvent)
        if depth > max_depth:
            raise InputError(f"{origin}, {_line(event.start_mark)}: nested more than {max_depth} levels deep")


def _line(mark: Any) -> str:
    return f"line {mark.line + 1}, column {mark.column + 1}" if mark is not None else "at its end"
