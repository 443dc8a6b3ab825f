"""Selection: motors and gearboxes for all joints of an arm, from a catalogue."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, final

import numpy as np

from puma_septic.cycle import Cycle
from puma_septic.doctor import doubts
from puma_septic.document import SCHEMAS, frame, one_line, plain
from puma_septic.drives import LEAST_SET, Catalogue
from puma_septic.sizing._candidates import Candidate
from puma_septic.sizing._conditions import Conditions
from puma_septic.sizing._drivetrains import GivenDrivetrains, checked_drivetrains
from puma_septic.sizing._front import ArmChoice, arm_front
from puma_septic.sizing._joint_selection import RANKS, JointSelection, Rank, select_joint
from puma_septic.sizing._load_cases import LoadCase, joint_cases, position_remarks
from puma_septic.sizing._result import Sizing, case_document, sized
from puma_septic.validation import checked_choice, checked_whole
from puma_septic.views import selection as view

__all__ = [
    "Selection",
    "checked_rank",
    "select",
]


def _with_common_sizes(
    joints: Sequence[JointSelection], groups: Sequence[Sequence[str]], *, rank: Rank
) -> tuple[tuple[JointSelection, ...], tuple[str, ...]]:
    """The joints, those of each group with the same pair first; and what is said of it.

    A wish: where no pair is strong enough at all joints of a group, each keeps its own.

    Returns
    -------
    tuple of JointSelection, tuple of str
    """
    names, chosen, notes = [one.joint for one in joints], list(joints), []
    for group in groups:
        places = [names.index(checked_choice("joint", name, names)) for name in group]
        best = _best_common([joints[j] for j in places], rank)
        who = ", ".join(group)
        if best is None:
            notes.append(f"no pair is strong enough at all of {who}: each has its own")
            continue
        for j in places:
            chosen[j] = _with_first(chosen[j], best)
        candidate = chosen[places[0]].kept[0]
        notes.append(f"one size for {who}: {candidate.motor} with {candidate.gearbox}")
    return tuple(chosen), tuple(notes)


def _best_common(group: list[JointSelection], rank: Rank) -> int | None:
    """Number of the pair of least mass or cost, then of least use at the joint where it is used most."""
    catalogue = group[0].catalogue
    rows = np.flatnonzero(np.all([one.is_feasible for one in group], axis=0))
    if not len(rows):
        return None
    values = np.zeros(len(rows))
    if rank != "margin":
        values = np.nan_to_num((catalogue.masses() if rank == "mass" else catalogue.costs())[rows], nan=np.inf)
    least = np.max([one.utilisation[rows] for one in group], axis=0)
    best: tuple[float, float, int] | None = None
    for i in np.lexsort((rows, least, values)).tolist():
        if best is not None and (values[i], least[i]) > best[:2]:
            break
        k = int(rows[i])
        found = (float(values[i]), max(one.assessed(k).stress for one in group), k)
        best = found if best is None else min(best, found)
    return None if best is None else best[2]


def _with_first(one: JointSelection, k: int) -> JointSelection:
    first = one.assessed(k)
    others = [c for c in one.kept if (c.motor, c.gearbox) != (first.motor, first.gearbox)]
    return replace(one, kept=(first, *others)[: max(1, len(one.kept))])


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Selection:
    """What of a catalogue is strong enough for a duty cycle; made by `size` with a catalogue.

    Attributes
    ----------
    load_cases : tuple of LoadCase
        With the masses of the chosen parts on the arm, where they were asked for.
    catalogue : Catalogue
    rank : {"mass", "cost", "margin"}
    joints : tuple of JointSelection
        One per joint.
    conditions : Conditions
    notes : tuple of str
        How the choice came about, where masses were placed.
    """

    load_cases: tuple[LoadCase, ...]
    catalogue: Catalogue
    rank: Rank
    joints: tuple[JointSelection, ...]
    conditions: Conditions
    notes: tuple[str, ...] = ()

    @property
    def cycle(self) -> Cycle:
        """Of the first load case."""
        return self.load_cases[0].cycle

    @property
    def is_feasible(self) -> bool:
        """Whether there is a pair for every joint that is strong enough, enough is known of it, and all can be fed."""
        return all(one.best is not None for one in self.joints) and self._is_fed

    @property
    def _is_fed(self) -> bool:
        """Whether the supply that all drives share, if there is one, bears them together."""
        return self.conditions.supply is None or self.sizing is None or self.sizing.is_feasible

    @property
    def can_be_decided(self) -> bool:
        """Whether the choice, or that there is none, rests on known data.

        Not where a joint has no pair that is strong enough and only pairs that are not decidable are left.
        """
        rejected = any(one.best is None and one.can_be_decided for one in self.joints)
        return rejected or all(one.can_be_decided for one in self.joints)

    @cached_property
    def sizing(self) -> Sizing | None:
        """The load cases checked against the best pair of each joint; None where a joint has none."""
        best = [one.best for one in self.joints]
        trains = [candidate.drivetrain for candidate in best if candidate is not None]
        if len(trains) != len(best):
            return None
        bare = [replace(train, momentary_torque=self._momentary(j)) for j, train in enumerate(trains)]
        return sized(self.load_cases, drivetrains=bare, conditions=self.conditions)

    def _momentary(self, j: int) -> float:
        """Without that of a rare load case, which is its own."""
        places = self.joints[j].places
        return float("nan") if places is None else places[j].momentary_torque

    def front(self) -> tuple[ArmChoice, ...]:
        """Choices for the whole arm than which no other is as light, as cheap and as little used; lightest first.

        Of the pairs that are strong enough at the load cases as they are: with the masses of the chosen parts on the
        arm these are those of the choice at hand. Joints that are to have one size may differ here. Empty where a joint
        has no such pair.

        Returns
        -------
        tuple of ArmChoice
        """
        return self._front

    @cached_property
    def _front(self) -> tuple[ArmChoice, ...]:
        return arm_front(self.joints)

    def joint(self, name: str) -> JointSelection:
        """The selection at one joint."""
        return self.joints[self.cycle.joint_names.index(checked_choice("joint", name, self.cycle.joint_names))]

    @property
    def verdict(self) -> str:
        """One sentence: a choice, or the joints that have none and the most frequent reason there."""
        open_ = sum(int(one.is_undecided.sum()) for one in self.joints)
        missing = [one for one in self.joints if one.best is None]
        if not missing:
            more = f"; {_pairs(open_)} not decidable" if open_ else ""
            if not self._is_fed and self.sizing is not None:
                more = f", but together: {self.sizing.violations[0]}{more}"
            return f"a pair that is strong enough for every joint{more}"
        undecided = [one for one in missing if not one.can_be_decided]
        rejected = [one for one in missing if one.can_be_decided]
        parts = []
        if rejected:
            reasons = "; ".join(f"{one.joint} (most frequent reason: {next(iter(one.rejections))})" for one in rejected)
            parts.append(f"no pair is strong enough for {reasons}")
        if undecided:
            reasons = "; ".join(
                f"{one.joint} ({_pairs(int(one.is_undecided.sum()))} left, most often unknown:"
                f" {next(iter(one.unknowns))})"
                for one in undecided
            )
            parts.append(f"not decidable for {reasons}")
        return "; ".join(parts)

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document; SI units, "unbounded" for infinity, null for unknown."""
        return {
            "schema": SCHEMAS["selection"],
            "robot": self.cycle.robot.name,
            "duration": self.cycle.duration,
            "rank": self.rank,
            "is_feasible": self.is_feasible,
            "can_be_decided": self.can_be_decided,
            "verdict": self.verdict,
            "bill_of_material": _bill(self.joints),
            "totals": self._totals(),
            "conditions": self.conditions.to_dict(),
            "load_cases": [case_document(case) for case in self.load_cases if case.name],
            "least_set": list(LEAST_SET),
            "catalogue": {
                "motors": len(self.catalogue.motors),
                "gearboxes": len(self.catalogue.gearboxes),
                "pairs": self.catalogue.n_pairs,
                "unused": list(self.catalogue.unused),
                "refused": list(self.catalogue.refused),
            },
            "notes": list(self.remarks),
            "joints": [_joint_document(one) for one in self.joints],
            "sizing": None if self.sizing is None else self.sizing.to_dict(),
        }

    def _totals(self) -> dict[str, Any]:
        """Of the arm: mass and cost of the chosen parts, least margin, energy."""
        best = [one.best for one in self.joints if one.best is not None]
        if self.sizing is None:
            return {}
        margins = [candidate.margin for candidate in best]
        return {
            "mass": plain(sum(candidate.mass for candidate in best)),
            "cost": plain(sum(candidate.cost for candidate in best)),
            "margin": plain(np.nanmin(margins) if np.isfinite(margins).any() else np.nan),
            "mean_drawn_power": plain(self.sizing.mean_drawn_power),
        }

    @property
    def remarks(self) -> tuple[str, ...]:
        """Notes, columns of the catalogue that no check uses, and what no choice of drives mends."""
        unused = self.catalogue.unused
        columns = (f"read but not used: {', '.join(unused)}",) if unused else ()
        refused = tuple(f"not read: {row}" for row in self.catalogue.refused)
        return (*self.notes, *refused, *columns, *doubts(self.cycle.robot), *position_remarks(self.cycle))

    def __str__(self) -> str:
        return view.text(self.to_dict())

    def _repr_html_(self) -> str:
        return view.html(self.to_dict())

    def __repr__(self) -> str:
        return one_line("Selection", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "robot": self.cycle.robot.name,
            "pairs": self.catalogue.n_pairs,
            "ranked by": self.rank,
            "verdict": self.verdict,
        }

    def to_dataframe(self) -> Any:
        """The shown pairs as a pandas DataFrame, one row for each joint and pair, the best first.

        Returns
        -------
        pandas.DataFrame
            In SI units; NaN where a number is not known.

        Raises
        ------
        ImportError
            Where pandas is not installed: ``python -m pip install 'puma-septic[pandas]'``.
        """
        return frame(_kept_pairs(self.to_dict()))


