"""By how much a motion exceeds what it must keep, what the limits say to a result, and how it is worded."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.assessment import LimitCheck, height_series, limit_checks, lowest_point, unknown_values
from puma_septic.errors import InputError
from puma_septic.limit_check import HEIGHT
from puma_septic.objectives import Candidate
from puma_septic.paths import TOOL, ToolLimits, tool_rates
from puma_septic.piecewise import Extrema
from puma_septic.quantities import MOTION, QUANTITIES
from puma_septic.robot import Robot
from puma_septic.validation import (
    Array,
    checked_choice,
    checked_each,
    checked_kind,
    checked_list,
    checked_number,
)
from puma_septic.views.tables import Cell, text_table

__all__ = [
    "Excess",
    "Verdict",
    "check_cell",
    "checked_quantities",
    "excess_function",
    "known_quantities",
    "told",
    "verdict_of",
]

Excess = Callable[[Candidate], Array]


def excess_function(
    robot: Robot | None,
    n_joints: int,
    *,
    max_overshoot: ArrayLike | None = None,
    keep: Sequence[str] = (),
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
) -> Excess:
    """A function of a candidate: excess of each constraint, wanted at most 0; in rad, m, or as a share of the limit.

    Raises
    ------
    InputError
        For an unknown quantity, a limit that is known for no joint, or limits without a robot.
    """
    checks: list[Excess] = []
    if max_overshoot is not None:
        bound = checked_each("max_overshoot", max_overshoot, n_joints, unit="rad", at_least=0.0)
        checks.append(lambda candidate: _beyond_hull(candidate, bound))
    checks += [_limit_check(robot, quantity) for quantity in keep]
    if robot is not None and (floor is not None or tool_limits is not None):
        checks.append(_cell_check(robot, floor, tool_limits))
    return lambda candidate: np.concatenate([np.zeros(0), *(check(candidate) for check in checks)])


def checked_quantities(keep: Sequence[str]) -> tuple[str, ...]:
    """Names of limits; one name alone is meant as such."""
    names = (keep,) if isinstance(keep, str) else checked_list("keep", keep)
    return tuple(checked_choice("limit", name, QUANTITIES) for name in names)


def _beyond_hull(candidate: Candidate, bound: Array) -> Array:
    trajectory = candidate.trajectory
    reach = trajectory.extrema(0)
    above, below = reach.max - trajectory.points.max(axis=0), trajectory.points.min(axis=0) - reach.min
    return np.concatenate([above - bound, below - bound])


def _limit_check(robot: Robot | None, quantity: str) -> Excess:
    if robot is None:
        raise InputError(f"to keep the limits of {quantity}, the robot is needed: give robot=...")
    limit = getattr(robot.limits, quantity)
    if np.isnan(limit).all():
        raise InputError(
            f"no {quantity} limit of robot {robot.name!r} is known; give them by robot.with_limits({quantity}=...)"
        )
    row = QUANTITIES[quantity]
    if row.is_range:
        return lambda candidate: _beyond_positions(candidate, limit)
    if row.signal == "position":
        return lambda candidate: _beyond_extrema(candidate.trajectory.extrema(row.order), limit)
    if quantity == "effort":
        return lambda candidate: _beyond(candidate.torque_ends[0], candidate.torque_ends[1], limit)
    return lambda candidate: _beyond_extrema(candidate.motion.signal(quantity).extrema(), limit)


def check_cell(robot: Robot | None, floor: float | None, tool_limits: ToolLimits | None) -> None:
    """Raise an InputError for a floor or limits of the tool that are none, or that stand without the robot."""
    if floor is not None:
        checked_number("floor", floor, unit="m")
    if tool_limits is not None:
        checked_kind("tool_limits", tool_limits, ToolLimits)
    if robot is None and (floor is not None or tool_limits is not None):
        raise InputError("a floor and limits of the tool need the robot: give robot=...")


def _cell_check(robot: Robot, floor: float | None, tool_limits: ToolLimits | None) -> Excess:
    """What the cell asks of the arm: each of its parts above the floor, the tool within its limits."""

    def excess(candidate: Candidate) -> Array:
        trajectory, found = candidate.trajectory, [np.zeros(0)]
        if floor is not None:
            found.append(floor - height_series(robot, trajectory).extrema().min)
        if tool_limits is not None:
            checks = tool_rates(robot, trajectory).checks(tool_limits)
            found.append(np.array([check.utilisation for check in checks]) - 1)
        return np.concatenate(found)

    return excess


def _beyond_positions(candidate: Candidate, limit: Array) -> Array:
    reach = candidate.trajectory.extrema(0)
    return _known(np.concatenate([limit[:, 0] - reach.min, reach.max - limit[:, 1]]))


def _beyond_extrema(reach: Extrema, limit: Array) -> Array:
    return _beyond(reach.min, reach.max, limit)


def _beyond(least: Array, greatest: Array, limit: Array) -> Array:
    return _known(np.concatenate([greatest / limit, -least / limit]) - 1)


def _known(excess: Array) -> Array:
    """An unknown limit is never exceeded."""
    return np.where(np.isnan(excess), -1.0, excess)


# At one decimal, what is used by less than this reads as 100 %.
_VISIBLE = 1.0005


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Verdict:
    """A motion assessed in full, beside the limits that its search respected.

    Attributes
    ----------
    respected : tuple of str
        Quantities whose limits the search had to keep; "tool" and "floor" where the cell has such.
    checks : tuple of LimitCheck
        Every known limit, respected or not, and what the cell asks: limits of the tool, the floor.
    not_assessed : tuple of str
        Limits that are not known, with the joints concerned.
    joint_names : tuple of str
    """

    respected: tuple[str, ...]
    checks: tuple[LimitCheck, ...]
    not_assessed: tuple[str, ...]
    joint_names: tuple[str, ...]

    @property
    def violations(self) -> tuple[LimitCheck, ...]:
        """The limits that are violated, the worst first."""
        violated = (check for check in self.checks if check.is_violated)
        return tuple(sorted(violated, key=lambda check: -check.utilisation))

    @property
    def failures(self) -> tuple[LimitCheck, ...]:
        """The violated limits among those that the search had to keep; a result of a search has none."""
        return tuple(check for check in self.violations if _kind(check) in self.respected)

    @property
    def is_feasible(self) -> bool:
        """Whether no known limit is violated."""
        return not self.violations

    @property
    def not_held(self) -> tuple[str, ...]:
        """Each violated quantity once, with its joints: ``effort (joint2 at 109.7 %)``."""
        return tuple(
            f"{quantity} ({', '.join(_use(c) for c in self.violations if c.quantity == quantity)})"
            for quantity in dict.fromkeys(check.quantity for check in self.violations)
        )

    def used(self, quantity: str) -> Array:
        """Utilisation of the limits of a quantity, shape (n_joints,); NaN where there is none."""
        use = {check.joint: check.utilisation for check in self.checks if check.quantity == quantity}
        return np.array([use.get(name, np.nan) for name in self.joint_names])

    @property
    def statement(self) -> str:
        """Limits respected, not held, not known."""
        named = {"limits respected": self.respected or ("none",), "not held": self.not_held}
        named["not assessed"] = self.not_assessed
        return "; ".join(f"{label}: {', '.join(texts)}" for label, texts in named.items() if texts)

    @property
    def sentence(self) -> str:
        """The statement as a sentence."""
        return f"{self.statement[0].upper()}{self.statement[1:]}."

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready part of a document."""
        return {
            "is_feasible": self.is_feasible,
            "respected": list(self.respected),
            "not_held": list(self.not_held),
            "not_assessed": list(self.not_assessed),
        }


