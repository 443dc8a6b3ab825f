"""Natural frequencies of an arm whose gears give: from its inertia along a motion and the stiffness of its joints."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from puma_septic.dynamics import check_inertia, mass_matrix
from puma_septic.errors import InputError
from puma_septic.kinematics import checked_joint_values
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_array, checked_each, checked_kind, n_dimensions, read_only

__all__ = ["checked_stiffness", "link_inertia", "natural_frequencies", "stiffness_for"]

# Of this ratio three digits are left of the frequency of a stiff joint that moves a ten-thousandth of the inertia.
_APART: Final = 1e8


def natural_frequencies(robot: Robot, q: ArrayLike, stiffness: ArrayLike) -> Array:
    """Natural frequencies of the links on the springs of their joints, the motors held still.

    Roots of ``det(K - w^2 (M(q) - rotors)) = 0`` with the joint-space inertia M of links and payload: the vibration of
    an arm whose motors hold their positions, the lowest of which an input shaper is made for.

    Parameters
    ----------
    q : array_like, shape (n_joints,) or (n, n_joints)
        Postures, such as ``trajectory(times)``, rad (m for prismatic joints).
    stiffness : array_like, shape () or (n_joints,)
        Of each joint, N m/rad (N/m), above 0. Hardly any maker publishes it: take it for an assumption.

    Returns
    -------
    ndarray, shape (n_joints,) or (n, n_joints)
        Hz, increasing.

    Raises
    ------
    InputError
        For a stiffness that is not positive.
    ModelError
        If the robot description has no inertia for a moving part.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> soft = natural_frequencies(robot, [0.0] * 6, 1e4)
    >>> stiff = natural_frequencies(robot, [0.0] * 6, 4e4)
    >>> bool(abs(stiff / soft - 2).max() < 1e-12)
    True
    """
    values = checked_joint_values(robot, "q", q)
    springs = checked_stiffness(robot, stiffness)
    if springs.max() > _APART * springs.min():
        raise InputError(
            f"stiffness: {springs.min():g} and {springs.max():g} N m/rad are more than {_APART:g} times apart; the"
            " frequencies of the stiffest joints would be lost in rounding"
        )
    compliance = 1 / np.sqrt(springs)
    scaled = link_inertia(robot, values) * np.multiply.outer(compliance, compliance)
    squares = np.linalg.eigvalsh(scaled)[:, ::-1]
    # Links of no inertia about a joint do not swing: rounding about 0 is one.
    tiny = np.finfo(np.float64).eps * len(compliance) * squares[:, :1]
    hertz = np.where(squares > tiny, 1 / np.sqrt(np.maximum(squares, tiny)), np.inf) / (2 * np.pi)
    return hertz[0] if n_dimensions(q) == 1 else hertz


def stiffness_for(robot: Robot, q: ArrayLike, frequency: ArrayLike) -> Array:
    """The stiffness with which each joint's links alone, all others held, swing at a frequency.

    ``K_j = (2 pi frequency)^2 (M_jj(q) - rotor_j)``: an assumption, where the stiffness is not known.

    Parameters
    ----------
    q : array_like, shape (n_joints,)
        The posture, rad (m for prismatic joints).
    frequency : array_like, shape () or (n_joints,)
        Hz.

    Returns
    -------
    ndarray, shape (n_joints,)
        N m/rad (N/m).

    Raises
    ------
    InputError
        For a frequency that is not positive, or a joint whose links have no inertia about it.
    ModelError
        If the robot description has no inertia for a moving part.
    """
    n = checked_kind("robot", robot, Robot).n_joints
    hertz = checked_each("frequency", frequency, n, unit="Hz", above=0.0)
    inertia = np.diagonal(link_inertia(robot, checked_array("q", q, (n,))[None])[0])
    if not (inertia > 0).all():
        j = int(np.argmin(inertia))
        raise InputError(f"joint {robot.joint_names[j]!r} moves no inertia in this posture: no stiffness swings it")
    return np.asarray((2 * np.pi * hertz) ** 2 * inertia)


def link_inertia(robot: Robot, q: Array) -> Array:
    """Joint-space inertia of links and payload without the rotors, shape (n, n_joints, n_joints), for a checked q."""
    check_inertia(robot)
    return np.asarray(mass_matrix(robot, q) - np.diag(robot.armature))


def checked_stiffness(robot: Robot, stiffness: ArrayLike) -> Array:
    """Stiffness of each joint, shape (n_joints,), above 0."""
    labels = [f"joint {name!r}" for name in robot.joint_names]
    remedy = "; a joint without elastic gears is rigid: leave the elasticity out"
    rules = {"unit": "N m/rad", "labels": labels, "above": 0.0, "remedy": remedy}
    return read_only(checked_each("stiffness", stiffness, robot.n_joints, **rules))
