"""A named branch of inverse kinematics followed along a path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.kinematics import IkBatch, inverse_kinematics_batch
from puma_septic.paths._path import Path
from puma_septic.paths._refusal import out_of_reach, singular
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["Branches", "Guide"]

_TURN = 2 * np.pi
# First places on each piece of a path; between two of them no joint moves farther than this, in rad, or more are added.
_PLACES = 33
_STEP = 0.5
# Where two places are closer than this part of the path, and a joint still leaps, the posture is singular.
_SMALLEST = 2.0**-24


class Guide(NamedTuple):
    """Joint positions (k, n_joints) at distances (k,), close enough to tell whole turns between them."""

    s: Array
    q: Array

    def __call__(self, s: Array) -> Array:
        return np.stack([np.interp(s, self.s, column) for column in self.q.T], axis=1)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Branches:
    """All branches at the first places of a path.

    Attributes
    ----------
    robot : Robot
    path : Path
    s : ndarray, shape (k,)
    found : IkBatch
    """

    robot: Robot
    path: Path
    s: Array
    found: IkBatch

    @classmethod
    def along(cls, robot: Robot, path: Path, start: Array | None) -> Branches:
        """At evenly spaced places of each piece; whole turns as `start` has them, where it is given."""
        ends = path.breaks
        share = np.arange(_PLACES - 1) / (_PLACES - 1)
        s = np.append((ends[:-1, None] + np.diff(ends)[:, None] * share).ravel(), ends[-1])
        return cls(robot=robot, path=path, s=s, found=inverse_kinematics_batch(robot, path.frames(s), q_near=start))

    @property
    def names(self) -> tuple[str, ...]:
        """Of all branches."""
        return self.found.configurations

    def at(self, k: int, s: Array, near: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Branch k at distances s (n,), whole turns nearest to `near` (n, n_joints), and whether it exists there."""
        found = inverse_kinematics_batch(self.robot, self.path.frames(s), q_near=near)
        q = found.q[:, k]
        return q - _TURN * np.rint((q - near) / _TURN), found.exists[:, k]

    def guide(self, k: int) -> Guide:
        """Branch k all along the path, without leaps.

        Raises
        ------
        NoSolution
            Where it ends, or leaps at a singular posture.
        """
        s, q, exists = self.s, self.found.q[:, k], self.found.exists[:, k]
        held = f", branch {self.names[k]!r}"
        while True:
            if not exists.all():
                lost = int(np.argmin(exists))
                distance = float(
                    inverse_kinematics_batch(self.robot, self.path.frames(s[lost : lost + 1])).out_of_reach[0]
                )
                raise out_of_reach(self.path, float(s[lost]), q[lost], distance, held)
            q = _unwound(q)
            wide = np.abs(np.diff(q, axis=0)).max(axis=1) > _STEP
            if not wide.any():
                return Guide(s, q)
            gaps = np.where(wide, np.diff(s), np.inf)
            if gaps.min() < _SMALLEST * self.path.length:
                tight = int(np.argmin(gaps))
                raise singular(self.path, float(s[tight]), q[tight], self.robot, held)
            s, q, exists = self._refined(k, s, q, exists, np.flatnonzero(wide))

    def _refined(
        self, k: int, s: Array, q: Array, exists: NDArray[np.bool_], wide: NDArray[np.int64]
    ) -> tuple[Array, Array, NDArray[np.bool_]]:
        """With places in the middle of the wide gaps added."""
        middle = (s[wide] + s[wide + 1]) / 2
        more, there = self.at(k, middle, q[wide])
        return np.insert(s, wide + 1, middle), np.insert(q, wide + 1, more, axis=0), np.insert(exists, wide + 1, there)


def _unwound(q: Array) -> Array:
    """The rows with whole turns that keep each near the one before."""
    steps = np.diff(q, axis=0)
    return np.concatenate([q[:1], q[:1] + np.cumsum(steps - _TURN * np.rint(steps / _TURN), axis=0)])
