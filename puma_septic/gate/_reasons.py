"""Reasons of a verdict, by codes that do not change."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from puma_septic.document import plain
from puma_septic.errors import InputError
from puma_septic.quantities import MAGNITUDES, QUANTITIES
from puma_septic.validation import checked_choice, checked_texts

__all__ = [
    "ALLOWABLE",
    "DRIVE_VALUES",
    "REASON_CODES",
    "VERDICTS",
    "Reason",
    "checked_allowances",
    "verdict_of",
]

VERDICTS: Final = ("ok", "undecided", "violated", "invalid")
"""From good to bad; the verdict of several is the last that occurs."""

# What a step of a lower derivative makes infinite.
_UNBOUNDED: Final = tuple(f"unbounded_{name}" for name in MAGNITUDES if name != "velocity")
_VIOLATED: Final = {
    **{f"{name}_limit": f"the {row.label} of a joint exceeds its limit" for name, row in QUANTITIES.items()},
    **dict.fromkeys(_UNBOUNDED, "a step of a derivative of the motion makes it infinite"),
    "position_limit": "a joint leaves its range",
    "velocity_limit": "a joint is faster than its limit",
    "acceleration_limit": "an acceleration exceeds its limit",
    "jerk_limit": "a jerk exceeds its limit",
    "effort_limit": "an actuator torque or force exceeds its limit",
    "unbounded_acceleration": "the velocity steps, as it does between straight lines",
    "unbounded_jerk": "the acceleration steps and the joint has a jerk limit",
    "unbounded_effort": "a step of velocity, of this joint or one coupled to it, needs an infinite torque",
    "start_mismatch": "the first point is farther from the start state than the tolerance",
    "tool_limit": "the tool exceeds what it may do in its cell",
    "below_floor": "a joint or the tool comes below the floor",
    "moving_start": "the motion begins with a velocity, from rest",
    "moving_end": "the motion ends with a velocity; the controller refuses that by default",
}
_UNDECIDED: Final = {
    "limit_unknown": "the robot has no such limit for a joint",
    "drive_unknown": "rotor inertia or friction of a joint is not known, so its torque is more than what is computed",
    "doubtful": "the motion itself is in doubt, by the noise or the units of a recording",
    "torque_unknown": "the torque cannot be computed: the robot lacks inertia",
}
_INVALID: Final = {
    "unresolvable": "the motion swings so wildly that its torque cannot be computed",
    "setup_invalid": "the robot, its actuator file or the start state cannot be read",
}
REASON_CODES: Final = {**_VIOLATED, **_UNDECIDED, **_INVALID}
"""What each code of a reason means; those of files that cannot be read are in `puma_septic.ros.FAULT_CODES`."""

ALLOWABLE: Final = (
    "limit_unknown", "drive_unknown", "torque_unknown", "doubtful", *_UNBOUNDED, "moving_start", "moving_end",
)  # fmt: skip
"""Codes that the caller may allow: what is not known, and what a real drive smooths."""

DRIVE_VALUES: Final = ("rotor_inertia", "viscous_friction", "coulomb_friction")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Reason:
    """Why a trajectory is not simply ok.

    Attributes
    ----------
    code : str
        A key of `REASON_CODES`, or of `puma_septic.ros.FAULT_CODES`.
    message : str
    allowed : bool
        Whether the caller allows it: it is told, and does not count.
    joint, quantity : str or None
        Whose, and of what: a limit's quantity, or the drive value that is not known.
    time : float
        Instant, s; NaN where it has none.
    demand, limit : float
        In `unit`; NaN where there is none.
    unit : str
    """

    code: str
    message: str
    allowed: bool = False
    joint: str | None = None
    quantity: str | None = None
    time: float = np.nan
    demand: float = np.nan
    limit: float = np.nan
    unit: str = ""

    @property
    def verdict(self) -> str:
        """What it makes of the trajectory, were it not allowed."""
        return "violated" if self.code in _VIOLATED else "undecided" if self.code in _UNDECIDED else "invalid"

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready, with its verdict; null for what it does not have.

        Returns
        -------
        dict
        """
        return {
            "code": self.code,
            "verdict": self.verdict,
            "allowed": self.allowed,
            "joint": self.joint,
            "quantity": self.quantity,
            **{key: plain(getattr(self, key)) for key in ("time", "demand", "limit")},
            "unit": self.unit or None,
            "message": self.message,
        }

    def __str__(self) -> str:
        return f"{self.code}: {self.message}{' (allowed)' if self.allowed else ''}"


def verdict_of(reasons: Iterable[Reason]) -> str:
    """The verdict that reasons add up to: "ok" where none counts."""
    return max((reason.verdict for reason in reasons if not reason.allowed), key=VERDICTS.index, default="ok")


def checked_allowances(allow: Iterable[str], quantities: tuple[str, ...]) -> frozenset[str]:
    """Reasons to allow, refused where they cannot be: a misspelt word would be found out by a verdict, if at all.

    Returns
    -------
    frozenset of str

    Raises
    ------
    InputError
        For what is no reason that can be allowed, with the valid ones.
    """
    if isinstance(allow, str):
        raise InputError(f"allow: expected a list of reasons, got the text {allow!r}; write [{allow!r}]")
    allow = checked_texts("allow", allow)
    allowed = frozenset(allow)
    for word in allowed:
        code, colon, quantity = word.partition(":")
        checked_choice("reason to allow", code, ALLOWABLE)
        if colon:
            valid = {"limit_unknown": quantities, "drive_unknown": DRIVE_VALUES}.get(code, ())
            if quantity not in valid:
                told = f"; valid: {', '.join(f'{code}:{one}' for one in valid)}" if valid else ", without a colon"
                raise InputError(f"reason to allow {word!r}: {code} has no {quantity!r}{told}")
    return allowed
