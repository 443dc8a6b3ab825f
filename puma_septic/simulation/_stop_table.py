"""Stopping distances and times as ISO 10218-1, Annex B lays them out: by speed, extension and load.

Annex B asks for the three joints with the largest displacement, at 33, 66 and 100 % of speed, extension and load.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple, final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize

from puma_septic.document import SCHEMAS, one_line, plain
from puma_septic.dynamics import check_inertia
from puma_septic.errors import InputError
from puma_septic.kinematics import chain_to, forward_kinematics
from puma_septic.robot import Payload, Robot
from puma_septic.simulation._stop import CATEGORIES, NOT_A_SAFETY_FUNCTION, checked_brakes, known_limits
from puma_septic.simulation._stop_categories import Path, brake, slow_down
from puma_septic.validation import (
    Array,
    checked_array,
    checked_choice,
    checked_each,
    checked_number,
    read_only,
)
from puma_septic.views import stops as view

__all__ = ["FRACTIONS", "StopRow", "StopTable", "extended_postures", "stop_table"]

FRACTIONS: Final = (0.33, 0.66, 1.0)
"""Of speed, extension and load, as ISO 10218-1, Annex B has them."""

_STARTS: Final = 6
# What the search leaves of a reach.
_AS_FAR: Final = 1e-6
_MARGIN: Final = 5e-4


class StopRow(NamedTuple):
    """One joint that moves alone, at shares of its speed limit, the arm's reach and the load; the worse direction.

    `duration` (s) and `angle` (rad or m) are infinite where the brakes do not hold, NaN where the torque limits allow
    no stop. `others` is the largest displacement of the joints that should hold meanwhile: brakes slip under the
    reaction of the one that stops.
    """

    joint: str
    speed: float
    extension: float
    load: float
    duration: float
    angle: float
    others: float


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class StopTable:
    """Stops of single joints; made by `stop_table`. A prediction, not a safety function.

    Attributes
    ----------
    robot : Robot
        Without the load.
    category : int
    reaction_time : float
        s.
    full_load : float
        kg.
    full_speed : ndarray, shape (k,)
        Of each of the joints, rad/s (m/s).
    reach : float
        Largest distance of the tool from the first axis that carries it, m.
    postures : ndarray, shape (n_extensions, n_joints)
        The arm at each extension, rad (m).
    rows : tuple of StopRow
    """

    robot: Robot
    category: int
    reaction_time: float
    full_load: float
    full_speed: Array
    reach: float
    postures: Array
    rows: tuple[StopRow, ...]

    @property
    def joints(self) -> tuple[str, ...]:
        """Those that move."""
        return tuple(dict.fromkeys(row.joint for row in self.rows))

    def worst(self, joint: str) -> StopRow:
        """The row in which a joint goes farthest.

        Returns
        -------
        StopRow
        """
        checked_choice("joint", joint, self.joints)
        rows = [row for row in self.rows if row.joint == joint]
        return max(rows, key=lambda row: -1.0 if np.isnan(row.angle) else row.angle)

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document.

        Returns
        -------
        dict
        """
        return {
            "schema": SCHEMAS["stops"],
            "robot": self.robot.name,
            "category": self.category,
            "meaning": CATEGORIES[self.category],
            "reaction_time": self.reaction_time,
            "full_load": self.full_load,
            "full_speed": dict(zip(self.joints, plain(self.full_speed), strict=True)),
            "reach": self.reach,
            "postures": plain(self.postures),
            "stops": [plain(row._asdict()) for row in self.rows],
            "warning": NOT_A_SAFETY_FUNCTION,
        }

    def to_csv(self) -> str:
        """One line per joint, speed, extension and load.

        Returns
        -------
        str
        """
        return view.csv(self.to_dict())

    def __str__(self) -> str:
        return view.text(self.to_dict())

    def __repr__(self) -> str:
        facts = {"robot": self.robot.name, "category": self.category, "joints": ", ".join(self.joints)}
        return one_line("StopTable", {**facts, "load": f"{self.full_load:g} kg"})

    def _repr_html_(self) -> str:
        return view.html(self.to_dict())


