"""Which profiles suit a task and which do not, and which of the compared ones to take: each with its reason."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any, Final, final

import numpy as np

from puma_septic import profiles as families
from puma_septic.errors import InputError
from puma_septic.limit_check import LimitCheck
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_choice

__all__ = ["Candidate", "advice_of", "make_profiles", "ranked", "recommended"]

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


# Values that agree to so many digits are one: rounding does not choose.
_DIGITS: Final = ".9g"


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Candidate:
    """What counts of one profile.

    Attributes
    ----------
    name : str
    meets_points : bool
        Whether it goes through all points, at their times if these are given.
    is_feasible : bool
        Whether it keeps all known limits, and nothing leaves that open.
    stops : bool or None
        At the vias; None where there are none.
    value : float
        Of the first objective.
    worst : LimitCheck or None
        The limit that it uses most.
    """

    name: str
    meets_points: bool
    is_feasible: bool
    stops: bool | None
    value: float
    worst: LimitCheck | None

    @property
    def rounded(self) -> float:
        """The value to nine digits."""
        return float(f"{self.value:{_DIGITS}}")


def ranked(candidates: Sequence[Candidate]) -> tuple[str, ...]:
    """Names: those that meet the points and keep the limits first, then by the objective; of equals the first."""
    order = sorted(candidates, key=lambda one: (not one.meets_points, not one.is_feasible, one.rounded))
    return tuple(one.name for one in order)


def recommended(candidates: Sequence[Candidate]) -> dict[str, Candidate]:
    """The best of those that pass the vias and of those that stop at them, as far as there are any."""
    good = [one for one in candidates if one.meets_points and one.is_feasible and isfinite(one.value)]
    groups = {"passes the vias": False, "stops at the vias": True, "goes from point to point": None}
    found = {}
    for label, stops in groups.items():
        group = [one for one in good if one.stops is stops]
        if group:
            found[label] = min(group, key=lambda one: one.rounded)
    return found


def advice_of(candidates: Sequence[Candidate], objective: str) -> str:
    """One sentence: what to take, and by which measure; where nothing fits, what comes nearest.

    Examples
    --------
    >>> one = Candidate(name="quintic", meets_points=True, is_feasible=True, stops=True, value=2.0, worst=None)
    >>> advice_of([one], "peak_jerk")
    'Stops at the vias, keeps all known limits, least peak jerk: quintic.'
    """
    best = recommended(candidates)
    measure = objective.replace("_", " ")
    if best:
        parts = [
            f"{label}, keeps all known limits, least {measure}: {one.name}" if k == 0 else f"{label}: {one.name}"
            for k, (label, one) in enumerate(best.items())
        ]
        sentence = "; ".join(parts)
        return f"{sentence[0].upper()}{sentence[1:]}."
    meeting = [one for one in candidates if one.meets_points]
    if not meeting:
        return "No profile goes through all points."
    nearest = min(meeting, key=lambda one: inf if one.worst is None else one.worst.utilisation)
    if nearest.worst is None or not nearest.worst.is_violated:
        return f"No profile through all points has a finite {measure} and keeps all known limits for certain."
    return f"No profile through all points keeps all known limits; {nearest.name} comes nearest: {nearest.worst}."
