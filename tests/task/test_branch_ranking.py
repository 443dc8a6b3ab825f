"""Which branch "auto" takes where none keeps all limits."""

from __future__ import annotations

import numpy as np

from puma_septic.kinematics import LowestPoints
from puma_septic.task._branches import Branch, ranked_branches
from puma_septic.validation import Array


def branch(name: str, excess: list[float], travel: float = 0.0) -> Branch:
    q: Array = np.array([[0.0, 0.0], [travel, 0.0]])
    lowest = LowestPoints(height=np.array([1.0, 1.0]), parts=("a", "a"))
    return Branch(configuration=name, q=q, excess=np.array([[0.0, 0.0], excess]), lowest=lowest)


def ranking(*branches: Branch) -> list[str]:
    return [one.configuration for one in ranked_branches(branches, "auto")]


def test_the_sum_of_what_is_beyond_the_limits_decides_not_the_largest() -> None:
    """Two joints half a radian beyond are worse than one by 0.6 rad, though each is less."""
    assert ranking(branch("two joints", [0.5, 0.5]), branch("one joint", [0.6, 0.0])) == ["one joint", "two joints"]


def test_within_the_limits_the_least_travel_decides() -> None:
    near, far, beyond = branch("near", [0.0, 0.0], 1.0), branch("far", [0.0, 0.0], 2.0), branch("beyond", [0.1, 0.0])
    assert ranking(beyond, far, near) == ["near", "far", "beyond"]
