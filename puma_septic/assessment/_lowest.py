"""How low an arm comes along a motion: the lowest of its joints and its tool."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Final, final

import numpy as np

from puma_septic.document import plain
from puma_septic.kinematics import height_parts, heights
from puma_septic.limit_check import LimitCheck
from puma_septic.motion import Motion
from puma_septic.piecewise import Piecewise

__all__ = ["LowestPoint", "height_series", "lowest_point"]

# m; parts that come this near to the lowest come as low.
_SAME: Final = 1e-9


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class LowestPoint:
    """Where an arm is lowest along a motion.

    What counts are the origins of the joints that carry the tool, but for the first, and the tool frame; links are
    thicker.

    Attributes
    ----------
    height : float
        Above the world's origin, where the arm stands, against gravity (along z without gravity), m.
    time : float
        When, s.
    part : str
        The joint, or the tool frame.
    """

    height: float
    time: float
    part: str

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready.

        Returns
        -------
        dict
        """
        return {field.name: plain(getattr(self, field.name)) for field in fields(self)}

    def check(self, floor: float) -> LimitCheck:
        """The height checked against a floor.

        Returns
        -------
        LimitCheck
        """
        return LimitCheck.of_height(part=self.part, height=self.height, floor=floor, time=self.time)


def height_series(motion: Motion) -> Piecewise:
    """Heights of `height_parts` as functions of time, m: to rounding, as each is smooth in the joint positions."""
    robot = motion.robot
    return motion.trajectory.derivative(0).mapped(lambda q: heights(robot, q))


def lowest_point(motion: Motion) -> LowestPoint:
    """The least of the minima of all parts' series; of parts that come as low, the first one."""
    extrema = height_series(motion).extrema()
    k = int(np.argmax(extrema.min <= extrema.min.min() + _SAME))
    return LowestPoint(height=float(extrema.min[k]), time=float(extrema.t_min[k]), part=height_parts(motion.robot)[k])
