"""Comparison: one row per profile, and which are Pareto-optimal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import nan
from typing import Any, Protocol, final

import numpy as np

from puma_septic.assessment import Assessment
from puma_septic.comparison._advice import Candidate, advice_of, ranked, recommended
from puma_septic.document import SCHEMAS, card, frame, one_line, plain
from puma_septic.limits import MinimumDuration
from puma_septic.objectives import Objective, non_dominated
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, FrozenMap, checked_choice, frozen
from puma_septic.views import comparison as view
from puma_septic.views.layout import laid_out

__all__ = ["ComparedProfile", "Comparison", "Gap", "Reference"]

# A velocity below this part of the joint's peak is rest.
_REST = 1e-9
_PER_JOINT = (
    "peak_velocity", "rms_velocity", "peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk",
    "integral_of_squared_jerk", "end_jerk", "overshoot", "via_miss", "peak_torque", "rms_torque", "energy_in",
    "energy_out",
)  # fmt: skip
# Of all joints together these are the sum; the others are the largest.
_SUMMED = ("integral_of_squared_jerk", "energy_in", "energy_out")


class Reference(Protocol):
    """A motion as quick as its limits let it be, and the quickest one along its path; `puma_septic.time_optimal`'s."""

    @property
    def given(self) -> MinimumDuration:
        """The motion itself, stretched."""

    @property
    def certified(self) -> MinimumDuration:
        """The reference, held against all limits."""


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Gap:
    """Least durations of a profile and of the quickest motion along its path, s; NaN where there is none.

    Attributes
    ----------
    least_duration, reference_duration : float
    reason : str
        Why there is none.
    """

    least_duration: float = nan
    reference_duration: float = nan
    reason: str = ""

    @property
    def ratio(self) -> float:
        """What the profile's time law costs: 1 is the optimum."""
        return self.least_duration / self.reference_duration

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document."""
        return {
            "least_duration": plain(self.least_duration),
            "reference_duration": plain(self.reference_duration),
            "ratio": plain(self.ratio),
            "reason": self.reason,
        }


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class ComparedProfile:
    """One profile on the task; arrays have the shape (n_joints,). Computed when asked for and kept (no slots).

    Attributes
    ----------
    name : str
    assessment : Assessment
        Peaks, root mean squares, torque, energy, violations, tool and singularities.
    objectives : mapping
        Values of the objectives that profiles are marked by.
    gap : Gap or None
        Beside the quickest motion along the same path, where that was asked for.
    """

    name: str
    assessment: Assessment
    objectives: Mapping[str, float]
    gap: Gap | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "objectives", FrozenMap(self.objectives))

    @property
    def trajectory(self) -> Trajectory:
        """The motion itself."""
        return self.assessment.motion.trajectory

    @property
    def duration(self) -> float:
        """Length of the motion, s."""
        return self.trajectory.duration

    @cached_property
    def integral_of_squared_jerk(self) -> Array:
        """rad^2/s^5; infinite where the jerk is unbounded."""
        jerk = self.trajectory.derivative(3)
        return frozen(np.where(np.isinf(self.assessment.peak_jerk), np.inf, jerk.inner(jerk)))

    @cached_property
    def end_jerk(self) -> Array:
        """The larger of the jerks at both ends, rad/s^3; infinite where the acceleration steps there."""
        trajectory = self.trajectory
        ends = trajectory.breaks[[0, -1]]
        at_ends = {}
        for order in (1, 2, 3):
            jumps = trajectory.jumps(order)
            sizes = jumps.sizes[np.isin(jumps.times, ends)]
            at_ends[order] = np.abs(sizes).max(axis=0, initial=0.0)
        return frozen(np.where((at_ends[1] > 0) | (at_ends[2] > 0), np.inf, at_ends[3]))

    @cached_property
    def continuity(self) -> str:
        """Measured class of the whole motion, rest before and after included; C3 says at least 3."""
        return f"C{next((k for k in (0, 1, 2) if len(self.trajectory.jumps(k + 1).times)), 3)}"

    @cached_property
    def stops_at_vias(self) -> bool:
        """Whether all joints are at rest at every via."""
        vias = self.trajectory.times[1:-1]
        speed = np.abs(self.trajectory(vias, order=1))
        left = np.abs(self.trajectory(np.nextafter(vias, -np.inf), order=1))
        return len(vias) > 0 and bool((np.maximum(speed, left) <= _REST * self.assessment.peak_velocity.max()).all())

    @property
    def meets_points(self) -> bool:
        """Whether it goes through all points."""
        return not self.trajectory.via_miss.any()

    @property
    def singularities_crossed(self) -> Mapping[str, int]:
        """How often each kind of singular posture is crossed, those that are."""
        reports = self.assessment.tool.singularities
        return FrozenMap({report.kind: len(report.crossings) for report in reports if len(report.crossings)})

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader must know before choosing this profile."""
        miss, over = self.trajectory.via_miss, self.trajectory.overshoot
        names = self.assessment.motion.robot.joint_names
        notes = []
        if miss.any():
            notes.append(f"misses its vias by {miss.max():.2g} rad ({names[int(miss.argmax())]})")
        if self.stops_at_vias:
            notes.append("stops at its vias")
        if over.any():
            notes.append(f"overshoots by {over.max():.2g} rad ({names[int(over.argmax())]})")
        if np.isinf(self.assessment.peak_acceleration).any():
            notes.append("the velocity steps: no arm can follow")
        elif np.isinf(self.assessment.peak_jerk).any():
            notes.append("the acceleration steps: unbounded jerk")
        return tuple(notes)

    @property
    def per_joint(self) -> Mapping[str, Array]:
        """Every metric by joint, shape (n_joints,) each."""
        sources = (self, self.trajectory, self.assessment)
        return FrozenMap(
            {name: getattr(next(one for one in sources if hasattr(one, name)), name) for name in _PER_JOINT}
        )

    @property
    def overall(self) -> Mapping[str, float]:
        """Each metric of the worst joint, integrals and energies summed."""
        worst = self.per_joint.items()
        return FrozenMap({name: float(values.sum() if name in _SUMMED else values.max()) for name, values in worst})

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document, one of `Comparison.to_dict`'s profiles."""
        return {
            "name": self.name,
            "continuity": self.continuity,
            "duration": self.duration,
            "stops_at_vias": self.stops_at_vias,
            "objectives": plain(self.objectives),
            "overall": plain(self.overall),
            "joints": plain(self.per_joint),
            "is_feasible": self.assessment.is_feasible,
            "undecided": list(self.assessment.undecided),
            "checks": [check.to_dict() for check in self.assessment.all_checks],
            "violations": [str(check) for check in self.assessment.violations],
            "singularities_crossed": dict(self.singularities_crossed),
            "notes": list(self.notes),
            **({} if self.gap is None else {"gap": self.gap.to_dict()}),
        }

    def __repr__(self) -> str:
        return one_line("ComparedProfile", self._facts())

    def _repr_html_(self) -> str:
        return card("ComparedProfile", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "profile": self.name,
            "duration": f"{self.duration:g} s",
            "verdict": self.assessment.verdict,
            "notes": ", ".join(self.notes) or "none",
        }


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Comparison:
    """Profiles side by side; made by `compare`.

    Attributes
    ----------
    points : ndarray, shape (k, n_joints)
    times : ndarray, shape (k,)
    profiles : tuple of ComparedProfile
        From the least to the most continuous, or as asked for.
    unsuitable : mapping
        Profile name to the reason.
    objectives : tuple of Objective
    own : tuple of str
        Profiles that are always shown and drawn, such as those of the task.
    """

    points: Array
    times: Array
    profiles: tuple[ComparedProfile, ...]
    unsuitable: Mapping[str, str]
    objectives: tuple[Objective, ...]
    own: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "unsuitable", FrozenMap(self.unsuitable))

    def __getitem__(self, name: str) -> ComparedProfile:
        """The row of a profile."""
        rows = {row.name: row for row in self.profiles}
        return rows[checked_choice("compared profile", name, rows)]

    @cached_property
    def pareto_optimal(self) -> tuple[str, ...]:
        """Pareto-optimal profiles in the objectives, among those through all points; of none where none is."""
        rows = [row for row in self.profiles if row.meets_points]
        values = np.array([list(row.objectives.values()) for row in rows]).reshape(len(rows), len(self.objectives))
        return tuple(row.name for row, best in zip(rows, non_dominated(values), strict=True) if best)

    @cached_property
    def _candidates(self) -> tuple[Candidate, ...]:
        first = self.objectives[0].name
        return tuple(
            Candidate(
                name=row.name,
                meets_points=row.meets_points,
                is_feasible=row.assessment.is_feasible and not row.assessment.undecided,
                stops=row.stops_at_vias if len(row.trajectory.times) > 2 else None,
                value=row.objectives[first],
                worst=row.assessment.worst,
            )
            for row in self.profiles
        )

    @property
    def ranking(self) -> tuple[str, ...]:
        """All profiles: those that meet the points and keep the limits first, then by the first objective."""
        return ranked(self._candidates)

    @property
    def recommended(self) -> tuple[str, ...]:
        """The profiles that `advice` names: the best that passes the vias, and the best that stops at them."""
        return tuple(one.name for one in recommended(self._candidates).values())

    @property
    def advice(self) -> str:
        """One sentence: which profile to take, by which measure; where none keeps the limits, which comes nearest."""
        return advice_of(self._candidates, self.objectives[0].name)

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document; numbers in SI units, "unbounded" for infinity, null for what is not known."""
        robot = self.profiles[0].assessment.motion.robot
        return {
            "schema": SCHEMAS["comparison"],
            "robot": robot.name,
            "joint_names": list(robot.joint_names),
            "position_unit": " or ".join(
                sorted({"m" if slides else "rad" for slides in robot.is_prismatic}, reverse=True)
            ),
            "points": plain(self.points),
            "times": plain(self.times),
            "objectives": [{"name": one.name, "unit": one.unit, "meaning": one.meaning} for one in self.objectives],
            "advice": self.advice,
            "recommended": list(self.recommended),
            "ranking": list(self.ranking),
            "own": list(self.own),
            "pareto_optimal": list(self.pareto_optimal),
            "profiles": [row.to_dict() for row in self.profiles],
            "unsuitable": dict(self.unsuitable),
            "not_assessed": list(self.profiles[0].assessment.not_assessed),
            "doubts": list(self.profiles[0].assessment.doubts),
        }

    def to_csv(self) -> str:
        """One line per profile and joint, after a line for all joints together."""
        return view.csv(self.to_dict())

    def __str__(self) -> str:
        return laid_out(view.text(self.to_dict()))

    def _repr_html_(self) -> str:
        return view.html(self.to_dict())

    def __repr__(self) -> str:
        return one_line("Comparison", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "robot": self.profiles[0].assessment.motion.robot.name,
            "profiles": len(self.profiles),
            "advice": self.advice,
        }

    def to_dataframe(self) -> Any:
        """The metrics of each profile as a pandas DataFrame, one row a profile, the best first.

        Returns
        -------
        pandas.DataFrame
            In SI units; NaN where a number is not known.

        Raises
        ------
        ImportError
            Where pandas is not installed: ``python -m pip install 'puma-septic[pandas]'``.
        """
        return frame(_overall(self), index="profile")


def _overall(comparison: Comparison) -> list[dict[str, Any]]:
    """What `Comparison.to_dataframe` has of each profile."""
    return [
        {
            "profile": row.name,
            "is_feasible": row.assessment.is_feasible,
            "meets_points": row.meets_points,
            "stops_at_vias": row.stops_at_vias,
            "duration": row.duration,
            **row.overall,
        }
        for row in map(comparison.__getitem__, comparison.ranking)
    ]
