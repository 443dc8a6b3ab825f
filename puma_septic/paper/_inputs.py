"""What the paper prints: the task, its tables, and what its text says of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.errors import InputError
from puma_septic.kinematics import CONFIGURATIONS
from puma_septic.validation import Array, checked_array, checked_choice, checked_times, store_needed

__all__ = ["PAPER", "POINTS", "PaperInputs"]

POINTS: Final = ("take", "lift", "unload", "place")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PaperInputs:
    """The paper's task as printed; what it does not state is None.

    Parameters
    ----------
    text_points : array_like, shape (4, 3)
        Take, lift, unload and place as the text has them (section 4.1), m, in the toolbox's base, which stands
        at shoulder height.
    points : array_like, shape (4, 3)
        The points that the paper's Table 1 was computed from.
    table_1 : array_like, shape (4, 6)
        Joint angles of the four points, rad.
    table_2 : array_like, shape (8, 6)
        Coefficients of the septic, ascending powers of t.
    times : array_like, shape (4,)
        When each point is reached (section 3.2, step iii), s.
    configuration : str
        What the text calls the posture, in this package's words (section 4.1).
    blend_time : float
        Length of an interior blend of LSPB (``tacc`` of ``mstraj``), s; the paper does not state it.
    septic_seconds, lspb_seconds : float
        Computing times of Figures 7 and 6, s.
    velocity_limit, acceleration_limit : float or None
        The constraints that section 3.1 says are not violated, rad/s and rad/s^2.
    tracking_errors : tuple of float, or None
        Of the septic and of LSPB, rad.
    """

    text_points: Array
    points: Array
    table_1: Array
    table_2: Array
    times: Array
    configuration: str
    blend_time: float
    septic_seconds: float
    lspb_seconds: float
    velocity_limit: float | None = None
    acceleration_limit: float | None = None
    tracking_errors: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        shapes = {"text_points": (4, 3), "points": (4, 3), "table_1": (4, 6), "table_2": (8, 6)}
        for name, shape in shapes.items():
            object.__setattr__(self, name, checked_array(name, getattr(self, name), shape))
        times = checked_times("times", self.times, 4)
        if times[0] != 0:
            raise InputError(f"times: the motion starts at 0 s, not at {times[0]:g} s")
        object.__setattr__(self, "times", times)
        checked_choice("configuration", self.configuration, CONFIGURATIONS)
        store_needed(self, {"blend_time": "s"}, at_least=0.0)
        store_needed(self, {"septic_seconds": "s", "lspb_seconds": "s"}, above=0.0)
        stated = [name for name in ("velocity_limit", "acceleration_limit") if getattr(self, name) is not None]
        store_needed(self, dict.fromkeys(stated, ""), above=0.0)
        if self.tracking_errors is not None:
            errors = checked_array("tracking_errors", self.tracking_errors, (2,), unit="rad")
            object.__setattr__(self, "tracking_errors", errors)


# Raji, Asaolu and Akano, Joint Space Robot Arm Trajectory Planning Using Septic Function.
PAPER: Final = PaperInputs(
    text_points=np.array([[-0.5, 0.5, -0.5], [-0.5, 0.5, 0.3], [0.5, -0.5, -0.3], [0.5, -0.5, -0.5]]),  # section 4.1
    points=np.array([[-0.5, 0.5, -0.5], [-0.5, 0.5, 0.3], [0.5, -0.5, 0.3], [0.5, -0.5, -0.5]]),  # found, see claim 1
    table_1=np.array(
        [
            [2.57, -0.7873, -1.2022, -3.1416, -1.9895, 0.5716],
            [2.57, -0.1026, -0.5, -3.1416, -0.6026, 0.5716],
            [-0.5716, -0.1026, -0.5, -3.1416, -0.6026, -2.57],
            [-0.5716, -0.7873, -1.2022, -3.1416, -1.9895, -2.57],
        ]
    ),
    table_2=np.array(
        [
            [2.57, -0.7873, -1.2022, -3.1416, -1.9895, 0.5716],
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0938, 0.2301, 0.2359, 0.0, 0.4660, 0.0938],
            [-0.0750, -0.1008, -0.1033, 0.0, -0.2041, -0.0750],
            [0.0169, 0.0165, 0.0170, 0.0, 0.0335, 0.0169],
            [-0.0015, -0.0012, -0.0012, 0.0, -0.0024, -0.0015],
            [0.0001, 0.0, 0.0, 0.0, 0.0001, 0.0001],
        ]
    ),
    times=np.array([0.0, 2.0, 6.0, 9.0]),  # segments of 2, 4 and 3 s: section 3.2, step iii
    configuration="left-down-flip",  # section 4.1: "left arm, elbow down, wrist flip (rotate 180 degrees)"
    blend_time=1.0,  # not stated; mstraj has no default, and 1 s is half the shortest segment
    septic_seconds=0.325196,  # Figure 7
    lspb_seconds=0.380144,  # Figure 6
)
