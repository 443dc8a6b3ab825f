"""Motion: a robot carrying its load along a trajectory, with torque and power as functions of time."""

from __future__ import annotations

import functools
import operator
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from puma_septic.document import card, one_line
from puma_septic.dynamics import TERMS, TorqueTerms, rigid_terms, rigid_torque, smooth_torque
from puma_septic.errors import InputError, PumaSepticError
from puma_septic.friction import dry_friction_along, loss_along
from puma_septic.piecewise import Piecewise
from puma_septic.quantities import QUANTITIES
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_choice

__all__ = ["Motion", "Rest", "check_joints", "compute_motion", "joined"]

# A hundredth of what the torque is fitted to: between reversals it needs fewer coefficients than over all of them.
_NEGLIGIBLE = 1e-13


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Motion:
    """A robot on a trajectory.

    Attributes
    ----------
    robot : Robot
    trajectory : Trajectory
    torque : Piecewise
        Joint-side actuator torque in N m (N for prismatic joints). It steps where a joint reverses or comes to rest, by
        the Coulomb friction. While a joint is at rest its Coulomb term is 0: static friction is indeterminate. Of a
        joint whose torque is not known (``robot.knows_torque``) it is that of massless links, and means nothing.
    coulomb : Piecewise
        The part of the torque that dry friction takes, see `TorqueTerms`.
    direction : Piecewise
        Which way each joint travels on each interval of ``torque.breaks``: +1, -1, or 0 at rest.
    n_evaluations : int
        How many samples of the rigid-body dynamics were computed.
    parts : tuple of Motion
        Of a motion that `joined` made, the motions that it is made of, each with its own payload; else empty.
    """

    robot: Robot
    trajectory: Trajectory
    torque: Piecewise
    coulomb: Piecewise
    direction: Piecewise
    n_evaluations: int
    parts: tuple[Motion, ...] = ()

    @property
    def still(self) -> NDArray[np.bool_]:
        """Whether each joint is at rest throughout each interval of ``torque.breaks``, shape (n, n_joints)."""
        still = np.asarray(self.direction.coefficients[0] == 0)
        still.setflags(write=False)
        return still

    def rest(self, duration: float) -> Rest:
        """The rest at its last point.

        Returns
        -------
        Rest
        """
        trajectory = self.trajectory
        return Rest(robot=self.robot, q=trajectory(trajectory.breaks[-1]), duration=duration)

    @property
    def power(self) -> Piecewise:
        """Mechanical joint power ``torque * velocity`` in W, positive where the actuator drives."""
        return self.torque * self.trajectory.derivative(1)

    def signal(self, quantity: str) -> Piecewise:
        """A quantity as a function of time: "position", "velocity", "acceleration", "jerk", "effort" ...

        A derivative of the torque is that of its smooth part, without the steps of dry friction: a real joint
        passes from stiction to sliding over some travel, and where makers limit the rate it is that of a command
        without friction (libfranka, ``franka::Torques``: "without gravity and friction").

        Returns
        -------
        Piecewise

        Raises
        ------
        InputError
            For an unknown quantity.
        """
        row = QUANTITIES[checked_choice("quantity", quantity, QUANTITIES)]
        if row.signal == "position":
            return self.trajectory.derivative(row.order)
        if row.order == 0:
            return self.torque
        function = self.torque - self.coulomb
        for _ in range(row.order):
            function = function.derivative()
        return function

    @functools.cached_property
    def torque_terms(self) -> TorqueTerms[Piecewise]:
        """The torque by cause, each a Piecewise; they sum to `torque`. Kept, hence no slots."""
        if not self.parts:
            return _split_torque(self)
        terms = [part.torque_terms for part in self.parts]
        return TorqueTerms(**{name: Piecewise.sequence([getattr(one, name) for one in terms]) for name in TERMS})

    def __repr__(self) -> str:
        return one_line("Motion", self._facts())

    def _repr_html_(self) -> str:
        return card("Motion", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "robot": self.robot.name,
            "profile": self.trajectory.profile,
            "duration": f"{self.trajectory.duration:g} s",
            "payload": "none" if self.robot.payload is None else f"{self.robot.payload.mass:g} kg",
            "joints": self.robot.n_joints,
        }


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Rest:
    """A robot that holds still for a while, without the help of static friction: functions of time from 0.

    Attributes
    ----------
    robot : Robot
    q : ndarray, shape (n_joints,)
        rad (m for prismatic joints).
    duration : float
        s, above 0.
    is_braked : bool
        A brake at the motor holds the joints instead of the actuators.
    """

    robot: Robot
    q: Array
    duration: float
    is_braked: bool = False

    @property
    def holding_torque(self) -> Array:
        """What holds each joint, N m (N), shape (n_joints,): gravity, payload and wrench."""
        rest = np.zeros((1, len(self.q)))
        return np.asarray(rigid_torque(self.robot, self.q[None], rest, rest)[0])

    @property
    def position(self) -> Piecewise:
        """The posture."""
        return Piecewise.constant(self.q, self.duration)

    @property
    def load(self) -> Piecewise:
        """What the gears carry."""
        return Piecewise.constant(self.holding_torque, self.duration)

    @property
    def torque(self) -> Piecewise:
        """What the actuators do: nothing under a brake."""
        return self.load * (0.0 if self.is_braked else 1.0)


