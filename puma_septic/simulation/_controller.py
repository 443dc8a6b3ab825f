"""Controller: which law follows the trajectory, with which gains, and how it sees the arm."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import floor, isinf
from types import MappingProxyType
from typing import Any, Final, NamedTuple, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.document import card, one_line, plain
from puma_septic.dynamics import mass_matrix, rigid_torque
from puma_septic.errors import InputError
from puma_septic.friction import friction_terms
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import (
    Array,
    checked_array,
    checked_choice,
    checked_number,
    frozen,
    n_dimensions,
    store_needed,
)

__all__ = [
    "LAWS",
    "TORQUE",
    "Controller",
    "Gains",
    "Reference",
    "controller_of",
    "planned_torque",
    "reference_at",
    "references",
    "smooth_friction",
]


class Reference(NamedTuple):
    """Planned motion of several arms, each of shape (n_instants, n_rows, n_joints), after its end at rest."""

    q: Array
    v: Array
    a: Array

    def at(self, k: int) -> Reference:
        """Of one instant, shape (n_rows, n_joints)."""
        return Reference(self.q[k], self.v[k], self.a[k])


def reference_at(trajectory: Trajectory, since: Array, *, from_left: bool = False) -> Reference:
    """A planned motion at times since its start, shape (n,); steps seen from the left where asked for."""
    duration, state, n = trajectory.duration, trajectory.state, trajectory.n_joints
    # A hair before an instant stands for its left-hand side; the hair is a rounding of the time.
    inside = np.clip(np.nextafter(since, -np.inf) if from_left else since, 0.0, duration)
    values = state.at_offsets(inside)
    ended = since > duration * (1 + 1e-12) if from_left else since >= duration * (1 - 1e-12)
    values[ended, n:] = 0.0
    frozen(values)
    return Reference(values[:, :n], values[:, n : 2 * n], values[:, 2 * n : 3 * n])


def references(trajectories: Sequence[Trajectory], instants: Array, *, from_left: bool = False) -> Reference:
    """Of several motions, each at its own times since the start, shape (n_instants, n_rows)."""
    rows = [reference_at(trajectory, instants[:, k], from_left=from_left) for k, trajectory in enumerate(trajectories)]
    return Reference(*(np.stack(parts, axis=1) for parts in zip(*rows, strict=True)))


LAWS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "none": "no torque: the arm moves freely",
        "pd": "each joint by itself: proportional and derivative",
        "pid": "each joint by itself: proportional, integral and derivative",
        "pd_gravity": "pd, and the gravity of the measured posture",
        "feedforward": "pd, and the torque that the planned motion needs by the controller's model",
        "computed_torque": "the torque of the planned acceleration, corrected by the error, in the measured posture",
    }
)
"""Control laws by name, and what each commands."""

USUAL_RATE: Final = 1000.0
"""Of industrial joint controllers, Hz: that of Franka's (libfranka) and KUKA's (FRI); UR's e-Series has 500 Hz."""

# How far from a whole number of periods is rounding.
_WHOLE: Final = 1e-9


