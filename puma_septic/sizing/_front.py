"""Choices for a whole arm than which no other is as light, as cheap and as little used."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from puma_septic.document import plain
from puma_septic.sizing._candidates import Candidate
from puma_septic.sizing._joint_selection import JointSelection, undominated
from puma_septic.validation import Array

__all__ = ["ArmChoice", "arm_front", "front_document"]

_DIGITS: Final = 9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ArmChoice:
    """A pair of motor and gearbox for each joint of an arm.

    Attributes
    ----------
    candidates : tuple of Candidate
        One per joint.
    """

    candidates: tuple[Candidate, ...]

    @property
    def mass(self) -> float:
        """Of all motors and gearboxes, kg; NaN where one is unknown."""
        return sum(candidate.mass for candidate in self.candidates)

    @property
    def cost(self) -> float:
        """Of all motors and gearboxes; NaN where one is unknown."""
        return sum(candidate.cost for candidate in self.candidates)

    @property
    def stress(self) -> float:
        """Largest utilisation over what may be used."""
        return max(candidate.stress for candidate in self.candidates)

    @property
    def margin(self) -> float:
        """What is left of the governing limit where the least is left."""
        return max(self.candidates, key=lambda candidate: candidate.stress).margin


def arm_front(joints: Sequence[JointSelection]) -> tuple[ArmChoice, ...]:
    """The front of the sums of masses and costs and of the largest use, lightest first; empty where a joint has none.

    Joint by joint, with what is dominated left out in between: neither sums nor the largest can make up for it.

    Returns
    -------
    tuple of ArmChoice
    """
    sizes, chosen = np.zeros((1, 3)), np.zeros((1, 0), dtype=np.int64)
    fronts = [joint.front() for joint in joints]
    for front in fronts:
        own = np.array([_size(candidate) for candidate in front]).reshape(-1, 3)
        first, second = (grid.ravel() for grid in np.indices((len(sizes), len(own))))
        # Masses and costs in another order of adding differ by rounding, which is no advantage.
        sums = np.round(sizes[first, :2] + own[second, :2], _DIGITS)
        both = np.column_stack([sums, np.maximum(sizes[first, 2], own[second, 2])])
        # Of choices that are equal in all three one will do.
        _, once = np.unique(both, axis=0, return_index=True)
        kept = once[undominated(both[once], both[once])]
        sizes, chosen = both[kept], np.column_stack([chosen[first[kept]], second[kept]])
    order = np.lexsort(sizes.T[::-1])
    return tuple(
        ArmChoice(candidates=tuple(front[k] for front, k in zip(fronts, row, strict=True)))
        for row in chosen[order].tolist()
    )


def _size(candidate: Candidate) -> Array:
    """Mass, cost and use; what is unknown is unbounded."""
    return np.nan_to_num([candidate.mass, candidate.cost, candidate.stress], nan=np.inf)


def front_document(front: Sequence[ArmChoice]) -> list[Mapping[str, Any]]:
    """JSON-ready: of each choice mass, cost, margin, and the pair of each joint.

    Returns
    -------
    list of dict
    """
    return [
        {
            "mass": plain(choice.mass),
            "cost": plain(choice.cost),
            "margin": plain(choice.margin),
            "pairs": [
                {"joint": one.demands.load.joint, "motor": one.motor, "gearbox": one.gearbox}
                for one in choice.candidates
            ],
        }
        for choice in front
    ]
