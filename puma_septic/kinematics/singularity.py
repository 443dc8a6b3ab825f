"""How far an arm is from its singular postures."""

from __future__ import annotations

import numpy as np

from puma_septic.checks import Array
from puma_septic.kinematics.chain import chain_to
from puma_septic.kinematics.forward import jacobian
from puma_septic.kinematics.puma import SINGULARITIES, branch_values, puma_geometry
from puma_septic.robot import Robot

__all__ = ["singularity_distances", "singularity_names", "singularity_zeros"]

# Far above the rounding of a measure and the residual of an inverse kinematics, far below a distance that matters.
_ZERO = 1e-9
# For a square, whose rounding is not squared.
_ZERO_SQUARE = 1e-13


def singularity_names(robot: Robot) -> tuple[str, ...]:
    """What `singularity_distances` measures for this arm.

    "shoulder", "elbow" and "wrist" for an arm with a PUMA's joints; otherwise "determinant" for six joints
    and "manipulability" for any other number.
    """
    if puma_geometry(chain_to(robot)) is not None:
        return SINGULARITIES
    return ("determinant",) if robot.n_joints == 6 else ("manipulability",)


def singularity_distances(robot: Robot, q: Array) -> Array:
    """Measures that are zero at singular postures, shape (n, len(singularity_names(robot))), smooth in q.

    For a PUMA they are signed: the wrist centre's distance in front of joint 1's axis (m), the sine of the
    angle between upper arm and forearm, and sin(q5). For other arms with six joints ``det J``, signed; for
    any other number of joints the square of Yoshikawa's manipulability, ``det(J J^T)``, or ``det(J^T J)``
    below six, never negative.

    Parameters
    ----------
    q : ndarray, shape (n, n_joints)
    """
    chain = chain_to(robot)
    geometry = puma_geometry(chain)
    if geometry is not None:
        return branch_values(geometry, q.T[chain.columns]).T
    j = jacobian(robot, q)
    if robot.n_joints == 6:
        return np.asarray(np.linalg.det(j)[:, None])
    square = j @ j.transpose(0, 2, 1) if robot.n_joints > 6 else j.transpose(0, 2, 1) @ j
    return np.asarray(np.linalg.det(square)[:, None])


def singularity_zeros(robot: Robot, q: Array) -> Array:
    """Magnitudes up to which the measures count as zero, shape (len(singularity_names(robot)),).

    A part of how large they can be: 1 m and 1 for a PUMA; for other arms Hadamard's bound, the product of the lengths
    of the Jacobian's rows (columns where there are fewer than six), squared for manipulability, the largest of the
    given configurations, shape (n, n_joints).
    """
    names = singularity_names(robot)
    if names == SINGULARITIES:
        return np.full(len(names), _ZERO)
    lengths = np.linalg.norm(jacobian(robot, q), axis=2 if robot.n_joints >= 6 else 1)
    bound = lengths.prod(axis=1).max(keepdims=True)
    return np.asarray(_ZERO * bound if names == ("determinant",) else _ZERO_SQUARE * bound**2)
