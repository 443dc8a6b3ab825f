"""Selection of one joint's motor and gearbox among all pairs of a catalogue."""

from __future__ import annotations

from bisect import insort
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final, Literal, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.drives import LEAST_SET, Catalogue, Drivetrain, lacking_of_pairs, names_of
from puma_septic.errors import InputError
from puma_septic.limit_check import AT_LIMIT, LimitCheck
from puma_septic.sizing._bounds import expected_lives
from puma_septic.sizing._candidates import Candidate, assessed
from puma_septic.sizing._checks import DRIVE_LIMITS, utilisation_bounds
from puma_septic.sizing._conditions import Conditions
from puma_septic.sizing._load_cases import LIFE, JointCase, shared_life, shortest_cycle, with_brakes
from puma_septic.sizing._load_features import LoadGrid, merged_peaks
from puma_septic.sizing._pair_demands import PairDemands, PeakBounds
from puma_septic.sizing._pair_features import PairParts, PairTable, pair_parts
from puma_septic.validation import Array, FrozenMap, checked_choice, freeze_fields

__all__ = ["RANKS", "JointSelection", "Rank", "select_joint", "undominated"]

Rank = Literal["mass", "cost", "margin"]
RANKS: Final[tuple[Rank, ...]] = ("mass", "cost", "margin")
_UNBOUNDED: Final = "unbounded torque (a velocity steps)"
# What is left by more than this of what may be used is not kept whatever the rounding, see `Conditions.is_kept`.
_CERTAIN: Final = 1 + 10 * AT_LIMIT
_NONE: Final = -1


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class JointSelection:
    """All pairs of a catalogue at one joint: strong enough, not decidable, or rejected.

    Attributes
    ----------
    joint : str
    catalogue : Catalogue
    is_feasible : ndarray of bool, shape (n_pairs,)
        Whether each pair keeps every known limit with its margin, and enough is known of it (`LEAST_SET`).
    is_undecided : ndarray of bool, shape (n_pairs,)
        Whether it keeps every known limit, but too little is known.
    utilisation : ndarray, shape (n_pairs,)
        Of the check of its worst violation, or of the one used most, over what may be used; a lower bound.
    kept, undecided : tuple of Candidate
        The best pairs of either kind, in order of rank.
    n_assessed : int
        Pairs that took a full assessment; the others are decided by bounds.
    cases : tuple of JointCase
    conditions : Conditions
    places : tuple of Drivetrain or None
    joint_index : int
    """

    joint: str
    catalogue: Catalogue
    is_feasible: NDArray[np.bool_]
    is_undecided: NDArray[np.bool_]
    utilisation: Array
    kept: tuple[Candidate, ...]
    undecided: tuple[Candidate, ...]
    n_assessed: int
    cases: tuple[JointCase, ...]
    conditions: Conditions
    places: tuple[Drivetrain, ...] | None
    joint_index: int
    _lacking: NDArray[np.uint16] = field(repr=False)
    _highest: Array = field(repr=False)
    _reason: NDArray[np.int32] = field(repr=False)
    _reason_names: tuple[str, ...] = field(repr=False)

    def __post_init__(self) -> None:
        freeze_fields(self)

    @property
    def best(self) -> Candidate | None:
        """The first of those that are strong enough; None where no pair is."""
        return self.kept[0] if self.kept else None

    @property
    def can_be_decided(self) -> bool:
        """Whether a pair is strong enough, or each is rejected: not where all that are left are not decidable."""
        return bool(self.kept) or not self.is_undecided.any()

    @property
    def reasons(self) -> tuple[str, ...]:
        """For each pair the check of its worst violation, by the bounds at hand; empty where no limit rejects it.

        Of several load cases that of the first that rejects it, in the order of their peak torques.
        """
        names = (*self._reason_names, "")
        return tuple(names[k] for k in self._reason.tolist())

    @cached_property
    def rejections(self) -> Mapping[str, int]:
        """How many pairs each check rejects, as the one that they fail worst; the most frequent first."""
        counts = np.bincount(self._reason[self._reason >= 0], minlength=len(self._reason_names))
        order = np.argsort(-counts, kind="stable")
        return FrozenMap({self._reason_names[k]: int(counts[k]) for k in order.tolist() if counts[k]})

    @cached_property
    def unknowns(self) -> Mapping[str, int]:
        """How many undecidable pairs lack each member of the least set, the most frequent first."""
        bits = self._lacking[self.is_undecided]
        counts = {name: int(np.count_nonzero(bits >> k & 1)) for k, name in enumerate(LEAST_SET)}
        return FrozenMap(dict(sorted(((name, n) for name, n in counts.items() if n), key=lambda item: -item[1])))

    @property
    def explanation(self) -> str:
        """What became of the pairs, in one sentence."""
        total, left = len(self._reason), int(self.is_feasible.sum())
        open_ = int(self.is_undecided.sum())
        rejected = ", ".join(f"{name} {count}" for name, count in self.rejections.items())
        unknown = ", ".join(f"{name} {count}" for name, count in self.unknowns.items())
        start = f"{left} of {total} pairs are strong enough" if left else f"none of {total} pairs is strong enough"
        parts = [start]
        if open_:
            parts.append(f"{open_} not decidable, for they do not tell {unknown}")
        if rejected:
            parts.append(f"rejected by {rejected}" if left else f"reasons, most frequent first: {rejected}")
        return "; ".join(parts)

    def why(self, motor: str, gearbox: str) -> str:
        """What became of one pair; an unknown name lists the valid ones."""
        motors, gearboxes = ([part.name for part in kind] for kind in (self.catalogue.motors, self.catalogue.gearboxes))
        i = motors.index(checked_choice("motor", motor, motors))
        j = gearboxes.index(checked_choice("gearbox", gearbox, gearboxes))
        rows = np.flatnonzero((self.catalogue.motor_index == i) & (self.catalogue.gearbox_index == j))
        if not len(rows):
            return f"{motor} and {gearbox} do not fit together"
        k = int(rows[0])
        if self.is_feasible[k]:
            return f"{motor} with {gearbox} is strong enough"
        if self.is_undecided[k]:
            missing = ", ".join(names_of(int(self._lacking[k])))
            return f"{motor} with {gearbox} is not decidable: {missing} unknown; every known limit is kept"
        reason = self._reason_names[self._reason[k]]
        return (
            f"{motor} with {gearbox} is undersized; worst violation: {reason}: at least"
            f" {self.utilisation[k]:.4g} times the limit"
        )

    def assessed(self, k: int) -> Candidate:
        """The k-th pair of the catalogue in full."""
        return assessed(self.cases, self.catalogue.drivetrain(k, self.joint_index, self.places), self.conditions)

    def front(self) -> tuple[Candidate, ...]:
        """The pairs than which no other is as light, as cheap and as little used, one of them better; lightest first.

        Of those that are strong enough; an unknown mass or cost counts as unbounded. Two that are equal in all three
        are both there.
        """
        rows = np.flatnonzero(self.is_feasible)
        sizes = [np.nan_to_num(v[rows], nan=np.inf) for v in (self.catalogue.masses(), self.catalogue.costs())]
        low, high = self.utilisation[rows], np.fmin(self._highest[rows], 1 + AT_LIMIT)
        possible = rows[undominated(np.column_stack([*sizes, low]), np.column_stack([*sizes, high]))]
        found = [self.assessed(int(k)) for k in possible]
        exact = np.array([[*np.nan_to_num([c.mass, c.cost], nan=np.inf), c.stress] for c in found]).reshape(-1, 3)
        best = [found[i] for i in np.flatnonzero(undominated(exact, exact)).tolist()]
        return tuple(sorted(best, key=lambda c: tuple(np.nan_to_num([c.mass, c.cost, c.stress], nan=np.inf))))