def select(
    cases: tuple[LoadCase, ...],
    catalogue: Catalogue,
    *,
    rank: Rank = "mass",
    keep: int | None = 5,
    places: GivenDrivetrains | None = None,
    conditions: Conditions | None = None,
    same: Sequence[Sequence[str]] = (),
) -> Selection:
    """Choose from a catalogue for every joint; see `size`."""
    checked_rank(rank, keep)
    names = cases[0].cycle.joint_names
    asked = Conditions() if conditions is None else conditions
    given = asked.places(names, None if places is None else checked_drivetrains(cases[0].cycle, places))
    joints = [
        select_joint(joint_cases(cases, j), catalogue, j, rank=rank, keep=keep, places=given, conditions=asked)
        for j in range(len(names))
    ]
    chosen, notes = _with_common_sizes(joints, same, rank=rank)
    return Selection(load_cases=cases, catalogue=catalogue, rank=rank, joints=chosen, conditions=asked, notes=notes)


def checked_rank(rank: Rank, keep: int | None) -> None:
    """Raise an InputError for an unknown rank or an invalid number of pairs."""
    checked_choice("rank", rank, RANKS)
    if keep is not None:
        checked_whole("keep", keep, at_least=1)


def _pairs(count: int) -> str:
    return "1 pair" if count == 1 else f"{count} pairs"


