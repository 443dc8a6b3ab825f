"""The one door for TOML files that others wrote: bounded in size, depth and numbers, with every unknown key named."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from puma_septic.errors import ModelError, did_you_mean, readable
from puma_septic.robot._urdf_text import read_utf8

__all__ = ["read_toml", "table"]

_MAX_BYTES: Final = 64_000
# A dotted key of 10,000 parts (20 KB) costs tomllib 0.7 s and 396 MB (measured, CPython 3.11).
_MAX_PARTS: Final = 16
# TOML 1.0.0: "Arbitrary 64-bit signed integers should be accepted"; an error where an integer is lost.
_INTEGERS: Final = (-(2**63), 2**63 - 1)
# A text that is not closed runs to the end of its line or file, so that the search is linear whatever the file holds.
_TOKEN: Final = re.compile(
    r'''
    (?P<long>   """(?:\\.|[^\\])*?(?:"""|\Z) | \'\'\'.*?(?:\'\'\'|\Z) )
  | (?P<part>   "(?:\\[^\n]|[^"\\\n])*"? | '[^'\n]*'? | [A-Za-z0-9_-]+ )
  | (?P<dot>    \. )
  | (?P<blank>  [ \t]+ | \#[^\n]* )
  | (?P<other>  . )
    ''',
    re.DOTALL | re.VERBOSE,
)


def read_toml(path: Path, what: str) -> dict[str, Any]:
    """The tables of a TOML file.

    Parameters
    ----------
    path : Path
    what : str
        How messages call the file.

    Returns
    -------
    dict
        Plain values; integers fit into 64 bits.

    Raises
    ------
    ModelError
        For a file that is missing, larger than 64 kB or not TOML, a key of more than 16 dotted parts, or an integer
        beyond 64 bits.
    """
    text = read_utf8(path, what, _MAX_BYTES)
    if _most_parts(text) > _MAX_PARTS:
        raise ModelError(f"{path}: a key with more than {_MAX_PARTS} dotted parts is not allowed")
    try:
        data = tomllib.loads(text)
    # ValueError: an integer of thousands of digits, which Python does not read.
    except (ValueError, RecursionError) as error:
        raise ModelError(f"{path}: not valid TOML: {error}") from error
    return {readable(key): _checked(value, f"{path}, {readable(key)}") for key, value in data.items()}


def table(value: object, where: str, keys: Sequence[str] | None = None, *, kind: str = "key") -> dict[str, Any]:
    """A table that has no keys but these (None: any); a message names all others, and what may have been meant."""
    if not isinstance(value, dict):
        raise ModelError(f"{where}: expected a table, got {value!r}")
    unknown = [key for key in value if keys is not None and key not in keys]
    if keys is None or not unknown:
        return value
    meant = did_you_mean(unknown, keys)
    raise ModelError(f"{where}: unknown {kind} {', '.join(map(repr, unknown))}; valid: {', '.join(keys)}{meant}")


def _most_parts(text: str) -> int:
    """Of any dotted key in the text; dots inside texts and comments do not count."""
    most = parts = 0
    after_dot = False
    for token in _TOKEN.finditer(text):
        kind = token.lastgroup
        if kind == "part":
            parts = parts + 1 if after_dot else 1
            most = max(most, parts)
        elif kind == "blank":
            continue
        after_dot = kind == "dot"
    return most


def _checked(value: Any, where: str) -> Any:
    """The value with its texts and keys readable, and no integer beyond 64 bits."""
    if isinstance(value, dict):
        return {readable(key): _checked(item, f"{where}, {readable(key)}") for key, item in value.items()}
    if isinstance(value, list):
        return [_checked(item, f"{where}, {k}") for k, item in enumerate(value)]
    if isinstance(value, int) and not _INTEGERS[0] <= value <= _INTEGERS[1]:
        raise ModelError(f"{where}: an integer beyond 64 bits; valid: -2^63 to 2^63 - 1")
    return readable(value) if isinstance(value, str) else value
