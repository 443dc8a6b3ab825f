"""Selection of one joint's motor and gearbox among all pairs of a catalogue."""

from __future__ import annotations

from bisect import insort
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.drives import Catalogue, Drivetrain
from puma_septic.limit_check import AT_LIMIT, LimitCheck, most_used_first
from puma_septic.sizing._checks import assess_joint, utilisation_bounds
from puma_septic.sizing._demands import Demands
from puma_septic.sizing._load_features import LoadGrid, load_grid
from puma_septic.sizing._loads import JointLoad, motor_load
from puma_septic.sizing._pair_features import PairTable, pair_table
from puma_septic.sizing._ratios import LoadMoments, RatioWindow, ratio_window
from puma_septic.validation import Array, checked_choice

__all__ = ["RANKS", "Candidate", "JointSelection", "Rank", "select_joint"]

Rank = Literal["mass", "cost", "margin"]
RANKS: Final[tuple[Rank, ...]] = ("mass", "cost", "margin")
_UNBOUNDED: Final = "unbounded torque (a velocity steps)"
# A limit that is used by more than this is violated whatever the rounding, see `LimitCheck.is_violated`.
_CERTAIN: Final = 1 + 10 * AT_LIMIT


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Candidate:
    """A pair that is strong enough, assessed in full.

    Attributes
    ----------
    demands : Demands
        With the drive train; see `Sizing`.
    checks : tuple of LimitCheck
        All limits that are known, the most used first.
    mass, cost : float
        Of motor and gearbox; NaN: unknown.
    window : RatioWindow or None
        Ratios that would do for this motor with this gearbox's inertia and efficiencies; None where its continuous
        torque or the inertia is unknown. It knows of RMS torque and speed alone, and of no friction.
    """

    demands: Demands
    checks: tuple[LimitCheck, ...]
    mass: float
    cost: float
    window: RatioWindow | None

    @property
    def drivetrain(self) -> Drivetrain:
        """What was assessed."""
        return self.demands.train

    @property
    def motor(self) -> str:
        """Name of the motor."""
        return self.drivetrain.motor.name

    @property
    def gearbox(self) -> str:
        """Name of the gearbox."""
        return self.drivetrain.gearbox.name

    @property
    def governing(self) -> LimitCheck | None:
        """The governing limit, rules of thumb apart; None where none is known."""
        return next((check for check in self.checks if check.kind != "rule of thumb"), None)

    @property
    def margin(self) -> float:
        """What is left of the governing limit, ``1 - demand / limit``; NaN where none is known."""
        return np.nan if self.governing is None else self.governing.margin


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class JointSelection:
    """All pairs of a catalogue at one joint, each accepted or rejected.

    Attributes
    ----------
    joint : str
    catalogue : Catalogue
    is_feasible : ndarray of bool, shape (n_pairs,)
        Whether each pair breaks no known limit.
    reasons : tuple of str
        For each pair the check of its worst violation, by the bounds at hand; empty where it is feasible.
    utilisation : ndarray, shape (n_pairs,)
        Of that check, or of the one used most; a lower bound.
    kept : tuple of Candidate
        The best pairs, in order of rank.
    n_assessed : int
        Pairs that took a full assessment; the others are decided by bounds.
    """

    joint: str
    catalogue: Catalogue
    is_feasible: NDArray[np.bool_]
    reasons: tuple[str, ...]
    utilisation: Array
    kept: tuple[Candidate, ...]
    n_assessed: int

    @property
    def best(self) -> Candidate | None:
        """The first of those kept; None where no pair is strong enough."""
        return self.kept[0] if self.kept else None

    @cached_property
    def rejections(self) -> dict[str, int]:
        """How many pairs each check rejects, as the one that they fail worst; the most frequent first."""
        return dict(Counter(reason for reason in self.reasons if reason).most_common())

    @property
    def explanation(self) -> str:
        """What became of the pairs, in one sentence."""
        total, left = len(self.reasons), int(self.is_feasible.sum())
        counts = ", ".join(f"{name} {count}" for name, count in self.rejections.items())
        if left:
            return f"{left} of {total} pairs are strong enough" + (f"; rejected by {counts}" if counts else "")
        return f"none of {total} pairs is strong enough; reasons, most frequent first: {counts}"

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
        worst = f"{self.reasons[k]}: at least {self.utilisation[k]:.4g} times the limit"
        return f"{motor} with {gearbox} is undersized; worst violation: {worst}"


