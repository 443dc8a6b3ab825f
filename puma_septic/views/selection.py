"""A selection's document as text, HTML and CSV: what was chosen, with which margin, and what else there is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from math import isnan
from typing import Any, Final

from puma_septic.document import csv_text, numeric
from puma_septic.limit_check import LimitCheck
from puma_septic.views.checks import percent
from puma_septic.views.sizing import governing_rows, hours, reserve_lines
from puma_septic.views.tables import Cell, html_table, number, text_table

__all__ = ["bill_csv", "html", "sentence", "short_text", "text"]

Document = Mapping[str, Any]
# A ratio beyond this is told as no bound: no gear train of a joint has one of the kind.
_ANY_RATIO: Final = 1e6
# Choices for the whole arm that are shown.
_SHOWN: Final = 20
_HEADS: Final = {
    "bill": "Bill of material",
    "choice": "Chosen, with the governing limit of each joint",
    "conditions": "Conditions",
    "cases": "Load cases",
    "front": "Choices for the whole arm that no other beats in mass, cost and margin together",
    "pairs": "The best pairs of each joint",
    "pairs_note": "use: utilisation of the governing limit; best ratio and ratio window: by RMS torque and speed,"
    " without friction",
}


def sentence(document: Document) -> str:
    """The verdict, with mass, cost and the limit that governs where every joint has a pair."""
    verdict = f"{document['verdict'][0].upper()}{document['verdict'][1:]}"
    if document["sizing"] is None:
        return f"{verdict}."
    totals = document["totals"]
    known = {"mass": f"{number(numeric(totals['mass']), 3)} kg", "cost": f"cost {numeric(totals['cost']):.6g}"}
    said = [text for key, text in known.items() if not isnan(numeric(totals[key]))]
    pairs = governing_rows(document["sizing"])
    if pairs:
        name, worst = max(pairs, key=lambda pair: pair[1].utilisation)
        said.append(f"governing: {name} {worst.quantity}, {percent(worst.utilisation, 1)} of its limit")
    return f"{verdict}: {', '.join(said)}." if said else f"{verdict}."


def short_text(document: Document) -> str:
    """What was chosen, what became of the pairs of joints without one, and what more there is."""
    lines = [_title(document)]
    if document["sizing"] is not None:
        power = _power(document["totals"])
        headers, rows = _choice(document)
        # The life, the last column, comes with -v.
        lines += ["", text_table(headers[:-1], [row[:-1] for row in rows]), *([power] if power else [])]
    if front := _front_section(document):
        head, table, note = front[0]
        lines += ["", f"{head}:", text_table(*table), note]
    without = [f"{joint['name']}: {joint['explanation']}" for joint in document["joints"] if not joint["kept"]]
    lines += ["", *without] if without else []
    notes = [f"Note: {note}" for note in document["notes"]]
    reserves = [f"{line[0].upper()}{line[1:]}." for line in reserve_lines(document)]
    more = "More: -v shows the bill of material and the best pairs of each joint, -vv every check of those chosen."
    return "\n".join([*lines, "", *reserves, *notes, more])


def text(document: Document) -> str:
    """Tables that a person reads."""
    lines = [_title(document)]
    for head, table, note in _sections(document):
        lines += ["", f"{head}:", text_table(*table), *([note] if note else [])]
    lines += ["", *reserve_lines(document), *_explanations(document)]
    return "\n".join([*lines, *(f"Note: {note}" for note in document["notes"])])


def html(document: Document) -> str:
    """The same for a page or a notebook; every text is escaped."""
    parts = [f"<p><strong>{escape(_title(document))}</strong></p>"]
    for head, table, note in _sections(document):
        together = html_table(*table).replace(" %</td>", "&nbsp;%</td>")
        parts += [f"<h4>{escape(head)}</h4>", together, *([f"<p>{escape(note)}</p>"] if note else [])]
    lines = [*reserve_lines(document), *_explanations(document), *(f"Note: {note}" for note in document["notes"])]
    return "\n".join([*parts, *(f"<p>{escape(line)}</p>" for line in lines)])


def bill_csv(document: Document) -> str:
    """The bill of material: one row for each part, and what it is for."""
    headers = ["kind", "name", "count", "ratio", "mass [kg]", "cost", "joints", "source"]
    keys = ["kind", "name", "count", "ratio", "mass", "cost"]
    rows = [
        [*(line[key] for key in keys), " ".join(line["joints"]), line["source"]]
        for line in document["bill_of_material"]
    ]
    return csv_text([headers, *rows])


def _title(document: Document) -> str:
    said = sentence(document)[:-1]
    head = f"{document['robot']}, cycle of {document['duration']:g} s, by {document['rank']}"
    return f"{head}: {said[0].lower()}{said[1:]}"


def _power(totals: Document) -> str:
    power = numeric(totals["mean_drawn_power"])
    return "" if isnan(power) else f"Together the motors draw {number(power)} W on average."


Table = tuple[list[str], list[list[Cell]]]


def _sections(document: Document) -> list[tuple[str, Table, str]]:
    """Title, table and note, in the order in which a review reads them."""
    sections = []
    if document["sizing"] is not None:
        sections += [
            (_HEADS["choice"], _choice(document), _power(document["totals"])),
            (_HEADS["bill"], _bill(document), ""),
        ]
    if document["conditions"]:
        sections.append((_HEADS["conditions"], _conditions(document["conditions"]), ""))
    if document["load_cases"]:
        sections.append((_HEADS["cases"], _cases(document["load_cases"]), ""))
    sections += _front_section(document)
    if any(joint["kept"] or joint["undecided"] for joint in document["joints"]):
        lacking = any(joint["undecided"] for joint in document["joints"])
        note = _HEADS["pairs_note"] + ("; not decidable: enough is not known of the pair" if lacking else "")
        sections.append((_HEADS["pairs"], _pairs(document), note))
    return sections


def _choice(document: Document) -> Table:
    headers = [
        "joint", "motor", "gearbox", "ratio", "mass [kg]", "cost", "governing limit", "use", "margin", "life [h]",
    ]  # fmt: skip
    rows: list[list[Cell]] = []
    for joint in document["joints"]:
        c = joint["kept"][0]
        use, quantity = _use(c)
        rows.append([
            joint["name"], c["motor"], c["gearbox"], f"{c['ratio']:g}", numeric(c["mass"]), numeric(c["cost"]),
            quantity, use, _percent(c["margin"]), hours(c["life_hours"]),
        ])  # fmt: skip
    totals = document["totals"]
    rows.append([
        "arm", "", "", "", numeric(totals["mass"]), numeric(totals["cost"]), "", "", _percent(totals["margin"]), "",
    ])  # fmt: skip
    return headers, rows


def _percent(margin: Any) -> str:
    value = numeric(margin)
    return "unknown" if isnan(value) else f"{100 * value:z.1f} %"


def _bill(document: Document) -> Table:
    headers = ["part", "name", "count", "ratio", "mass [kg]", "cost", "joints"]
    rows: list[list[Cell]] = [
        [
            line["kind"], line["name"], line["count"], "" if line["ratio"] is None else f"{line['ratio']:g}",
            numeric(line["mass"]), numeric(line["cost"]), ", ".join(line["joints"]),
        ]
        for line in document["bill_of_material"]
    ]  # fmt: skip
    return headers, rows


def _conditions(conditions: Document) -> Table:
    rows: list[list[Cell]] = []
    for name, value in conditions.items():
        if name == "margins":
            rows += [[f"margin of {key}", f"{100 * share:g} %"] for key, share in value.items()]
        elif name == "stages":
            rows += [[f"stage of {joint}", told] for joint, told in value.items()]
        else:
            rows.append([name.replace("_", " "), _listed(value)])
    return ["condition", "value"], rows


def _front_section(document: Document) -> list[tuple[str, Table, str]]:
    """Of the whole arm's front, where it was asked for and there is one."""
    front = document.get("front")
    return [(_HEADS["front"], _front(front), _front_note(front))] if front else []


