"""What must be known of a motor with its gearbox before it can be called strong enough."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from puma_septic.drives._catalogue import Catalogue
from puma_septic.drives._drivetrain import Drivetrain
from puma_septic.drives._gearbox import Gearbox
from puma_septic.drives._motor import Motor

__all__ = ["LEAST_SET", "lacking", "lacking_of_pairs", "names_of"]


class _Need(NamedTuple):
    """One value that must be known: whose it is, whether a part at its place and cycle has it, what stands for it."""

    name: str
    part: str
    is_known: Callable[[Any, Drivetrain, float], bool]
    stands_for_it: Callable[[Drivetrain], bool] | None = None


def _is_direct(gearbox: Gearbox) -> bool:
    """A ratio of 1 is a direct drive, which has no gears to wear or to lose by."""
    return abs(gearbox.ratio) == 1


def _has_curve(motor: Motor) -> bool:
    return len(motor.peak_curve) > 0 or len(motor.peak_curves) > 0


def _has_continuous_curve(motor: Motor) -> bool:
    return len(motor.continuous_curve) > 0 or len(motor.continuous_curves) > 0


def _known(*values: float) -> bool:
    return not np.isnan(values).all()


_NEEDS: Final = (
    _Need("rotor inertia", "motor", lambda m, *_: _known(m.rotor_inertia)),
    _Need("continuous torque", "motor", lambda m, *_: _known(m.continuous_torque) or _has_continuous_curve(m)),
    # Above its rated ambient or altitude less of it is left, and who does not say how much must not win by it.
    _Need(
        "continuous torque at this ambient and altitude", "motor",
        lambda m, place, _: _known(m.continuous_share(ambient_celsius=place.ambient_celsius, altitude=place.altitude)),
    ),
    _Need(
        "peak torque", "motor", lambda m, *_: _known(m.peak_torque) or _has_curve(m),
        lambda train: _known(train.max_effort),
    ),
    # A curve of peak torque ends at the highest speed.
    _Need("highest speed", "motor", lambda m, *_: _known(m.max_speed) or _has_curve(m)),
    # Curves that hold at higher voltages than the bus has, or at an unknown one, tell nothing that decides.
    _Need(
        "torque over speed at this bus voltage", "motor",
        lambda m, place, _: m.has_curves_at(place.drive.bus_voltage),
    ),
    _Need("average torque", "gearbox", lambda g, *_: _known(g.max_average_torque) or _is_direct(g)),
    _Need("repeated peak torque", "gearbox", lambda g, *_: _known(g.max_repeated_torque) or _is_direct(g)),
    # Beyond 1000 cycles an hour the peaks of a planetary gear count more than once.
    _Need("peak torque at this cycle rate", "gearbox", lambda g, _, cycle: _known(g.impact_factor(cycle))),
    # Where a life is asked for, gears whose life nobody has told must not win by it.
    _Need(
        "rated life, torque and speed", "gearbox",
        lambda g, place, _: not _known(place.required_life_hours) or _is_direct(g)
        or all(map(_known, (g.rated_life_hours, g.rated_torque, g.rated_speed))),
    ),
    _Need(
        "efficiency or measured friction", "gearbox",
        lambda g, *_: _known(g.efficiency) or len(g.efficiency_map) > 0 or _is_direct(g),
        lambda train: train.measured_friction is not None and train.measured_friction.is_known,
    ),
)  # fmt: skip
LEAST_SET: Final = tuple(f"{need.name} of the {need.part}" for need in _NEEDS)
"""The least that must be known of a pair: without one of these it is not decidable, unless a known limit rejects it."""


def lacking(train: Drivetrain, *, cycle: float = np.inf) -> tuple[str, ...]:
    """What of `LEAST_SET` is not known of a drive train.

    Parameters
    ----------
    train : Drivetrain
    cycle : float
        Duration of the shortest cycle, s.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> from puma_septic.drives import Gearbox, Motor
    >>> lacking(Drivetrain(motor=Motor(rotor_inertia=1e-4, peak_torque=1.0), gearbox=Gearbox(ratio=1.0)))
    ('continuous torque of the motor', 'highest speed of the motor')
    """
    return names_of(_bits(train, cycle))


def names_of(bits: int) -> tuple[str, ...]:
    """The members of `LEAST_SET` that the bits stand for.

    Returns
    -------
    tuple of str
    """
    return tuple(name for k, name in enumerate(LEAST_SET) if bits >> k & 1)


def lacking_of_pairs(catalogue: Catalogue, place: Drivetrain, *, cycle: float) -> NDArray[np.uint16]:
    """The same of every pair of a catalogue, a bit for each member of `LEAST_SET`.

    Parameters
    ----------
    catalogue : Catalogue
    place : Drivetrain
        What the joint has whatever the parts, such as its ambient.
    cycle : float
        Duration of the shortest cycle, s.

    Returns
    -------
    ndarray of uint16, shape (n_pairs,)
    """
    fed = [replace(place, drive=catalogue.drive(i, place)) for i in range(len(catalogue.motors))]
    of_motors = [_part_bits("motor", *both, cycle) for both in zip(catalogue.motors, fed, strict=True)]
    of_gearboxes = [_part_bits("gearbox", part, place, cycle) for part in catalogue.gearboxes]
    motors, gearboxes = (np.array(bits, dtype=np.uint16) for bits in (of_motors, of_gearboxes))
    bits = motors[catalogue.motor_index] | gearboxes[catalogue.gearbox_index]
    for k, pair in enumerate(catalogue.pairs or ()):
        if bits[k] and (pair.friction is not None or not np.isnan(pair.max_effort)):
            bits[k] = _bits(catalogue.drivetrain(k, 0, (place,)), cycle)
    return np.asarray(bits)


def _part_bits(kind: str, part: object, place: Drivetrain, cycle: float) -> int:
    return sum(1 << k for k, need in enumerate(_NEEDS) if need.part == kind and not need.is_known(part, place, cycle))


def _bits(train: Drivetrain, cycle: float) -> int:
    parts = {"motor": train.motor, "gearbox": train.gearbox}
    return sum(
        1 << k
        for k, need in enumerate(_NEEDS)
        if not (
            need.is_known(parts[need.part], train, cycle)
            or (need.stands_for_it is not None and need.stands_for_it(train))
        )
    )
