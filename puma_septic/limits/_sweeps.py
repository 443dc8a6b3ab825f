"""Peaks and root mean squares of one motion over many durations and payloads, exactly and all at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from puma_septic.assessment import Assessment, assess
from puma_septic.document import SCHEMAS, card, csv_text, one_line, plain
from puma_septic.dynamics import check_plain_friction, payload_torque, rigid_torque
from puma_septic.errors import InputError
from puma_septic.limit_check import AT_LIMIT
from puma_septic.limits._drives import drive_checks
from puma_septic.limits._dwell import added_holding_torque
from puma_septic.limits._payload import Load, checked_load
from puma_septic.limits._stretching import split_torque
from puma_septic.motion import Motion, compute_motion
from puma_septic.piecewise import Piecewise
from puma_septic.piecewise.combinations import Combinations
from puma_septic.quantities import QUANTITIES
from puma_septic.validation import Array, checked_array, checked_kind, checked_number, freeze_fields, read_only

__all__ = [
    "Sweep",
    "duration_sweep",
    "payload_and_duration",
    "payload_duration_map",
    "payload_sweep",
]

_ORDERS: Final = {"velocity": 1, "acceleration": 2, "jerk": 3}


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Sweep:
    """A motion at many durations and payloads; made by `duration_sweep`, `payload_sweep` and `payload_duration_map`.

    Attributes
    ----------
    motion : Motion
        What was asked about.
    load : Load
        Of which the masses are.
    durations, masses : ndarray, shape (...,)
        s and kg: of shape (n,), of a map (n_durations, n_masses).
    peaks : mapping of str to ndarray
        "velocity", "acceleration", "jerk", "effort" and what else has limits: largest magnitudes, shape
        (..., n_joints); NaN for the torque of a joint whose torque is not known.
    rms_torque : ndarray, shape (..., n_joints)
        Over the motion, and the rest after it where there is one.
    utilisation : ndarray, shape (...,)
        The largest share of a known limit, positions apart; NaN where none is known.
    governing_joint : ndarray of int, shape (...,)
        Of that limit.
    governing_quantity : ndarray of str, shape (...,)
    is_feasible : ndarray of bool, shape (...,)
        Whether no known limit is violated.
    not_assessed : tuple of str
        What is not known, and limits of the motors, which are not held here.
    """

    motion: Motion
    load: Load
    durations: Array
    masses: Array
    peaks: Mapping[str, Array]
    rms_torque: Array
    utilisation: Array
    governing_joint: NDArray[np.int64]
    governing_quantity: NDArray[np.str_]
    is_feasible: NDArray[np.bool_]
    not_assessed: tuple[str, ...]

    def __post_init__(self) -> None:
        freeze_fields(self)

    @property
    def peak_torque(self) -> Array:
        """Largest magnitude of each torque, N m (N), shape (..., n_joints)."""
        return self.peaks["effort"]

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document.

        Returns
        -------
        dict
        """
        names = self.motion.robot.joint_names
        return {
            "schema": SCHEMAS["sweep"],
            "profile": self.motion.trajectory.profile,
            "joints": list(names),
            "com": plain(self.load.com),
            "gyration": plain(self.load.gyration),
            "durations": plain(self.durations),
            "masses": plain(self.masses),
            "peaks": plain(self.peaks),
            "rms_torque": plain(self.rms_torque),
            "utilisation": plain(self.utilisation),
            "governing": [
                f"{names[j]} {quantity}"
                for j, quantity in zip(self.governing_joint.flat, self.governing_quantity.flat, strict=True)
            ],
            "is_feasible": self.is_feasible.tolist(),
            "not_assessed": list(self.not_assessed),
        }

    def to_csv(self) -> str:
        """A row for each case: duration, mass, feasible, utilisation, governing limit, peaks and RMS by joint.

        Returns
        -------
        str
        """
        names = self.motion.robot.joint_names
        columns = [f"peak {quantity} {name}" for quantity in self.peaks for name in names]
        head = ["duration", "mass", "feasible", "utilisation", "joint", "quantity", *columns]
        numbers = np.concatenate([*self.peaks.values(), self.rms_torque], axis=-1).reshape(self.durations.size, -1)
        rows = [
            [t, m, str(bool(ok)).lower(), plain(use), names[j], quantity, *map(plain, values)]
            for t, m, ok, use, j, quantity, values in zip(
                self.durations.ravel().tolist(), self.masses.ravel().tolist(), self.is_feasible.flat,
                self.utilisation.flat, self.governing_joint.flat, self.governing_quantity.flat, numbers, strict=True,
            )
        ]  # fmt: skip
        return csv_text([[*head, *(f"RMS torque {name}" for name in names)], *rows])

    def __repr__(self) -> str:
        return one_line("Sweep", self._facts())

    def _repr_html_(self) -> str:
        return card("Sweep", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "robot": self.motion.robot.name,
            "durations": np.size(self.durations),
            "masses": np.size(self.masses),
            "feasible": int(np.sum(self.is_feasible)),
        }


