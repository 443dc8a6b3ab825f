"""Joint torques of arrays of (q, v, a): rigid body by Pinocchio, rotor inertia, friction, payload, wrench.

Torque is what the actuators must apply, at the joint side, in N m (N for prismatic joints).
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Generic, TypeVar, final

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from puma_septic.errors import InputError, ModelError
from puma_septic.friction import friction_terms, loss
from puma_septic.kinematics import checked_joint_values, forward_kinematics, jacobian
from puma_septic.robot import Robot, Wrench, inertia_matrices
from puma_septic.validation import Array, checked_flag, checked_kind, n_dimensions

__all__ = [
    "TERMS",
    "TorqueTerms",
    "acceleration_function",
    "check_inertia",
    "check_plain_friction",
    "check_uncoupled",
    "forward_dynamics",
    "inverse_dynamics",
    "joint_wrenches",
    "mass_matrix",
    "payload_torque",
    "potential_energy",
    "rigid_acceleration",
    "rigid_terms",
    "rigid_torque",
    "smooth_torque",
    "torque_terms",
]

TERMS = ("inertia", "coriolis", "gravity", "rotor", "viscous", "coulomb", "payload", "wrench")
Quantity = TypeVar("Quantity")
# A second thread saves 50 us at best and costs 100 ms on a busy machine, where it waits for its core.
_THREADS = 1


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class TorqueTerms(Generic[Quantity]):
    """Joint torque by cause; the terms sum to the whole.

    Attributes
    ----------
    inertia : ndarray, shape (n, n_joints), or Piecewise
        ``M(q) a`` of the links, rotors apart.
    coriolis : ndarray
        ``C(q, v) v``.
    gravity : ndarray
        ``g(q)``.
    rotor : ndarray
        Rotor inertia, ``rotor_inertia gear_ratio^2 a``.
    viscous : ndarray
        Friction that grows with the velocity; see `Friction`.
    coulomb : ndarray
        Dry friction: Coulomb's, what Stribeck's has more, and what the gears lose of their load.
    payload : ndarray
        All that the payload adds: weight, inertia and Coriolis.
    wrench : ndarray
        ``J^T w`` of the wrench exerted at the tool.
    """

    inertia: Quantity
    coriolis: Quantity
    gravity: Quantity
    rotor: Quantity
    viscous: Quantity
    coulomb: Quantity
    payload: Quantity
    wrench: Quantity

    @property
    def total(self) -> Quantity:
        """Their sum: what `inverse_dynamics` returns."""
        total: Quantity = functools.reduce(operator.add, (getattr(self, name) for name in TERMS))
        return total


def inverse_dynamics(robot: Robot, q: ArrayLike, v: ArrayLike, a: ArrayLike, *, friction: bool = True) -> Array:
    """Torque that moves the arm through (q, v, a), with its payload and wrench; rotor inertia always included.

    ``tau = M(q) a + C(q, v) v + g(q) + rotor a + J^T w + viscous v + coulomb(sign v)``, with the friction law of each
    drivetrain, see `Friction`, and the losses of gears whose efficiency or load share is known; the Coulomb term is
    zero at rest, where static friction can have any value within its band.

    Parameters
    ----------
    q, v, a : array_like, shape (n_joints,) or (n, n_joints)
        rad, rad/s, rad/s^2 (m ... for prismatic joints).
    friction : bool
        False leaves out all friction, and the losses of the gears.

    Returns
    -------
    ndarray, shape of `q`
        N m (N for prismatic joints), at the joint side.

    Raises
    ------
    InputError
        For misshapen or non-finite arrays.
    ModelError
        If the robot description has no inertia for a moving part.

    Examples
    --------
    >>> import puma_septic as ps
    >>> rest = [0.0] * 6
    >>> qn = [0.0, 0.7853981633974483, 3.141592653589793, 0.0, 0.7853981633974483, 0.0]
    >>> ps.inverse_dynamics(ps.load_robot(), qn, rest, rest).round(4).tolist()  # Robotics Toolbox: gravload(qn)
    [-0.0, 31.6399, 6.0351, 0.0, 0.0283, 0.0]
    """
    single, (q_, v_, a_) = _samples(robot, q, v, a)
    with_friction = checked_flag("friction", friction)
    check_inertia(robot)
    tau = rigid_torque(robot, q_, v_, a_)
    if with_friction:
        terms = _friction(robot, v_, a_, tau)
        tau = tau + terms["viscous"] + terms["coulomb"]
    return tau[0] if single else tau


def torque_terms(robot: Robot, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> TorqueTerms[Array]:
    """The torque of `inverse_dynamics`, split by cause.

    Parameters and errors are those of `inverse_dynamics`; each term has the shape of `q`.

    Returns
    -------
    TorqueTerms[ndarray]
    """
    single, (q_, v_, a_) = _samples(robot, q, v, a)
    check_inertia(robot)
    terms = rigid_terms(robot, q_, v_, a_)
    terms |= _friction(robot, v_, a_, functools.reduce(operator.add, terms.values()))
    return TorqueTerms(**{name: term[0] if single else term for name, term in terms.items()})


def smooth_torque(robot: Robot, q: Array, v: Array, a: Array) -> Array:
    """All but dry friction, for checked arrays of shape (n, n_joints): smooth wherever the motion is."""
    return np.asarray(rigid_torque(robot, q, v, a) + robot.viscous_friction * v)


def rigid_terms(robot: Robot, q: Array, v: Array, a: Array) -> dict[str, Array]:
    """The terms of `rigid_torque`, for checked arrays of shape (n, n_joints)."""
    rest = np.zeros_like(q)
    gravity = _rnea(robot, robot.bare_model, q, rest, rest)
    bias = _rnea(robot, robot.bare_model, q, v, rest)
    bare = _rnea(robot, robot.bare_model, q, v, a)
    loaded = bare if robot.payload is None else _rnea(robot, robot.model, q, v, a) - robot.armature * a
    return {
        "inertia": bare - bias,
        "coriolis": bias - gravity,
        "gravity": gravity,
        "rotor": robot.armature * a,
        "payload": loaded - bare,
        "wrench": _wrench_torque(robot, q),
    }


def payload_torque(robot: Robot, parameters: Array) -> Callable[[Array, Array, Array], Array]:
    """The torque that a payload adds, of checked q, v and a of shape (n, n_joints): linear in its ten parameters.

    Parameters
    ----------
    robot : Robot
        Whatever it carries itself is left out.
    parameters : ndarray, shape (10,)
        ``m, m c_x, m c_y, m c_z, I_xx, I_xy, I_yy, I_xz, I_yz, I_zz`` of the tool frame, the inertia about its origin;
        kg, kg m, kg m^2. Also of what is no body, such as a single one of them, but m must not be 0.

    Returns
    -------
    callable
    """
    model = robot.bare_model.copy()
    for k in range(model.njoints):
        model.inertias[k] = pin.Inertia.Zero()
    frame = model.frames[robot.tool_id]
    model.appendBodyToJoint(frame.parentJoint, pin.Inertia.FromDynamicParameters(parameters), frame.placement)
    return functools.partial(_rnea, robot, model)


def forward_dynamics(robot: Robot, q: ArrayLike, v: ArrayLike, tau: ArrayLike, *, friction: bool = True) -> Array:
    """Acceleration of the arm under joint torques: the inverse of `inverse_dynamics`.

    ``M(q) a = tau - C(q, v) v - g(q) - J^T w - friction``, by the articulated-body algorithm, with the rotors' inertia
    in M; where joints mimic others, by the composite-rigid-body algorithm and a linear solver.

    Parameters
    ----------
    q, v, tau : array_like, shape (n_joints,) or (n, n_joints)
        rad, rad/s, N m (m, m/s, N for prismatic joints).
    friction : bool
        False leaves out all friction.

    Returns
    -------
    ndarray, shape of `q`
        rad/s^2 (m/s^2).

    Raises
    ------
    InputError
        For misshapen or non-finite arrays, or gears that lose a part of their load: what they lose depends on the
        acceleration.
    ModelError
        If the robot description has no inertia for a moving part.

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> tau = ps.inverse_dynamics(robot, [0.1] * 6, [0.2] * 6, [0.3] * 6)
    >>> ps.forward_dynamics(robot, [0.1] * 6, [0.2] * 6, tau).round(9).tolist()
    [0.3, 0.3, 0.3, 0.3, 0.3, 0.3]
    """
    check_inertia(robot)
    is_single, (q, v, tau) = _samples(robot, q, v, tau, names=("q", "v", "tau"))
    if checked_flag("friction", friction):
        if robot.has_losses:
            raise InputError(
                f"forward dynamics knows no gears that lose a part of their load, as robot {robot.name!r} has; leave"
                " the friction out: friction=False"
            )
        tau = tau - sum(friction_terms(robot.friction, v, np.sign(v)).values())
    a = rigid_acceleration(robot, q, v, tau)
    return a[0] if is_single else a


def rigid_acceleration(robot: Robot, q: Array, v: Array, tau: Array) -> Array:
    """The same without friction, for checked arrays of shape (n, n_joints)."""
    if robot.mimics:
        bias = rigid_torque(robot, q, v, np.zeros_like(q))
        return np.asarray(np.linalg.solve(mass_matrix(robot, q), (tau - bias)[..., None])[..., 0])
    if robot.wrench is not None:
        tau = tau - _wrench_torque(robot, q)
    a = np.empty((len(q), robot.model.nv))
    arrays = (robot.configurations(q), robot.tangents(v), robot.tangents(tau), a)
    pin.abaInParallel(_THREADS, _pool(robot.model), *(array.T for array in arrays))
    return robot.from_tangents(a)


def acceleration_function(robot: Robot) -> Callable[[Array, Array, Array], Array]:
    """`rigid_acceleration` of one robot with as little as possible left to do at each call: a simulation makes many.

    Returns
    -------
    callable
        Of position, velocity and torque of shape (n, n_joints).
    """
    if robot.mimics or robot.wrench is not None or not robot.is_plain:
        return functools.partial(rigid_acceleration, robot)
    model, data, pool = robot.model, robot.model.createData(), _pool(robot.model)
    one, many = pin.aba, pin.abaInParallel

    def acceleration(q: Array, v: Array, tau: Array) -> Array:
        if len(q) == 1:
            return np.asarray(one(model, data, q[0], v[0], tau[0]))[None]
        a = np.empty_like(q)
        many(_THREADS, pool, q.T, v.T, tau.T, a.T)
        return a

    return acceleration


def mass_matrix(robot: Robot, q: Array) -> Array:
    """Joint-space inertia ``M(q)``, rotors and payload included, shape (n, n_joints, n_joints), for a checked q.

    kg m^2 between revolute joints, kg between prismatic ones; see `inertia_matrices`.
    """
    full = inertia_matrices(robot.model, list(robot.configurations(q)), mimics=bool(robot.mimics))
    return np.array([robot.from_tangents(robot.from_tangents(matrix).T) for matrix in full])


def potential_energy(robot: Robot, q: Array) -> Array:
    """Of gravity on links and payload, J, shape (n,), for a checked q."""
    data = robot.model.createData()
    return np.array([pin.computePotentialEnergy(robot.model, data, row) for row in robot.configurations(q)])


def joint_wrenches(robot: Robot, q: Array, v: Array, a: Array) -> Array:
    """What each joint passes on to the links that it carries: force and moment about the joint's origin.

    The whole wrench of Newton and Euler, of which the joint's torque is the last component (or its force the third);
    links, payload and wrench, no rotors and no friction.

    Parameters
    ----------
    q, v, a : ndarray, shape (n, n_joints)
        Checked.

    Returns
    -------
    ndarray, shape (n, n_joints, 6)
        N and N m, along two axes at right angles to the joint's, fixed to its links, and along it.
    """
    model = robot.model
    data, ids = model.createData(), [model.getJointId(name) for name in robot.joint_names]
    axes = [_axes(model.joints[i]) for i in ids]
    outer = [pin.Force.Zero() for _ in range(model.njoints)]
    found = np.zeros((len(q), len(ids), 6))
    for k, (q_, v_, a_) in enumerate(zip(robot.configurations(q), robot.tangents(v), robot.tangents(a), strict=True)):
        if robot.wrench is not None:
            pin.forwardKinematics(model, data, q_)
            _push(robot, robot.wrench, data, outer)
        pin.rnea(model, data, q_, v_, a_, outer)
        for j, i in enumerate(ids):
            found[k, j, :3], found[k, j, 3:] = axes[j] @ data.f[i].linear, axes[j] @ data.f[i].angular
    return found


def _push(robot: Robot, wrench: Wrench, data: Any, outer: list[Any]) -> None:
    """Write what the world does to the tool, against the tool's wrench, to the joint that carries the tool."""
    frame = robot.model.frames[robot.tool_id]
    turn = frame.placement.rotation if wrench.axes == "tool" else data.oMi[frame.parentJoint].rotation.T
    at_tool = pin.Force(-(turn @ wrench.force), -(turn @ wrench.torque))
    outer[frame.parentJoint] = pin.SE3(np.eye(3), frame.placement.translation).act(at_tool)