def compute_motion(robot: Robot, trajectory: Trajectory) -> Motion:
    """Torque and power of a robot along a trajectory, exactly.

    The smooth part of the torque (rigid body, rotors, viscous friction, payload, wrench) is fitted by Chebyshev series
    between the trajectory's breaks, to 1e-11 of each joint's largest value. Dry friction is added by its law: Coulomb
    friction is a step function that changes where the joint reverses or comes to rest, Stribeck friction an exponential
    of the velocity that is fitted likewise, and the losses of the gears are shares of the load between its changes of
    sign.

    Parameters
    ----------
    robot : Robot
    trajectory : Trajectory
        With as many joints as the robot has, in the robot's order.

    Returns
    -------
    Motion

    Raises
    ------
    InputError
        If the joints do not match, or swing so wildly that their torque cannot be resolved.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> motion = ps.compute_motion(robot, move)
    >>> motion.torque(1.0).shape
    (6,)
    """
    check_joints(robot, trajectory)
    n = robot.n_joints
    n_evaluations = 0

    def torque_of(state: Array) -> Array:
        nonlocal n_evaluations
        n_evaluations += len(state)
        return smooth_torque(robot, state[:, :n], state[:, n : 2 * n], state[:, 2 * n : 3 * n])

    try:
        smooth = trajectory.state.mapped(torque_of)
    except PumaSepticError as error:
        raise InputError(_why_not_resolved(robot, trajectory)) from error
    coulomb = _dry_friction(robot, trajectory, smooth)
    torque = (smooth + coulomb).trimmed(_NEGLIGIBLE)
    return Motion(
        robot=robot,
        trajectory=trajectory,
        torque=torque,
        coulomb=coulomb.aligned_with(torque),
        direction=trajectory.direction.aligned_with(torque),
        n_evaluations=n_evaluations,
    )


def joined(motions: Sequence[Motion], trajectory: Trajectory) -> Motion:
    """Motions of one arm one after the other, from time 0, along the trajectory that they make up.

    Each keeps its own payload in the torque; as a whole the robot is that of the first.

    Parameters
    ----------
    motions : sequence of Motion
    trajectory : Trajectory
        Of all of them.

    Returns
    -------
    Motion
    """
    torque = Piecewise.sequence([one.torque for one in motions])
    return Motion(
        robot=motions[0].robot,
        trajectory=trajectory,
        torque=torque,
        coulomb=Piecewise.sequence([one.coulomb for one in motions]),
        direction=Piecewise.sequence([one.direction for one in motions]),
        n_evaluations=sum(one.n_evaluations for one in motions),
        parts=tuple(motions),
    )


def _dry_friction(robot: Robot, trajectory: Trajectory, smooth: Piecewise) -> Piecewise:
    """Of the joints and their gears, which carry all of the smooth torque but viscous friction and the rotors'."""
    dry = dry_friction_along(robot.friction, trajectory.derivative(1), trajectory.direction)
    if not robot.has_losses:
        return dry
    load = smooth - trajectory.derivative(1) * robot.viscous_friction - trajectory.derivative(2) * robot.armature
    return dry + loss_along(robot.transmission, load, trajectory.direction)


def check_joints(robot: Robot, trajectory: Trajectory) -> None:
    """Raise an InputError unless the trajectory is one of this robot's joints."""
    if not (isinstance(robot, Robot) and isinstance(trajectory, Trajectory)):
        raise InputError(
            f"a robot and a trajectory are needed, got {type(robot).__name__} and {type(trajectory).__name__}"
        )
    if trajectory.n_joints != robot.n_joints:
        raise InputError(
            f"the trajectory has {trajectory.n_joints} joints, robot {robot.name!r} has {robot.n_joints}:"
            f" {', '.join(robot.joint_names)}"
        )
    if trajectory.joint_names and trajectory.joint_names != robot.joint_names:
        raise InputError(
            f"the trajectory's joints {', '.join(trajectory.joint_names)} are not those of robot {robot.name!r},"
            f" {', '.join(robot.joint_names)}, in this order"
        )


def _why_not_resolved(robot: Robot, trajectory: Trajectory) -> str:
    """What a trajectory does whose torque no series of a sensible length describes: the joint that swings most."""
    position = trajectory.extrema(0)
    j = int(np.argmax(position.max - position.min))
    unit = "m" if robot.is_prismatic[j] else "rad"
    return (
        f"the torque along this trajectory ({trajectory.profile}) cannot be resolved: joint {robot.joint_names[j]!r}"
        f" swings from {position.min[j]:.4g} to {position.max[j]:.4g} {unit} in {trajectory.duration:.4g} s; check the"
        " points and times"
    )


def _split_torque(motion: Motion) -> TorqueTerms[Piecewise]:
    """Each rigid term fitted on its own; friction as the motion has it."""
    robot, trajectory, n = motion.robot, motion.trajectory, motion.robot.n_joints

    def terms_of(state: Array) -> Array:
        q, v, a = (state[:, k * n : (k + 1) * n] for k in range(3))
        return np.concatenate(list(rigid_terms(robot, q, v, a).values()), axis=1)

    fitted = trajectory.state.mapped(terms_of)
    names = list(rigid_terms(robot, *np.zeros((3, 1, n))))
    parts = {name: fitted[k * n : (k + 1) * n] for k, name in enumerate(names)}
    viscous = trajectory.derivative(1) * robot.viscous_friction
    smooth = functools.reduce(operator.add, parts.values(), viscous)
    return TorqueTerms(**parts, viscous=viscous, coulomb=_dry_friction(robot, trajectory, smooth))
