"""Motions sampled for drawing; no number that is reported is read off these samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.assessment import Assessment
from puma_septic.kinematics import tool_motion
from puma_septic.piecewise import Piecewise, sampled
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["Samples", "Track", "samples_of", "together", "track_of"]

# A line of this many points is smooth on any screen; the least on each interval, and of many intervals at most in all.
_SAMPLES: Final = 200
_LEAST: Final = 8
_MOST: Final = 1200


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Track:
    """A trajectory sampled: t (k,), and position, velocity, acceleration and jerk, each (k, n_joints)."""

    trajectory: Trajectory
    label: str
    t: Array
    signals: tuple[Array, Array, Array, Array]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Samples:
    """An assessed motion sampled: its track, torque (k, n_joints), tool place (k, 3) and speed (k,).

    `detail` tells how densely, for what is sampled later.
    """

    assessment: Assessment
    track: Track
    torque: Array
    place: Array
    speed: Array
    detail: float

    @property
    def label(self) -> str:
        """The profile's name in legends."""
        return self.track.label

    @property
    def t(self) -> Array:
        """Instants, s."""
        return self.track.t


def track_of(trajectory: Trajectory, label: str, *, detail: float = 1.0) -> Track:
    """Position to jerk at common instants, both sides of each break; `detail` times as many as usual."""
    t, values = _sampled([trajectory.state], detail)
    return _track(trajectory, label, t, values)


def samples_of(assessment: Assessment, label: str, *, detail: float = 1.0) -> Samples:
    """Position to torque and the tool at common instants, both sides of each break; `detail` times as many as usual."""
    motion, n = assessment.motion, assessment.motion.robot.n_joints
    t, values = _sampled([motion.trajectory.state, motion.torque], detail)
    track = _track(motion.trajectory, label, t, values)
    tool = tool_motion(motion.robot, *track.signals[:3])
    return Samples(
        assessment=assessment,
        track=track,
        torque=values[:, 4 * n :],
        place=tool.position,
        speed=np.linalg.norm(tool.velocity, axis=1),
        detail=detail,
    )


def together(functions: Sequence[Piecewise], *, detail: float = 1.0) -> tuple[Array, list[Array]]:
    """Functions at common instants, both sides of each break of any: t (k,) and one array (k, m) for each."""
    t, values = _sampled(functions, detail)
    ends = np.cumsum([function.n_components for function in functions])
    return t, np.split(values, ends[:-1], axis=1)


def _sampled(functions: Sequence[Piecewise], detail: float) -> tuple[Array, Array]:
    joined = Piecewise.joined(functions)
    least = min(_LEAST, max(2, _MOST // len(joined.lengths)))
    return sampled(joined, samples=round(detail * _SAMPLES), least=round(detail * least))


def _track(trajectory: Trajectory, label: str, t: Array, values: Array) -> Track:
    q, v, a, j = np.split(values[:, : 4 * trajectory.n_joints], 4, axis=1)
    return Track(trajectory=trajectory, label=label, t=t, signals=(q, v, a, j))
