"""JointTrajectory and JointState messages as values, and where they lie in messages that carry one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.errors import InputError
from puma_septic.ros._faults import Fault
from puma_septic.validation import Array, read_only

__all__ = [
    "Found",
    "JointState",
    "JointTrajectoryMessage",
    "found_messages",
    "joint_state",
    "joint_trajectory_message",
]

# Fields that lead to a JointTrajectory.
_INTO: Final = (
    "goal", "request", "motion_plan_response", "planned_trajectory", "trajectory", "joint_trajectory",
    "sub_trajectory", "solution",
)  # fmt: skip
# Fields with the state that the motion starts from (moveit_msgs/RobotState).
_START: Final = ("trajectory_start", "start_state")
# Fields that move a floating base or the like.
_MULTI_DOF: Final = ("multi_dof_joint_trajectory", "multi_dof_trajectory")
# Fields beside them that say nothing about the motion of the joints.
_BESIDE: Final = (
    "header", "model_id", "goal_id", "group_name", "planning_time", "error_code", "controller_names", "path_tolerance",
    "component_path_tolerance", "goal_tolerance", "component_goal_tolerance", "goal_time_tolerance", "planner_id",
    "start_scene", "scene_diff", "info", "execution_info", "task_id", "sub_solution",
)  # fmt: skip


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Found:
    """A JointTrajectory as plain values.

    Attributes
    ----------
    where : str
        Its path in the document, empty where the document itself is it.
    message : Mapping
    start : Mapping or None
        The RobotState that the plan starts from, where the message around it has one.
    """

    where: str
    message: Mapping[str, Any]
    start: Mapping[str, Any] | None = None


def found_messages(document: object, faults: list[Fault]) -> list[Found]:
    """Every JointTrajectory in a document, in its order; what does not fit is added to `faults`."""
    return list(_walk(document, "", None, faults))


def _walk(node: object, where: str, start: Mapping[str, Any] | None, faults: list[Fault]) -> Iterator[Found]:
    if isinstance(node, list):
        for k, one in enumerate(node):
            # Only the first part of a plan starts where the plan does.
            yield from _walk(one, f"{where}[{k}]", start if k == 0 else None, faults)
    elif not isinstance(node, Mapping):
        faults.append(Fault(code="no_trajectory", message=f"{where or 'the document'} is no message but {node!r:.60}"))
    elif "joint_names" in node or "points" in node:
        yield Found(where=where, message=node, start=start)
    else:
        yield from _inside(node, where, start, faults)


def _inside(
    node: Mapping[str, Any], where: str, start: Mapping[str, Any] | None, faults: list[Fault]
) -> Iterator[Found]:
    """Go on into the one field that leads to a trajectory."""
    place = f"{where}." if where else ""
    into = [key for key in _INTO if key in node]
    known = {*_INTO, *_START, *_MULTI_DOF, *_BESIDE}
    if not into:
        keys = ", ".join(map(str, list(node)[:8])) or "nothing"
        faults.append(
            Fault(
                code="no_trajectory",
                message=f"no JointTrajectory (joint_names, points) in {where or 'the document'}, which has {keys}",
            )
        )
        return
    faults += [
        Fault(code="unknown_key", message=f"{place}{key} is no field of a message around a JointTrajectory")
        for key in node
        if key not in known
    ]
    for key in _MULTI_DOF:
        if isinstance(node.get(key), Mapping) and node[key].get("points"):
            text = f"{place}{key} moves joints of several degrees of freedom, which are not assessed"
            faults.append(Fault(code="unsupported", message=text))
    for key in _START:
        if isinstance(node.get(key), Mapping):
            start = node[key]
    for key in into:
        yield from _walk(node[key], place + key, start, faults)


_FIELDS: Final = ("positions", "velocities", "accelerations", "effort")
_POINT_KEYS: Final = (*_FIELDS, "time_from_start")
_MESSAGE_KEYS: Final = ("header", "joint_names", "points")
_CUT: Final = "..."  # what `ros2 topic echo` writes for the elements beyond its --truncate-length (128 by default)
_NS: Final = 10**9
_LARGEST: Final = 1e12  # rad, rad/s, rad/s^2, N m: far beyond any joint, and no square of it overflows
_LONGEST: Final = 2**31  # builtin_interfaces/Duration holds the seconds in an int32


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class JointTrajectoryMessage:
    """The points of a trajectory_msgs/JointTrajectory.

    Attributes
    ----------
    joint_names : tuple of str
        In the message's order.
    nanoseconds : ndarray of int, shape (n,)
        time_from_start, as the message holds it.
    positions : ndarray, shape (n, n_joints)
        rad (m for prismatic joints).
    velocities, accelerations, effort : ndarray, shape (n, n_joints)
        NaN in the rows of points that do not have them.
    """

    joint_names: tuple[str, ...]
    nanoseconds: NDArray[np.int64]
    positions: Array
    velocities: Array
    accelerations: Array
    effort: Array

    def __post_init__(self) -> None:
        times = np.array(self.nanoseconds, dtype=np.int64)
        times.setflags(write=False)
        object.__setattr__(self, "nanoseconds", times)
        for name in _FIELDS:
            object.__setattr__(self, name, read_only(getattr(self, name)))

    @property
    def times(self) -> Array:
        """time_from_start of each point, s, shape (n,)."""
        return read_only(self.nanoseconds / _NS)

    def stretched(self, factor: float) -> JointTrajectoryMessage:
        """The message of the same motion, `factor` times as long; without efforts, which another speed changes."""
        return replace(
            self,
            nanoseconds=np.round(self.nanoseconds * factor).astype(np.int64),
            velocities=self.velocities / factor,
            accelerations=self.accelerations / factor**2,
            effort=np.full_like(self.effort, np.nan),
        )

    def has(self, field: str) -> NDArray[np.bool_]:
        """Whether each point has this field, shape (n,)."""
        return np.asarray(~np.isnan(getattr(self, field)).any(axis=1))


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class JointState:
    """Where joints stand, and how fast they move.

    Attributes
    ----------
    joint_names : tuple of str
    position : ndarray, shape (n,)
        rad (m for prismatic joints).
    velocity : ndarray, shape (n,)
        rad/s (m/s); 0 where the message has none.
    """

    joint_names: tuple[str, ...]
    position: Array
    velocity: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "position", read_only(self.position))
        object.__setattr__(self, "velocity", read_only(self.velocity))


def joint_trajectory_message(data: Mapping[str, Any], faults: list[Fault]) -> JointTrajectoryMessage | None:
    """The message of plain values; None where it has faults, which are added to `faults`."""
    before = len(faults)
    _refuse_unknown(data, _MESSAGE_KEYS, "JointTrajectory", "", faults)
    names = _names(data.get("joint_names"), "joint_names", faults)
    points = data.get("points")
    if not isinstance(points, list) or not points:
        faults.append(Fault(code="no_trajectory", message="points: at least one is needed"))
        return None
    if points[-1] == _CUT:
        faults.append(_truncated("points"))
        points = points[:-1]
    rows: dict[str, list[Array]] = {name: [] for name in _FIELDS}
    times = [0] * len(points)
    for k, point in enumerate(points):
        where = f"points[{k}]"
        if not isinstance(point, Mapping):
            faults.append(Fault(code="bad_value", message=f"{where}: a JointTrajectoryPoint is expected"))
            continue
        _refuse_unknown(point, _POINT_KEYS, "JointTrajectoryPoint", f"{where}.", faults)
        for name in _FIELDS:
            rows[name].append(_row(point.get(name), len(names), f"{where}.{name}", faults))
        times[k] = _nanoseconds(point.get("time_from_start"), f"{where}.time_from_start", faults)
    if len(faults) > before:
        return None
    message = JointTrajectoryMessage(
        joint_names=names,
        nanoseconds=np.array(times, dtype=np.int64),
        **{name: np.array(values) for name, values in rows.items()},
    )
    faults += [*_order_faults(message), *_field_faults(message)]
    return message if len(faults) == before else None


def joint_state(data: object, origin: str) -> JointState:
    """A sensor_msgs/JointState, or the one in a moveit_msgs/RobotState, of plain values.

    Raises
    ------
    InputError
        Naming what is wrong, all at once.
    """
    while isinstance(data, Mapping) and "name" not in data and isinstance(data.get("joint_state"), Mapping):
        data = data["joint_state"]
    if not isinstance(data, Mapping) or not {"name", "position"} <= set(data):
        raise InputError(f"{origin}: no JointState (name, position) in it")
    faults: list[Fault] = []
    names = _names(data["name"], "name", faults)
    position = _row(data["position"], len(names), "position", faults)
    velocity = _row(data.get("velocity"), len(names), "velocity", faults)
    if np.isnan(position).any() and not faults:
        faults.append(Fault(code="bad_value", message="position is empty"))
    if faults:
        raise InputError(f"{origin}: {'; '.join(fault.message for fault in faults)}")
    return JointState(joint_names=names, position=position, velocity=np.nan_to_num(velocity))


def _refuse_unknown(
    data: Mapping[str, Any], known: Sequence[str], message: str, place: str, faults: list[Fault]
) -> None:
    faults += [
        Fault(code="unknown_key", message=f"{place}{key} is no field of a {message}; valid: {', '.join(known)}")
        for key in data
        if key not in known
    ]


def _names(value: object, where: str, faults: list[Fault]) -> tuple[str, ...]:
    if isinstance(value, list) and value and value[-1] == _CUT:
        faults.append(_truncated(where))
        value = value[:-1]
    if not isinstance(value, list) or not value or not all(isinstance(name, str) and name for name in value):
        faults.append(Fault(code="no_trajectory", message=f"{where}: a list of names is needed, got {value!r:.60}"))
        return ()
    for name in sorted({name for name in value if value.count(name) > 1}):
        faults.append(Fault(code="unknown_joint", message=f"{where}: {name!r} is listed twice", joint=name))
    return tuple(value)


def _row(value: object, count: int, where: str, faults: list[Fault]) -> Array:
    """One array of a point; NaN where it is absent or empty, or has a fault."""
    absent = np.full(count, np.nan)
    if value is None or value == []:
        return absent
    if isinstance(value, list) and value[-1] == _CUT:
        faults.append(_truncated(where))
    elif not isinstance(value, list) or not all(map(_is_number, value)):
        bad = next((one for one in value if not _is_number(one)), value) if isinstance(value, list) else value
        faults.append(Fault(code="bad_value", message=f"{where}: numbers up to 1e12 are expected, got {bad!r:.60}"))
    elif len(value) != count:
        if count:  # joint_names themselves are missing otherwise, and said so
            text = f"{where} has {len(value)} values for {count} joints"
            faults.append(Fault(code="bad_value", message=text))
    else:
        return np.array(value, dtype=np.float64)
    return absent


def _is_number(value: object) -> bool:
    """A number that a joint may have: finite, not NaN."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= _LARGEST


