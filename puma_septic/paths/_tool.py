"""What the tool does along a trajectory: its speed, acceleration, jerk and angular speed, and limits of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.errors import InputError
from puma_septic.kinematics import tool_derivatives
from puma_septic.limit_check import LimitCheck
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_array, checked_choice, checked_kind, checked_number

__all__ = ["TOOL", "TOOL_QUANTITIES", "ToolLimits", "ToolRates", "tool_rates"]

TOOL: Final = "tool"
"""What stands in place of a joint where the tool is held to its limits."""

# Each quantity: where its vector stands among the components, the joints' derivative that makes it unbounded, its unit.
_QUANTITIES: Final = {
    "speed": (0, 1, "m/s"),
    "acceleration": (1, 2, "m/s^2"),
    "jerk": (2, 3, "m/s^3"),
    "angular speed": (3, 1, "rad/s"),
}
TOOL_QUANTITIES: Final = tuple(_QUANTITIES)
"""What limits of the tool are of, as checks call it."""


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ToolLimits:
    """What the tool may do at most, whatever its joints may: a hand-guided cell's speed, that of a process.

    Parameters
    ----------
    speed, acceleration, jerk, angular_speed : float, optional
        Largest values allowed, positive: m/s, m/s^2, m/s^3, rad/s; at least one.
    source : str
        Where they come from.

    Raises
    ------
    InputError
        For a limit that is not positive, or none at all.

    Examples
    --------
    >>> ToolLimits(speed=0.25, source="manual reduced speed, ISO 10218-1:2011, 5.6.2").known
    {'speed': 0.25}
    """

    speed: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    angular_speed: float | None = None
    source: str = ""

    def __post_init__(self) -> None:
        checked_kind("source", self.source, str)
        if not self.known:
            raise InputError("tool limits: give one of speed, acceleration, jerk or angular_speed")
        units = {quantity.replace(" ", "_"): _QUANTITIES[quantity][2] for quantity in self.known}
        for name, unit in units.items():
            object.__setattr__(self, name, checked_number(name, getattr(self, name), unit=unit, above=0.0))

    @property
    def known(self) -> dict[str, float]:
        """The limits that are given, by quantity."""
        every = {quantity: getattr(self, quantity.replace(" ", "_")) for quantity in _QUANTITIES}
        return {quantity: limit for quantity, limit in every.items() if limit is not None}

    def within(self, share: float, *, source: str) -> ToolLimits:
        """So much of each limit, from 0 to 1, with what says so behind the source.

        Returns
        -------
        ToolLimits

        Raises
        ------
        InputError
            Where nothing of a limit is left.
        """
        left = {quantity.replace(" ", "_"): share * limit for quantity, limit in self.known.items()}
        return ToolLimits(**left, source="; ".join(filter(None, (self.source, source))))


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ToolRates:
    """The motion of the tool's origin as functions of time, in world axes.

    Attributes
    ----------
    trajectory : Trajectory
    vectors : Piecewise
        Twelve components: velocity, acceleration, jerk and angular velocity, three each.
    """

    trajectory: Trajectory
    vectors: Piecewise

    def vector(self, quantity: str) -> Piecewise:
        """The vector whose length is the quantity: "speed", "acceleration", "jerk" or "angular speed"."""
        k = _QUANTITIES[checked_choice("quantity", quantity, tuple(_QUANTITIES))][0]
        return self.vectors[3 * k : 3 * k + 3]

    def square(self, quantity: str) -> Piecewise:
        """The square of the quantity, which is smooth also where the tool rests."""
        vector = self.vector(quantity)
        return (vector * vector).combined(np.ones((3, 1)))

    def peak(self, quantity: str) -> tuple[float, float]:
        """Largest value and its instant, s; infinite at the first step of what it is the derivative of.

        Examples
        --------
        >>> import puma_septic as ps
        >>> robot = ps.load_robot()
        >>> pose = ps.forward_kinematics(robot, [0, 0.5, -2.5, 0, 0.7, 0])
        >>> path = ps.paths.line(pose, pose[:3, 3] + [0, 0.2, 0.1])
        >>> move = ps.tool_move(robot, path, ps.paths.at_speed(path, speed=0.25, acceleration=1.0))
        >>> rates = ps.paths.tool_rates(robot, move)
        >>> round(rates.peak("speed")[0], 9), rates.peak("jerk")
        (0.25, (inf, 0.0))
        """
        order = _QUANTITIES[checked_choice("quantity", quantity, tuple(_QUANTITIES))][1]
        steps = self.trajectory.unbounded(order)
        if not np.isnan(steps).all():
            return np.inf, float(np.nanmin(steps))
        extrema = self.square(quantity).extrema()
        return float(np.sqrt(extrema.max[0])), float(extrema.t_max[0])

    def needed_stretch(self, limits: ToolLimits) -> float:
        """By what factor the motion must be stretched in time at least to keep limits; infinite at a step.

        Stretched by k, the tool's speeds go down by k, its acceleration by k^2 and its jerk by k^3: it needs the
        largest of ``(peak / limit) ** (1 / order)``. Below 1 it may be quicker.

        Returns
        -------
        float
        """
        shares = [(self.peak(name)[0] / limit, _QUANTITIES[name][1]) for name, limit in limits.known.items()]
        return max(float(share ** (1 / order)) for share, order in shares)

    def shares(self, limits: ToolLimits, rates: ArrayLike) -> dict[str, Array]:
        """How much of each limit is used where the motion takes ``1 / rate`` of its time.

        Parameters
        ----------
        limits : ToolLimits
        rates : array_like, shape (n,)

        Returns
        -------
        dict of str to ndarray, shape (n,)
        """
        u = checked_array("rates", rates, (None,))
        return {name: self.peak(name)[0] / limit * u ** _QUANTITIES[name][1] for name, limit in limits.known.items()}

    def checks(self, limits: ToolLimits) -> tuple[LimitCheck, ...]:
        """The peaks held against limits, such as 0.25 m/s of a cell that is guided by hand.

        Returns
        -------
        tuple of LimitCheck
            One for each limit that is known, of the "joint" tool.
        """
        return tuple(self._check(name, limit, limits.source) for name, limit in limits.known.items())

    def _check(self, quantity: str, limit: float, source: str) -> LimitCheck:
        unit = _QUANTITIES[quantity][2]
        demand, time = self.peak(quantity)
        return LimitCheck.of_magnitude(
            joint=TOOL, quantity=quantity, demand=demand, limit=limit, unit=unit, time=time, source=source
        )


def tool_rates(robot: Robot, trajectory: Trajectory) -> ToolRates:
    """Speed, acceleration, jerk and angular speed of the tool along any trajectory, as series.

    Parameters
    ----------
    robot : Robot
    trajectory : Trajectory

    Returns
    -------
    ToolRates

    Raises
    ------
    InputError
        For a trajectory of another number of joints.
    """
    n = checked_kind("robot", robot, Robot).n_joints
    if checked_kind("trajectory", trajectory, Trajectory).n_joints != n:
        raise InputError(f"trajectory: {trajectory.n_joints} joints, {robot.name} has {n}")

    def moved(state: Array) -> Array:
        q, *rates = (state[:, k * n : (k + 1) * n].T for k in range(4))
        _, linear, angular = tool_derivatives(robot, q, rates)
        return np.concatenate([*linear, angular[0]]).T

    return ToolRates(trajectory=trajectory, vectors=trajectory.state.mapped(moved))
