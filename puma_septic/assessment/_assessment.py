"""Assessment: a motion, what it demands, and what its limits say to that."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, final

import numpy as np

from puma_septic.assessment._joints import PowerMetrics, derivative_peak, joint_metrics, power_metrics
from puma_septic.assessment._limits import limit_checks, unit_doubts, unknown_values
from puma_septic.assessment._remarks import below_base_remarks, friction_step_remarks, rest_remarks
from puma_septic.assessment._tool import LowestPoint, ToolMetrics, lowest_point, tool_metrics
from puma_septic.doctor import doubts
from puma_septic.document import SCHEMAS, frame, one_line, plain
from puma_septic.errors import InputError
from puma_septic.limit_check import LimitCheck, most_used_first
from puma_septic.motion import Motion, compute_motion
from puma_septic.paths import ToolLimits, tool_rates
from puma_septic.piecewise import Extrema
from puma_septic.quantities import MAGNITUDES, QUANTITIES
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, FrozenMap, checked_choice, checked_number, frozen, read_only
from puma_septic.views import assessment as view
from puma_septic.views.checks import verdict

__all__ = ["Assessment", "assess"]

# What a document has of each joint, of the tool and of each kind of singular posture, as its attributes are called.
_PER_JOINT = (
    "peak_velocity", "peak_velocity_time", "peak_acceleration", "peak_acceleration_time", "peak_jerk", "peak_jerk_time",
    "peak_torque", "peak_torque_time", "peak_torque_sign", "rms_velocity", "rms_acceleration", "rms_jerk", "rms_torque",
    "holding_torque", "least_holding_torque", "peak_power", "peak_regenerated_power", "energy_in", "energy_out",
    "overshoot",
)  # fmt: skip
_TOOL = (
    "peak_speed", "peak_speed_time", "peak_acceleration", "peak_acceleration_time", "height_range", "height_times",
)  # fmt: skip
_SINGULARITY = ("kind", "least_distance", "time", "crossings")


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Assessment:
    """A motion checked against the limits of its robot; made by `assess`.

    Each array has the shape (n_joints,), in the order of ``motion.robot.joint_names``. Power, tool and checks are
    computed when first asked for and kept; the value itself never changes (the cache needs a ``__dict__``, hence no
    slots).

    Attributes
    ----------
    motion : Motion
    dwell : float
        Rest at the last point, without brake, before the cycle repeats, s.
    tool_limits : ToolLimits or None
        What the tool may do at most, held against the motion beside the limits of the joints.
    peak_velocity, peak_acceleration, peak_jerk : ndarray
        Largest magnitudes in rad/s ... (m/s ... for prismatic joints); infinite where a lower derivative steps.
    peak_velocity_time, peak_acceleration_time, peak_jerk_time : ndarray
        Their instants, s.
    peak_torque, peak_torque_time, peak_torque_sign : ndarray
        Largest magnitude of the actuator torque at the joint in N m (N), its instant and its sign; a dwell counts with
        its holding torque. NaN, as all that follows from torque, where the inertia that the joint moves is not known.
    rms_velocity, rms_acceleration, rms_jerk : ndarray
        Root mean squares over motion and dwell.
    rms_torque : ndarray
        Root mean square over motion and dwell; the dwell takes the holding torque, without static friction.
    floor : float or None
        Height that joints and tool must not go below, m; None where there is none.
    """

    motion: Motion
    dwell: float
    tool_limits: ToolLimits | None = None
    peak_velocity: Array
    peak_velocity_time: Array
    peak_acceleration: Array
    peak_acceleration_time: Array
    peak_jerk: Array
    peak_jerk_time: Array
    peak_torque: Array
    peak_torque_time: Array
    peak_torque_sign: Array
    rms_velocity: Array
    rms_acceleration: Array
    rms_jerk: Array
    rms_torque: Array
    floor: float | None = None

    @cached_property
    def position(self) -> Extrema:
        """Least and greatest position of each joint and their instants."""
        return self.motion.trajectory.extrema(0)

    @property
    def overshoot(self) -> Array:
        """Largest excess beyond the hull of the via points, rad (m)."""
        return self.motion.trajectory.overshoot

    @cached_property
    def tool(self) -> ToolMetrics:
        """Speed, acceleration and height of the tool, and singular postures."""
        return tool_metrics(self.motion)

    @cached_property
    def lowest(self) -> LowestPoint:
        """Where joints and tool are lowest along the motion, between its points too: exact, from series of height."""
        return lowest_point(self.motion.robot, self.motion.trajectory)

    @cached_property
    def floor_check(self) -> LimitCheck | None:
        """The lowest point checked against the floor; None without a floor."""
        return None if self.floor is None else self.lowest.check(self.floor)

    @property
    def all_checks(self) -> tuple[LimitCheck, ...]:
        """`checks`, those of the tool, whose `joint` is "tool", and that of the floor, where there are some."""
        floor = () if self.floor_check is None else (self.floor_check,)
        return (*self.checks, *self.tool_checks, *floor)

    @cached_property
    def _power(self) -> PowerMetrics:
        return power_metrics(self.motion)

    @cached_property
    def holding_torque(self) -> Array:
        """Torque that holds the arm at rest at the last point without static friction, N m (N)."""
        rest = self.motion.rest(self.dwell)
        return read_only(np.where(self.motion.robot.knows_torque, rest.holding_torque, np.nan))

    @cached_property
    def least_holding_torque(self) -> Array:
        """The same with all the help that static friction can give: 0 within its band.

        Friction can carry any torque of its band, so the actuator needs at least the distance of the holding torque
        from it. The band is the law's static level, where that is not known Coulomb friction; see `Friction.band`.
        """
        positive, negative = np.transpose([law.band for law in self.motion.robot.friction])
        return read_only(self.holding_torque - np.clip(self.holding_torque, -positive, -negative))

    @property
    def peak_power(self) -> Array:
        """Largest mechanical power that the actuator delivers, W."""
        return self._power.peak_power

    @property
    def peak_regenerated_power(self) -> Array:
        """Largest mechanical power that flows back into the actuator, W, as a magnitude."""
        return self._power.peak_regenerated_power

    @property
    def energy_in(self) -> Array:
        """Work that the actuator does, the integral of its positive power, J."""
        return self._power.energy_in

    @property
    def energy_out(self) -> Array:
        """Work that is done on the actuator, the integral of its negative power as a magnitude, J."""
        return self._power.energy_out

    @cached_property
    def checks(self) -> tuple[LimitCheck, ...]:
        """Every known limit checked against its demand, joint by joint, and every demand that no arm can meet."""
        demands = {name: self.peak(name) for name in self.motion.robot.limits.quantities if name in MAGNITUDES}
        return limit_checks(self.motion.robot, self.position, demands)

    @cached_property
    def tool_checks(self) -> tuple[LimitCheck, ...]:
        """The limits of the tool checked; none where there are none."""
        if self.tool_limits is None:
            return ()
        return tool_rates(self.motion.robot, self.motion.trajectory).checks(self.tool_limits)

    def peak(self, quantity: str) -> tuple[Array, Array]:
        """Largest magnitude of a quantity and its instant in s, each of shape (n_joints,): "velocity", "effort" ...

        Also of what has no attribute of its own, a derivative of the torque. Infinite where it is unbounded.

        Returns
        -------
        tuple of ndarray

        Raises
        ------
        InputError
            For an unknown quantity; a position has bounds on both sides, see `position`.
        """
        row = QUANTITIES[checked_choice("quantity", quantity, MAGNITUDES)]
        if row.is_torque_derivative:
            return self._torque_derivatives[quantity]
        return getattr(self, f"peak_{row.attribute}"), getattr(self, f"peak_{row.attribute}_time")

    @cached_property
    def _torque_derivatives(self) -> dict[str, tuple[Array, Array]]:
        return {row.name: derivative_peak(self.motion, row) for row in QUANTITIES.values() if row.is_torque_derivative}

    def keeps(self, margin: float = 0.0) -> tuple[LimitCheck, ...]:
        """What does not keep its limit with so much to spare: empty where all is kept.

        Velocity, acceleration, jerk and effort must stay below ``(1 - margin) * limit``; a position must stay within
        its bounds, and the arm above its floor, whatever the margin.

        Parameters
        ----------
        margin : float
            Share of each limit that must be left, from 0 to 1.

        Returns
        -------
        tuple of LimitCheck
            Joint by joint, the floor last.

        Raises
        ------
        InputError
            For a margin outside [0, 1].
        """
        least = checked_number("margin", margin, at_least=0.0, at_most=1.0)
        return tuple(check for check in self.all_checks if not check.keeps(least))

    @property
    def violations(self) -> tuple[LimitCheck, ...]:
        """The violated limits, the worst first; infinite acceleration or torque violates an unknown one too."""
        return most_used_first(check for check in self.all_checks if check.is_violated)

    @property
    def worst(self) -> LimitCheck | None:
        """The governing limit: the one of highest utilisation, violated or not; None where no limit is known at all."""
        return next(iter(most_used_first(self.all_checks)), None)

    @property
    def verdict(self) -> str:
        """One sentence: feasible or not, and the governing limit; or why that cannot be decided."""
        if self.undecided:
            return "undecided: " + "; ".join(self.undecided)
        sentence = verdict(("feasible", "infeasible"), self.violations, self.worst)
        return f"{sentence}; on doubtful data, see the remarks" if self.doubts else sentence

    @property
    def is_feasible(self) -> bool:
        """Whether no known limit is violated and no unbounded torque is needed (as a step in velocity would).

        Never where the motion itself is in doubt; see `undecided`.
        """
        return not self.violations and not self.undecided

    @property
    def undecided(self) -> tuple[str, ...]:
        """What must be settled before a verdict: the noise or the units of a log, points that look like degrees."""
        return self.motion.trajectory.doubts or unit_doubts(self.motion.robot, self.motion.trajectory)

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is doubtful in the robot's data, which the verdict rests on; see `puma_septic.doctor`."""
        return doubts(self.motion.robot)

    @property
    def not_assessed(self) -> tuple[str, ...]:
        """What is not known of the robot, with the joints concerned; it never makes a motion infeasible."""
        return unknown_values(self.motion.robot)

    @property
    def margins(self) -> Mapping[str, Array]:
        """``1 - demand / limit`` by quantity; for positions the distance in rad to the nearest bound.

        Shape (n_joints,) each; NaN where the limit is not known, ``-inf`` where the demand is infinite.
        """
        names = self.motion.robot.joint_names
        result = {quantity: np.full(len(names), np.nan) for quantity in self.motion.robot.limits.quantities}
        for check in self.checks:
            result[check.quantity][names.index(check.joint)] = check.margin
        return FrozenMap({quantity: frozen(margins) for quantity, margins in result.items()})

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a reader must know to read the numbers right."""
        motion, held = self.motion, (self.holding_torque, self.least_holding_torque) if self.dwell else None
        return (
            *(f"undecided: {doubt}" for doubt in self.undecided),
            *motion.trajectory.remarks,
            *self.doubts,
            *(below_base_remarks(self.lowest) if self.floor is None else ()),
            *motion.robot.notes,
            *rest_remarks(motion, self.peak_torque, held),
            *friction_step_remarks(motion),
        )

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document; numbers in SI units, "unbounded" for infinity, null for what is not known."""
        robot, trajectory = self.motion.robot, self.motion.trajectory
        return {
            "schema": SCHEMAS["assessment"],
            "robot": robot.name,
            "tool_frame": robot.tool,
            "profile": trajectory.profile,
            "duration": trajectory.duration,
            "dwell": self.dwell,
            "verdict": self.verdict,
            "is_feasible": self.is_feasible,
            "undecided": list(self.undecided),
            "doubts": list(self.doubts),
            "joints": [self._joint_document(j) for j in range(robot.n_joints)],
            "tool": {
                **{key: plain(getattr(self.tool, key)) for key in _TOOL},
                **({"checks": [check.to_dict() for check in self.tool_checks]} if self.tool_checks else {}),
            },
            "lowest": self.lowest.to_dict() | {"floor": self.floor},
            "singularities": [
                {key: plain(getattr(report, key)) for key in _SINGULARITY} for report in self.tool.singularities
            ],
            "violations": [check.to_dict() for check in self.violations],
            "governing": None if self.worst is None else self.worst.to_dict(),
            "not_assessed": list(self.not_assessed),
            "remarks": list(self.remarks),
            "n_evaluations": self.motion.n_evaluations,
        }

    def _joint_document(self, j: int) -> dict[str, Any]:
        robot = self.motion.robot
        return {
            "name": robot.joint_names[j],
            "is_prismatic": bool(robot.is_prismatic[j]),
            "position_min": plain(self.position.min[j]),
            "position_max": plain(self.position.max[j]),
            **{key: plain(getattr(self, key)[j]) for key in _PER_JOINT},
            **{key: plain(values[j]) for key, values in self._further_peaks().items()},
            "margins": {quantity: plain(values[j]) for quantity, values in self.margins.items()},
            "checks": [check.to_dict() for check in self.checks if check.joint == robot.joint_names[j]],
        }

    def _further_peaks(self) -> dict[str, Array]:
        """Peaks of the optional quantities that there are limits of, as their attributes would be called."""
        rows = (QUANTITIES[name] for name in self.motion.robot.limits.quantities)
        peaks = {f"peak_{row.attribute}": self.peak(row.name) for row in rows if row.is_torque_derivative}
        return {key: size for key, (size, _) in peaks.items()} | {f"{key}_time": t for key, (_, t) in peaks.items()}

    def __str__(self) -> str:
        return view.text(self.to_dict())

    def _repr_html_(self) -> str:
        return view.html(self.to_dict())

    def __repr__(self) -> str:
        return one_line("Assessment", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "robot": self.motion.robot.name,
            "profile": self.motion.trajectory.profile,
            "duration": f"{self.motion.trajectory.duration:g} s",
            "verdict": self.verdict,
        }

    def to_dataframe(self) -> Any:
        """The metrics of each joint as a pandas DataFrame, one row a joint.

        Returns
        -------
        pandas.DataFrame
            In SI units; NaN where a number is not known.

        Raises
        ------
        ImportError
            Where pandas is not installed: ``python -m pip install 'puma-septic[pandas]'``.
        """
        return frame(self.to_dict()["joints"], index="name").drop(columns="checks", errors="ignore")