class Gains(NamedTuple):
    """Of each joint, shape (n_joints,): per rad, per rad/s and per rad s; in N m, or rad/s^2 for computed torque."""

    proportional: Array
    derivative: Array
    integral: Array


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Controller:
    """A control law of the joints, evaluated at a rate, on what the encoders show.

    Gains follow from a bandwidth and a damping ratio: with ``w = 2 pi bandwidth`` and the inertia m of a joint (the
    diagonal of M at the first point, rotor included, of the controller's model; 1 for computed torque), the error obeys
    ``s^2 + 2 damping_ratio w s + w^2``, times ``s + w`` with an integral: ``kp = m w^2`` and ``kd = 2 damping_ratio w
    m``, or ``m w^2 (1 + 2 damping_ratio)``, ``m w (1 + 2 damping_ratio)`` and ``ki = m w^3``.

    Parameters
    ----------
    law : str
        One of `LAWS`.
    bandwidth : array_like, shape () or (n_joints,)
        Hz. At most half of the lowest natural frequency of the structure, 5 to 25 Hz of industrial arms (Craig,
        "Introduction to Robotics", 3rd ed., 2005, chapter 9): 5 Hz.
    damping_ratio : float
        Above 0; 1 is critical.
    rate : float, optional
        Evaluations per second; the motion must last a whole number of periods. None: the rate next to 1 kHz that does.
        Infinity: at every stage of the integrator, as if it were continuous.
    encoder_resolution : array_like, shape () or (n_joints,)
        Step of the measured position at the joint, rad (m); 0: exact.
    velocity_filter : float
        Corner of a first-order low-pass filter of the velocity, Hz; infinity: no filter. Without it and with exact
        positions the velocity is exact, else the difference of two measured positions over the period.
    delay : float
        From the measurement to the torque, a whole number of periods, s.
    model : Robot, optional
        The arm as the controller knows it: its masses, payload, friction. None: as it is.
    gains : Gains, optional
        Instead of those of the rule.

    Raises
    ------
    InputError
        For an unknown law, or values out of range; what depends on the motion is found when it is simulated.

    Examples
    --------
    >>> pd = Controller(law="pd", rate=500.0)
    >>> pd.periods(2.0), Controller(law="pd").periods(0.3333)
    (1000, 333)
    """

    law: str = "computed_torque"
    bandwidth: ArrayLike = 5.0
    damping_ratio: float = 1.0
    rate: float | None = None
    encoder_resolution: ArrayLike = 0.0
    velocity_filter: float = np.inf
    delay: float = 0.0
    model: Robot | None = None
    gains: Gains | None = field(default=None)

    def __post_init__(self) -> None:
        checked_choice("controller", self.law, LAWS)
        store_needed(self, {"damping_ratio": ""}, above=0.0)
        store_needed(self, {"delay": "s"}, at_least=0.0)
        for name, unit in (("rate", "Hz"), ("velocity_filter", "Hz")):
            value = getattr(self, name)
            if value is not None and not (isinstance(value, float) and isinf(value) and value > 0):
                object.__setattr__(self, name, checked_number(name, value, unit=unit, above=0.0))
        for name, unit, above, least in (("bandwidth", "Hz", 0.0, None), ("encoder_resolution", "rad", None, 0.0)):
            value = getattr(self, name)
            shape = () if n_dimensions(value) == 0 else (None,)
            object.__setattr__(self, name, checked_array(name, value, shape, unit=unit, above=above, at_least=least))
        if self.model is not None and not isinstance(self.model, Robot):
            raise InputError(f"model: expected a Robot, got {type(self.model).__name__}")
        if self.is_continuous and (self.delay > 0 or self.estimates_velocity):
            raise InputError(
                "a controller at every stage of the integrator (rate infinite) has no delay, encoder or filter; give it"
                f" a rate, such as {USUAL_RATE:g} Hz"
            )

    def __repr__(self) -> str:
        return one_line("Controller", self._facts())

    def _repr_html_(self) -> str:
        return card("Controller", self._facts())

    def _facts(self) -> dict[str, object]:
        rate = "nearest to 1 kHz" if self.rate is None else "each stage" if self.is_continuous else f"{self.rate:g} Hz"
        return {
            "law": self.law,
            "bandwidth": f"{', '.join(f'{value:g}' for value in np.ravel(np.asarray(self.bandwidth)))} Hz",
            "rate": rate,
            "model": "the arm itself" if self.model is None else self.model.name,
        }

    @property
    def is_continuous(self) -> bool:
        """Whether it is evaluated at every stage of the integrator."""
        return self.rate is not None and isinf(self.rate)

    @property
    def estimates_velocity(self) -> bool:
        """Whether it takes the velocity from measured positions."""
        return bool(np.any(np.asarray(self.encoder_resolution) > 0)) or not isinf(self.velocity_filter)

    def periods(self, duration: float) -> int:
        """How many control periods a motion lasts.

        Returns
        -------
        int

        Raises
        ------
        InputError
            For a rate that does not divide the duration.
        """
        if self.rate is None:
            return max(1, round(duration * USUAL_RATE))
        count = duration * self.rate
        if count < 0.5 or abs(count - round(count)) > _WHOLE * count:
            below = max(1, floor(count))
            raise InputError(
                f"rate = {self.rate:g} Hz: the motion of {duration:.9g} s is {count:.6g} control periods, not a whole"
                f" number of them; {below / duration:.9g} Hz and {(below + 1) / duration:.9g} Hz divide it, and without"
                f" a rate the one next to {USUAL_RATE:g} Hz is taken"
            )
        return round(count)

    def delayed_periods(self, period: float) -> int:
        """Its delay in control periods.

        Returns
        -------
        int

        Raises
        ------
        InputError
            For a delay that is not a whole number of them.
        """
        count = self.delay / period
        if abs(count - round(count)) > 1e-6 * max(1.0, count):
            raise InputError(
                f"delay = {self.delay:g} s is {count:.6g} control periods of {period:.6g} s; it must be a whole number"
                " of them"
            )
        return round(count)

    def gains_for(self, model: Robot, q: Array) -> Gains:
        """Its own gains, or those of the rule in a posture, shape (n_joints,).

        Returns
        -------
        Gains
        """
        n = model.n_joints
        if self.gains is not None:
            given = zip(Gains._fields, self.gains, strict=True)
            return Gains(*(checked_array(f"{name} gain", one, (n,)) for name, one in given))
        is_normalised = self.law == "computed_torque"
        m = np.ones(n) if is_normalised else np.diagonal(mass_matrix(model, q[None])[0])
        w = 2 * np.pi * np.broadcast_to(np.asarray(self.bandwidth, dtype=np.float64), (n,))
        both = 2 * self.damping_ratio
        if self.law == "pid":
            return Gains(m * w**2 * (1 + both), m * w * (1 + both), m * w**3)
        return Gains(m * w**2, both * w * m, np.zeros(n))

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document.

        Returns
        -------
        dict
        """
        numbers = {
            "bandwidth": self.bandwidth,
            "damping_ratio": self.damping_ratio,
            "encoder_resolution": self.encoder_resolution,
            "velocity_filter": self.velocity_filter,
            "delay": self.delay,
        }
        return {
            "law": self.law,
            "meaning": LAWS[self.law],
            **plain({name: np.asarray(value, dtype=np.float64) for name, value in numbers.items()}),
            "has_own_model": self.model is not None,
            "has_own_gains": self.gains is not None,
        }


def controller_of(value: Controller | str) -> Controller:
    """A controller, or the one of a law's name with all else as usual.

    Returns
    -------
    Controller

    Raises
    ------
    InputError
        For an unknown law, or something else.
    """
    if isinstance(value, Controller):
        return value
    if isinstance(value, str):
        return Controller(law=value)
    raise InputError(f"controller: expected a Controller or one of {', '.join(map(repr, LAWS))}, got {value!r}")


_ControlLaw = Callable[[Robot, Gains, Reference, Array, Array, Array], Array]
"""Torque (n_rows, n_joints) by model, gains, reference, planned torque, and measured position and velocity."""


def smooth_friction(robot: Robot, v: Array, rest_speed: float) -> Array:
    """The friction law with its step at rest made smooth: the way is ``tanh(v / rest_speed)``."""
    terms = friction_terms(robot.friction, v, np.tanh(v / rest_speed))
    return terms["viscous"] + terms["coulomb"]


def planned_torque(model: Robot, reference: Reference, rest_speed: float) -> Array:
    """What the planned motion needs by the controller's model, shape of the reference."""
    q, v, a = (values.reshape(-1, values.shape[-1]) for values in reference)
    return (rigid_torque(model, q, v, a) + smooth_friction(model, v, rest_speed)).reshape(reference.q.shape)


