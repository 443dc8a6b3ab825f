"""CycleAssessment: every motion of a cycle held against the limits with what it carries."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, final

import numpy as np

from puma_septic.assessment import Assessment, assess
from puma_septic.cycle._cycle import Cycle
from puma_septic.cycle._steps import Dwell
from puma_septic.document import SCHEMAS, frame, one_line, plain
from puma_septic.errors import InputError
from puma_septic.limit_check import LimitCheck
from puma_septic.motion import Motion
from puma_septic.paths import ToolLimits
from puma_septic.validation import checked_texts
from puma_septic.views import cycle as view

__all__ = ["CycleAssessment", "assess_cycle"]


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class CycleAssessment:
    """A cycle checked against the limits of its robot; made by `assess_cycle`.

    Attributes
    ----------
    cycle : Cycle
    names : tuple of str
        Of its steps.
    whole : Assessment
        The whole cycle as one motion: its peaks are those of all steps, rests included, its RMS values those of the
        cycle.
    motions : tuple of Assessment
        Of each motion alone, on its own clock, in the cycle's order.
    """

    cycle: Cycle
    names: tuple[str, ...]
    whole: Assessment
    motions: tuple[Assessment, ...]

    @property
    def motion_names(self) -> tuple[str, ...]:
        """Names of the motions, without the rests."""
        return tuple(self.names[k] for k in self._moving)

    @cached_property
    def _moving(self) -> tuple[int, ...]:
        return tuple(k for k, step in enumerate(self.cycle.steps) if isinstance(step, Motion))

    @property
    def violations(self) -> tuple[LimitCheck, ...]:
        """The violated limits of the whole cycle, the worst first; their times are the cycle's."""
        return self.whole.violations

    @property
    def worst(self) -> LimitCheck | None:
        """The governing limit of the whole cycle; None where no limit is known."""
        return self.whole.worst

    @property
    def is_feasible(self) -> bool:
        """Whether no known limit is violated in any step, and nothing is in doubt."""
        return self.whole.is_feasible

    @property
    def governing(self) -> int:
        """Index of the step in which the governing limit is reached; the first where none is known."""
        return 0 if self.worst is None else self.step_at(self.worst)

    def step_at(self, check: LimitCheck) -> int:
        """Index of the step that a check's demand belongs to.

        Returns
        -------
        int
            Of two that meet at its instant the one whose own demand is as large.
        """
        starts = self.cycle.starts
        after = int(np.clip(np.searchsorted(starts, check.time, side="right") - 1, 0, len(self.names) - 1))
        touching = [k for k in (after - 1, after) if k >= 0 and abs(starts[k + 1] - check.time) <= 1e-9 * starts[-1]]
        own = [k for k in (*touching, after) if self._demands(k, check)]
        return own[0] if own else after

    def _demands(self, k: int, check: LimitCheck) -> bool:
        """Whether step k alone demands as much of the check's limit."""
        if k not in self._moving:
            return False
        own = self.motions[self._moving.index(k)].all_checks
        same = (one for one in own if (one.joint, one.quantity) == (check.joint, check.quantity))
        return any(
            one.demand == check.demand or abs(one.demand - check.demand) <= 1e-9 * abs(check.demand) for one in same
        )

    @property
    def verdict(self) -> str:
        """One sentence: feasible or not, the governing limit, and the step in which it is reached."""
        if self.worst is None or self.whole.undecided:
            return self.whole.verdict
        return self.whole.verdict.replace(str(self.worst), f"{self.worst}, in {self.names[self.governing]!r}", 1)

    @property
    def order(self) -> tuple[int, ...]:
        """Indices of `motions`, the most used first; of two that agree to nine digits the earlier."""
        use = [0.0 if one.worst is None else float(f"{one.worst.utilisation:.9g}") for one in self.motions]
        return tuple(sorted(range(len(use)), key=lambda k: -use[k]))

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document: the whole cycle, its steps, and each motion, the governing one first.

        Returns
        -------
        dict
        """
        whole = self.whole.to_dict()
        return {
            "schema": SCHEMAS["cycle"],
            "robot": whole["robot"],
            "tool_frame": whole["tool_frame"],
            "duration": self.cycle.duration,
            "is_periodic": self.cycle.is_periodic,
            "verdict": self.verdict,
            "is_feasible": self.is_feasible,
            "undecided": whole["undecided"],
            "governing_step": self.names[self.governing],
            "governing": whole["governing"],
            "steps": [self._step_document(k) for k in range(len(self.names))],
            "whole": whole,
            "motions": [{"name": self.motion_names[k], "assessment": self.motions[k].to_dict()} for k in self.order],
        }

    def _step_document(self, k: int) -> dict[str, Any]:
        step = self.cycle.steps[k]
        payload = step.payload if isinstance(step, Dwell) else step.robot.payload
        found: dict[str, Any] = {
            "name": self.names[k],
            "kind": "dwell" if isinstance(step, Dwell) else step.trajectory.profile,
            "start": float(self.cycle.starts[k]),
            "duration": float(self.cycle.starts[k + 1] - self.cycle.starts[k]),
            "payload_mass": 0.0 if payload is None else payload.mass,
            "tool_speed": 0.0,
            "is_feasible": None,
            "governing": None,
        }
        if isinstance(step, Dwell):
            return found
        one = self.motions[self._moving.index(k)]
        found |= {"is_feasible": one.is_feasible, "tool_speed": plain(one.tool.peak_speed)}
        return found | {"governing": None if one.worst is None else one.worst.to_dict()}

    def __str__(self) -> str:
        return view.text(self.to_dict())

    def __repr__(self) -> str:
        facts = {"motions": len(self.motions), "duration": f"{self.cycle.duration:g} s", "verdict": self.verdict}
        return one_line("CycleAssessment", facts)

    def _repr_html_(self) -> str:
        return view.html(self.to_dict())

    def to_dataframe(self) -> Any:
        """The steps of the cycle as a pandas DataFrame, one row a step.

        Returns
        -------
        pandas.DataFrame
            In SI units.

        Raises
        ------
        ImportError
            Where pandas is not installed: ``python -m pip install 'puma-septic[pandas]'``.
        """
        return frame(self.to_dict()["steps"], index="name").drop(columns="governing")


def assess_cycle(
    cycle: Cycle,
    *,
    names: Sequence[str] | None = None,
    tool_limits: ToolLimits | None = None,
    floor: float | None = None,
) -> CycleAssessment:
    """Hold every motion of a cycle against the limits of its robot, each with what it carries.

    Parameters
    ----------
    cycle : Cycle
    names : sequence of str, optional
        Of its steps, for tables; "1 quintic", "2 dwell" ... by default.
    tool_limits : ToolLimits, optional
        What the tool may do at most.
    floor : float, optional
        Height above the base that no joint that carries the tool, and not the tool, may go below, m.

    Returns
    -------
    CycleAssessment

    Raises
    ------
    InputError
        For anything but a cycle, or names that are not one for each step.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> there = ps.compute_motion(robot, ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0]))
    >>> result = ps.assess_cycle(ps.cycle.with_return(there, dwell=0.5), names=["there", "wait", "back", "wait"])
    >>> result.is_feasible, result.names[result.governing], result.motions[0].is_feasible
    (True, 'there', True)
    """
    if not isinstance(cycle, Cycle):
        raise InputError(f"assess_cycle takes a Cycle, got {cycle!r}")
    steps = cycle.steps
    own = [f"{k + 1} {'dwell' if isinstance(one, Dwell) else one.trajectory.profile}" for k, one in enumerate(steps)]
    given = tuple(own) if names is None else checked_texts("names", names)
    if len(given) != len(steps):
        raise InputError(f"names: {len(given)} names for {len(steps)} steps; one for each is needed")
    motions = (assess(step, tool_limits=tool_limits, floor=floor) for step in steps if isinstance(step, Motion))
    return CycleAssessment(
        cycle=cycle,
        names=given,
        whole=assess(cycle.motion, tool_limits=tool_limits, floor=floor),
        motions=tuple(motions),
    )