def assess(
    what: Motion | Robot,
    trajectory: Trajectory | None = None,
    *,
    dwell: float = 0.0,
    floor: float | None = None,
    tool_limits: ToolLimits | None = None,
) -> Assessment:
    """Hold a motion against the limits of its robot.

    Parameters
    ----------
    what : Motion or Robot
        A motion from `compute_motion`, or a robot together with a trajectory.
    trajectory : Trajectory, optional
        Only with a robot.
    dwell : float
        Rest at the last point before the cycle repeats, s; it counts in the root mean squares.
    floor : float, optional
        Height above the base that no joint that carries the tool, and not the tool, may go below, m.
    tool_limits : ToolLimits, optional
        What the tool may do at most, such as 0.25 m/s of a hand-guided cell; see `puma_septic.paths.ToolLimits`.

    Returns
    -------
    Assessment
        A violated limit is part of the answer, not an error.

    Raises
    ------
    InputError
        For a negative dwell, a dwell after a motion that ends moving, or a trajectory that is missing or not the
        robot's.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> result = ps.assess(ps.load_robot(), move)
    >>> result.is_feasible, result.worst.joint, result.worst.quantity, round(result.worst.utilisation, 2)
    (True, 'joint3', 'position', 0.88)
    """
    if isinstance(what, Motion) and trajectory is None:
        motion = what
    elif isinstance(what, Robot) and trajectory is not None:
        motion = compute_motion(what, trajectory)
    else:
        raise InputError("assess takes either a motion, or a robot and a trajectory")
    dwell = checked_number("dwell", dwell, unit="s", at_least=0.0)
    if dwell and not motion.trajectory.rest_after:
        _check_stops(motion.trajectory, dwell)
    if floor is not None:
        floor = checked_number("floor", floor, unit="m")
    if not (tool_limits is None or isinstance(tool_limits, ToolLimits)):
        raise InputError(f"tool_limits: expected paths.ToolLimits, got {tool_limits!r}")
    metrics = joint_metrics(motion, dwell)
    return Assessment(motion=motion, dwell=dwell, floor=floor, tool_limits=tool_limits, **metrics)


def _check_stops(trajectory: Trajectory, dwell: float) -> None:
    """Raise an InputError where a motion of which nothing is assumed beyond its end is moving there; as in a cycle."""
    steps = replace(trajectory, rest_after=True).jumps(1)
    at_end = steps.sizes[steps.times == trajectory.breaks[-1]]
    if at_end.any():
        j = int(np.argmax(np.abs(at_end[-1])))
        raise InputError(
            f"dwell = {dwell:g} s: the motion ends moving (rest_after=False), so no rest can follow it;"
            f" {trajectory.joint_label(j)} has {-at_end[-1, j]:.6g} rad/s there"
        )