def undominated(least: Array, most: Array) -> NDArray[np.bool_]:
    """Rows of `least` that no row of `most` equals or undercuts in every column, and undercuts in one."""
    left = np.ones(len(least), dtype=bool)
    for k in np.lexsort(most.T[::-1]).tolist():
        if left[k]:
            left &= ~((most[k] <= least).all(axis=1) & (most[k] < least).any(axis=1))
    return left


def select_joint(
    cases: Sequence[JointCase],
    catalogue: Catalogue,
    joint: int,
    *,
    rank: Rank,
    keep: int | None,
    places: Sequence[Drivetrain] | None,
    conditions: Conditions | None = None,
) -> JointSelection:
    """Accept or reject every pair at one joint, and assess the best in full; see `size`."""
    asked = Conditions() if conditions is None else conditions
    own = None if places is None else tuple(places)
    if own is not None:
        own = (*own[:joint], with_brakes(own[joint], cases), *own[joint + 1 :])
    cases = [_behind_stage(case, None if own is None else own[joint]) for case in cases]
    # The hardest case first: what it rejects need not be tried in the others.
    ordered = tuple(sorted(cases, key=lambda case: -case.peak_torque))
    judge = _Judge(cases=ordered, parts=pair_parts(catalogue, joint, own), conditions=asked)
    found: dict[int, Candidate] = {}
    n = catalogue.n_pairs
    reason, lowest, highest = np.full(n, _NONE, dtype=np.int32), np.full(n, np.inf), np.full(n, np.inf)
    if any(not np.isnan(case.load.unbounded) for case in ordered):
        reason[:] = len(judge.names)
        n_violated = 0
    else:
        n_violated = sum(judge.block(table, reason, lowest, highest, found) for table in judge.parts.blocks())
    lacking, passes = lacking_of_pairs(catalogue, judge.parts.place, cycle=shortest_cycle(ordered)), reason == _NONE
    decided, undecided = passes & (lacking == 0), passes & (lacking != 0)
    n_found = len(found)
    ranked = [_ranked(judge, _keys(catalogue, rank, which, lowest), keep, found) for which in (decided, undecided)]
    return JointSelection(
        joint=ordered[0].load.joint,
        catalogue=catalogue,
        is_feasible=decided,
        is_undecided=undecided,
        utilisation=lowest,
        kept=ranked[0],
        undecided=ranked[1],
        n_assessed=n_violated + max(n_found, len(found)),
        cases=ordered,
        conditions=asked,
        places=own,
        joint_index=joint,
        _lacking=lacking,
        _highest=highest,
        _reason=reason,
        _reason_names=(*judge.names, _UNBOUNDED, *judge.unmade_names),
    )


