"""Straight lines between the points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.piecewise import Piecewise
from puma_septic.profiles._info import BIAGIOTTI, ProfileInfo
from puma_septic.profiles._vias import Vias
from puma_septic.trajectory import Trajectory

__all__ = ["LINEAR", "linear"]

LINEAR = ProfileInfo(
    name="linear",
    continuity="C0",
    inside="C0",
    needs="times",
    at_vias="passes",
    overshoots=False,
    source=f"{BIAGIOTTI}, 2.1.1",
)


def linear(points: ArrayLike, times: ArrayLike, *, joint_names: Sequence[str] | None = None) -> Trajectory:
    """Constant velocity ``(q_k+1 - q_k) / (t_k+1 - t_k)`` between the points.

    The velocity steps at every point and at both ends, so acceleration, jerk and torque are unbounded there:
    the yardstick for the others, not a motion for an arm (Biagiotti and Melchiorri, Trajectory Planning for
    Automatic Machines and Robots).

    Parameters
    ----------
    points : array_like, shape (k, n_joints)
        At least two, rad (m for prismatic joints).
    times : array_like, shape (k,)
        Strictly increasing, s.
    joint_names : sequence of str, optional

    Returns
    -------
    Trajectory
        With breaks at the points.

    Raises
    ------
    InputError
        For fewer than two points, times that do not increase, non-finite or misshapen arrays.

    Examples
    --------
    >>> from puma_septic import profiles
    >>> profiles.linear([[0.0], [1.0], [0.0]], [0.0, 2.0, 3.0])([1.0, 2.5]).ravel().tolist()
    [0.5, 0.5]
    """
    vias = Vias.of("linear", points, times, joint_names)
    return vias.trajectory(Piecewise.from_power(vias.t, np.stack([vias.q[:-1], np.diff(vias.q, axis=0)])))
