"""The points and times that a profile is given: checked once, its times relative to the first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.piecewise import Piecewise
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array, checked_each, checked_texts, checked_times

__all__ = ["Vias", "boundary", "checked_points", "joint_labels", "named"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Vias:
    """What a profile leads through, and what its trajectory is told besides the position.

    A profile computes with `t`, which begins at 0, so that one that begins at a late time (stamps since 1970,
    say) loses no digits; `trajectory` sets the result at its time.

    Attributes
    ----------
    profile : str
        The family, as messages and the trajectory call it.
    q : ndarray, shape (k, n_joints)
        Points, in each joint's own unit: rad, or m where it is prismatic.
    t : ndarray, shape (k,)
        Times since the first point, s.
    times : ndarray, shape (k,)
        As they were given, s.
    joint_names : tuple of str
        Empty where none are given.
    """

    profile: str
    q: Array
    t: Array
    times: Array
    joint_names: tuple[str, ...]

    @classmethod
    def of(
        cls,
        profile: str,
        points: ArrayLike,
        times: ArrayLike,
        joint_names: Sequence[str] | None = None,
        *,
        at_least: int = 2,
        at_most: int | None = None,
        exactly: int | None = None,
    ) -> Vias:
        """Points and times that pass the checks which every profile makes at its door.

        Parameters
        ----------
        profile : str
        points : array_like, shape (k, n_joints)
        times : array_like, shape (k,)
            Strictly increasing, s.
        joint_names : sequence of str, optional
        at_least, at_most, exactly : int
            How many points the profile needs, or takes.

        Returns
        -------
        Vias

        Raises
        ------
        InputError
            For too few points or too many, times that do not increase or do not number as many, non-finite or
            misshapen arrays.
        """
        q = checked_points(profile, points, at_least=at_least, at_most=at_most, exactly=exactly)
        instants = checked_times("times", times)
        if len(instants) != len(q):
            raise InputError(f"times: {len(instants)} times for {len(q)} points; one for each is needed")
        t = instants - instants[0] if instants[0] else instants
        gaps = t[1:] - t[:-1]
        if gaps.min() <= np.spacing(t[-1]):
            k = int(np.argmin(gaps))
            raise InputError(
                f"times: times[{k}] = {instants[k]:.12g} s and times[{k + 1}] = {instants[k + 1]:.12g} s are too close"
                f" to each other to be told apart in the {t[-1]:g} s since the first"
            )
        t.setflags(write=False)
        return cls(profile=profile, q=q, t=t, times=instants, joint_names=named(joint_names))

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return int(self.q.shape[1])

    @property
    def labels(self) -> list[str]:
        """How messages call the joints."""
        return joint_labels(self.joint_names, self.n_joints)

    def boundary(self, name: str, value: ArrayLike | None) -> Array:
        """A boundary value per joint, shape (n_joints,): None is zero, a scalar holds for all joints."""
        return boundary(name, value, self.n_joints)

    def at_points(self, name: str, value: ArrayLike | None) -> Array:
        """A value per point and joint, shape (k, n_joints); zeros where none is given."""
        return np.zeros_like(self.q) if value is None else checked_array(name, value, self.q.shape)

    def trajectory(self, position: Piecewise, *, start: ArrayLike = 0.0, end: ArrayLike = 0.0) -> Trajectory:
        """The trajectory of a position over the time since the first point.

        Parameters
        ----------
        position : Piecewise
            Breaks from 0 to ``t[-1]``.
        start, end : array_like
            Velocities and accelerations given there, of any shape: where one is not zero, the trajectory is part of a
            longer motion, and the arm is not at rest before or after it.

        Returns
        -------
        Trajectory
        """
        return Trajectory(
            position=position.shifted(self.times[0]) if self.times[0] else position,
            points=self.q,
            times=self.times,
            profile=self.profile,
            joint_names=self.joint_names,
            rest_before=not np.any(start),
            rest_after=not np.any(end),
        )


def checked_points(
    profile: str, points: ArrayLike, *, at_least: int = 2, at_most: int | None = None, exactly: int | None = None
) -> Array:
    """Via points (k, n_joints) with as many rows as the profile needs."""
    array = checked_array("points", points, (None, None))
    if array.shape[1] == 0:
        raise InputError("points: at least one joint (column) is needed")
    if exactly is not None and len(array) != exactly:
        raise InputError(f"{profile} needs exactly {exactly} points, got {len(array)}")
    if len(array) < at_least:
        raise InputError(f"{profile} needs at least {at_least} points, got {len(array)}")
    if at_most is not None and len(array) > at_most:
        raise InputError(f"{profile} takes at most {at_most} points, got {len(array)}")
    return array


def boundary(name: str, value: ArrayLike | None, n_joints: int) -> Array:
    """A boundary value per joint: None is zero, a scalar holds for all joints."""
    if value is None:
        return np.zeros(n_joints)
    return checked_each(name, value, n_joints)


def named(joint_names: Sequence[str] | None) -> tuple[str, ...]:
    """Joint names as a tuple, empty where none are given."""
    if isinstance(joint_names, str):
        raise InputError(f"joint_names: expected one name per joint, got the single string {joint_names!r}")
    return checked_texts("joint_names", joint_names)


def joint_labels(joint_names: Sequence[str], n_joints: int) -> list[str]:
    """How messages call the joints: by name, or by number from 1 where there are no names."""
    return [f"joint {name!r}" for name in joint_names] or [f"joint {j + 1}" for j in range(n_joints)]
