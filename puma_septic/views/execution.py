"""Documents of simulations and executions as text, HTML and CSV: samples, and said so."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from math import isinf
from textwrap import wrap
from typing import Any, Final

from puma_septic.document import csv_text, numeric
from puma_septic.views.tables import Cell, html_table, number, text_table

__all__ = ["csv", "html", "sentence", "simulation_html", "simulation_text", "text"]

Document = Mapping[str, Any]

_WIDTH: Final = 100
_JOINTS: Final = ("joint", "error [rad]", "rms", "at the end", "vibration", "at limit [s]", "energy [J]")
_JOINT_NOTE: Final = (
    "Deviation from the plan (m for prismatic joints): the largest, the root mean square and at the end of the motion;"
    " vibration: half the range after the end; at limit: how long the torque was at its limit; energy: what the"
    " actuator put in. From samples of a simulation."
)
_PROFILES: Final = (
    "profile",
    "time\n[s]",
    "tool\n[mm]",
    "rms\n[mm]",
    "at end\n[mm]",
    "settled\n[s]",
    "swing\n[mm]",
    "joints\n[mrad]",
    "limit\n[s]",
    "energy\n[J]",
)
_PROFILE_NOTE: Final = (
    "Distance of the tool from its plan: the largest, the root mean square and at the end of the motion; settled: time"
    " until it stays within 0.1 mm; swing: half its range after the end; joints: the largest deviation of a joint"
    " (mm where prismatic); limit: how long a torque was at its limit, summed over the joints; energy put in. From"
    " samples of a simulation."
)


def simulation_text(document: Document) -> str:
    """A table of the joints, and a sentence about the tool."""
    run = document["run"]
    lines = [*wrap(_head(document), _WIDTH), ""]
    if run["divergence"] is not None:
        return "\n".join([*lines, *wrap(_divergence(run["divergence"]), _WIDTH)])
    lines += [text_table(_JOINTS, _joint_rows(document)), *wrap(_JOINT_NOTE, _WIDTH), "", _tool(run["metrics"])]
    return "\n".join(lines)


def simulation_html(document: Document) -> str:
    """The same for a notebook."""
    run = document["run"]
    head = f"<p>{escape(_head(document))}</p>"
    if run["divergence"] is not None:
        return f"{head}\n<p>{escape(_divergence(run['divergence']))}</p>"
    table = html_table(_JOINTS, _joint_rows(document))
    return f"{head}\n{table}\n<p>{escape(_JOINT_NOTE)}</p>\n<p>{escape(_tool(run['metrics']))}</p>"


def sentence(document: Document) -> str:
    """What a reader wants to know first: which arms left their plans, and which came closest to its own."""
    diverged = [run["name"] for run in document["runs"] if run["divergence"]]
    kept = [run for run in document["runs"] if not run["divergence"]]
    said = [f"Diverged from the plan: {', '.join(diverged)}."] if diverged else []
    if not kept:
        return said[0]
    best = min(kept, key=lambda run: float(run["metrics"]["tool_peak_error"]))
    closest = "Closest to its plan" if len(kept) > 1 else "Distance from the plan"
    said.append(f"{closest}: {best['name']}, the tool at most {_mm(best['metrics']['tool_peak_error'])} mm off.")
    late = [run["name"] for run in kept if isinf(numeric(run["metrics"]["settling_time"]))]
    said += [f"Not within 0.1 mm in the simulated time after the end: {', '.join(late)}."] if late else []
    limited = [run["name"] for run in kept if sum(run["metrics"]["saturation_time"]) > 0]
    said.append(f"Torque at its limit: {', '.join(limited)}." if limited else "No torque reached its limit.")
    return " ".join(said)


def text(document: Document) -> str:
    """What matters in a sentence, one row for each profile, and what they have in common."""
    lines = [
        *wrap(sentence(document), _WIDTH),
        "",
        *wrap(_common(document), _WIDTH),
        "",
        text_table(_PROFILES, _profile_rows(document)),
        *wrap(_PROFILE_NOTE, _WIDTH),
    ]
    for remark in _remarks(document):
        lines += ["", *wrap(remark, _WIDTH)]
    return "\n".join(lines)


def html(document: Document) -> str:
    """The same as a page has it."""
    parts = [f"<p>{escape(_common(document))}</p>", f'<div class="scroll">{_profile_table(document)}</div>']
    parts += [f"<p>{escape(remark)}</p>" for remark in (_PROFILE_NOTE, *_remarks(document))]
    return "\n".join(parts)


def csv(document: Document) -> str:
    """One line per profile and joint, after a line for the tool."""
    runs = document["runs"]
    of_joints = [name for name, value in runs[0]["metrics"].items() if name in _PER_JOINT]
    of_tool = [name for name in runs[0]["metrics"] if name not in of_joints]
    rows: list[list[Any]] = [["profile", "duration", "diverged_at", "joint", *of_joints, *of_tool]]
    for run in runs:
        stopped = None if run["divergence"] is None else run["divergence"]["time"]
        head = [run["name"], run["duration"], stopped]
        rows.append([*head, "all", *[None] * len(of_joints), *(run["metrics"][name] for name in of_tool)])
        for j, joint in enumerate(document["joint_names"]):
            values = [None if run["metrics"][name] is None else run["metrics"][name][j] for name in of_joints]
            rows.append([*head, joint, *values, *[None] * len(of_tool)])
    return csv_text(rows)


_PER_JOINT: Final = (
    "peak_error", "rms_error", "end_error", "saturation_time", "chattering", "residual_vibration", "energy_in",
)  # fmt: skip


def _profile_table(document: Document) -> str:
    return html_table([head.replace("\n", " ") for head in _PROFILES], _profile_rows(document))


def _head(document: Document) -> str:
    run = document["run"]
    return f"{run['profile']} in {run['duration']:.4g} s, simulated: {_controller(document['controller'], run)}"


def _common(document: Document) -> str:
    return f"Simulated: {_controller(document['controller'], document['runs'][0])}"


def _controller(controller: Document, run: Document) -> str:
    rate = numeric(run["rate"])
    law = controller["law"].replace("_", " ")
    said = f"{law} at each stage of the integrator" if isinf(rate) else f"{law} at {rate:.6g} Hz"
    if controller["law"] != "none" and not controller["has_own_gains"]:
        said += f", bandwidth {_values(controller['bandwidth'])} Hz"
    return f"{said}, {'rigid' if run['elastic'] is None else 'elastic'} gears, steps of {run['step']:.3g} s"


def _values(value: float | Sequence[float]) -> str:
    return f"{value:g}" if isinstance(value, float) else "/".join(f"{one:g}" for one in value)


def _divergence(divergence: Document) -> str:
    return (
        f"Diverged at t = {divergence['time']:.4g} s: joint {divergence['joint']!r} is"
        f" {_short(numeric(divergence['error']))} rad (m) off its plan. What was computed until then is kept."
    )


def _joint_rows(document: Document) -> list[list[Cell]]:
    metrics = document["run"]["metrics"]
    keys = ("peak_error", "rms_error", "end_error", "residual_vibration", "saturation_time", "energy_in")
    return [[name, *(_short(metrics[key][j]) for key in keys)] for j, name in enumerate(document["joint_names"])]


def _tool(metrics: Document) -> str:
    settled = numeric(metrics["settling_time"])
    return (
        f"Tool: {_mm(metrics['tool_peak_error'])} mm off its plan at most, {_mm(metrics['tool_rms_error'])} mm rms,"
        f" {_mm(metrics['tool_end_error'])} mm at the end; "
        + ("not settled within 0.1 mm." if isinf(settled) else f"within 0.1 mm {settled:.3g} s later.")
    )


def _profile_rows(document: Document) -> list[list[Cell]]:
    return [_profile_row(run) for run in document["runs"]]


def _profile_row(run: Document) -> list[Cell]:
    metrics = run["metrics"]
    if run["divergence"] is not None:
        return [run["name"], f"{run['duration']:.4g}", f"diverged at {run['divergence']['time']:.3g} s", *[""] * 7]
    settled = numeric(metrics["settling_time"])
    return [
        run["name"],
        f"{run['duration']:.4g}",
        *(_mm(metrics[f"tool_{name}"]) for name in ("peak_error", "rms_error", "end_error")),
        "no" if isinf(settled) else f"{settled:.3g}",
        _mm(metrics["tool_residual_vibration"]),
        _short(1e3 * max(metrics["peak_error"])),
        _short(sum(metrics["saturation_time"])),
        _short(sum(metrics["energy_in"])),
    ]


def _remarks(document: Document) -> list[str]:
    remarks = list(document["notes"])
    remarks += [f"{run['name']}: {_divergence(run['divergence'])}" for run in document["runs"] if run["divergence"]]
    return remarks


def _mm(metres: float) -> str:
    return _short(1e3 * metres)


def _short(value: float) -> str:
    return number(value, 3)