def duration_sweep(motion: Motion, durations: ArrayLike) -> Sweep:
    """Peaks and root mean squares of a motion stretched to each of some durations.

    Parameters
    ----------
    motion : Motion
    durations : array_like, shape (n,)
        s.

    Returns
    -------
    Sweep
        Exact, as an assessment of each would be; one pass of the dynamics for all.

    Raises
    ------
    InputError
        For a duration that is not positive, or friction that is not viscous plus constant.

    Examples
    --------
    >>> import puma_septic as ps
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> sweep = ps.duration_sweep(ps.compute_motion(ps.load_robot(), move), [0.5, 1.0, 2.0])
    >>> sweep.is_feasible.tolist(), sweep.utilisation.round(3).tolist()
    ([False, True, True], [1.242, 0.699, 0.575])
    """
    times = _checked("durations", durations, unit="s", above=0.0)
    payload = checked_kind("motion", motion, Motion).robot.payload
    return _sweep(motion, checked_load(motion.robot, None, None), times, np.full(len(times), _mass(payload)))


def payload_sweep(
    motion: Motion, masses: ArrayLike, *, com: ArrayLike | None = None, gyration: ArrayLike | None = None
) -> Sweep:
    """Peaks and root mean squares of a motion under each of some payloads of one shape.

    Parameters
    ----------
    motion : Motion
        What its robot carries is replaced.
    masses : array_like, shape (n,)
        kg.
    com, gyration : array_like, optional
        As `maximum_payload` takes them.

    Returns
    -------
    Sweep

    Raises
    ------
    InputError
        For a negative mass, a shape that no body has, or friction that is not viscous plus constant.
    """
    m = _checked("masses", masses, unit="kg", at_least=0.0)
    load = checked_load(checked_kind("motion", motion, Motion).robot, com, gyration)
    return _sweep(motion, load, np.full(len(m), motion.trajectory.duration), m)


def payload_duration_map(
    motion: Motion,
    durations: ArrayLike,
    masses: ArrayLike,
    *,
    com: ArrayLike | None = None,
    gyration: ArrayLike | None = None,
) -> Sweep:
    """All pairs of some durations and payloads.

    Parameters
    ----------
    motion : Motion
        What its robot carries is replaced.
    durations, masses : array_like, shapes (n_durations,) and (n_masses,)
        s and kg.
    com, gyration : array_like, optional
        As `maximum_payload` takes them.

    Returns
    -------
    Sweep
        With arrays of shape (n_durations, n_masses, ...).

    Raises
    ------
    InputError
        As `duration_sweep` and `payload_sweep`.
    """
    times = _checked("durations", durations, unit="s", above=0.0)
    m = _checked("masses", masses, unit="kg", at_least=0.0)
    load = checked_load(checked_kind("motion", motion, Motion).robot, com, gyration)
    all_times, all_masses = (np.ascontiguousarray(axis.T) for axis in np.meshgrid(times, m))
    return _sweep(motion, load, all_times, all_masses)


