"""Elastic gears: a spring and a damper between each motor and its link."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.document import card, one_line
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_array, checked_kind, checked_number
from puma_septic.vibration import stiffness_for

__all__ = ["ElasticJoints"]

ASSUMED: Final = "assumed: no maker's value"


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ElasticJoints:
    """Stiffness and damping of the gears, both at the joint: Spong's model of elastic joints.

    ``torque on the link = stiffness (motor - link) + damping (motor' - link')``, with the motor's angle over the gear
    ratio; its rotor inertia and its friction stay on the motor's side of the spring (Spong, "Modeling and control of
    elastic joint robots", J. Dyn. Sys., Meas., Control 109 (4), 1987, pp. 310-318; the rotor spins about its axis
    alone).

    Parameters
    ----------
    stiffness : array_like, shape (n_joints,)
        N m/rad (N/m), above 0.
    damping : array_like, shape (n_joints,)
        N m s/rad (N s/m), at least 0.
    source : str
        Where the values come from; hardly any maker publishes them.

    Raises
    ------
    InputError
        For values out of range.

    Examples
    --------
    >>> ElasticJoints(stiffness=[2e4], damping=[10.0]).source
    "assumed: no maker's value"
    """

    stiffness: Array
    damping: Array
    source: str = ASSUMED

    def __post_init__(self) -> None:
        checked_kind("source", self.source, str)
        remedy = "; rigid gears need no ElasticJoints"
        stiffness = checked_array("stiffness", self.stiffness, (None,), unit="N m/rad", above=0.0, remedy=remedy)
        damping = checked_array("damping", self.damping, (len(stiffness),), unit="N m s/rad", at_least=0.0)
        object.__setattr__(self, "stiffness", stiffness)
        object.__setattr__(self, "damping", damping)

    def __repr__(self) -> str:
        return one_line("ElasticJoints", self._facts())

    def _repr_html_(self) -> str:
        return card("ElasticJoints", self._facts())

    def _facts(self) -> dict[str, object]:
        stiffness = ", ".join(f"{value:.3g}" for value in self.stiffness)
        return {"joints": len(self.stiffness), "stiffness": f"{stiffness} N m/rad", "source": self.source}

    @classmethod
    def of_frequency(
        cls, robot: Robot, q: ArrayLike, frequency: ArrayLike, *, damping_ratio: float = 0.02
    ) -> ElasticJoints:
        """The gears with which each joint's links alone, all motors held, swing at a frequency in a posture.

        ``stiffness = (2 pi frequency)^2 m`` and ``damping = 2 damping_ratio 2 pi frequency m``, with the links' inertia
        m about the joint; see `puma_septic.vibration.stiffness_for`.

        Parameters
        ----------
        robot : Robot
        q : array_like, shape (n_joints,)
            The posture, rad (m for prismatic joints).
        frequency : array_like, shape () or (n_joints,)
            Hz. Structures of industrial arms swing at 5 to 25 Hz (Craig, "Introduction to Robotics", 3rd ed., 2005,
            chapter 9).
        damping_ratio : float
            Of each joint alone, at least 0.

        Returns
        -------
        ElasticJoints

        Raises
        ------
        InputError
            For a frequency that is not positive, or a joint that moves no inertia.
        """
        ratio = checked_number("damping_ratio", damping_ratio, at_least=0.0)
        stiffness = stiffness_for(robot, q, frequency)
        omega = 2 * np.pi * np.broadcast_to(np.asarray(frequency, dtype=np.float64), (robot.n_joints,))
        return cls(stiffness=stiffness, damping=2 * ratio * stiffness / omega, source=ASSUMED)
