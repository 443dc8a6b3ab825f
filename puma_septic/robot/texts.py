"""A robot as tables that a person reads."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from puma_septic.checks import Array
from puma_septic.tables import html_table

if TYPE_CHECKING:  # the value that these texts describe stands one file up in this room
    from puma_septic.robot.model import Robot

__all__ = ["robot_html"]


def robot_html(robot: Robot) -> str:
    """Joints, limits and drives with their sources, for a notebook; every text is escaped."""
    load = "" if robot.payload is None else f", payload {robot.payload.mass:g} kg"
    head = f"{robot.name}: {robot.n_joints} joints, tool {robot.tool!r}{load}"
    limits, actuators = robot.limits, robot.actuators
    places, axes = _at_zero(robot)
    kinds = ["slides" if slides else "turns" for slides in robot.is_prismatic]
    parts = [
        html_table(
            ["joint", "moves", "origin x, y, z [m]", "axis x, y, z"],
            [
                [name, kind, _triple(place), _triple(axis)]
                for name, kind, place, axis in zip(robot.joint_names, kinds, places, axes, strict=True)
            ],
            caption="Joints, with all positions at zero, in the world",
        ),
        html_table(
            ["joint", "position [rad]", "velocity [rad/s]", "acceleration [rad/s²]", "jerk [rad/s³]", "effort [N m]"],
            [
                [
                    name,
                    "unbounded"
                    if robot.is_continuous[j]
                    else " to ".join(_known(bound) for bound in limits.position[j]),
                    *(
                        _known(getattr(limits, quantity)[j])
                        for quantity in ("velocity", "acceleration", "jerk", "effort")
                    ),
                ]
                for j, name in enumerate(robot.joint_names)
            ],
            caption=_sourced("Limits", [limits.source], robot),
        ),
        html_table(
            ["joint", "gear ratio", "rotor inertia [kg m²]", "viscous [N m s/rad]", "Coulomb +, − [N m]"],
            [
                [
                    name,
                    *(_known(value) for value in (one.gear_ratio, one.rotor_inertia, one.viscous_friction)),
                    ", ".join(_known(value) for value in one.coulomb_friction),
                ]
                for name, one in zip(robot.joint_names, actuators, strict=True)
            ],
            caption=_sourced("Drives, motor side", [actuator.source for actuator in actuators], None),
        ),
    ]
    boxes = [f'<div class="scroll" style="overflow-x:auto">{part}</div>' for part in parts]
    notes = f"<p>{escape('; '.join(robot.notes))}</p>" if robot.notes else ""
    return "\n".join([f"<p><strong>{escape(head)}</strong></p>", *boxes, notes])


def _at_zero(robot: Robot) -> tuple[Array, Array]:
    """Origin and direction of each joint's axis in the world, each of shape (n_joints, 3)."""
    model = robot.model
    data = model.createData()
    pin.computeJointJacobians(model, data, robot.configurations(np.zeros((1, robot.n_joints)))[0])
    places, axes = [], []
    for name, slides in zip(robot.joint_names, robot.is_prismatic, strict=True):
        joint = model.getJointId(name)
        column = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)[:, model.joints[joint].idx_v]
        places.append(data.oMi[joint].translation)
        axes.append(column[:3] if slides else column[3:])
    return np.array(places), np.array(axes)


def _triple(vector: Array) -> str:
    # Rounding leaves -0, which adding 0 makes 0.
    return ", ".join(f"{round(value, 4) + 0.0:.4g}" for value in vector.tolist())


def _known(value: float) -> str:
    return "unknown" if np.isnan(value) else f"{value:.6g}"


def _sourced(what: str, sources: Sequence[str], robot: Robot | None) -> str:
    """A caption with the sources, each named once; sliding joints have other units."""
    known = "; ".join(dict.fromkeys(source for source in sources if source))
    slides = " (sliding joints: m and N)" if robot is not None and robot.is_prismatic.any() else ""
    return f"{what}{slides}" + (f", from: {known}" if known else "")
