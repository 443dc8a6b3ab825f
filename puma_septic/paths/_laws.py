"""Laws of time on a path: how far the tool has come, from rest to rest."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from puma_septic import profiles
from puma_septic.paths._path import Path
from puma_septic.trajectory import Trajectory
from puma_septic.validation import checked_number

__all__ = ["at_speed", "in_time"]


def at_speed(path: Path, *, speed: float, acceleration: float, jerk: float | None = None) -> Trajectory:
    r"""The fastest law of time within limits of the tool's speed, acceleration and jerk along its path.

    Without a limit of jerk a trapezoid in speed: with the length L, ramps of :math:`v/a` and a cruise in
    :math:`L/v + v/a` if L is more than :math:`v^2/a`, else two ramps in :math:`2\sqrt{L/a}`. With one the double-S.
    Curves add their centripetal acceleration, :math:`\dot s^2` over the radius: see `tool_rates`.

    Parameters
    ----------
    path : Path
    speed : float
        Of the cruise, m/s, positive.
    acceleration : float
        Along the path, m/s^2, positive.
    jerk : float, optional
        m/s^3, positive.

    Returns
    -------
    Trajectory
        Of one joint, the distance covered in m.

    Raises
    ------
    InputError
        For a value that is not positive.

    Examples
    --------
    >>> import numpy as np
    >>> from puma_septic import paths
    >>> way = paths.line(np.eye(4), [1.0, 0.0, 0.0])
    >>> float(paths.at_speed(way, speed=0.5, acceleration=1.0).duration)
    2.5
    """
    v = checked_number("speed", speed, unit="m/s", above=0.0)
    a = checked_number("acceleration", acceleration, unit="m/s^2", above=0.0)
    points = [[0.0], [path.length]]
    if jerk is not None:
        j = checked_number("jerk", jerk, unit="m/s^3", above=0.0)
        return profiles.double_s(points, max_velocity=v, max_acceleration=a, max_jerk=j)
    if path.length <= v * v / a:
        return profiles.bang_bang(points, [0.0, 2 * float(np.sqrt(path.length / a))])
    return profiles.trapezoidal(points, [0.0, path.length / v + v / a], blend_time=v / a)


def in_time(
    path: Path, duration: float, profile: str = "quintic_segments", *, options: Mapping[str, Any] | None = None
) -> Trajectory:
    """A law of time that covers the path in a given time, by a profile of the package from rest to rest.

    Parameters
    ----------
    path : Path
    duration : float
        s, positive.
    profile : str
        A name that `profiles.make` takes.
    options : mapping, optional
        Its further arguments by name.

    Returns
    -------
    Trajectory
        Of one joint, the distance covered in m.

    Raises
    ------
    InputError
        For a duration that is not positive, an unknown profile or option.

    Examples
    --------
    >>> import numpy as np
    >>> from puma_septic import paths
    >>> way = paths.line(np.eye(4), [1.0, 0.0, 0.0])
    >>> float(paths.in_time(way, 2.0, "cycloidal").extrema(1).max[0])
    1.0
    """
    time = checked_number("duration", duration, unit="s", above=0.0)
    return profiles.make(profile, [[0.0], [path.length]], [0.0, time], options=options)
