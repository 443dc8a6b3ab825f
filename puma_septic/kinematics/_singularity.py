"""How far an arm is from its singular postures."""

from __future__ import annotations

import numpy as np

from puma_septic.kinematics._chain import chain_to
from puma_septic.kinematics._forward import jacobian
from puma_septic.kinematics._puma_branches import SINGULARITIES, branch_values, puma_geometry
from puma_septic.robot import Robot
from puma_septic.validation import Array

__all__ = ["manipulability", "singularity_distances", "singularity_names", "singularity_zeros"]

# Far above the rounding of a measure and the residual of an inverse kinematics, far below a distance that matters.
_ZERO = 1e-9
# For a square, whose rounding is not squared.
_ZERO_SQUARE = 1e-13


def manipulability(robot: Robot, q: Array) -> Array:
    """Yoshikawa's manipulability ``sqrt(det(J J^T))`` of the joints that carry the tool; 0 at singular postures.

    J has metres and radians in it: a measure to compare postures of one arm and one tool by, not arms. With fewer than
    six joints it is ``sqrt(det(J^T J))``. Source: Yoshikawa, Manipulability of Robotic Mechanisms, International
    Journal of Robotics Research 4(2), 1985.

    Parameters
    ----------
    q : ndarray, shape (n, n_joints)

    Returns
    -------
    ndarray, shape (n,)

    Examples
    --------
    >>> import puma_septic as ps
    >>> folded, bent = manipulability(ps.load_robot("ur5"), np.array([[0.0] * 6, [0.0, -1.0, 1.0, 0.0, 1.0, 0.0]]))
    >>> bool(folded < 1e-9), round(float(bent), 4)
    (True, 0.0)
    """
    return np.asarray(np.linalg.svd(_carrying(robot, q), compute_uv=False).prod(axis=1))


def singularity_names(robot: Robot) -> tuple[str, ...]:
    """What `singularity_distances` measures for this arm.

    Returns
    -------
    tuple of str
        "shoulder", "elbow" and "wrist" for an arm with a PUMA's joints; otherwise "determinant" where six joints carry
        the tool and "manipulability" for any other number.
    """
    chain = chain_to(robot)
    if puma_geometry(chain) is not None:
        return SINGULARITIES
    return ("determinant",) if len(chain.driving) == 6 else ("manipulability",)


def singularity_distances(robot: Robot, q: Array) -> Array:
    """Measures that are zero at singular postures, smooth in q.

    For a PUMA they are signed: the wrist centre's distance in front of joint 1's axis (m), the sine of the
    angle between upper arm and forearm, and sin(q5). For other arms J is the Jacobian of the joints that carry the
    tool, as a jaw does not: with six of them ``det J``, signed; with any other number the square of Yoshikawa's
    manipulability, ``det(J J^T)``, or ``det(J^T J)`` below six, never negative.

    Parameters
    ----------
    q : ndarray, shape (n, n_joints)

    Returns
    -------
    ndarray, shape (n, len(singularity_names(robot)))
    """
    chain = chain_to(robot)
    geometry = puma_geometry(chain)
    if geometry is not None:
        return branch_values(geometry, q.T[chain.columns]).T
    j = _carrying(robot, q)
    if j.shape[2] == 6:
        return np.asarray(np.linalg.det(j)[:, None])
    square = j @ j.transpose(0, 2, 1) if j.shape[2] > 6 else j.transpose(0, 2, 1) @ j
    return np.asarray(np.linalg.det(square)[:, None])


def singularity_zeros(robot: Robot, q: Array) -> Array:
    """Magnitudes up to which the measures count as zero.

    A part of how large they can be: 1 m and 1 for a PUMA; for other arms Hadamard's bound, the product of the lengths
    of the Jacobian's rows (columns where there are fewer than six), squared for manipulability, the largest of the
    given configurations.

    Parameters
    ----------
    q : ndarray, shape (n, n_joints)

    Returns
    -------
    ndarray, shape (len(singularity_names(robot)),)
    """
    names = singularity_names(robot)
    if names == SINGULARITIES:
        return np.full(len(names), _ZERO)
    j = _carrying(robot, q)
    lengths = np.linalg.norm(j, axis=2 if j.shape[2] >= 6 else 1)
    bound = lengths.prod(axis=1).max(keepdims=True)
    return np.asarray(_ZERO * bound if names == ("determinant",) else _ZERO_SQUARE * bound**2)


def _carrying(robot: Robot, q: Array) -> Array:
    """The Jacobian's columns of the joints that carry the tool, shape (n, 6, m)."""
    return jacobian(robot, q)[:, :, chain_to(robot).driving]
