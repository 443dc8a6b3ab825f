"""Joint positions along a path: a branch of inverse kinematics, or the least-norm motion; where none can follow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.errors import NoSolution
from puma_septic.kinematics import IkBatch, inverse_kinematics_batch, singularity_distances, singularity_names
from puma_septic.paths._differential import Follower
from puma_septic.paths._path import Path, PathRates
from puma_septic.piecewise import Piecewise, matrices
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["Branches", "Guide", "beyond_limit", "off_path", "singular", "track"]

# A pose that is nearer than this to one in reach, in m, is reached, by another branch.
_REACHED = 1e-9


def _place(path: Path, s: float) -> str:
    """A place on the path in words."""
    s = min(max(s, 0.0), path.length)
    point = ", ".join(f"{x:.6g}" for x in path.frames(s)[:3, 3])
    return f"at s = {s:.6g} m of {path.length:.6g} m, tool at [{point}] m"


def _out_of_reach(path: Path, s: float, q: Array, distance: float, held: str) -> NoSolution:
    """The branch ends: no branch reaches the pose, or others do."""
    ends = f"out of reach by {distance:.3g} m" if distance > _REACHED else "this branch ends"
    return NoSolution(
        f"{path.kind}{held}: {ends} {_place(path, s)}; move the path nearer, or its ends",
        residual=distance,
        q=q,
    )


def singular(path: Path, s: float, q: Array, follower: Follower, held: str) -> NoSolution:
    """The path meets a singular posture: two branches, or all turns of a joint, are one there."""
    if follower.conditions == 6:
        measures = singularity_distances(follower.robot, q[None])[0]
        nearest = int(np.argmin(np.abs(measures)))
        name, measure = singularity_names(follower.robot)[nearest], float(measures[nearest])
    else:  # what the arm could do to an orientation that is left free does not count
        name, measure = "least singular value of the position's Jacobian", float(follower.inverse(q[None])[1][0])
    return NoSolution(
        f"{path.kind}{held}: meets a singularity {_place(path, s)} ({name} {measure:.3g}, zero where singular), where"
        " joints would have to move without bound; tilt the tool, shift the path aside, or pass there by a joint move",
        residual=abs(measure),
        q=q,
    )


def off_path(path: Path, s: float, q: Array, residual: float, held: str) -> NoSolution:
    """No joint positions hold the pose, though others before it are held."""
    return NoSolution(
        f"{path.kind}{held}: the arm leaves the path {_place(path, s)} ({residual:.3g} m or rad off): that pose is out"
        " of its reach, or asks for more than its joints can do; constrain='position' leaves the orientation free",
        residual=residual,
        q=q,
    )


def beyond_limit(path: Path, robot: Robot, j: int, s: float, q: Array, held: str) -> NoSolution:
    """A joint leaves its range, with whatever whole turns."""
    low, high = robot.limits.position[j]
    unit = "m" if robot.is_prismatic[j] else "rad"
    excess = float(np.nanmax([low - q[j], q[j] - high]))
    return NoSolution(
        f"{path.kind}{held}: joint {robot.joint_names[j]!r}: {q[j]:.6g} {unit} is outside [{low:.6g}, {high:.6g}]"
        f" {unit} {_place(path, s)}; take another branch, start or tool angle",
        residual=excess,
        q=q,
    )


_DEGREE = 20
# Sweeps of the fixed point until all nodes agree to the tolerance, in rad or m; more mean that the step is too long.
_SWEEPS, _AGREED = 40, 1e-14
_TAIL = 1e-12
# What the pose at the end of a step may be off before it is corrected, in m or rad.
_OFF = 1e-10
_SHORTEST_STEP = 2.0**-20


def track(follower: Follower, path: Path, start: Array, held: str) -> Piecewise:
    r"""Joint positions by distance, from a start posture on the path.

    The differential equation :math:`q' = J^+(q)\,x'(s)`, the least norm of joint rates, is solved on intervals at 21
    Chebyshev nodes: :math:`q \leftarrow q_0 + \int J^+(q)\,x'` until all nodes agree, the interval halved where they do
    not or where the series has not converged. The end of each is moved onto its pose.

    Raises
    ------
    NoSolution
        At a singular posture, or where the arm cannot hold the pose.
    """
    breaks, series = [0.0], []
    q, left, piece, length = start, 0.0, 0, path.length / 8
    while left < path.length:
        end = float(path.breaks[piece + 1])
        right = end if end - left <= 1.2 * length else left + length
        step = _step(follower, path, piece, (left, right), q)
        if step is None:
            length = (right - left) / 2
            if length < _SHORTEST_STEP * path.length:
                raise singular(path, left, q, follower, held)
            continue
        q, residual = follower.polished(step.sum(axis=0)[None], path.frames(np.array([right])))
        if residual[0] > _OFF:
            raise off_path(path, right, q[0], float(residual[0]), held)
        q = q[0]
        breaks.append(right)
        series.append(step)
        length, left, piece = 1.5 * (right - left), right, piece + (right == end)
    return Piecewise(breaks=np.array(breaks), coefficients=np.stack(series, axis=1))


def _step(follower: Follower, path: Path, piece: int, span: tuple[float, float], start: Array) -> Array | None:
    """Series (degree + 2, n_joints) on one interval, or None where it is too long."""
    nodes, half = matrices.nodes(_DEGREE), (span[1] - span[0]) / 2
    pieces: NDArray[np.int64] = np.full(len(nodes), piece)
    rates: PathRates = path.rates(pieces, span[0] + half * (nodes + 1))
    wanted = follower.targets(rates)[0][:, :, None]
    to_series = matrices.coefficients_from_values(_DEGREE)
    to_values = matrices.values_matrix(_DEGREE + 1, _DEGREE)
    q, change = np.tile(start, (len(nodes), 1)), np.inf
    for _ in range(_SWEEPS):
        inverse, _ = follower.inverse(q)
        slopes = to_series @ (inverse @ wanted)[:, :, 0]
        integral = half * matrices.integral_matrix(_DEGREE) @ slopes
        integral[0] += start
        moved = to_values @ integral
        before, change = change, float(np.abs(moved - q).max())
        q = moved
        if change <= _AGREED * max(1.0, float(np.abs(q).max())):
            break
        if not change <= 1.0 or change > 2 * before:
            return None
    tail, size = np.abs(slopes[-3:]).max() * half, max(1.0, float(np.abs(q).max()))
    agreed = change <= 100 * _AGREED * size and tail <= _TAIL * size
    return np.asarray(integral) if agreed else None


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
                raise _out_of_reach(self.path, float(s[lost]), q[lost], distance, held)
            q = _unwound(q)
            wide = np.abs(np.diff(q, axis=0)).max(axis=1) > _STEP
            if not wide.any():
                return Guide(s, q)
            gaps = np.where(wide, np.diff(s), np.inf)
            if gaps.min() < _SMALLEST * self.path.length:
                tight = int(np.argmin(gaps))
                follower = Follower(robot=self.robot, conditions=6, rank=6)
                raise singular(self.path, float(s[tight]), q[tight], follower, held)
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