def payload_and_duration(motion: Motion, durations: ArrayLike, masses: ArrayLike, *, dwell: float = 0.0) -> Sweep:
    """As many cases as there are durations, each with its own payload of the shape that the robot carries.

    Parameters
    ----------
    motion : Motion
    durations, masses : array_like, shape (n,)
        s and kg.
    dwell : float
        Rest at the last point after each, s; its holding torque counts in peaks and root mean squares.

    Returns
    -------
    Sweep

    Raises
    ------
    InputError
        As `duration_sweep` and `payload_sweep`, and for other than one mass for each duration.
    """
    times = _checked("durations", durations, unit="s", above=0.0)
    m = _checked("masses", masses, unit="kg", at_least=0.0)
    if len(times) != len(m):
        raise InputError(f"{len(times)} durations and {len(m)} masses: expected one of each for a case")
    return _sweep(motion, checked_load(checked_kind("motion", motion, Motion).robot, None, None), times, m, dwell)


def _checked(name: str, values: ArrayLike, *, unit: str, **bounds: float) -> Array:
    array = checked_array(name, values, (None,), unit=unit)
    if not len(array):
        raise InputError(f"{name}: at least one is needed")
    checked_number(f"the least of {name}", array.min(), unit=unit, **bounds)
    return array


def _mass(payload: Any) -> float:
    return 0.0 if payload is None else float(payload.mass)


def _sweep(motion: Motion, load: Load, durations: Array, masses: Array, dwell: float = 0.0) -> Sweep:
    robot = motion.robot
    bare = motion if robot.payload is None else compute_motion(robot.with_payload(None), motion.trajectory)
    first = assess(bare, dwell=dwell)
    rates, m = motion.trajectory.duration / durations.ravel(), masses.ravel()
    torque = LoadedTorque.of(bare, load)
    found, rms = torque.peaks(rates, m), torque.rms(rates, m)
    if dwell:
        hold = first.holding_torque + m[:, None] * added_holding_torque(bare, load.per_kg)
        share = (dwell / (dwell + durations.ravel()))[:, None]
        found, rms = np.maximum(found, np.abs(hold)), np.sqrt((1 - share) * rms**2 + share * hold**2)
    kinematic = {name: getattr(first, f"peak_{name}") * rates[:, None] ** order for name, order in _ORDERS.items()}
    peaks = kinematic | {"effort": found} | torque.derivative_peaks(rates, m)
    verdict = _Verdict.of(first, peaks)
    shape = durations.shape

    def shaped(values: Any) -> Any:
        return read_only(values.reshape(*shape, *values.shape[1:])) if values.dtype == float else values.reshape(shape)

    return Sweep(
        motion=motion,
        load=load,
        durations=read_only(durations),
        masses=read_only(masses),
        peaks={name: shaped(values) for name, values in peaks.items()},
        rms_torque=shaped(rms),
        utilisation=shaped(verdict.utilisation),
        governing_joint=shaped(verdict.joint),
        governing_quantity=shaped(verdict.quantity),
        is_feasible=shaped(verdict.is_feasible),
        not_assessed=(*first.not_assessed, *_motors(bare)),
    )


