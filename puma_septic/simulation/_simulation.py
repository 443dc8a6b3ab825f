"""Simulation: how an arm under a controller went along a trajectory, as samples, and what it is judged by."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.document import SCHEMAS, one_line, plain
from puma_septic.kinematics import forward_kinematics
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.simulation._controller import Controller, Reference, planned_torque, reference_at
from puma_septic.simulation._elasticity import ElasticJoints
from puma_septic.simulation._integration import Divergence, Record
from puma_septic.simulation._plant import LOSS, POSITION, VELOCITY, WORK, Plant
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, freeze_fields, frozen, read_only
from puma_septic.views import execution as view

__all__ = ["METRICS", "SETTLED", "EnergyBalance", "Metrics", "Simulation"]

SETTLED: Final = 1e-4
"""Tool error of a settled arm, m: the PUMA 560's repeatability (Unimation, Descriptive Bulletin 22-523)."""

METRICS: Final = {
    "peak_error": "largest deviation of a joint from its plan, rad (m)",
    "rms_error": "its root mean square during the motion, rad (m)",
    "end_error": "its magnitude at the end of the motion, rad (m)",
    "saturation_time": "how long a joint's torque was at its limit, s",
    "chattering": "travel of a joint's torque per second beyond that of the planned torque, N m/s (N/s)",
    "residual_vibration": "half the range of a joint after the end (of its deflection, if elastic), rad (m)",
    "energy_in": "positive work of a joint's actuator, J",
    "tool_peak_error": "largest distance of the tool from its plan, m",
    "tool_rms_error": "its root mean square during the motion, m",
    "tool_end_error": "at the end of the motion, m",
    "tool_residual_vibration": "half the largest extent of the tool's path after the end, m",
    "settling_time": f"from the end of the motion until the tool stays within {1e3 * SETTLED:g} mm, s",
}
"""The metrics by name and what they mean, those of the joints first."""


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Metrics:
    """See `METRICS`; of each joint an array of shape (n_joints,), of the tool a number.

    `settling_time` is infinite where the tool has not settled when the simulation ends.
    """

    peak_error: Array
    rms_error: Array
    end_error: Array
    saturation_time: Array
    chattering: Array
    residual_vibration: Array
    energy_in: Array
    tool_peak_error: float
    tool_rms_error: float
    tool_end_error: float
    tool_residual_vibration: float
    settling_time: float

    def __post_init__(self) -> None:
        freeze_fields(self)

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready mapping.

        Returns
        -------
        dict
        """
        return {name: plain(getattr(self, name)) for name in METRICS}


def _peak_rms_end(t: Array, error: Array, duration: float) -> tuple[Array, Array, Array]:
    """Of error magnitudes (n, m) at samples (n,): over all, over the motion, and at its end."""
    moving = t <= duration * (1 + 1e-12)
    square = error[moving] ** 2
    mean = np.trapezoid(square, t[moving], axis=0) / max(t[moving][-1], 1e-300) if moving.sum() > 1 else square[0]
    return np.abs(error).max(axis=0), np.sqrt(mean), np.abs(error[moving][-1])


def _settling_time(t: Array, error: Array, duration: float) -> float:
    """From the end of the motion until an error (n,) stays within `SETTLED`, between samples by a straight line."""
    after: NDArray[np.int64] = np.flatnonzero(t >= duration * (1 - 1e-12))
    beyond = after[error[after] > SETTLED]
    if not len(beyond):
        return 0.0
    k = int(beyond[-1])
    if k + 1 >= len(t):
        return float("inf")
    share = (error[k] - SETTLED) / (error[k] - error[k + 1])
    return float(t[k] + share * (t[k + 1] - t[k]) - duration)


def _travel(values: Array) -> Array:
    """How far samples (n, m) go up and down in all."""
    return np.asarray(np.abs(np.diff(values, axis=0)).sum(axis=0))


# The balance of energy is drawn up at this many samples at most.
_MOST_BALANCED = 1000
# Between the knots of the executed trajectory, s; and travel that is creep of smoothed friction, not motion, rad (m).
_KNOTS = 0.02
_STANDSTILL = 1e-4


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class EnergyBalance:
    """Energy along a simulation, J, shapes (k,).

    Attributes
    ----------
    t : ndarray
        s since the start.
    kinetic, potential, elastic : ndarray
        Potential from its value at the start.
    work : ndarray
        Of the actuators since the start.
    taken : ndarray
        By friction, dampers and the wrench since the start.
    """

    t: Array
    kinetic: Array
    potential: Array
    elastic: Array
    work: Array
    taken: Array

    def __post_init__(self) -> None:
        freeze_fields(self)

    @property
    def drift(self) -> Array:
        """What appears from nowhere: stored energy less work and more what is taken, from its value at the start."""
        stored = self.kinetic + self.potential + self.elastic
        return frozen(np.asarray(stored - stored[0] - self.work + self.taken))


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Simulation:
    """An arm that follows a trajectory; samples, not functions of time. Computed when asked for and kept (no slots).

    Attributes
    ----------
    robot : Robot
    trajectory : Trajectory
    controller : Controller
    elastic : ElasticJoints or None
    rate, step : float
        Control rate, Hz (infinite: at each stage), and step of the integrator, s.
    rest_speed : float
        Over which dry friction rises at rest, rad/s (m/s).
    saved : Record
        The samples.
    """

    robot: Robot
    trajectory: Trajectory
    controller: Controller
    elastic: ElasticJoints | None
    rate: float
    step: float
    rest_speed: float
    saved: Record

    def __post_init__(self) -> None:
        for array in self.saved[:4]:
            array.setflags(write=False)

    @property
    def t(self) -> Array:
        """Instants of the samples since the start of the motion, s, shape (n,)."""
        return self.saved.t

    @property
    def q(self) -> Array:
        """Positions of the links, rad (m), shape (n, n_joints)."""
        return self.saved.states[:, POSITION]

    @property
    def v(self) -> Array:
        """Velocities of the links, rad/s (m/s), shape (n, n_joints)."""
        return self.saved.states[:, VELOCITY]

    @property
    def motor_q(self) -> Array:
        """Positions of the motors over their gear ratios, rad (m): those of the links, unless the gears are elastic."""
        return self.saved.states[:, self._plant.motor.start]

    @property
    def torque(self) -> Array:
        """What the actuators apply from each sample on, after saturation, N m (N), shape (n, n_joints)."""
        return self.saved.applied

    @property
    def is_saturated(self) -> NDArray[np.bool_]:
        """Whether a joint's commanded torque is beyond its limit, shape (n, n_joints)."""
        return frozen(self.saved.commanded != self.saved.applied)

    @property
    def divergence(self) -> Divergence | None:
        """When and where the arm left its plan for good; the samples end before that."""
        return self.saved.divergence

    @property
    def has_diverged(self) -> bool:
        """Whether it did."""
        return self.divergence is not None

    @property
    def settle(self) -> float:
        """How long it goes on after the motion, s."""
        return float(max(0.0, self.t[-1] - self.trajectory.duration))

    @cached_property
    def planned(self) -> Reference:
        """Planned position, velocity and acceleration at the samples, each of shape (n, n_joints)."""
        return reference_at(self.trajectory, self.t)

    @cached_property
    def error(self) -> Array:
        """Position of the links less the planned one, rad (m), shape (n, n_joints)."""
        return read_only(self.q - self.planned.q)

    @cached_property
    def tool_error(self) -> Array:
        """Distance of the tool's origin from where it should be, m, shape (n,)."""
        return read_only(np.linalg.norm(self._tool - self._planned_tool, axis=1))

    @cached_property
    def _tool(self) -> Array:
        return forward_kinematics(self.robot, self.q)[:, :3, 3]

    @cached_property
    def _planned_tool(self) -> Array:
        return forward_kinematics(self.robot, self.planned.q)[:, :3, 3]

    @cached_property
    def _plant(self) -> Plant:
        return Plant.of(self.robot, () if self.elastic is None else (self.elastic,), self.rest_speed)

    @cached_property
    def executed(self) -> Trajectory:
        """The simulated motion as a trajectory: quintics between samples at least 20 ms apart, for drawing and tables.

        They take over position, velocity and acceleration of the links there; what happens between is left out.
        """
        every = max(1, round(_KNOTS * len(self.t) / max(self.t[-1], _KNOTS)))
        some = np.unique([*range(0, len(self.t) - 1, every), len(self.t) - 1])
        t, q, v = self.t[some], self.q[some], self.v[some]
        states = np.moveaxis(self.saved.states[some], 0, 1)
        a = self._plant.slope(states, self.torque[some])[VELOCITY]
        return Trajectory(
            position=_quintics(t, q, v, a),
            points=q,
            times=t,
            profile=f"{self.trajectory.profile}, executed",
            joint_names=self.robot.joint_names,
            rest_before=False,
            rest_after=False,
            resolution=_STANDSTILL,
        )

    @cached_property
    def energy(self) -> EnergyBalance:
        """Where the energy goes; see `EnergyBalance`."""
        some = np.unique(np.linspace(0, len(self.t) - 1, min(len(self.t), _MOST_BALANCED)).astype(int))
        states = self.saved.states[some]
        kinetic, potential, elastic = self._plant.energy(states).T
        return EnergyBalance(
            t=self.t[some],
            kinetic=kinetic,
            potential=potential - potential[0],
            elastic=elastic,
            work=states[:, WORK].sum(axis=1),
            taken=states[:, LOSS].sum(axis=1),
        )

    @cached_property
    def metrics(self) -> Metrics:
        """Errors, settling, saturation, chattering, vibration and energy; see `METRICS`."""
        t, duration = self.t, self.trajectory.duration
        after = t >= duration * (1 - 1e-12)
        peak, rms, end = _peak_rms_end(t, self.error, duration)
        tool = _peak_rms_end(t, self.tool_error[:, None], duration)
        planned = planned_torque(self.robot, self.planned, self.rest_speed)
        swings = self.q - self.motor_q if self.elastic is not None else self.q
        return Metrics(
            peak_error=peak,
            rms_error=rms,
            end_error=end,
            saturation_time=self.is_saturated[:-1].T @ np.diff(t),
            chattering=np.maximum(_travel(self.torque) - _travel(planned), 0.0) / max(t[-1], 1e-300),
            residual_vibration=_half_range(swings[after]),
            energy_in=np.maximum(np.diff(self.saved.states[:, WORK], axis=0), 0.0).sum(axis=0),
            tool_peak_error=float(tool[0][0]),
            tool_rms_error=float(tool[1][0]),
            tool_end_error=float(tool[2][0]),
            tool_residual_vibration=float(np.linalg.norm(_half_range(self._tool[after]))),
            settling_time=_settling_time(t, self.tool_error, duration),
        )

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document without the samples; null for what is not known, as after a divergence.

        Returns
        -------
        dict
        """
        return {
            "schema": SCHEMAS["simulation"],
            "robot": self.robot.name,
            "joint_names": list(self.robot.joint_names),
            "controller": self.controller.to_dict(),
            "run": self.run_document(self.trajectory.profile),
        }

    def run_document(self, name: str) -> dict[str, Any]:
        """The part of the document that is of this trajectory alone.

        Returns
        -------
        dict
        """
        divergence = self.divergence
        return {
            "name": name,
            "profile": self.trajectory.profile,
            "duration": self.trajectory.duration,
            "settle": self.settle,
            "rate": plain(self.rate),
            "step": self.step,
            "rest_speed": self.rest_speed,
            "elastic": None if self.elastic is None else _elastic_document(self.elastic),
            "n_samples": len(self.t),
            "metrics": dict.fromkeys(METRICS) if divergence is not None else self.metrics.to_dict(),
            "divergence": None
            if divergence is None
            else {"time": divergence.time, "joint": divergence.joint, "error": plain(divergence.error)},
        }

    def __str__(self) -> str:
        return view.simulation_text(self.to_dict())

    def __repr__(self) -> str:
        return one_line("Simulation", self._facts())

    def _facts(self) -> dict[str, object]:
        lost = self.divergence
        errors = (
            f"diverged at {lost.time:.4g} s" if lost else f"{1e3 * self.metrics.tool_rms_error:.3g} mm rms at the tool"
        )
        return {
            "robot": self.robot.name,
            "profile": self.trajectory.profile,
            "controller": self.controller.law,
            "samples": len(self.t),
            "error": errors,
        }

    def _repr_html_(self) -> str:
        return view.simulation_html(self.to_dict())


def _quintics(t: Array, q: Array, v: Array, a: Array) -> Piecewise:
    """The piecewise quintic with these positions, velocities and accelerations at times (k,)."""
    h = np.diff(t)[:, None]
    v0, v1, a0, a1 = v[:-1] * h, v[1:] * h, a[:-1] * h**2, a[1:] * h**2
    gap, turn, bend = q[1:] - q[:-1] - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
    powers = [
        q[:-1], v0, a0 / 2,
        10 * gap - 4 * turn + bend / 2, -15 * gap + 7 * turn - bend, 6 * gap - 3 * turn + bend / 2,
    ]  # fmt: skip
    return Piecewise.from_power(t, np.stack(powers))


def _half_range(values: Array) -> Array:
    """Half the range of samples (n, m), shape (m,)."""
    return np.zeros(values.shape[1]) if not len(values) else np.asarray(np.ptp(values, axis=0) / 2)


def _elastic_document(elastic: ElasticJoints) -> dict[str, Any]:
    return {
        "stiffness": plain(elastic.stiffness),
        "damping": plain(elastic.damping),
        "source": elastic.source,
    }
