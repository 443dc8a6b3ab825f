"""Documents held against docs/schemas.json, every key of theirs included."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from typing import Any

from jsonschema import Draft202012Validator

from helpers.places import DOCS

SCHEMA: Mapping[str, Any] = json.loads((DOCS / "schemas.json").read_text(encoding="utf-8"))


def assert_documented(document: Mapping[str, Any]) -> None:
    """The document is as its own schema says, and has no key that the schema does not have."""
    faults = undocumented(document)
    assert not faults, "\n".join(faults[:10])


def undocumented(document: Mapping[str, Any]) -> list[str]:
    """What the schema of the document's kind does not say, one line each."""
    validator = _validator(document["schema"].split("/")[1])
    return [f"{error.json_path}: {error.message[:300]}" for error in validator.iter_errors(document)]


@cache
def _validator(kind: str) -> Draft202012Validator:
    return Draft202012Validator({"$ref": f"#/$defs/{kind}", "$defs": _closed(SCHEMA["$defs"])})


def _closed(schema: Any) -> Any:
    """What is published leaves room for keys to come; here a key that nobody described is a fault."""
    if isinstance(schema, list):
        return [_closed(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    closed = {key: _closed(value) for key, value in schema.items()}
    if isinstance(closed.get("properties"), dict):
        closed.setdefault("additionalProperties", False)
    return closed
