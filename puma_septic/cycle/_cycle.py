"""Cycle: motions and rests in sequence, as an arm repeats them all day."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import final

import numpy as np
from numpy.typing import NDArray

from puma_septic.assessment import impulses
from puma_septic.cycle._steps import (
    Dwell,
    Stretch,
    check_join,
    check_steps,
    gaps,
    gravity,
    inertia,
    mass_matrices,
    moved,
    stretch,
    tool_travel,
    wrenches,
)
from puma_septic.document import card, one_line
from puma_septic.motion import Motion, compute_motion, joined
from puma_septic.piecewise import Jumps, Piecewise
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_kind, checked_list, checked_number, frozen

__all__ = ["Cycle", "way_back", "with_return"]


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Cycle:
    """A duty cycle: motions and dwells in sequence, joined in position and velocity.

    The payload changes where consecutive motions have robots with different payloads. Time begins at 0. The functions
    of time are computed when first asked for and kept (the cache needs a ``__dict__``, hence no slots).

    Parameters
    ----------
    steps : sequence of Motion or Dwell
        At least one motion; all of the same arm with the same drives.

    Raises
    ------
    InputError
        If there is no motion, the arms differ, or two steps do not join, with both ends.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> there = ps.compute_motion(robot, ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0]))
    >>> cycle = Cycle(steps=[there, Dwell(duration=1.0)])
    >>> cycle.duration, cycle.is_periodic
    (3.0, False)
    """

    steps: tuple[Motion | Dwell, ...] = field(kw_only=False)
    _stretches: tuple[Stretch, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        steps = checked_list("steps", self.steps)
        object.__setattr__(self, "steps", steps)
        check_steps(steps)
        stretches = tuple(stretch(steps, k) for k in range(len(steps)))
        for k in range(len(steps) - 1):
            check_join(stretches[k], stretches[k + 1])
        object.__setattr__(self, "_stretches", stretches)

    @property
    def robot(self) -> Robot:
        """The arm, with the payload of the first step."""
        return self._stretches[0].robot

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints, in the robot's order."""
        return self.robot.joint_names

    @cached_property
    def starts(self) -> Array:
        """Instants at which the steps begin, and the end of the last, s, shape (n_steps + 1,)."""
        return frozen(np.concatenate([[0.0], np.cumsum([step.position.duration for step in self._stretches])]))

    @property
    def duration(self) -> float:
        """s, dwells included."""
        return float(self.starts[-1])

    @cached_property
    def trajectory(self) -> Trajectory:
        """Position and its derivatives over the whole cycle; its points are the ends of the steps.

        What does not count as motion is the largest travel that does not in any step.
        """
        position = self._sequence([step.position for step in self._stretches])
        return Trajectory(
            position=position,
            points=position(self.starts),
            times=self.starts,
            profile="cycle",
            joint_names=self.joint_names,
            rest_before=_rests(self.steps[0], "before"),
            rest_after=_rests(self.steps[-1], "after"),
            resolution=np.max([step.resolution for step in self._stretches], axis=0),
        )

    @cached_property
    def motion(self) -> Motion:
        """The whole cycle as one motion, each stretch with what the arm carries there."""
        return joined([moved(self.steps, k) for k in range(len(self.steps))], self.trajectory)

    @cached_property
    def torque(self) -> Piecewise:
        """Torque of the robot's own actuators at the joint, N m (N), shape (n_joints,); 0 under a brake."""
        return self._sequence([step.torque for step in self._stretches])

    @cached_property
    def load_torque(self) -> Piecewise:
        """Torque at the joint without drives, N m (N): links, payload and wrench; no rotors, no friction."""
        return self._sequence([step.load for step in self._stretches])

    @cached_property
    def gravity_torque(self) -> Piecewise:
        """The part of `load_torque` that the arm needs at rest in the same posture, N m (N), payload included."""
        return self._sequence([gravity(step) for step in self._stretches])

    @cached_property
    def velocity_sign(self) -> Array:
        """Direction of each joint on each interval of ``load_torque.breaks``, 0 at rest, shape (n, n_joints)."""
        return frozen(np.concatenate([step.direction for step in self._stretches]))

    @cached_property
    def braked(self) -> NDArray[np.bool_]:
        """Whether a brake holds the joints on each interval of ``load_torque.breaks``, shape (n,)."""
        return frozen(np.concatenate([np.full(len(step.direction), step.braked) for step in self._stretches]))

    @cached_property
    def inertia(self) -> Piecewise:
        """Inertia that each joint moves alone, ``M_jj(q)`` without rotors, kg m^2 (kg), along the cycle."""
        return self._sequence([inertia(step) for step in self._stretches])

    @cached_property
    def joint_wrench(self) -> Piecewise:
        """Force and moment that each joint passes on to the links it carries, N and N m, shape (6 n_joints,).

        About the joint's origin, along two axes at right angles to the joint's, fixed to its links, and along it: so
        component 6 j + 5 is the load torque of a joint j that turns. Links, payload and wrench, no drives.
        """
        return self._sequence([wrenches(step) for step in self._stretches])

    @cached_property
    def mass_matrix(self) -> Piecewise:
        """``M(q)`` without rotors along the cycle, row by row, kg m^2 (kg), shape (n_joints^2,)."""
        return self._sequence([mass_matrices(step) for step in self._stretches])

    @cached_property
    def tool_jacobian(self) -> Piecewise:
        """What the tool's origin travels in world axes per travel of each joint, m, shape (3 n_joints,)."""
        return self._sequence([tool_travel(step) for step in self._stretches])

    @property
    def why_not_periodic(self) -> str:
        """The joint that differs most between start and end; empty for a cycle that returns to its start."""
        first, last = self._stretches[0], self._stretches[-1]
        differences = gaps(last, first, self.robot.is_continuous)
        if not differences:
            return ""
        return f"the cycle does not return to its start: {'; '.join(differences)}"

    @property
    def is_periodic(self) -> bool:
        """Whether the arm is at the end where it was at the start, at the same velocity."""
        return not self.why_not_periodic

    @cached_property
    def unbounded(self) -> Array:
        """When each joint's torque is first unbounded because a velocity steps, s; NaN where never. Shape (n_joints,).

        At the ends of a cycle that is not periodic, and beside a dwell, the arm is at rest.
        """
        jumps = self.trajectory.jumps(1)
        counted = np.full(len(jumps.times), True)
        if self.is_periodic:
            counted = (jumps.times > 0) & (jumps.times < self.duration)
        steps = Jumps(times=jumps.times[counted], sizes=jumps.sizes[counted])
        return frozen(impulses(self.robot, self.trajectory, steps)[0])

    @cached_property
    def rms_torque(self) -> Array:
        """Root mean square of `torque` over the whole cycle, shape (n_joints,); infinite where it is unbounded."""
        return frozen(np.where(np.isnan(self.unbounded), self.torque.rms(), np.inf))

    @cached_property
    def mean_speed(self) -> Array:
        """Mean magnitude of the velocity over the whole cycle, rad/s (m/s), shape (n_joints,)."""
        velocity = self.trajectory.derivative(1)
        velocity = velocity.split(self.load_torque.breaks)
        travel = np.diff(velocity.integral()(velocity.breaks), axis=0)
        # A joint reverses at breaks only, so that each interval's travel has one direction.
        return frozen(np.asarray(np.abs(travel).sum(axis=0) / self.duration))

    def _sequence(self, functions: Sequence[Piecewise]) -> Piecewise:
        """Functions that each begin at 0, one after the other."""
        return Piecewise.sequence(functions)

    def __repr__(self) -> str:
        return one_line("Cycle", self._facts())

    def _repr_html_(self) -> str:
        return card("Cycle", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "robot": self.robot.name,
            "steps": len(self.steps),
            "duration": f"{self.duration:g} s",
            "repeats": "yes" if self.is_periodic else "no",
        }