def _behind_stage(case: JointCase, place: Drivetrain | None) -> JointCase:
    """The case as the joint's gearbox sees it, which turns."""
    if case.load.is_prismatic and (place is None or place.stage is None):
        raise InputError(
            f"joint {case.load.joint!r} slides, but the catalogue's gearboxes turn, in N m and turns per turn; give the"
            " stage between them in drivetrains, stage=LinearStage(kind='screw', 'rack' or 'belt', ...)"
        )
    return case if place is None else case.through(place)


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class _Judge:
    """Holds pairs to the limits, in every case.

    `names` are the reasons to reject: check by check, of each case; then one for each check that could not be made.
    """

    cases: tuple[JointCase, ...]
    parts: PairParts
    conditions: Conditions

    @cached_property
    def _checks(self) -> tuple[str, ...]:
        return tuple(limit.quantity for limit in DRIVE_LIMITS if limit.kind != "rule of thumb")

    @cached_property
    def _allowed(self) -> Array:
        """What may be used of each limit."""
        return np.array(
            [1 - self.conditions.margin(x.kind, x.quantity) for x in DRIVE_LIMITS if x.kind != "rule of thumb"]
        )

    @cached_property
    def names(self) -> tuple[str, ...]:
        if len(self.cases) == 1:
            return self._checks
        return (*(f"{check} ({case.name})" for case in self.cases for check in self._checks), LIFE)

    @property
    def unmade_names(self) -> tuple[str, ...]:
        return tuple(f"{check} (cannot be assessed)" for check in self._checks)

    def block(
        self, table: PairTable, reason: NDArray[np.int32], lowest: Array, highest: Array, found: dict[int, Candidate]
    ) -> int:
        """Judge some pairs: fill in their rows, and return how many were rejected by a full assessment."""
        low, high, code, unsure = self._by_bounds(table)
        reason[table.rows] = np.where(low > _CERTAIN, code, _NONE)
        lowest[table.rows], highest[table.rows] = low, high
        rejected = 0
        for i in np.flatnonzero((low <= _CERTAIN) & (high > 1)).tolist():
            k = int(table.rows[i])
            candidate = self.assessed(k)
            verdict, use = self._verdict(candidate, int(unsure[i]))
            if verdict == _NONE:
                found[k] = candidate
            else:
                reason[k], lowest[k], rejected = verdict, max(use, low[i]), rejected + 1
        return rejected

    def assessed(self, k: int) -> Candidate:
        """The k-th pair of the catalogue in full."""
        catalogue = self.parts.catalogue
        train = catalogue.drivetrain(k, self.parts.joint, self.parts.places)
        return assessed(self.cases, train, self.conditions)

    def _by_bounds(self, table: PairTable) -> tuple[Array, Array, NDArray[np.int32], NDArray[np.int64]]:
        """Utilisation over what may be used, from below and above, the worst check, and a bit for each unsure one.

        A pair that a case rejects is not tried in those after it.
        """
        n = len(table.rows)
        low, high = np.zeros((2, n))
        code, unsure = np.zeros(n, dtype=np.int32), np.zeros(n, dtype=np.int64)
        left, rows, lives = table, np.arange(n), list[Array]()
        shared = None if self._merged is None else PairDemands(grid=self._merged, table=table).peaks
        for c, case in enumerate(self.cases):
            own_low, own_high = self._of_case(case, left, shared)
            worst, own = own_low.argmax(axis=0), own_low.max(axis=0)
            is_worse = own > low[rows]
            code[rows[is_worse]] = c * len(self._checks) + worst[is_worse]
            low[rows], high[rows] = np.maximum(low[rows], own), np.maximum(high[rows], own_high.max(axis=0))
            for bit, is_unsure in enumerate(own_high > 1):
                unsure[rows] |= is_unsure.astype(np.int64) << bit
            stays = low[rows] <= _CERTAIN
            if len(self.cases) == 1 or not stays.any():
                return low, high, code, unsure
            lives = [life[stays] for life in (*lives, expected_lives(case.grid, left))]
            left, rows = left.at(stays), rows[stays]
            shared = None if shared is None else shared.at(stays)
        if lives:
            use = self._life_use(np.array(lives))
            code[rows[use > low[rows]]] = len(self.names) - 1
            low[rows], high[rows] = np.fmax(low[rows], use), np.fmax(high[rows], use * (1 + 1e-9))
        return low, high, code, unsure

    @cached_property
    def _merged(self) -> LoadGrid | None:
        """The ordinary cases as one, for their peaks; None where there is only one."""
        grids = [case.grid for case in self.cases if case.only is None]
        return merged_peaks(grids) if len(grids) > 1 else None

    def _of_case(self, case: JointCase, table: PairTable, shared: PeakBounds | None) -> tuple[Array, Array]:
        """Each check's utilisation over what may be used, from below and above, shape (n_checks, n); 0: not made."""
        own = shared if case.only is None else None
        bounds = utilisation_bounds(
            case.grid, table, momentary_torque=case.momentary_torque, only=case.only, shared=own
        )
        low, high = np.zeros((2, len(self._checks), len(table.rows)))
        for i, name in enumerate(self._checks):
            if name in bounds and not (name == LIFE and len(self.cases) > 1):
                low[i], high[i] = (np.fmax(bound / self._allowed[i], 0.0) for bound in bounds[name])
        return low, high

    def _life_use(self, lives: Array) -> Array:
        """Utilisation of the gearbox's life in the mix of the cases; NaN where it is not assessed."""
        life = shared_life(lives, np.array([case.share for case in self.cases]))
        with np.errstate(divide="ignore"):
            return np.asarray(self.parts.place.required_life_hours / life / self._allowed[self._checks.index(LIFE)])

    def _verdict(self, candidate: Candidate, unsure: int) -> tuple[int, float]:
        """The number of the reason to reject and the use there; `_NONE` where there is no reason."""
        worst = candidate.governing
        if worst is not None and not self.conditions.is_kept(worst):
            return self._code(worst), candidate.stress
        made = {check.quantity for check in candidate.checks}
        for bit, name in enumerate(self._checks):
            if unsure >> bit & 1 and name not in made:
                return len(self.names) + 1 + bit, 0.0
        return _NONE, candidate.stress

    def _code(self, check: LimitCheck) -> int:
        if len(self.cases) == 1:
            return self._checks.index(check.quantity)
        if check.quantity == LIFE:
            return len(self.names) - 1
        case = [one.name for one in self.cases].index(check.case)
        return case * len(self._checks) + self._checks.index(check.quantity)