def _axes(joint: Any) -> Array:
    """Rows: two axes at right angles to the joint's own, and that one."""
    screw = np.asarray(joint.createData().S, dtype=np.float64).reshape(6, -1)[:, 0]
    axis = screw[3:] if screw[3:].any() else screw[:3]
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    return np.array([first, np.cross(axis, first), axis])


def check_inertia(robot: Robot) -> None:
    """Raise a ModelError if the torque of a joint is not known: it would silently be zero."""
    if checked_kind("robot", robot, Robot).missing_inertia:
        joints = ", ".join(map(repr, robot.missing_inertia))
        raise ModelError(
            f"robot {robot.name!r}: no mass or inertia beyond joint {joints}; every torque is needed here, so give an"
            " <inertial> in the URDF for every moving part, or mass, com and inertia of its link in an actuator file"
        )


def check_uncoupled(robot: Robot, what: str) -> None:
    """Raise an InputError if a joint mimics another, for what takes each joint to move its own links alone."""
    if robot.mimics:
        names = ", ".join(map(repr, robot.mimics))
        raise InputError(
            f"{what} does not know joints that mimic another one: {names} of robot {robot.name!r}; lock those of a"
            " gripper: locked='others'"
        )


def check_plain_friction(robot: Robot, what: str) -> None:
    """Raise an InputError unless friction is viscous plus constant, as what scales a motion in time takes it to be."""
    joints = [
        name
        for name, law, factors in zip(robot.joint_names, robot.friction, robot.transmission, strict=True)
        if not law.is_linear or (factors != 1).any()
    ]
    if joints:
        raise InputError(
            f"{what} knows viscous and Coulomb friction alone; {', '.join(map(repr, joints))} of robot"
            f" {robot.name!r} has Stribeck friction, or gears that lose a part of their load"
        )