def _truncated(where: str) -> Fault:
    text = f"{where} ends in '...': `ros2 topic echo` has cut it short; record it with --full-length"
    return Fault(code="truncated", message=text)


def _nanoseconds(value: object, where: str, faults: list[Fault]) -> int:
    """A duration as {sec, nanosec} (ROS 2), {secs, nsecs} (ROS 1) or a number of seconds, in whole nanoseconds."""
    if isinstance(value, (int, float)) and _is_number(value) and abs(value) < _LONGEST:
        return round(float(value) * _NS)
    if isinstance(value, Mapping):
        for whole, part in (("sec", "nanosec"), ("secs", "nsecs")):
            if set(value) <= {whole, part} and value:
                seconds, rest = value.get(whole, 0), value.get(part, 0)
                if _is_integer(seconds, _LONGEST) and _is_integer(rest, _NS) and rest >= 0:
                    return int(seconds) * _NS + int(rest)
    text = f"{where}: seconds, or whole {{sec, nanosec}} with nanosec below 1e9, are expected, got {value!r:.60}"
    faults.append(Fault(code="bad_value", message=text))
    return 0


def _is_integer(value: object, below: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and -below <= value < below


def _order_faults(message: JointTrajectoryMessage) -> list[Fault]:
    t = message.nanoseconds
    faults = []
    if t[0] < 0:
        faults.append(_time_fault("points[0].time_from_start is negative", t[0]))
    for k in np.flatnonzero(np.diff(t) <= 0):
        text = f"points[{k + 1}] at {t[k + 1] / _NS:.9g} s does not come after points[{k}] at {t[k] / _NS:.9g} s"
        faults.append(_time_fault(text, t[k + 1]))
    return faults


def _time_fault(text: str, nanoseconds: int) -> Fault:
    return Fault(code="time_order", message=f"{text}; times must increase strictly", time=float(nanoseconds / _NS))


def _field_faults(message: JointTrajectoryMessage) -> list[Fault]:
    """Points for which joint_trajectory_controller has no interpolation, unless its integration is switched on."""
    faults = []
    for k in np.flatnonzero(~message.has("positions")):
        text = f"points[{k}] has no positions: the controller refuses it unless it is set to integrate"
        faults.append(Fault(code="unsupported", message=text, time=float(message.times[k])))
    for k in np.flatnonzero(message.has("accelerations") & ~message.has("velocities")):
        text = f"points[{k}] has accelerations without velocities, between which the controller does not interpolate"
        faults.append(Fault(code="unsupported", message=text, time=float(message.times[k])))
    return faults