def stop_table(
    robot: Robot,
    *,
    load: float | Payload,
    category: int = 1,
    brake_torque: ArrayLike | None = None,
    reaction_time: float | None = None,
    joints: Sequence[str] | None = None,
    speed: ArrayLike | None = None,
    fractions: Sequence[float] = FRACTIONS,
) -> StopTable:
    """Stopping times and angles of single joints by speed, extension and load (ISO 10218-1, Annex B).

    Each joint moves alone at a share of its speed limit, in the worse of both directions, while all others hold. Full
    extension is the largest distance of the tool from the first axis that carries it, wherever the arm stands; for
    less, the third joint from the base is bent.

    Parameters
    ----------
    robot : Robot
        Its payload is replaced.
    load : float or Payload
        Full load: kg at the tool's origin, or a payload whose mass, and inertia with it, is scaled.
    category, brake_torque, reaction_time
        As of `puma_septic.simulation.stop`.
    joints : sequence of str, optional
        By default the first three that carry the tool, from the base.
    speed : array_like, shape () or (k,), optional
        Full speed of each of them, rad/s (m/s); by default their limits.
    fractions : sequence of float
        Of speed, extension and load.

    Returns
    -------
    StopTable

    Raises
    ------
    InputError
        For joints without a speed or torque limit, brakes without data, or fractions that are not from 0 to 1.
    """
    first = [robot.joint_names[column] for column in chain_to(robot).driving[:3]]
    names = tuple(first if joints is None else joints)
    moving = np.array([robot.joint_index(name) for name in names])
    full = _full_speed(robot, names, moving, speed)
    shares = checked_array("fractions", fractions, (None,), above=0.0, at_most=1.0)
    payload = load if isinstance(load, Payload) else Payload(mass=checked_number("load", load, unit="kg", at_least=0.0))
    checked_choice("category", str(category), [str(one) for one in CATEGORIES])
    braking = checked_brakes(robot, brake_torque, reaction_time) if category == 0 else None
    reaction = braking[1] if braking else checked_number("reaction_time", reaction_time or 0.0, unit="s", at_least=0.0)
    check_inertia(robot)
    reach, postures = extended_postures(robot, shares)
    rows = _rows(robot, names, full, shares, postures, payload, braking, reaction)
    return StopTable(
        robot=robot,
        category=category,
        reaction_time=reaction,
        full_load=payload.mass,
        full_speed=full,
        reach=reach,
        postures=postures,
        rows=tuple(sorted(rows, key=lambda row: (names.index(row.joint), row.load, row.extension, row.speed))),
    )


def _rows(
    robot: Robot,
    names: Sequence[str],
    full: Array,
    shares: Array,
    postures: Array,
    payload: Payload,
    braking: tuple[Array, float] | None,
    reaction: float,
) -> list[StopRow]:
    """All stops of a load at once, each in both directions, of which the worse one counts."""
    moving = np.array([robot.joint_index(name) for name in names])
    cases = list(itertools.product(range(len(moving)), range(len(shares)), range(len(shares)), (1, -1)))
    q = np.array([postures[e] for _, _, e, _ in cases])
    v = np.zeros_like(q)
    for row, (k, s, _, way) in enumerate(cases):
        v[row, moving[k]] = way * shares[s] * full[k]
    rows: list[StopRow] = []
    for part in shares:
        loaded = robot.with_payload(_scaled(payload, float(part)))
        durations, angles, others = _stops(loaded, q, v, moving[[k for k, *_ in cases]], braking, reaction)
        for first in range(0, len(cases), 2):
            k, s, e, _ = cases[first]
            worse = first + int(_is_worse(angles[first + 1], angles[first]))
            where = float(shares[s]), float(shares[e]), float(part)
            results = (float(values[worse]) for values in (durations, angles, others))
            rows.append(StopRow(names[k], *where, *results))
    return rows