def _samples(robot: Robot, *values: ArrayLike, names: Sequence[str] = ("q", "v", "a")) -> tuple[bool, list[Array]]:
    arrays = [checked_joint_values(robot, name, value) for name, value in zip(names, values, strict=True)]
    q = values[0]
    if len({np.shape(value) for value in values}) != 1:
        from_shapes = ", ".join(str(np.shape(value)) for value in values)
        raise InputError(f"{', '.join(names[:-1])} and {names[-1]} must have one shape, got {from_shapes}")
    return n_dimensions(q) == 1, arrays


def _friction(robot: Robot, v: Array, a: Array, rigid: Array) -> dict[str, Array]:
    """Friction by cause; the gears carry all of the rigid-body torque but the rotors'."""
    terms = friction_terms(robot.friction, v, np.sign(v))
    if robot.has_losses:
        terms["coulomb"] = terms["coulomb"] + loss(robot.transmission, rigid - robot.armature * a, v)
    return terms


def rigid_torque(robot: Robot, q: Array, v: Array, a: Array) -> Array:
    """All but friction, for checked arrays of shape (n, n_joints)."""
    tau = _rnea(robot, robot.model, q, v, a)
    return tau if robot.wrench is None else tau + _wrench_torque(robot, q)


def _rnea(robot: Robot, model: pin.Model, q: Array, v: Array, a: Array) -> Array:
    """Pinocchio's recursive Newton-Euler over all samples in one call."""
    # The transpose of a C-ordered (n, nv) array is the Fortran-ordered (nv, n) that Pinocchio wants.
    tau = np.empty((len(q), model.nv))
    arrays = (robot.configurations(q), robot.tangents(v), robot.tangents(a), tau)
    pin.rneaInParallel(_THREADS, _pool(model), *(array.T for array in arrays))
    return robot.from_tangents(tau)


@lru_cache(maxsize=16)
def _pool(model: Any) -> Any:
    """Working memory for a model; making it anew costs as much as a hundred samples."""
    return pin.ModelPool(model, _THREADS)


def _wrench_torque(robot: Robot, q: Array) -> Array:
    """``J^T w`` of the wrench that the tool exerts on the world."""
    if robot.wrench is None:
        return np.zeros_like(q)
    force = np.broadcast_to(robot.wrench.force, (len(q), 3))
    torque = np.broadcast_to(robot.wrench.torque, (len(q), 3))
    if robot.wrench.axes == "tool":
        rotation = forward_kinematics(robot, q)[:, :3, :3]
        force, torque = rotation @ robot.wrench.force, rotation @ robot.wrench.torque
    return np.asarray(np.einsum("nij,ni->nj", jacobian(robot, q), np.concatenate([force, torque], axis=1)))
