"""The drive trains of a cycle's joints, in whichever form they are given."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from puma_septic.cycle import Cycle
from puma_septic.drives import Drivetrain
from puma_septic.errors import InputError

__all__ = ["GivenDrivetrains", "checked_drivetrains", "checked_ratios"]

# In the robot's order, or by joint name.
GivenDrivetrains = Iterable[Drivetrain] | Mapping[str, Drivetrain]


def checked_drivetrains(cycle: Cycle, given: object) -> tuple[Drivetrain, ...]:
    """One drive train per joint, in the robot's order.

    Raises
    ------
    InputError
        Unless each joint has one, and nothing else has: by number, by name, or by type.
    """
    names = cycle.joint_names
    if isinstance(given, Mapping):
        trains = _by_name(names, given)
    elif isinstance(given, Iterable) and not isinstance(given, np.ndarray):
        trains = list(given)
    else:
        raise InputError(
            f"drivetrains: expected one for each of {', '.join(names)}, as a sequence in this order or a mapping by"
            f" joint name, got one {type(given).__name__}"
        )
    if len(trains) != len(names):
        raise InputError(
            f"{len(trains)} drivetrains for {len(names)} joints: expected one for each of {', '.join(names)}"
        )
    wrong = [
        f"joint {name!r} has a {type(train).__name__}"
        for name, train in zip(names, trains, strict=True)
        if not isinstance(train, Drivetrain)
    ]
    if wrong:
        raise InputError(f"drivetrains: expected a Drivetrain for each joint, but {'; '.join(wrong)}")
    return tuple(trains)


def checked_ratios(cycle: Cycle, trains: tuple[Drivetrain, ...]) -> tuple[Drivetrain, ...]:
    """The drive trains, each with a gear ratio: without one a motor has neither speed nor torque.

    Returns
    -------
    tuple of Drivetrain

    Raises
    ------
    InputError
        With the joints whose gear ratio is not known.
    """
    unknown = [repr(name) for name, train in zip(cycle.joint_names, trains, strict=True) if np.isnan(train.ratio)]
    if unknown:
        raise InputError(f"drivetrains: the gear ratio of joint {', '.join(unknown)} is not known; give gearbox.ratio")
    return trains


def _by_name(names: tuple[str, ...], given: Mapping[Any, Any]) -> list[Any]:
    """In the robot's order; every joint and nothing else must be in it."""
    missing = [name for name in names if name not in given]
    unknown = [name for name in given if name not in names]
    faults = [f"no drivetrain for {', '.join(map(repr, missing))}"] if missing else []
    faults += [f"unknown joint {', '.join(map(repr, unknown))}"] if unknown else []
    if faults:
        raise InputError(f"drivetrains: {'; '.join(faults)}; expected one for each of {', '.join(names)}")
    return [given[name] for name in names]
