"""One size for several joints: the best pair that is strong enough at all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from puma_septic.sizing._joint_selection import JointSelection, Rank
from puma_septic.validation import checked_choice

__all__ = ["with_common_sizes"]


def with_common_sizes(
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