def _keys(catalogue: Catalogue, rank: Rank, which: NDArray[np.bool_], lowest: Array) -> list[tuple[float, float, int]]:
    """Rank, least use and number of each of some pairs, the best first; unknown masses last."""
    rows = np.flatnonzero(which)
    values = np.zeros(len(rows))
    if rank != "margin":
        values = np.nan_to_num((catalogue.masses() if rank == "mass" else catalogue.costs())[rows], nan=np.inf)
    order = np.lexsort((rows, lowest[rows], values))
    return list(zip(values[order].tolist(), lowest[rows][order].tolist(), rows[order].tolist(), strict=True))


def _ranked(
    judge: _Judge, keys: list[tuple[float, float, int]], keep: int | None, found: dict[int, Candidate]
) -> tuple[Candidate, ...]:
    """The best candidates, assessed in full, those of equal rank by margin.

    A margin is known from the assessment alone: candidates are assessed until no bound is better than those found.
    """
    wanted = len(keys) if keep is None else keep
    done: list[tuple[float, float, int]] = []
    for value, least, k in keys:
        if len(done) >= wanted and (value, least) > done[wanted - 1][:2]:
            break
        if k not in found:
            found[k] = judge.assessed(k)
        insort(done, (value, found[k].stress, k))
    return tuple(found[k] for _, _, k in done[:wanted])