def told(sentence: str, table: tuple[tuple[str, ...], tuple[tuple[Cell, ...], ...]], notes: Iterable[str]) -> str:
    """What an optimisation found, within 100 columns: a sentence, a table, and notes."""
    parts = ["\n".join(wrap(sentence, 100)), text_table(*table), *("\n".join(wrap(note, 100)) for note in notes)]
    return "\n\n".join(parts)


def verdict_of(candidate: Candidate, respected: Iterable[str]) -> Verdict | None:
    """The verdict on a motion; None where no robot is known. Without any inertia, all but effort is assessed."""
    robot, trajectory, kept = candidate.robot, candidate.trajectory, set(respected)
    if robot is None:
        return None
    unknown = (line.partition(": ") for line in unknown_values(robot) if "limit" in line)
    missing = [f"{what} ({why})" for what, _, why in unknown]
    if robot.knows_torque.any():
        checks = candidate.assessment.all_checks
    else:  # which spares the torque
        demands = {name: trajectory.peak(order) for order, name in enumerate(MOTION[1:], start=1)}
        checks = (*limit_checks(robot, trajectory.extrema(0), demands), *_cell_checks(robot, candidate))
    if robot.missing_inertia:
        missing.append(f"effort (no inertia is known beyond {', '.join(robot.missing_inertia)})")
    cell = [name for name, rule in ((TOOL, candidate.tool_limits), ("floor", candidate.floor)) if rule is not None]
    return Verdict(
        respected=(*(name for name in QUANTITIES if name in kept), *cell),
        checks=checks,
        not_assessed=tuple(missing),
        joint_names=robot.joint_names,
    )


def _cell_checks(robot: Robot, candidate: Candidate) -> Iterator[LimitCheck]:
    trajectory = candidate.trajectory
    if candidate.tool_limits is not None:
        yield from tool_rates(robot, trajectory).checks(candidate.tool_limits)
    if candidate.floor is not None:
        yield lowest_point(robot, trajectory).check(candidate.floor)


def known_quantities(robot: Robot | None) -> tuple[str, ...]:
    """Quantities of which the robot has a limit for some joint; effort only where its torque can be computed."""
    if robot is None:
        return ()
    limits = checked_kind("robot", robot, Robot).limits
    known = [name for name in QUANTITIES if not np.isnan(getattr(limits, name)).all()]
    return tuple(name for name in known if QUANTITIES[name].signal == "position" or robot.knows_torque.any())


def _kind(check: LimitCheck) -> str:
    if check.quantity == HEIGHT:
        return "floor"
    return TOOL if check.joint == TOOL else check.quantity


def _use(check: LimitCheck) -> str:
    if check.quantity == HEIGHT:
        return f"{check.joint} {-check.margin:.4g} m below the floor"
    if check.quantity == "position":
        return f"{check.joint} {-check.margin:.4g} {check.unit} beyond its bound"
    if check.utilisation == float("inf"):
        return f"{check.joint} unbounded"
    share = 100 * check.utilisation
    used = f"{share:z.1f} %" if check.utilisation > _VISIBLE else f"100 % + {share - 100:.1g} %"
    return f"{check.joint} at {used}"
