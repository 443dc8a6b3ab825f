"""What a controller is to follow: planned positions, velocities and accelerations at the instants that it asks for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["Reference", "reference_at", "references"]


class Reference(NamedTuple):
    """Planned motion of several arms, each of shape (n_instants, n_rows, n_joints), after its end at rest."""

    q: Array
    v: Array
    a: Array

    def at(self, k: int) -> Reference:
        """Of one instant, shape (n_rows, n_joints)."""
        return Reference(self.q[k], self.v[k], self.a[k])


def reference_at(trajectory: Trajectory, since: Array, *, from_left: bool = False) -> Reference:
    """A planned motion at times since its start, shape (n,); steps seen from the left where asked for."""
    duration, state, n = trajectory.duration, trajectory.state, trajectory.n_joints
    # A hair before an instant stands for its left-hand side; the hair is a rounding of the time.
    inside = np.clip(np.nextafter(since, -np.inf) if from_left else since, 0.0, duration)
    values = state.at_offsets(inside)
    ended = since > duration * (1 + 1e-12) if from_left else since >= duration * (1 - 1e-12)
    values[ended, n:] = 0.0
    return Reference(values[:, :n], values[:, n : 2 * n], values[:, 2 * n : 3 * n])


def references(trajectories: Sequence[Trajectory], instants: Array, *, from_left: bool = False) -> Reference:
    """Of several motions, each at its own times since the start, shape (n_instants, n_rows)."""
    rows = [reference_at(trajectory, instants[:, k], from_left=from_left) for k, trajectory in enumerate(trajectories)]
    return Reference(*(np.stack(parts, axis=1) for parts in zip(*rows, strict=True)))