def select_joint(
    load: JointLoad,
    catalogue: Catalogue,
    joint: int,
    *,
    rank: Rank,
    keep: int | None,
    places: Sequence[Drivetrain] | None,
) -> JointSelection:
    """Accept or reject every pair at one joint, and assess the best in full; see `size`."""
    if not np.isnan(load.unbounded):
        return _rejected(load, catalogue)
    grid, table = load_grid(load), pair_table(catalogue, joint, places)
    bounds = utilisation_bounds(grid, table)
    names = tuple(bounds)
    low, high = (np.fmax(np.array([pair[k] for pair in bounds.values()]), 0.0) for k in (0, 1))
    worst, lowest, highest = low.argmax(axis=0), low.max(axis=0), high.max(axis=0)
    is_feasible, reasons = highest <= 1, [names[k] for k in worst]
    found: dict[int, Candidate] = {}
    n_violated = 0
    for k in np.flatnonzero((lowest <= _CERTAIN) & ~is_feasible).tolist():
        candidate = assessed(grid, table, k)
        violated, unmade = _worst(candidate), _unmade(candidate, [names[i] for i in np.flatnonzero(high[:, k] > 1)])
        if violated is not None:
            reasons[k], lowest[k], n_violated = violated.quantity, violated.utilisation, n_violated + 1
        elif unmade:
            reasons[k], n_violated = f"{unmade} (cannot be assessed)", n_violated + 1
        else:
            is_feasible[k], found[k] = True, candidate
    kept = _ranked(grid, table, _keys(catalogue, rank, is_feasible, lowest), keep, found)
    return JointSelection(
        joint=load.joint,
        catalogue=catalogue,
        is_feasible=is_feasible,
        reasons=tuple("" if fits else reason for fits, reason in zip(is_feasible.tolist(), reasons, strict=True)),
        utilisation=lowest,
        kept=kept,
        n_assessed=n_violated + len(found),
    )


def assessed(grid: LoadGrid, table: PairTable, k: int) -> Candidate:
    """The k-th pair in full, by the code that assesses any drive train."""
    train = table.train(k)
    demands = Demands(load=grid.load, train=train, motor=motor_load(grid.load, train))
    return Candidate(
        demands=demands,
        checks=most_used_first(one for one in assess_joint(demands) if isinstance(one, LimitCheck)),
        mass=train.motor.mass + train.gearbox.mass,
        cost=train.motor.cost + train.gearbox.cost,
        window=_window(demands, grid),
    )


def _worst(candidate: Candidate) -> LimitCheck | None:
    """The violated limit of highest utilisation."""
    return next((c for c in candidate.checks if c.is_violated and c.kind != "rule of thumb"), None)


def _unmade(candidate: Candidate, needed: list[str]) -> str:
    """The first check that the bounds leave open and that could not be made; empty where all are."""
    made = {check.quantity for check in candidate.checks}
    return next((name for name in needed if name not in made), "")


def _window(demands: Demands, grid: LoadGrid) -> RatioWindow | None:
    """By the moments of the load as it comes through the gears, losses of either direction included."""
    train = demands.train
    torque = train.motor.continuous_torque_at(demands.mean_speed)
    if not (torque > 0 and train.inertia > 0):
        return None
    passed = train.transmission[::-1]
    moments = LoadMoments(
        torque_square=max(float(passed @ grid.gram[1:4, 1:4] @ passed), 0.0),
        acceleration_square=float(grid.gram[0, 0]),
        product=float(grid.gram[0, 1:4] @ passed),
        peak_speed=grid.moments.peak_speed,
    )
    limits = [train.motor.max_speed, train.gearbox.max_input_speed, np.inf]
    return ratio_window(moments, inertia=train.inertia, continuous_torque=torque, max_speed=float(np.nanmin(limits)))


def _keys(
    catalogue: Catalogue, rank: Rank, is_feasible: NDArray[np.bool_], lowest: Array
) -> list[tuple[float, float, int]]:
    """Rank, least utilisation and number of each pair that is strong enough, the best first; unknown masses last."""
    values = np.zeros(len(lowest))
    if rank != "margin":
        values = np.nan_to_num(catalogue.masses() if rank == "mass" else catalogue.costs(), nan=np.inf)
    rows = np.flatnonzero(is_feasible)
    return sorted(zip(values[rows].tolist(), lowest[rows].tolist(), rows.tolist(), strict=True))


def _ranked(
    grid: LoadGrid,
    table: PairTable,
    keys: list[tuple[float, float, int]],
    keep: int | None,
    found: dict[int, Candidate],
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
            found[k] = assessed(grid, table, k)
        insort(done, (value, _use(found[k]), k))
    return tuple(found[k] for _, _, k in done[:wanted])


def _use(candidate: Candidate) -> float:
    """Utilisation of the governing check, 0 where none is known."""
    return 0.0 if candidate.governing is None else candidate.governing.utilisation


def _rejected(load: JointLoad, catalogue: Catalogue) -> JointSelection:
    """No motor can step its velocity."""
    return JointSelection(
        joint=load.joint,
        catalogue=catalogue,
        is_feasible=np.zeros(catalogue.n_pairs, dtype=bool),
        reasons=(_UNBOUNDED,) * catalogue.n_pairs,
        utilisation=np.full(catalogue.n_pairs, np.inf),
        kept=(),
        n_assessed=0,
    )
