"""What can be wrong with a trajectory file, by stable codes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, final

from puma_septic.errors import InputError

__all__ = ["FAULT_CODES", "Fault", "JointTrajectoryError"]

FAULT_CODES: Final = {
    "unreadable": "the file is missing, too large, or not YAML, JSON or a bag",
    "no_trajectory": "nothing in it is a JointTrajectory, or it has no joints or points",
    "unknown_key": "a key that the message does not have",
    "bad_value": "a value that is missing, not a finite number, or of the wrong length",
    "truncated": "`ros2 topic echo` has cut an array short",
    "unsupported": "the controller has no motion for it by default: no positions, or accelerations without velocities",
    "time_order": "times that are negative or do not increase strictly",
    "missing_joint": "a joint of the robot that the trajectory does not have",
    "unknown_joint": "a joint that the robot does not have, or one that is listed twice",
    "start_unknown": "a single point, and no state to start from",
}
_MOST_TOLD: Final = 20


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Fault:
    """One thing that is wrong with a file.

    Attributes
    ----------
    code : str
        A key of `FAULT_CODES`; codes do not change.
    message : str
        Where, what, and what would be valid.
    joint : str or None
    time : float or None
        s from the start.
    """

    code: str
    message: str
    joint: str | None = None
    time: float | None = None

    def __str__(self) -> str:
        return self.message


@final
class JointTrajectoryError(InputError):
    """A trajectory that cannot be read as one for this robot; everything that is wrong, at once.

    Attributes
    ----------
    origin : str
        The file, and where in it.
    faults : tuple of Fault
    """

    def __init__(self, origin: str, faults: Sequence[Fault]) -> None:
        told = "; ".join(fault.message for fault in faults[:_MOST_TOLD])
        more = f" (and {len(faults) - _MOST_TOLD} more)" if len(faults) > _MOST_TOLD else ""
        super().__init__(f"{origin}: {told}{more}")
        self.origin = origin
        self.faults = tuple(faults)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.origin, self.faults)