def _motors(motion: Motion) -> tuple[str, ...]:
    quantities = dict.fromkeys(check.quantity for check in drive_checks(motion))
    return (f"limits of the motors ({', '.join(quantities)})",) if quantities else ()


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Verdict:
    utilisation: Array
    joint: NDArray[np.int64]
    quantity: NDArray[np.str_]
    is_feasible: NDArray[np.bool_]

    @classmethod
    def of(cls, first: Assessment, peaks: Mapping[str, Array]) -> _Verdict:
        """Peaks of many cases (n, n_joints) held against the limits of the robot of an assessment."""
        limits, n = first.motion.robot.limits, first.motion.robot.n_joints
        used = np.concatenate([peaks[name] / getattr(limits, name) for name in peaks], axis=1)
        impossible = np.isinf(np.concatenate([peaks["acceleration"], peaks["effort"]], axis=1)).any(axis=1)
        known = np.where(np.isnan(used), -1.0, used)
        best = known.argmax(axis=1)
        largest = known[np.arange(len(known)), best]
        in_place = not any(check.quantity == "position" and check.is_violated for check in first.checks)
        return cls(
            utilisation=np.where(largest < 0, np.nan, largest),
            joint=best % n,
            quantity=np.array(list(peaks))[best // n],
            is_feasible=(largest <= 1 + AT_LIMIT) & ~impossible & in_place & (not first.undecided),
        )


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LoadedTorque:
    """The torque of a motion at any rate u and mass m: ``S + V u + D u^2 + m (S' + D' u^2)``.

    Attributes
    ----------
    whole : Combinations
        Of the parts in this order, and Coulomb friction.
    derivatives : mapping of str to Combinations
        The same of the derivatives of the torque that have limits, over the original time.
    known : ndarray of bool, shape (n_joints,)
        Joints whose torque is known.
    unbounded : ndarray of bool, shape (n_joints,)
        Joints whose torque is infinite at any rate, where a velocity steps.
    """

    whole: Combinations
    derivatives: Mapping[str, Combinations]
    known: NDArray[np.bool_]
    unbounded: NDArray[np.bool_]

    @classmethod
    def of(cls, motion: Motion, load: Load) -> LoadedTorque:
        """Of a motion without load."""
        robot, trajectory, n = motion.robot, motion.trajectory, motion.robot.n_joints
        check_plain_friction(robot, "the torque of a motion at another speed")
        bare = split_torque(trajectory, partial(rigid_torque, robot))
        added = split_torque(trajectory, payload_torque(robot, load.per_kg)).aligned_with(bare)
        bare = bare.aligned_with(added)
        viscous = (trajectory.derivative(1) * robot.viscous_friction).aligned_with(bare)
        parts = (bare[:n], viscous, bare[n:], added[:n], added[n:])
        names = [name for name in robot.limits.quantities if QUANTITIES[name].signal == "torque"]
        rest = assess(motion)
        return cls(
            whole=Combinations(parts=parts, steps=motion.coulomb.aligned_with(bare)),
            derivatives={
                name: Combinations(parts=[_derivative(part, QUANTITIES[name].order) for part in parts])
                for name in names
                if QUANTITIES[name].order
            },
            known=robot.knows_torque,
            unbounded=np.isinf(rest.peak_torque),
        )

    def peaks(self, rates: Array, masses: Array) -> Array:
        """Largest magnitudes at rates and masses of shape (f,), shape (f, n_joints)."""
        return self._told(self.whole.peaks(_weights(rates, masses))[0])

    def rms(self, rates: Array, masses: Array) -> Array:
        """Root mean squares over the motion."""
        return self._told(self.whole.rms(_weights(rates, masses)))

    def derivative_peaks(self, rates: Array, masses: Array) -> dict[str, Array]:
        """The same of the derivatives that have limits."""
        weights = _weights(rates, masses)
        return {
            name: self._told(one.peaks(weights)[0] * rates[:, None] ** QUANTITIES[name].order)
            for name, one in self.derivatives.items()
        }

    def _told(self, values: Array) -> Array:
        return np.where(self.known, np.where(self.unbounded, np.inf, values), np.nan)


def _weights(rates: Array, masses: Array) -> Array:
    return np.stack([np.ones_like(rates), rates, rates**2, masses, masses * rates**2], axis=1)


def _derivative(function: Piecewise, order: int) -> Piecewise:
    for _ in range(order):
        function = function.derivative()
    return function
