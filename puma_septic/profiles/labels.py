"""How messages call the joints."""

from __future__ import annotations

from collections.abc import Sequence

__all__ = ["joint_labels"]


def joint_labels(joint_names: Sequence[str], n_joints: int) -> list[str]:
    """By name, or by number from 1 where there are no names."""
    return [f"joint {name!r}" for name in joint_names] or [f"joint {j + 1}" for j in range(n_joints)]