def _bill(joints: Sequence[JointSelection]) -> list[dict[str, Any]]:
    """The chosen parts, each once, with how many there are and where."""
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for one in joints:
        if one.best is None:
            continue
        for kind, part in (("motor", one.best.drivetrain.motor), ("gearbox", one.best.drivetrain.gearbox)):
            line = found.setdefault(
                (kind, part.name),
                {
                    "kind": kind,
                    "name": part.name,
                    "ratio": plain(one.best.drivetrain.gearbox.ratio) if kind == "gearbox" else None,
                    "mass": plain(part.mass),
                    "cost": plain(part.cost),
                    "source": part.source,
                    "count": 0,
                    "joints": [],
                },
            )
            line["count"] += 1
            line["joints"].append(one.joint)
    return sorted(found.values(), key=lambda line: line["kind"] == "gearbox")


def _joint_document(one: JointSelection) -> dict[str, Any]:
    return {
        "name": one.joint,
        "pairs": one.catalogue.n_pairs,
        "feasible_pairs": int(np.count_nonzero(one.is_feasible)),
        "undecided_pairs": int(np.count_nonzero(one.is_undecided)),
        "rejections": dict(one.rejections),
        "unknowns": dict(one.unknowns),
        "explanation": one.explanation,
        "kept": [_candidate_document(candidate) for candidate in one.kept],
        "undecided": [_candidate_document(candidate) for candidate in one.undecided],
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
        "life_hours": plain(c.life_hours),
        "inertia_ratio": plain(c.demands.inertia_ratio.size),
        "lacking": list(c.lacking),
        "optimal_ratio": None if window is None else plain(window.optimal),
        "ratio_window": None if window is None else [plain(window.least), plain(window.most)],
    }


def _kept_pairs(document: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The kept pairs of all joints."""
    return [{"joint": joint["name"], **pair} for joint in document["joints"] for pair in joint["kept"]]
