"""Which profiles suit a task, and which do not and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from puma_septic import profiles as families
from puma_septic.errors import InputError
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_choice

__all__ = ["make_profiles"]

# Two motions whose coefficients differ by less than this part of the largest are one: some thousand roundings.
_SAME: Final = 1e-10


def make_profiles(
    robot: Robot,
    points: Array,
    times: Array,
    *,
    names: Sequence[str] | None,
    options: Mapping[str, Mapping[str, Any]],
    own: Sequence[str] = (),
) -> tuple[dict[str, Trajectory], dict[str, str]]:
    """Trajectories by profile, and for each profile that does not suit the reason.

    Without names, all profiles are tried, and of those that give the same motion the first one stays, or one of `own`.

    Raises
    ------
    InputError
        For an unknown profile, or options of one that is not among those compared.
    """
    known = [info.name for info in families.available()]
    wanted = known if names is None else [checked_choice("profile", name, known) for name in names]
    for name in options:
        checked_choice("profile in options", name, wanted)
    made: dict[str, Trajectory] = {}
    unsuitable: dict[str, str] = {}
    for name in wanted:
        try:
            trajectory = _make(name, robot, points, times, options.get(name, {}))
        except InputError as error:
            unsuitable[name] = str(error)
            continue
        twin = next((other for other, one in made.items() if _is_same(one, trajectory)), None)
        if names is None and twin is not None and name in own and twin not in own:
            made = {name if other == twin else other: one for other, one in made.items()}
            unsuitable[twin] = f"here the same motion as {name}"
        elif names is None and twin is not None:
            unsuitable[name] = f"here the same motion as {twin}"
        else:
            made[name] = trajectory
    return made, unsuitable


def _make(name: str, robot: Robot, points: Array, times: Array, options: Mapping[str, Any]) -> Trajectory:
    """The profile with what it needs: times or durations, a blend time, limits, unless options say otherwise."""
    given: dict[str, Any] = {}
    if "blend_time" in families.family(name).options and "cruise_velocity" not in options:
        # Blends of half the shortest segment never overlap; on the paper's times, its own 1 s.
        given["blend_time"] = float(np.diff(times).min()) / 2
    limits = {f"max_{kind}": getattr(robot.limits, kind) for kind in ("velocity", "acceleration", "jerk")}
    return families.make(
        name, points, times, limits=limits, options=given | dict(options), joint_names=robot.joint_names
    )


def _is_same(one: Trajectory, other: Trajectory) -> bool:
    f, g = one.position, other.position
    if not np.array_equal(f.breaks, g.breaks):
        return False
    return bool((f - g).bounds().max() <= _SAME * max(f.bounds().max(), g.bounds().max()))