def _none(_model: Robot, _gains: Gains, want: Reference, _planned: Array, _q: Array, _v: Array) -> Array:
    return np.zeros_like(want.q)


def _pd(_model: Robot, gains: Gains, want: Reference, _planned: Array, q: Array, v: Array) -> Array:
    return gains.proportional * (want.q - q) + gains.derivative * (want.v - v)


def _pd_gravity(model: Robot, gains: Gains, want: Reference, planned: Array, q: Array, v: Array) -> Array:
    rest = np.zeros_like(q)
    return _pd(model, gains, want, planned, q, v) + rigid_torque(model, q, rest, rest)


def _feedforward(model: Robot, gains: Gains, want: Reference, planned: Array, q: Array, v: Array) -> Array:
    return _pd(model, gains, want, planned, q, v) + planned


def _computed_torque(model: Robot, gains: Gains, want: Reference, planned: Array, q: Array, v: Array) -> Array:
    """`planned` is the friction of the planned velocity alone."""
    return rigid_torque(model, q, v, want.a + _pd(model, gains, want, planned, q, v)) + planned


TORQUE: Final[Mapping[str, _ControlLaw]] = MappingProxyType(
    {
        "none": _none,
        "pd": _pd,
        "pid": _pd,  # the integral is added where it is kept
        "pd_gravity": _pd_gravity,
        "feedforward": _feedforward,
        "computed_torque": _computed_torque,
    }
)
"""The torque of each law of `LAWS`."""
