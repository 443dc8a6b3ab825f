"""Which of the compared profiles to take, and why: one sentence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import Final, final

from puma_septic.limit_check import LimitCheck

__all__ = ["Candidate", "advice_of", "ranked", "recommended"]

# Values that agree to so many digits are one: rounding does not choose.
_DIGITS: Final = ".9g"


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Candidate:
    """What counts of one profile.

    Attributes
    ----------
    name : str
    meets_points : bool
        Whether it goes through all points, at their times if these are given.
    is_feasible : bool
        Whether it keeps all known limits, and nothing leaves that open.
    stops : bool or None
        At the vias; None where there are none.
    value : float
        Of the first objective.
    worst : LimitCheck or None
        The limit that it uses most.
    """

    name: str
    meets_points: bool
    is_feasible: bool
    stops: bool | None
    value: float
    worst: LimitCheck | None

    @property
    def rounded(self) -> float:
        """The value to nine digits."""
        return float(f"{self.value:{_DIGITS}}")


def ranked(candidates: Sequence[Candidate]) -> tuple[str, ...]:
    """Names: those that meet the points and keep the limits first, then by the objective; of equals the first."""
    order = sorted(candidates, key=lambda one: (not one.meets_points, not one.is_feasible, one.rounded))
    return tuple(one.name for one in order)


def recommended(candidates: Sequence[Candidate]) -> dict[str, Candidate]:
    """The best of those that pass the vias and of those that stop at them, as far as there are any."""
    good = [one for one in candidates if one.meets_points and one.is_feasible and isfinite(one.value)]
    groups = {"passes the vias": False, "stops at the vias": True, "goes from point to point": None}
    found = {}
    for label, stops in groups.items():
        group = [one for one in good if one.stops is stops]
        if group:
            found[label] = min(group, key=lambda one: one.rounded)
    return found


def advice_of(candidates: Sequence[Candidate], objective: str) -> str:
    """One sentence: what to take, and by which measure; where nothing fits, what comes nearest.

    Examples
    --------
    >>> one = Candidate(name="quintic", meets_points=True, is_feasible=True, stops=True, value=2.0, worst=None)
    >>> advice_of([one], "peak_jerk")
    'Stops at the vias, keeps all known limits, least peak jerk: quintic.'
    """
    best = recommended(candidates)
    measure = objective.replace("_", " ")
    if best:
        parts = [
            f"{label}, keeps all known limits, least {measure}: {one.name}" if k == 0 else f"{label}: {one.name}"
            for k, (label, one) in enumerate(best.items())
        ]
        sentence = "; ".join(parts)
        return f"{sentence[0].upper()}{sentence[1:]}."
    meeting = [one for one in candidates if one.meets_points]
    if not meeting:
        return "No profile goes through all points."
    nearest = min(meeting, key=lambda one: inf if one.worst is None else one.worst.utilisation)
    if nearest.worst is None or not nearest.worst.is_violated:
        return f"No profile through all points has a finite {measure} and keeps all known limits for certain."
    return f"No profile through all points keeps all known limits; {nearest.name} comes nearest: {nearest.worst}."