def _front(front: Sequence[Document]) -> Table:
    """The lightest, and what the others change beside the one before."""
    headers = ["mass [kg]", "cost", "margin", "pairs"]
    rows: list[list[Cell]] = []
    before: dict[str, str] = {}
    for choice in front[:_SHOWN]:
        pairs = {pair["joint"]: f"{pair['motor']} with {pair['gearbox']}" for pair in choice["pairs"]}
        told = "; ".join(f"{joint} {pair}" for joint, pair in pairs.items() if before.get(joint) != pair)
        rows.append([numeric(choice["mass"]), numeric(choice["cost"]), _percent(choice["margin"]), told])
        before = pairs
    return headers, rows


def _front_note(front: Sequence[Document]) -> str:
    more = len(front) - _SHOWN
    return "pairs: where they differ from the line above" + (f"; {more} heavier choices not shown" if more > 0 else "")


def _listed(value: Any) -> str:
    if isinstance(value, str):
        return value
    values = value if isinstance(value, Sequence) else [value]
    words = {None: "as the joint has it", True: "yes", False: "no"}
    return ", ".join(words[one] if one is None or isinstance(one, bool) else f"{one:g}" for one in values)


def _cases(cases: Sequence[Document]) -> Table:
    """Those of one name, each for a joint, in one row."""
    total = sum(case["share"] for case in cases)
    groups: dict[str, list[Document]] = {}
    for case in cases:
        groups.setdefault(case["name"], []).append(case)
    rows: list[list[Cell]] = [
        [
            name, f"{100 * sum(case['share'] for case in group) / total:.3g} %", f"{group[0]['duration']:.4g}",
            ", ".join(f"{mass:g}" for mass in group[0]["payloads"]), "; ".join(map(_whom, group)),
        ]
        for name, group in groups.items()
    ]  # fmt: skip
    return ["load case", "share", "duration [s]", "payloads [kg]", "joints"], rows


