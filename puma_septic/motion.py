"""Motion: a robot carrying its load along a trajectory, with torque and power as functions of time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from puma_septic.dynamics import TorqueTerms, check_inertia, coulomb_torque, smooth_terms, smooth_torque
from puma_septic.errors import InputError, PumaSepticError
from puma_septic.piecewise import Piecewise
from puma_septic.quantities import QUANTITIES
from puma_septic.robot import Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_choice

__all__ = ["Motion", "compute_motion"]

# A hundredth of what the torque is fitted to: between reversals it needs fewer coefficients than over all of them.
_NEGLIGIBLE = 1e-13


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Motion:
    """A robot on a trajectory.

    Attributes
    ----------
    robot : Robot
    trajectory : Trajectory
    torque : Piecewise
        Joint-side actuator torque in N m (N for prismatic joints). It steps where a joint reverses or comes to rest, by
        the Coulomb friction. While a joint is at rest its Coulomb term is 0: static friction is indeterminate.
    direction : Piecewise
        Which way each joint travels on each interval of ``torque.breaks``: +1, -1, or 0 at rest.
    n_evaluations : int
        How many samples of the rigid-body dynamics were computed.
    """

    robot: Robot
    trajectory: Trajectory
    torque: Piecewise
    direction: Piecewise
    n_evaluations: int

    @property
    def still(self) -> NDArray[np.bool_]:
        """Whether each joint is at rest throughout each interval of ``torque.breaks``, shape (n, n_joints)."""
        still = np.asarray(self.direction.coefficients[0] == 0)
        still.setflags(write=False)
        return still

    @property
    def power(self) -> Piecewise:
        """Mechanical joint power ``torque * velocity`` in W, positive where the actuator drives."""
        return self.torque * self.trajectory.derivative(1)

    def signal(self, quantity: str) -> Piecewise:
        """A quantity as a function of time: "position", "velocity", "acceleration", "jerk", "effort" ...

        A derivative of the torque is that of its smooth part, without the steps of the Coulomb friction: a real joint
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

    @property
    def coulomb(self) -> Piecewise:
        """The part of the torque that Coulomb friction takes, constant between the breaks of `torque`, N m (N)."""
        return self.direction.stepwise(coulomb_torque(self.robot, self.direction.coefficients[0]))

    @property
    def torque_terms(self) -> TorqueTerms[Piecewise]:
        """The torque by cause, each a Piecewise; they sum to `torque`."""
        return _split_torque(self)


def compute_motion(robot: Robot, trajectory: Trajectory) -> Motion:
    """Torque and power of a robot along a trajectory, exactly.

    The smooth part of the torque (rigid body, rotors, viscous friction, payload, wrench) is fitted by Chebyshev series
    between the trajectory's breaks, to 1e-11 of each joint's largest value; Coulomb friction is a step function that
    changes where the joint's velocity changes sign.

    Parameters
    ----------
    robot : Robot
    trajectory : Trajectory
        With as many joints as the robot has, in the robot's order.

    Raises
    ------
    InputError
        If the joints do not match, or swing so wildly that their torque cannot be resolved.
    ModelError
        If the robot description lacks inertia.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    >>> motion = ps.compute_motion(robot, move)
    >>> motion.torque(1.0).shape
    (6,)
    """
    _check_joints(robot, trajectory)
    check_inertia(robot)
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
    direction = trajectory.direction
    coulomb = direction.stepwise(coulomb_torque(robot, direction.coefficients[0]))
    torque = (smooth + coulomb).trimmed(_NEGLIGIBLE)
    return Motion(
        robot=robot,
        trajectory=trajectory,
        torque=torque,
        direction=direction.aligned_with(torque),
        n_evaluations=n_evaluations,
    )


def _check_joints(robot: Robot, trajectory: Trajectory) -> None:
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
    """Each term fitted on its own; the Coulomb term as the motion has it."""
    robot, trajectory, n = motion.robot, motion.trajectory, motion.robot.n_joints

    def terms_of(state: Array) -> Array:
        q, v, a = (state[:, k * n : (k + 1) * n] for k in range(3))
        return np.concatenate(list(smooth_terms(robot, q, v, a).values()), axis=1)

    fitted = trajectory.state.mapped(terms_of)
    names = list(smooth_terms(robot, *np.zeros((3, 1, n))))
    parts = {name: fitted[k * n : (k + 1) * n] for k, name in enumerate(names)}
    parts["coulomb"] = motion.direction.stepwise(coulomb_torque(robot, motion.direction.coefficients[0]))
    return TorqueTerms(**parts)