def extended_postures(robot: Robot, fractions: Array) -> tuple[float, Array]:
    """The largest reach of the tool from the first axis that carries it, and a posture at each share of it.

    The full one by a search from several starts; the others by bending the third joint until the reach fits.

    Returns
    -------
    float
        m.
    ndarray, shape (k, n_joints)
        rad (m).
    """
    n, chain = robot.n_joints, chain_to(robot)
    if len(chain.driving) < 3:
        raise InputError(
            f"a table of extensions needs a tool that at least 3 joints carry; {robot.tool!r} of robot {robot.name!r}"
            f" is carried by {len(chain.driving)}"
        )
    third = int(chain.driving[2])
    low, high = _range(robot)
    axis, origin = chain.placements[0][:3, 2], chain.placements[0][:3, 3]

    def reach_of(q: Array) -> Array:
        place = forward_kinematics(robot, q)[:, :3, 3]
        return np.asarray(np.linalg.norm(np.cross(place - origin, axis), axis=1))

    rng = np.random.default_rng(10218)
    starts = [np.clip(np.zeros(n), low, high), *rng.uniform(low, high, (_STARTS, n))]
    bounds = list(zip(low, high, strict=True))
    found = [
        minimize(lambda q: -float(reach_of(q[None])[0]), start, method="L-BFGS-B", bounds=bounds) for start in starts
    ]
    # Of postures that reach as far the first, so that rounding does not choose.
    least = min(float(one.fun) for one in found)
    full = next(one.x for one in found if float(one.fun) <= least + _AS_FAR * abs(least))
    reach = float(reach_of(full[None])[0])
    bends = np.linspace(low[third], high[third], 2001)
    bent = np.tile(full, (len(bends), 1))
    bent[:, third] = bends
    distance = reach_of(bent)
    nearest = [_nearest(bends, distance, float(share * reach), float(full[third])) for share in fractions]
    postures = np.tile(full, (len(fractions), 1))
    postures[:, third] = np.where(np.asarray(fractions) >= 1, full[third], nearest)
    return reach, read_only(postures)


def _nearest(bends: Array, distance: Array, wanted: float, full: float) -> float:
    """The least bend at which the reach is as wanted, between samples by a straight line; else the nearest to it."""
    signs = np.sign(distance - wanted)
    crossings = np.flatnonzero(signs[1:] != signs[:-1])
    if not len(crossings):
        return float(bends[int(np.argmin(np.abs(distance - wanted)))])
    share = (wanted - distance[crossings]) / (distance[crossings + 1] - distance[crossings])
    at = bends[crossings] + share * (bends[crossings + 1] - bends[crossings])
    return float(at[int(np.argmin(np.abs(at - full)))])


def _range(robot: Robot) -> tuple[Array, Array]:
    """Position limits, a turn each way where there are none."""
    bounds = np.where(np.isnan(robot.limits.position), [-np.pi, np.pi], robot.limits.position)
    return np.maximum(bounds[:, 0], -2 * np.pi), np.minimum(bounds[:, 1], 2 * np.pi)


def _full_speed(robot: Robot, names: Sequence[str], moving: Array, speed: ArrayLike | None) -> Array:
    if speed is None:
        known = robot.limits.velocity[moving]
        if np.isnan(known).any():
            unknown = ", ".join(name for name, value in zip(names, known, strict=True) if np.isnan(value))
            raise InputError(f"a table of stops needs the speed limit of each joint, or speed=; not known of {unknown}")
        return read_only(known)
    return read_only(checked_each("speed", speed, len(names), unit="rad/s", above=0.0))


def _scaled(payload: Payload, part: float) -> Payload:
    return Payload(mass=part * payload.mass, com=payload.com, inertia=part * np.asarray(payload.inertia))


def _stops(
    robot: Robot, q: Array, v: Array, moving: Array, braking: tuple[Array, float] | None, reaction: float
) -> tuple[Array, Array, Array]:
    """Durations, angles of the moving joints and the largest of the others, of all rows, (n_rows,)."""
    rows = np.arange(len(q))
    if braking is not None:
        made = brake(robot, q, v, *braking)
        moved = np.abs(made.q - q).max(axis=0)
        angles = moved[rows, moving].copy()
        moved[rows, moving] = 0.0
        held = np.isfinite(made.durations)
        return made.durations, np.where(held, angles, np.inf), np.where(held, moved.max(axis=1), np.inf)

    def path(s: Array) -> tuple[Array, Array, Array]:
        return q + v * s[:, None], v, np.zeros_like(v)

    at: Path = path
    slowing = slow_down(robot, at, np.full(len(q), reaction), known_limits(robot) * (1 - _MARGIN))
    durations = np.where(slowing.is_possible, reaction + slowing.lengths.sum(axis=0), np.nan)
    angles = np.where(slowing.is_possible, slowing.s[-1] * np.abs(v[rows, moving]), np.nan)
    return durations, angles, np.zeros(len(q))


def _is_worse(one: float, other: float) -> bool:
    """Whether an angle is the worse one: no stop at all is worse than any."""
    return bool(np.isnan(one) or (not np.isnan(other) and one > other))