def _whom(case: Document) -> str:
    return " ".join(filter(None, (", ".join(case["joints"]) or "all", case["note"])))


def _pairs(document: Document) -> Table:
    headers = [
        "joint", "motor", "gearbox", "mass [kg]", "cost", "use", "governing limit", "inertia ratio", "gear ratio",
        "best ratio", "ratio window",
    ]  # fmt: skip
    rows: list[list[Cell]] = []
    for joint in document["joints"]:
        own = [_row(c) for c in joint["kept"]]
        own += [_row(c, "not decidable; ") for c in joint["undecided"]]
        if not joint["kept"]:
            reason = next(iter(joint["rejections"] or joint["unknowns"]), "")
            own.insert(0, ["none", "", "", "", "", reason, "", "", "", ""])
        rows += [[joint["name"], *cells] for cells in own]
    return headers, rows


def _row(c: Document, mark: str = "") -> list[Cell]:
    use, quantity = _use(c)
    best, window = numeric(c["optimal_ratio"]), c["ratio_window"]
    return [
        c["motor"], c["gearbox"], numeric(c["mass"]), numeric(c["cost"]), use, mark + quantity,
        numeric(c["inertia_ratio"]), f"{c['ratio']:g}", _ratio(best) if 0 < best < _ANY_RATIO else "",
        "unknown" if window is None else _window(*map(numeric, window)),
    ]  # fmt: skip


def _use(c: Document) -> tuple[str, str]:
    if c["governing"] is None:
        return "", "none known"
    governing = LimitCheck.from_dict(c["governing"])
    case = f" ({governing.case})" if governing.case else ""
    return f"{100 * governing.utilisation:z.1f} %", governing.quantity + case


def _window(least: float, most: float) -> str:
    if not least <= most:
        return "empty"
    if most > _ANY_RATIO:
        return f"any above {_ratio(least)}" if least else "any"
    return f"{_ratio(least)} to {_ratio(most)}" if least else f"any up to {_ratio(most)}"


def _ratio(value: float) -> str:
    return f"{value:z.0f}" if value >= 1 else f"{value:.2g}"


def _explanations(document: Document) -> list[str]:
    return [f"{joint['name']}: {joint['explanation']}" for joint in document["joints"]]
