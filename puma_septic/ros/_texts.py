"""Files of messages as plain documents: YAML as `ros2 topic echo` prints it, or JSON."""

from __future__ import annotations

import json
from contextlib import suppress
from io import StringIO
from pathlib import Path
from typing import Any, Final

from ruamel.yaml import YAML
from ruamel.yaml.nodes import ScalarNode
from ruamel.yaml.representer import RoundTripRepresenter

from puma_septic.errors import InputError
from puma_septic.files import decoded, read_bytes, yaml_documents

__all__ = ["SUFFIXES", "documents_of", "read_documents", "text_of"]

SUFFIXES: Final = (".yaml", ".yml", ".json")
# The pure-Python YAML parser takes 7 s for a megabyte, some 2,200 points of six joints with velocities and
# accelerations; JSON a twentieth of a second.
MAX_YAML: Final = 2_000_000
MAX_JSON: Final = 64_000_000
# A goal of an action with a plan in it needs nine.
_MAX_DEPTH: Final = 24


def read_documents(path: Path) -> tuple[list[Any], bytes]:
    """The plain documents of a file, and the bytes that they were read from.

    Raises
    ------
    InputError
        Naming file and place, for what cannot be read.
    """
    as_json = path.suffix == ".json"
    data = read_bytes(path, what="trajectory file", at_most=MAX_JSON if as_json else MAX_YAML)
    return documents_of(decoded(data, path), str(path), as_json=as_json), data


def documents_of(text: str, origin: str, *, as_json: bool = False) -> list[Any]:
    """Every document of a text that is JSON, or YAML with ``---`` between documents; empty ones are left out."""
    if as_json:
        return [_json(text, origin)]
    if text.lstrip()[:1] in ("{", "["):
        with suppress(InputError):  # YAML may begin like JSON, which is read a hundred times faster
            return [_json(text, origin)]
    documents = yaml_documents(text, origin, max_depth=_MAX_DEPTH)
    return [document for document in documents if document is not None]


def text_of(document: dict[str, Any], *, as_json: bool) -> str:
    """A message as text, with all digits of each number."""
    if as_json:
        return json.dumps(document, indent=1, allow_nan=False) + "\n"
    stream = StringIO()
    yaml = YAML()  # the round-trip writer keeps the order of the keys
    yaml.Representer = _Representer
    yaml.dump(document, stream)
    return stream.getvalue()


class _Representer(RoundTripRepresenter):
    """Writes 1e-05 as 1.0e-05: without the point it is a text in YAML 1.1, which `ros2 topic pub` reads."""

    def represent_float(self, data: float) -> ScalarNode:
        text = repr(data)
        return self.represent_scalar("tag:yaml.org,2002:float", text if "." in text else text.replace("e", ".0e"))


_Representer.add_representer(float, _Representer.represent_float)


def _json(text: str, origin: str) -> Any:
    def pairs(items: list[tuple[str, Any]]) -> dict[str, Any]:
        keys = [key for key, _ in items]
        twice = next((key for key in keys if keys.count(key) > 1), None)
        if twice is not None:
            raise InputError(f"{origin}: the key {twice!r} is given twice")
        return dict(items)

    def refuse(constant: str) -> None:
        raise InputError(f"{origin}: {constant} is no number of JSON")

    try:
        return json.loads(text, object_pairs_hook=pairs, parse_constant=refuse)
    except json.JSONDecodeError as error:
        raise InputError(f"{origin}, line {error.lineno}, column {error.colno}: not valid JSON: {error.msg}") from error
    except (ValueError, RecursionError) as error:  # a number of thousands of digits; brackets nested without end
        if isinstance(error, InputError):
            raise
        raise InputError(f"{origin}: not valid JSON: {error}") from error
