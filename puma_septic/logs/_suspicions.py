"""What in a log looks like something else than it is taken for, each with its evidence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from puma_septic.validation import Array

__all__ = ["held_rows", "suspicions"]

# More than three turns: what arms with cables inside do not do.
_MOST_TURNED: Final = 20.0
# A motion that breaks its bounds breaks them by less, rad or m.
_BEYOND: Final = 1.0
# No logger writes rows this far apart, and an arm that never exceeds this speed hardly moves.
_LONG_STEP: Final = 0.9
_SLOW: Final = 0.02
_FAST_ENOUGH: Final = 0.05
_FEWEST: Final = 50
# Larger than any step of an arm between two rows, smaller than a turn by less than that.
_WRAP: Final = 0.6
# A hold has one length nearly always; rests, and slow parts seen by an encoder, have any.
_REGULAR: Final = 0.9


def suspicions(
    t: Array, q: Array, labels: Sequence[str], *, bounds: Array | None = None, units_stated: bool = False
) -> tuple[str, ...]:
    """Questions that must be answered before a verdict.

    Parameters
    ----------
    t : ndarray, shape (n,)
        From 0, s.
    q : ndarray, shape (n, n_joints)
        Without the jumps of continuous joints.
    bounds : ndarray, shape (n_joints, 2), optional
        Of the positions, NaN where not known.
    units_stated : bool
        Whether the units have been said by somebody; then they are not doubted.
    """
    found = [*_wraps(q, labels), *_holds(q)]
    if not units_stated:
        found = [*_scale(q, labels, bounds), *_clock(t, q), *found]
    return tuple(found)


def _degrees(q: Array, labels: Sequence[str]) -> list[str]:
    largest = np.abs(q).max(axis=0)
    j = int(np.argmax(largest))
    if largest[j] <= _MOST_TURNED:
        return []
    return [
        f"degrees or mm? {labels[j]} reaches {largest[j]:.4g} rad, {largest[j] / (2 * np.pi):.3g} turns"
        f" ({largest[j]:.4g} deg would be {np.radians(largest[j]):.3g} rad)"
    ]


def _scale(q: Array, labels: Sequence[str], bounds: Array | None) -> list[str]:
    """Positions that are out of bounds as they stand, and within them all together in another unit."""
    if bounds is None or not _outside(q, bounds).any():
        return _degrees(q, labels)
    for unit, factor in (("degrees", np.pi / 180), ("mm", 1e-3)):
        if not _outside(factor * q, bounds).any():
            j = int(np.argmax(_outside(q, bounds)))
            return [
                f"{unit}? {labels[j]} reaches {np.abs(q[:, j]).max():.4g}, {_outside(q, bounds)[j]:.3g} beyond its"
                f" bounds [{bounds[j, 0]:.3g}, {bounds[j, 1]:.3g}]; in {unit} all joints are within theirs"
            ]
    return _degrees(q, labels)


def _outside(q: Array, bounds: Array) -> Array:
    """By how much each joint leaves its bounds, beyond what a motion that breaks them does; 0 within."""
    excess = np.fmax(bounds[:, 0] - q.min(axis=0), q.max(axis=0) - bounds[:, 1])
    return np.where(excess > _BEYOND, excess, 0.0)


def _clock(t: Array, q: Array) -> list[str]:
    step = float(np.median(np.diff(t)))
    if len(t) < _FEWEST or step < _LONG_STEP:
        return []
    unit, factor = ("ms", 1e-3) if step < 100 else ("us", 1e-6) if step < 1e5 else ("ns", 1e-9)
    fastest = float(np.abs(np.diff(q, axis=0) / np.diff(t)[:, None]).max())
    if fastest > _SLOW or fastest / factor < _FAST_ENOUGH:
        return []
    return [
        f"times in {unit}? rows are {step:.4g} s apart, the motion takes {t[-1]:.5g} s and no joint exceeds"
        f" {fastest:.2g} rad/s (in {unit}: {step * factor:.3g} s, {t[-1] * factor:.4g} s, {fastest / factor:.2g} rad/s)"
    ]


def _wraps(q: Array, labels: Sequence[str]) -> list[str]:
    change = np.diff(q, axis=0)
    turns = np.abs(np.abs(change) - 2 * np.pi) < _WRAP
    # What moves by nearly a turn from row to row all the time has not wrapped.
    usual = np.median(np.abs(change), axis=0)
    bad = np.flatnonzero(turns.any(axis=0) & (usual < _WRAP))
    if not len(bad):
        return []
    j = int(bad[0])
    k = int(np.argmax(turns[:, j]))
    return [
        f"a wrapped angle? {labels[j]} jumps by {change[k, j]:.4g} rad between two rows ({k + 1} and {k + 2} of the"
        " samples), nearly a turn; joints that are continuous are unwrapped"
    ]


def _holds(q: Array) -> list[str]:
    held = held_rows(q)
    if held < 2:
        return []
    return [
        f"held samples? each position stands in {held} rows one after the other while the arm moves: the log is faster"
        f" than its source; keep one row of {held}"
    ]


def held_rows(q: Array) -> int:
    """In how many rows, one after the other, each position stands while the arm moves: 1 in a plain log."""
    changed = np.flatnonzero((np.diff(q, axis=0) != 0).any(axis=1))
    if len(changed) < 8:
        return 1
    runs = np.diff(changed)
    usual = int(np.median(runs))
    regular = (np.abs(runs - usual) <= 1).mean()
    return usual if usual >= 2 and regular >= _REGULAR else 1
