"""Robot: a Pinocchio model with its drives, limits, tool and load."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, TypeVar, final

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from puma_septic.document import SCHEMAS, one_line, plain
from puma_septic.drives import Drivetrain
from puma_septic.errors import InputError
from puma_septic.friction import Friction
from puma_septic.quantities import QUANTITIES
from puma_septic.robot._actuator import Actuator
from puma_septic.robot._components import Limits, Payload, Wrench
from puma_septic.robot._meshes import Geometry, is_drawn
from puma_septic.robot._mimic import Mimic
from puma_septic.validation import (
    Array,
    FrozenMap,
    checked_array,
    checked_choice,
    checked_each,
    checked_kind,
    checked_list,
    frozen,
    read_only,
)
from puma_septic.views import robot as view

__all__ = ["Robot"]

_Value = TypeVar("_Value")

# What a document has of a payload and of an actuator, as their fields are called.
_PAYLOAD = ("mass", "com", "inertia")
_MIMIC = ("master", "multiplier", "offset")
_ACTUATOR = ("gear_ratio", "rotor_inertia", "viscous_friction", "coulomb_friction", "source")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Robot:
    """An arm as `load_robot` returns it: immutable, shared freely.

    Arrays are in the order of `joint_names`, the order in which the URDF lists its moving joints.

    Attributes
    ----------
    name : str
    model : pinocchio.Model
        Rotor inertia is in ``model.armature`` and the payload in the last link. Never write to it.
    bare_model : pinocchio.Model
        The same without payload.
    joint_names : tuple of str
    tool : str
        Name of the frame that is positioned and that carries payload and wrench.
    drivetrains : tuple of Drivetrain
        One per joint; its values are NaN where nothing is known of them.
    limits : Limits
    geometry : Geometry
        Visual and collision shapes, not yet built.
    missing_inertia : tuple of str
        Joints whose torque is not known, because the URDF has no inertia at all for what they move, or one that no
        body can have.
    unusable_inertia : mapping of str to str
        Links whose inertia no body can have, and why.
    missing_meshes : tuple of str
        Link, mesh name and reason of each shape that is left out because its file cannot be used.
    mimics : mapping of str to Mimic
        Joints of the model without a coordinate of their own, and what they follow: the torque of both is at the
        joint that they follow.
    tool_is_chosen : bool
        Nobody named the tool.
    payload : Payload or None
    wrench : Wrench or None
    notes : tuple of str
        What a reader of results must know: parameter sets, unphysical tensors, ignored tags.
    friction : tuple of Friction
        One per joint, at the joint.
    transmission : ndarray, shape (n_joints, 3)
        Of each drivetrain: factors of the load where it drives, at rest, and where the motor drives.
    armature : ndarray, shape (n_joints,)
        Inertia of rotor and gears at the joint, kg m^2; 0 where unknown.
    viscous_friction : ndarray, shape (n_joints,)
        At the joint, N m s/rad; 0 where unknown.
    coulomb_friction : ndarray, shape (n_joints, 2)
        At the joint, N m, for positive and negative velocity; 0 where unknown.
    is_plain : bool
        Whether Pinocchio's vectors are this package's, so that nothing has to be put in order.
    is_continuous, is_prismatic : ndarray of bool, shape (n_joints,)
        Joints without position limits, and joints that slide (m and N instead of rad and N m).
    """

    name: str
    bare_model: pin.Model
    joint_names: tuple[str, ...]
    tool: str
    drivetrains: tuple[Drivetrain, ...]
    limits: Limits
    geometry: Geometry
    missing_inertia: tuple[str, ...] = ()
    unusable_inertia: Mapping[str, str] = field(default_factory=dict)
    missing_meshes: tuple[str, ...] = ()
    mimics: Mapping[str, Mimic] = field(default_factory=dict)
    tool_is_chosen: bool = False
    payload: Payload | None = None
    wrench: Wrench | None = None
    notes: tuple[str, ...] = ()
    model: pin.Model = field(init=False)
    friction: tuple[Friction, ...] = field(init=False)
    transmission: Array = field(init=False)
    armature: Array = field(init=False)
    viscous_friction: Array = field(init=False)
    coulomb_friction: Array = field(init=False)
    _index_q: NDArray[np.int64] = field(init=False, repr=False)
    _index_v: NDArray[np.int64] = field(init=False, repr=False)
    is_plain: bool = field(init=False, repr=False)
    is_continuous: NDArray[np.bool_] = field(init=False, repr=False)
    is_prismatic: NDArray[np.bool_] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "drivetrains", tuple(self.drivetrains))
        for name in ("mimics", "unusable_inertia"):
            object.__setattr__(self, name, FrozenMap(getattr(self, name)))
        self._check_consistent()
        joints = [self.bare_model.joints[self.bare_model.getJointId(name)] for name in self.joint_names]
        derived = {
            "_index_q": np.array([joint.idx_q for joint in joints]),
            "_index_v": np.array([joint.idx_v for joint in joints]),
            "is_continuous": np.array([joint.nq == 2 for joint in joints]),
            "is_prismatic": np.array([joint.shortname().startswith("JointModelP") for joint in joints]),
        }
        for value in derived.values():
            value.setflags(write=False)
        for name, value in (derived | _joint_side(self.drivetrains)).items():
            object.__setattr__(self, name, value)
        own = np.arange(self.n_joints)
        is_plain = self.bare_model.nq == self.n_joints and bool((self._index_q == own).all())
        object.__setattr__(self, "is_plain", is_plain)
        object.__setattr__(self, "model", self._loaded_model())

    def _check_consistent(self) -> None:
        """Refuse what would fail later, or not at all: Pinocchio answers an unknown name with an index past the end."""
        checked_kind("limits", self.limits, Limits)
        if self.payload is not None:
            checked_kind("payload", self.payload, Payload)
        if self.wrench is not None:
            checked_kind("wrench", self.wrench, Wrench)
        for train in self.drivetrains:
            checked_kind("drivetrains", train, Drivetrain)
        checked_choice("tool frame", self.tool, [frame.name for frame in self.bare_model.frames])
        for name in self.joint_names:
            checked_choice("joint", name, list(self.bare_model.names)[1:])
        if len(self.drivetrains) != self.n_joints:
            raise InputError(f"actuators: {len(self.drivetrains)} given for {self.n_joints} joints")
        if len(self.limits.velocity) != self.n_joints:
            raise InputError(f"limits: given for {len(self.limits.velocity)} joints, the arm has {self.n_joints}")

    def _loaded_model(self) -> pin.Model:
        """The bare model with rotor inertia and payload written into a copy of it."""
        model = self.bare_model.copy()
        armature = np.zeros(model.nv)
        armature[self._index_v] = self.armature
        model.armature = armature
        if self.payload is not None:
            frame = model.frames[_frame_id(model, self.tool)]
            body = pin.Inertia(self.payload.mass, self.payload.com, self.payload.inertia)
            model.appendBodyToJoint(frame.parentJoint, body, frame.placement)
        return model

    @property
    def n_joints(self) -> int:
        """Number of moving joints."""
        return len(self.joint_names)

    @property
    def knows_torque(self) -> NDArray[np.bool_]:
        """Whether each joint's torque can be computed, shape (n_joints,): not where the inertia that it moves lacks."""
        return frozen(np.array([name not in self.missing_inertia for name in self.joint_names]))

    @property
    def has_losses(self) -> bool:
        """Whether the gears lose a part of the load that they carry, in one direction or the other."""
        return bool((self.transmission != 1).any())

    @property
    def actuators(self) -> tuple[Actuator, ...]:
        """The drivetrains in their short form."""
        return tuple(Actuator.of(train) for train in self.drivetrains)

    @property
    def fixed_joint_names(self) -> tuple[str, ...]:
        """Joints that do not move: fixed in the URDF, or locked when it was loaded."""
        frames = list(self.bare_model.frames)[1:]  # the first is the world's
        return tuple(frame.name for frame in frames if frame.type == pin.FrameType.FIXED_JOINT)

    @property
    def tool_id(self) -> int:
        """Index of the tool frame in `model`."""
        return _frame_id(self.model, self.tool)

    @property
    def visual_model(self) -> pin.GeometryModel:
        """Shapes to draw, built on each access (meshes are read then): keep it where it is used twice."""
        return self.geometry.build(self.bare_model, pin.GeometryType.VISUAL)

    @property
    def undrawn(self) -> tuple[str, ...]:
        """Link, mesh and reason of every visual shape that is not drawn; reads the meshes, as `visual_model` does."""
        missing = filter(is_drawn, self.missing_meshes)
        return (*missing, *self.geometry.unreadable(self.bare_model, pin.GeometryType.VISUAL))

    @property
    def collision_model(self) -> pin.GeometryModel:
        """Shapes to test for contact, without pairs; built on each access like `visual_model`."""
        return self.geometry.build(self.bare_model, pin.GeometryType.COLLISION)

    def joint_index(self, name: str) -> int:
        """Index of a joint in this package's arrays; an unknown name lists the valid ones."""
        return self.joint_names.index(checked_choice("joint", name, self.joint_names))

    def configurations(self, q: Array) -> Array:
        """Pinocchio's configurations, shape (n, nq), of joint positions, shape (n, n_joints).

        A continuous joint takes two places there, the cosine and the sine of its angle.
        """
        if self.is_plain:
            return np.ascontiguousarray(q)
        result = np.empty((len(q), self.model.nq))
        result[:, self._index_q] = q
        if self.is_continuous.any():
            index, angle = self._index_q[self.is_continuous], q[:, self.is_continuous]
            result[:, index], result[:, index + 1] = np.cos(angle), np.sin(angle)
        return result

    def tangents(self, v: Array) -> Array:
        """Pinocchio's velocities (or accelerations), shape (n, nv), of joint values, shape (n, n_joints)."""
        if self.is_plain:
            return np.ascontiguousarray(v)
        result = np.empty((len(v), self.model.nv))
        result[:, self._index_v] = v
        return result

    def from_tangents(self, values: Array) -> Array:
        """Joint values, shape (n, n_joints), of Pinocchio's, shape (n, nv): the inverse of `tangents`."""
        return values if self.is_plain else values[:, self._index_v]

    def with_payload(self, payload: Payload | None) -> Robot:
        """The same arm carrying this payload instead (None: nothing)."""
        return replace(self, payload=payload)

    def with_wrench(self, wrench: Wrench | None) -> Robot:
        """The same arm exerting this wrench at the tool instead (None: none)."""
        return replace(self, wrench=wrench)

    def with_tool(self, tool: str) -> Robot:
        """The same arm with another frame as its tool."""
        return replace(self, tool=tool, tool_is_chosen=False)

    def with_actuators(self, actuators: Iterable[Actuator]) -> Robot:
        """The same arm with other drives in their short form, one per joint.

        Returns
        -------
        Robot
        """
        given = [checked_kind("actuators", one, Actuator) for one in checked_list("actuators", actuators)]
        return self.with_drivetrains(one.drivetrain for one in given)

    def with_drivetrains(self, drivetrains: Iterable[Drivetrain]) -> Robot:
        """The same arm with other drivetrains, one per joint.

        Their rotors, friction and gear losses are in its torques.

        Returns
        -------
        Robot
        """
        return replace(self, drivetrains=checked_list("drivetrains", drivetrains))

    def with_limits(
        self, limits: Limits | None = None, *, position: ArrayLike | None = None, **magnitudes: ArrayLike | None
    ) -> Robot:
        """The same arm with other limits: a whole set, or the named ones.

        Parameters
        ----------
        limits : Limits, optional
        position : array_like, shape (n_joints, 2), optional
        **magnitudes : array_like, shape () or (n_joints,), optional
            Any of ``velocity``, ``acceleration``, ``jerk``, ``effort`` and the others of `Limits`; a scalar holds for
            all joints.

        Returns
        -------
        Robot

        Raises
        ------
        InputError
            For an unknown limit, or values that no limit can have.
        """
        new = self.limits if limits is None else checked_kind("limits", limits, Limits)
        changes: dict[str, Any] = {}
        for name, value in magnitudes.items():
            checked_choice("limit", name, QUANTITIES)
            if value is not None:
                changes[name] = checked_each(name, value, self.n_joints, allow_nan=True)
        if position is not None:
            changes["position"] = checked_array("position", position, (self.n_joints, 2), allow_nan=True)
        return replace(self, limits=replace(new, **changes) if changes else new)

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document: joints with their axes, limits and drives; null for what is not known.

        Returns
        -------
        dict
        """
        payload = self.payload
        return {
            "schema": SCHEMAS["robot"],
            "name": self.name,
            "tool": self.tool,
            "tool_is_chosen": self.tool_is_chosen,
            "payload": None if payload is None else plain({key: getattr(payload, key) for key in _PAYLOAD}),
            "joints": [
                self._joint_document(j, actuator, place, axis)
                for j, (actuator, place, axis) in enumerate(zip(self.actuators, *self._axes(), strict=True))
            ],
            "mimics": {name: plain({key: getattr(one, key) for key in _MIMIC}) for name, one in self.mimics.items()},
            "frames": [frame.name for frame in self.bare_model.frames if frame.type == pin.FrameType.BODY],
            "base_mass": float(self.bare_model.inertias[0].mass),
            "missing_inertia": list(self.missing_inertia),
            "missing_meshes": list(self.missing_meshes),
            "limits_source": self.limits.source,
            "notes": list(self.notes),
        }

    def _joint_document(self, j: int, actuator: Actuator, place: Array, axis: Array) -> dict[str, Any]:
        return {
            "name": self.joint_names[j],
            "is_prismatic": bool(self.is_prismatic[j]),
            "is_continuous": bool(self.is_continuous[j]),
            "origin": plain(place),
            "axis": plain(axis),
            "mass": self._moved_mass(self.joint_names[j]),
            "limits": {name: plain(getattr(self.limits, name)[j]) for name in self.limits.quantities},
            "actuator": plain({**{key: getattr(actuator, key) for key in _ACTUATOR}, **actuator.options}),
        }

    def _moved_mass(self, name: str) -> float:
        """All that a joint moves without its payload, and what hangs on the joints that mimic it with it, kg."""
        model = self.bare_model
        followers = [other for other, mimic in self.mimics.items() if mimic.master == name]
        moved = {k for joint in (name, *followers) for k in model.subtrees[model.getJointId(joint)]}
        return float(sum(model.inertias[k].mass for k in moved))

    def _axes(self) -> tuple[Array, Array]:
        """Origin and direction of each joint's axis in the world at zero, each of shape (n_joints, 3)."""
        data = self.model.createData()
        pin.computeJointJacobians(self.model, data, self.configurations(np.zeros((1, self.n_joints)))[0])
        places, axes = [], []
        for name, slides in zip(self.joint_names, self.is_prismatic, strict=True):
            joint = self.model.getJointId(name)
            # Pinocchio's bindings hand out the Jacobian of an arm with one joint as a vector.
            column = pin.getJointJacobian(self.model, data, joint, pin.LOCAL_WORLD_ALIGNED).reshape(6, -1)
            direction = column[:, self.model.joints[joint].idx_v]
            places.append(data.oMi[joint].translation)
            axes.append(direction[:3] if slides else direction[3:])
        return np.array(places), np.array(axes)

    def _repr_html_(self) -> str:
        return view.html(self.to_dict())

    def __repr__(self) -> str:
        return one_line("Robot", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "name": self.name,
            "joints": self.n_joints,
            "tool": self.tool,
            "payload": "none" if self.payload is None else f"{self.payload.mass:g} kg",
        }


@lru_cache(maxsize=16)
def _joint_side(drivetrains: tuple[Drivetrain, ...]) -> dict[str, Any]:
    """What a robot has of its drivetrains; kept, as robots that differ in payload or limits share it."""
    friction = tuple(train.joint_friction for train in drivetrains)
    return {
        "friction": friction,
        "transmission": read_only([train.transmission for train in drivetrains]),
        "armature": read_only(np.nan_to_num([train.reflected_inertia for train in drivetrains])),
        "viscous_friction": read_only(np.nan_to_num([law.viscous for law in friction])),
        "coulomb_friction": read_only(np.nan_to_num([law.coulomb for law in friction])),
    }


def _frame_id(model: pin.Model, name: str) -> int:
    """Index of a frame that exists; where a link and a joint share the name, the link is meant."""
    return int(model.getFrameId(name, pin.FrameType.BODY) if model.existBodyName(name) else model.getFrameId(name))
