"""The examination of a robot as text and as SARIF."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

__all__ = ["sarif", "text"]

Document = Mapping[str, Any]

_LEVELS: Final = {"impossible": "error", "doubtful": "warning", "missing": "note"}


def text(document: Document) -> str:
    """A verdict for each kind of answer, with what it rests on; then the loader's notes."""
    lines = [f"{document['robot']}: {'nothing doubtful' if document['is_sound'] else 'doubtful data'}"]
    for answer, verdict in document["verdicts"].items():
        lines.append(f"{answer}: {verdict}")
        found = [finding for finding in document["findings"] if finding["answer"] == answer]
        lines += [f"  {finding['severity']}, {finding['code']}: {finding['message']}" for finding in found]
    if document["notes"]:
        lines += ["noted when it was loaded:", *(f"  {note}" for note in document["notes"])]
    return "\n".join(lines)


def sarif(
    document: Document, codes: Mapping[str, tuple[str, str]], *, version: str, uri: str, lines: Mapping[str, int]
) -> dict[str, Any]:
    """SARIF 2.1.0 (OASIS, 2020), one result a part: what code-scanning services show beside the file.

    Parameters
    ----------
    document : mapping
        Of an examination.
    codes : mapping
        Of each code the answer that it touches, and what it means.
    version : str
        Of this package.
    uri : str
        Of the robot's file.
    lines : mapping of str to int
        Where parts stand in it, from 1; what is not in it stands at the first line.

    Returns
    -------
    dict
    """
    results = [
        _result(finding, part, uri, lines) for finding in document["findings"] for part in finding["parts"] or [""]
    ]
    rules = [{"id": code, "shortDescription": {"text": meaning}} for code, (_, meaning) in codes.items()]
    driver = {"name": "puma-septic doctor", "version": version, "rules": rules}
    return {
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{"tool": {"driver": driver}, "results": results}],
    }


def _result(finding: Document, part: str, uri: str, lines: Mapping[str, int]) -> dict[str, Any]:
    return {
        "ruleId": finding["code"],
        "level": _LEVELS[finding["severity"]],
        "message": {"text": finding["message"]},
        "locations": [
            {
                "physicalLocation": {
                    "artifactLocation": {"uri": uri},
                    "region": {"startLine": lines.get(part, 1)},
                },
                "logicalLocations": [{"name": part}],
            }
        ],
    }
