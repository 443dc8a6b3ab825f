"""Selection: motors and gearboxes for all joints of an arm, from a catalogue."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, final

import numpy as np

from puma_septic.cycle import Cycle
from puma_septic.doctor import doubts
from puma_septic.document import SCHEMAS, plain
from puma_septic.drives import Catalogue
from puma_septic.errors import InputError
from puma_septic.sizing._drivetrains import GivenDrivetrains, checked_cycle, checked_drivetrains
from puma_septic.sizing._joint_selection import RANKS, Candidate, JointSelection, Rank, select_joint
from puma_septic.sizing._loads import joint_load
from puma_septic.sizing._positions import position_remarks
from puma_septic.sizing._ratios import RatioWindow
from puma_septic.sizing._result import Sizing, size
from puma_septic.validation import checked_choice
from puma_septic.views.tables import Cell, text_table

__all__ = ["Selection", "checked_rank", "select"]

# A ratio beyond this is told as no bound: no gear train of a joint has one of the kind.
_ANY_RATIO: Final = 1e6


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Selection:
    """What of a catalogue is strong enough for a duty cycle; made by `size` with a catalogue.

    Attributes
    ----------
    cycle : Cycle
        With the masses of the chosen parts on the arm, where they were asked for.
    catalogue : Catalogue
    rank : {"mass", "cost", "margin"}
    joints : tuple of JointSelection
        One per joint.
    notes : tuple of str
        How the choice came about, where masses were placed.
    """

    cycle: Cycle
    catalogue: Catalogue
    rank: Rank
    joints: tuple[JointSelection, ...]
    notes: tuple[str, ...] = ()

    @property
    def is_feasible(self) -> bool:
        """Whether there is a pair for every joint."""
        return all(one.best is not None for one in self.joints)

    @cached_property
    def sizing(self) -> Sizing | None:
        """The cycle checked against the best pair of each joint; None where a joint has none."""
        best = [one.best for one in self.joints]
        trains = [candidate.drivetrain for candidate in best if candidate is not None]
        return size(self.cycle, drivetrains=trains) if len(trains) == len(best) else None

    def joint(self, name: str) -> JointSelection:
        """The selection at one joint."""
        return self.joints[self.cycle.joint_names.index(checked_choice("joint", name, self.cycle.joint_names))]

    @property
    def verdict(self) -> str:
        """One sentence: a choice, or the joints that have none and the most frequent reason there."""
        missing = [one for one in self.joints if one.best is None]
        if not missing:
            return "a pair that is strong enough for every joint"
        reasons = "; ".join(f"{one.joint} (most frequent reason: {next(iter(one.rejections))})" for one in missing)
        return f"no pair is strong enough for {reasons}"

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document; SI units, "unbounded" for infinity, null for unknown."""
        return {
            "schema": SCHEMAS["selection"],
            "robot": self.cycle.robot.name,
            "duration": self.cycle.duration,
            "rank": self.rank,
            "is_feasible": self.is_feasible,
            "verdict": self.verdict,
            "notes": list(self.remarks),
            "joints": [_joint_document(one) for one in self.joints],
            "sizing": None if self.sizing is None else self.sizing.to_dict(),
        }

    @property
    def remarks(self) -> tuple[str, ...]:
        """Notes, columns of the catalogue that no check uses, and what no choice of drives mends."""
        unused = self.catalogue.unused
        columns = (f"read but not used: {', '.join(unused)}",) if unused else ()
        return (*self.notes, *columns, *doubts(self.cycle.robot), *position_remarks(self.cycle))

    def __str__(self) -> str:
        title = f"{self.cycle.robot.name}, cycle of {self.cycle.duration:g} s, by {self.rank}: {self.verdict}"
        lines = [
            title,
            "",
            _table(self),
            "use: utilisation of the governing limit; ratio window: by RMS torque and speed",
        ]
        lines += ["", *(f"{one.joint}: {one.explanation}" for one in self.joints)]
        return "\n".join([*lines, *(f"Note: {note}" for note in self.remarks)])


def select(
    cycle: Cycle,
    catalogue: Catalogue,
    *,
    rank: Rank = "mass",
    keep: int | None = 5,
    places: GivenDrivetrains | None = None,
) -> Selection:
    """Choose from a catalogue for every joint; see `size`."""
    checked_rank(rank, keep)
    checked_cycle(cycle)
    own = None if places is None else checked_drivetrains(cycle, places)
    joints = tuple(
        select_joint(joint_load(cycle, j), catalogue, j, rank=rank, keep=keep, places=own)
        for j in range(len(cycle.joint_names))
    )
    return Selection(cycle=cycle, catalogue=catalogue, rank=rank, joints=joints)


def checked_rank(rank: Rank, keep: int | None) -> None:
    """Raise an InputError for an unknown rank or an invalid number of pairs."""
    checked_choice("rank", rank, RANKS)
    if keep is not None and (isinstance(keep, bool) or not isinstance(keep, int) or keep < 1):
        raise InputError(f"keep = {keep!r}: expected a number of pairs from 1, or None for all")


def _table(selection: Selection) -> str:
    headers = ["joint", "motor", "gearbox", "mass [kg]", "cost", "use", "governing limit", "ratio", "best", "window"]
    rows: list[list[Cell]] = []
    for one in selection.joints:
        if one.best is None:
            rows.append([one.joint, "none", "", "", "", "", next(iter(one.rejections)), "", "", ""])
        for k, candidate in enumerate(one.kept):
            rows.append(_row(one.joint if k == 0 else "", candidate))
    return text_table(headers, rows)


def _row(joint: str, c: Candidate) -> list[Cell]:
    use, quantity = "", "none known"
    if c.governing is not None:
        use, quantity = f"{100 * c.governing.utilisation:.1f} %", c.governing.quantity
    best = "" if c.window is None or not 0 < c.window.optimal < _ANY_RATIO else _ratio(c.window.optimal)
    return [
        joint, c.motor, c.gearbox, c.mass, c.cost, use, quantity, f"{c.drivetrain.ratio:g}", best, _window(c.window)
    ]  # fmt: skip


def _window(window: RatioWindow | None) -> str:
    if window is None:
        return "unknown"
    if window.is_empty:
        return "empty"
    if window.most > _ANY_RATIO:
        return f"any above {_ratio(window.least)}" if window.least else "any"
    return f"{_ratio(window.least)} to {_ratio(window.most)}" if window.least else f"any up to {_ratio(window.most)}"


def _ratio(value: float) -> str:
    return f"{value:.0f}" if value >= 1 else f"{value:.2g}"


def _joint_document(one: JointSelection) -> dict[str, Any]:
    return {
        "name": one.joint,
        "pairs": len(one.reasons),
        "feasible_pairs": int(np.count_nonzero(one.is_feasible)),
        "rejections": one.rejections,
        "kept": [_candidate_document(candidate) for candidate in one.kept],
    }


def _candidate_document(c: Candidate) -> dict[str, Any]:
    window = c.window
    return {
        "motor": c.motor,
        "gearbox": c.gearbox,
        "ratio": c.drivetrain.gearbox.ratio,
        "mass": plain(c.mass),
        "cost": plain(c.cost),
        "margin": plain(c.margin),
        "governing": None if c.governing is None else c.governing.to_dict(),
        "optimal_ratio": None if window is None else plain(window.optimal),
        "ratio_window": None if window is None else [plain(window.least), plain(window.most)],
    }
