"""What a report says of drives: held against a cycle, or chosen from a catalogue."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

from puma_septic.assessment import Assessment
from puma_septic.cycle import assess_cycle
from puma_septic.pictures.sizing import arm_front_picture, sizing_pictures
from puma_septic.report._case import Case, DriveUse, boxed, titled
from puma_septic.sizing import LoadCase, Selection, Sizing
from puma_septic.views import selection as selection_view
from puma_septic.views.checks import percent
from puma_septic.views.sizing import governing_rows

__all__ = ["selection_case", "sizing_case"]


def _drives(document: Mapping[str, Any], chosen: Mapping[str, str]) -> tuple[DriveUse, ...]:
    """Of a sizing's document, with the chosen parts of each joint."""
    return tuple(
        DriveUse(
            joint=joint,
            parts=chosen.get(joint, ""),
            limit=check.quantity,
            use=percent(check.utilisation) + (" !" if check.is_violated else ""),
            percent=100 * check.utilisation,
            is_violated=check.is_violated,
        )
        for joint, check in governing_rows(document)
    )


def _chosen(document: Mapping[str, Any]) -> dict[str, str]:
    """Motor and gearbox of each joint."""
    first = {joint["name"]: joint["kept"][0] for joint in document["joints"] if joint["kept"]}
    return {name: " + ".join(filter(None, (pair["motor"], pair["gearbox"]))) for name, pair in first.items()}


def sizing_case(
    sizing: Sizing, title: str | None, document: Mapping[str, Any], point_names: Sequence[str] = ()
) -> Case:
    """The verdict on given drives, and the limit that each joint's uses most."""
    group = _cycle(sizing.load_cases)
    return Case(
        title=titled(group, title),
        assessments=group,
        labels=["cycle"],
        is_feasible=sizing.is_feasible,
        sentence=f"The drives are {sizing.verdict}.",
        drives=_drives(document, {}),
        point_names=tuple(point_names),
        preface=boxed(sizing._repr_html_() + _BELOW),
        pictures=sizing_pictures(sizing),
        inputs=_repeating(document),
    )


def selection_case(
    selection: Selection, title: str | None, document: Mapping[str, Any], point_names: Sequence[str] = ()
) -> Case:
    """What was chosen first, then how it fares."""
    group = _cycle(selection.load_cases)
    sizing = selection.sizing
    chosen = "" if sizing is None else f"<h3>The first pair of each joint</h3>{sizing._repr_html_()}{_BELOW}"
    front = (arm_front_picture(selection.front()),) if document.get("front") else ()
    return Case(
        title=titled(group, title),
        assessments=group,
        labels=["cycle"],
        is_feasible=selection.is_feasible,
        sentence=selection_view.sentence(document),
        drives=() if sizing is None else _drives(document["sizing"], _chosen(document)),
        point_names=tuple(point_names),
        preface=boxed(selection_view.html(document) + chosen),
        pictures=() if sizing is None else (*front, *sizing_pictures(sizing)),
        inputs=_repeating(document),
        is_undecided=not selection.can_be_decided,
    )


_BELOW: Final = (
    "<p>Below the charts of the drives is the cycle, of load cases the first, held against the robot's limits.</p>"
)
# Keys of a sizing's document that say what was asked.
_ASKED: Final = ("task", "file", "inputs", "rank", "conditions", "load_cases", "catalogue")


def _cycle(cases: Sequence[LoadCase]) -> tuple[Assessment, ...]:
    """The first load case as one motion, with what the arm carries at each time."""
    return (assess_cycle(cases[0].cycle).whole,)


def _repeating(document: Mapping[str, Any]) -> dict[str, Any]:
    return {key: document[key] for key in _ASKED if document.get(key)}