def _rests(step: Motion | Dwell, side: str) -> bool:
    """Whether the arm is at rest before, or after, a step."""
    return isinstance(step, Dwell) or bool(getattr(step.trajectory, f"rest_{side}"))


def with_return(motion: Motion, *, dwell: float = 0.0, robot_back: Robot | None = None) -> Cycle:
    """There and back: a motion, then the same path in reversed time.

    Parameters
    ----------
    motion : Motion
    dwell : float
        Rest at either end, without brake, s.
    robot_back : Robot, optional
        The same arm with what it carries on the way back; the motion's own by default.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> there = ps.compute_motion(robot, ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0]))
    >>> with_return(there, dwell=0.5).is_periodic
    True
    """
    rest = [Dwell(duration=dwell)] if checked_number("dwell", dwell, unit="s", at_least=0.0) else []
    return Cycle(steps=(motion, *rest, way_back(motion, robot_back), *rest))


def way_back(motion: Motion, robot: Robot | None = None) -> Motion:
    """The same path in reversed time.

    Parameters
    ----------
    motion : Motion
    robot : Robot, optional
        The same arm with what it carries on the way back; the motion's own by default.

    Returns
    -------
    Motion
    """
    trajectory = checked_kind("motion", motion, Motion).trajectory
    back = replace(
        trajectory,
        position=trajectory.position.reversed(),
        points=trajectory.points[::-1],
        times=trajectory.breaks[-1] - trajectory.times[::-1],
        profile=f"{trajectory.profile}, reversed",
        rest_before=trajectory.rest_after,
        rest_after=trajectory.rest_before,
    )
    return compute_motion(motion.robot if robot is None else robot, back)
