"""The joints between world and a frame, and the chain product over them for many configurations at once.

Frames are held as ``(4, 3, n)``: the images of the frame's x, y and z axes and its origin, each a vector in
world coordinates for n configurations. One joint then costs one small matrix product over everything.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, final

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from puma_septic.errors import InputError, ModelError
from puma_septic.robot import Robot
from puma_septic.validation import Array, checked_array, checked_choice, checked_kind, n_dimensions, numbers, read_only

__all__ = ["Chain", "chain_to", "checked_joint_values", "cross", "end_frame", "frames"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Chain:
    """The moving joints that carry a frame, each made to act about or along its own z axis.

    Attributes
    ----------
    columns : ndarray of int, shape (m,)
        Where each joint's value stands in `q`, that of a joint that mimics another where the other's stands; a joint on
        another branch of the tree is absent.
    factors : tuple of float, length m
        What the value is multiplied by: 1 but for joints that mimic another.
    prismatic : tuple of bool, length m
    placements : ndarray, shape (m, 4, 4)
        From each joint's parent joint (the world for the first) to the joint at zero.
    end : ndarray, shape (4, 4)
        From the last joint to the frame.
    """

    columns: NDArray[np.int64]
    factors: tuple[float, ...]
    prismatic: tuple[bool, ...]
    placements: Array
    end: Array

    @property
    def is_coupled(self) -> bool:
        """Whether a joint mimics another one."""
        return any(factor != 1.0 for factor in self.factors) or len(self.driving) < len(self.columns)

    @property
    def driving(self) -> NDArray[np.int64]:
        """Where the values that move the frame stand in `q`, each once."""
        return np.array(list(dict.fromkeys(self.columns.tolist())), dtype=np.int64)


@lru_cache(maxsize=32)
def chain_to(robot: Robot, frame: str | None = None) -> Chain:
    """Read the chain of a named frame (the robot's tool by default) from the model.

    A robot never changes, so the answer is kept: for one configuration reading costs as much as computing.

    Raises
    ------
    InputError
        For an unknown frame; the message lists the valid ones.
    ModelError
        For a joint with more than one degree of freedom, or one that both turns and slides.
    """
    model = checked_kind("robot", robot, Robot).model
    name = checked_choice("frame", robot.tool if frame is None else frame, [f.name for f in model.frames])
    target = model.frames[_frame_id(model, name)]
    supports = [i for i in model.supports[target.parentJoint] if i != 0]
    placements, prismatic = [], []
    undo = np.eye(4)
    mimics = [robot.mimics.get(model.names[i]) for i in supports]
    for i, mimic in zip(supports, mimics, strict=True):
        axis, slides = _axis(model, i) if mimic is None else _mimicking_axis(model, i, mimic.multiplier)
        turn = _z_onto(axis)
        start = np.eye(4) if mimic is None else _moved(mimic.offset, slides=slides)
        placements.append(undo @ model.jointPlacements[i].homogeneous @ turn @ start)
        prismatic.append(slides)
        undo = turn.T
    names = [model.names[i] if mimic is None else mimic.master for i, mimic in zip(supports, mimics, strict=True)]
    return Chain(
        columns=np.array([robot.joint_index(name) for name in names], dtype=np.int64),
        factors=tuple(1.0 if mimic is None else mimic.multiplier for mimic in mimics),
        prismatic=tuple(prismatic),
        placements=read_only(np.reshape(placements, (-1, 4, 4))),
        end=read_only(undo @ target.placement.homogeneous),
    )


def frames(chain: Chain, q: Sequence[Array] | Array) -> Iterator[Array]:
    """Yield the frame after each joint, shape (4, 3, ...), for one array of values per joint of the robot.

    The arrays broadcast against each other: what several configurations share, such as the first joints of a
    tree of branches, is computed once. A yielded frame holds until the next one is asked for: two buffers
    take turns, because fresh memory for every joint costs more than the arithmetic.
    """
    shape = (1,) * np.ndim(q[0])
    frame = np.eye(4, 3).reshape(4, 3, *shape)
    spare = np.empty_like(frame)
    for placement, column, factor, slides in zip(
        chain.placements, chain.columns, chain.factors, chain.prismatic, strict=True
    ):
        value = np.ascontiguousarray(q[column]) if factor == 1.0 else factor * np.asarray(q[column])
        np.matmul(placement.T, frame.reshape(4, -1), out=spare.reshape(4, -1))
        frame, spare = spare, frame
        if frame.shape[2:] != value.shape:
            shape = np.broadcast_shapes(frame.shape[2:], value.shape)
            if frame.shape[2:] != shape:
                frame = np.broadcast_to(frame, (4, 3, *shape)).copy()
                spare = np.empty_like(frame)
        if slides:
            frame[3] += frame[2] * value
        else:
            c, s = cos_sin(value)
            np.multiply(frame[:2], s, out=spare[:2])
            frame[:2] *= c
            frame[0] += spare[1]
            frame[1] -= spare[0]
        yield frame


def cos_sin(angle: Array) -> tuple[Array, Array]:
    """Cosine and sine through the tangent of half the angle: to 4e-16, in half the time of calling both."""
    tangent = np.tan(0.5 * angle)
    sine = tangent * tangent
    sine += 1.0
    cosine = np.divide(2.0, sine)
    np.multiply(cosine, tangent, out=sine)
    cosine -= 1.0
    return cosine, sine


def end_frame(chain: Chain, q: Sequence[Array] | Array) -> Array:
    """Return the chain's frame, shape (4, 3, ...), for one array of values per joint of the robot."""
    shape = np.broadcast_shapes(*(np.shape(value) for value in q))
    frame = np.eye(4, 3).reshape(4, 3, *(1,) * len(shape))
    for frame in frames(chain, q):  # noqa: B007 - only the last one matters
        pass
    moved: Array = (chain.end.T @ frame.reshape(4, -1)).reshape(frame.shape)
    return moved if moved.shape[2:] == shape else np.broadcast_to(moved, (4, 3, *shape))


def cross(a: Array, b: Array) -> Array:
    """Cross product along the first axis: several times faster than `numpy.cross` on this layout."""
    ax, ay, az = a
    bx, by, bz = b
    result = np.empty(np.broadcast_shapes(a.shape, b.shape))
    result[0] = ay * bz - az * by
    result[1] = az * bx - ax * bz
    result[2] = ax * by - ay * bx
    return result


def checked_joint_values(robot: Robot, name: str, values: ArrayLike) -> Array:
    """Return joint values as (n, n_joints) from one configuration or many; a message names the joint."""
    checked_kind("robot", robot, Robot)
    one = n_dimensions(values) == 1
    try:
        array = checked_array(name, values, (robot.n_joints,) if one else (None, robot.n_joints))
    except InputError as error:
        given = numbers(name, values)
        if given.ndim in (1, 2) and given.shape[-1] == robot.n_joints and not np.isfinite(given).all():
            bad = tuple(np.argwhere(~np.isfinite(given))[0])
            joint, index = robot.joint_names[bad[-1]], ", ".join(map(str, bad))
            raise InputError(f"joint {joint!r}: {name}[{index}] = {given[bad]} is not a finite number") from error
        joints = ", ".join(robot.joint_names)
        raise InputError(f"{error}: expected one number per joint ({joints}), or rows of them") from error
    return array[None] if one else array


def _axis(model: Any, index: int) -> tuple[Array, bool]:
    """A joint's axis in its own frame, and whether it slides along it."""
    joint, name = model.joints[index], model.names[index]
    if joint.nv != 1:
        raise ModelError(f"joint {name!r}: {joint.nv} degrees of freedom; only revolute and prismatic joints are known")
    return _line(model, index)


def _mimicking_axis(model: Any, index: int, multiplier: float) -> tuple[Array, bool]:
    """The same of a joint that mimics another one, whose motion Pinocchio multiplies already."""
    if multiplier == 0.0:  # it stands still, about any axis
        return np.array([0.0, 0.0, 1.0]), False
    axis, slides = _line(model, index)
    return axis / multiplier, slides


def _moved(value: float, *, slides: bool) -> Array:
    """A turn about z, or a shift along it, as 4x4."""
    result = np.eye(4)
    if slides:
        result[2, 3] = value
    else:
        c, s = np.cos(value), np.sin(value)
        result[:2, :2] = [[c, -s], [s, c]]
    return result


def _line(model: Any, index: int) -> tuple[Array, bool]:
    """The direction of a joint's motion subspace, and whether it slides."""
    joint, name = model.joints[index], model.names[index]
    data = joint.createData()
    joint.calc(data, np.zeros(model.nq))
    linear, angular = np.ravel(data.S)[:3], np.ravel(data.S)[3:]
    if linear.any() and angular.any():
        raise ModelError(f"joint {name!r}: a screw joint; only revolute and prismatic joints are known")
    return (linear, True) if linear.any() else (angular, False)


def _z_onto(axis: Array) -> Array:
    """A rotation, as 4x4, that takes z to the axis; exact for the coordinate axes, the identity for z."""
    helper = np.array([1.0, 0.0, 0.0]) if abs(axis[1]) > 0.7 else np.array([0.0, 1.0, 0.0])
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x)
    turn = np.eye(4)
    turn[:3, :3] = np.column_stack((x, np.cross(axis, x), axis))
    return turn


def _frame_id(model: Any, name: str) -> int:
    """Index of a frame that exists; where a link and a joint share the name, the link is meant."""
    return int(model.getFrameId(name, pin.FrameType.BODY) if model.existBodyName(name) else model.getFrameId(name))
