"""The columns of some cases: those of one shape from one pass of the dynamics."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from puma_septic.assessment import Assessment, assess
from puma_septic.errors import PumaSepticError
from puma_septic.limit_check import AT_LIMIT, most_used_first
from puma_septic.limits import payload_and_duration, stretched
from puma_septic.motion import compute_motion
from puma_septic.paths import TOOL, tool_rates
from puma_septic.robot import Payload, Robot
from puma_septic.study._definition import SCALED, Study, placed
from puma_septic.task import make_task, resolve_task
from puma_septic.validation import Array

__all__ = ["Columns", "evaluated", "joint_count"]

Columns = dict[str, NDArray[Any]]
# What of a task makes its robot.
_ROBOT: Final = ("robot", "payload", "wrench", "limits")
# Robots that are kept from one shape to the next: to load one takes as long as all else of a shape.
_KEPT: Final = 16
_MAGNITUDES: Final = ("velocity", "acceleration", "jerk", "effort")
_CALLED: Final = {"velocity": "velocity", "acceleration": "acceleration", "jerk": "jerk", "effort": "torque"}


def joint_count(study: Study) -> int:
    """The largest number of joints of all robots of a study.

    Raises
    ------
    InputError
        Where not even the task as it stands can be resolved.
    """
    counts = [resolve_task(study.task).robot.n_joints]
    for axis in study.axes:
        if axis.name in ("robot", "robot.source"):
            counts += [_joints_of(study, axis.name, value) for value in axis.values]
    return max(counts)


def _joints_of(study: Study, place: str, value: Any) -> int:
    document = deepcopy(study.task.document())
    placed(document, place, value, f"axis {place!r}")
    try:
        return resolve_task(make_task(document)).robot.n_joints
    except PumaSepticError:
        return 0


def evaluated(study: Study, cases: NDArray[np.int64], n_joints: int) -> Columns:
    """All columns of some cases; what fails is a row with its error.

    Returns
    -------
    dict of str to ndarray
    """
    places = study.places(cases)
    columns = _empty(study, cases, places, n_joints)
    shape = [k for k, axis in enumerate(study.axes) if axis.name not in SCALED]
    keys = places[:, shape]
    changes = np.flatnonzero(np.append(True, (keys[1:] != keys[:-1]).any(axis=1))).tolist()
    robots: dict[str, Robot] = {}
    for start, end in zip(changes, [*changes[1:], len(cases)], strict=True):
        _fill(columns, slice(start, end), study, places, shape, robots)
    return columns


def _empty(study: Study, cases: NDArray[np.int64], places: Array, n_joints: int) -> Columns:
    n, wanted = len(cases), study.columns
    columns: Columns = {"case": cases}
    for k, axis in enumerate(study.axes):
        values = study.values(k, places[:, k])
        is_number = all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
        columns[f"axis:{axis.name}"] = np.array(values, dtype=float) if is_number else np.array(list(map(str, values)))
    columns["error"] = np.full(n, "", dtype=object)
    if "feasible" in wanted:
        columns["feasible"] = np.zeros(n, dtype=np.int8)
    if "certificate" in wanted:
        columns["certificate"] = np.full(n, "undecided", dtype=object)
    if "governing" in wanted:
        columns |= {"governing_joint": np.full(n, "", dtype=object), "governing_quantity": np.full(n, "", dtype=object)}
        columns["utilisation"] = np.full(n, np.nan)
    if "margins" in wanted:
        columns |= {f"margin_{name}": np.full(n, np.nan) for name in _MAGNITUDES}
    for kind, names in (("peaks", _MAGNITUDES), ("rms", ("effort",))):
        if kind in wanted:
            stem = "peak" if kind == "peaks" else "rms"
            called = [f"{stem}_{_CALLED[name]}_{j + 1}" for name in names for j in range(n_joints)]
            columns |= {name: np.full(n, np.nan) for name in called}
    return columns


def _fill(
    columns: Columns, rows: slice, study: Study, places: Array, shape: list[int], robots: dict[str, Robot]
) -> None:
    """Columns of the cases of one shape; the robots of some shapes before it, by what made them, are used again."""
    try:
        document = deepcopy(study.task.document())
        for k in shape:
            value, name = study.values(k, places[rows.start : rows.start + 1, k])[0], study.axes[k].name
            if name == "profile":
                document["profiles"] = [value if isinstance(value, Mapping) else _choice(document, str(value))]
            else:
                placed(document, name, value, f"axis {name!r}")
        made_from = repr([document.get(section) for section in _ROBOT])
        resolved = resolve_task(make_task(document, origin=study.task.origin), robot=robots.get(made_from))
        _keep(robots, made_from, resolved.robot)
        motion = compute_motion(resolved.robot, resolved.trajectories[0])
    except PumaSepticError as error:
        columns["error"][rows] = str(error)
        return
    scaled = {axis.name: places[rows, k] for k, axis in enumerate(study.axes) if axis.name in SCALED}
    values = {name: _numbers(study, name, place) for name, place in scaled.items()}
    n = rows.stop - rows.start
    payload = motion.robot.payload
    durations = values.get("duration", np.full(n, motion.trajectory.duration))
    masses = values.get("payload", np.full(n, 0.0 if payload is None else payload.mass))
    task = resolved.task
    try:
        first = assess(motion, dwell=task.dwell, floor=task.floor, tool_limits=resolved.tool_limits)
        _store(columns, rows, first, durations, masses)
    except PumaSepticError as error:
        columns["error"][rows] = str(error)


def _keep(robots: dict[str, Robot], made_from: str, robot: Robot) -> None:
    if made_from not in robots and len(robots) == _KEPT:
        robots.pop(next(iter(robots)))
    robots[made_from] = robot


def _numbers(study: Study, name: str, places: Array) -> Array:
    k = [axis.name for axis in study.axes].index(name)
    return np.array(study.values(k, places))


def _choice(document: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """The task's own options of a profile, if it has some."""
    return next((one for one in document["profiles"] if one["name"] == name), {"name": name})


def _store(columns: Columns, rows: slice, first: Assessment, durations: Array, masses: Array) -> None:
    motion, robot = first.motion, first.motion.robot
    if robot.has_losses or not all(law.is_linear for law in robot.friction):
        for k, (duration, mass) in enumerate(zip(durations.tolist(), masses.tolist(), strict=True)):
            _store_one(columns, rows.start + k, _alone(first, duration, mass))
        return
    sweep = payload_and_duration(motion, durations, masses, dwell=first.dwell)
    limits = robot.limits
    names = np.array(robot.joint_names, dtype=object)
    _put(columns, "feasible", rows, sweep.is_feasible)
    _put(columns, "certificate", rows, "undecided" if first.undecided else "resolved")
    _put(columns, "governing_joint", rows, np.where(np.isnan(sweep.utilisation), "", names[sweep.governing_joint]))
    _put(columns, "governing_quantity", rows, sweep.governing_quantity)
    _put(columns, "utilisation", rows, sweep.utilisation)
    for name in _MAGNITUDES:
        share = sweep.peaks[name] / getattr(limits, name)
        _put(columns, f"margin_{name}", rows, 1 - np.fmax.reduce(share, axis=1))
        for j in range(robot.n_joints):
            _put(columns, f"peak_{_CALLED[name]}_{j + 1}", rows, sweep.peaks[name][:, j])
    for j in range(robot.n_joints):
        _put(columns, f"rms_torque_{j + 1}", rows, sweep.rms_torque[:, j])
    _hold_to_cell(columns, rows, first, motion.trajectory.duration / durations)


def _hold_to_cell(columns: Columns, rows: slice, first: Assessment, rates: Array) -> None:
    """What the cell asks beside the robot: the arm above the floor at any rate, the tool within its limits."""
    motion, kept = first.motion, np.full(len(rates), first.floor_check is None or first.floor_check.keeps())
    shares = {}
    if first.tool_limits is not None:
        shares = tool_rates(motion.robot, motion.trajectory).shares(first.tool_limits, rates)
    for quantity, share in shares.items():
        kept &= share <= 1 + AT_LIMIT
        if "utilisation" in columns:
            governs = np.flatnonzero(~(columns["utilisation"][rows] >= share)) + rows.start
            columns["utilisation"][governs] = share[governs - rows.start]
            columns["governing_joint"][governs], columns["governing_quantity"][governs] = TOOL, quantity
    if "feasible" in columns:
        columns["feasible"][rows] &= kept


def _put(columns: Columns, name: str, rows: slice, values: Any) -> None:
    if name in columns:
        columns[name][rows] = values


def _alone(first: Assessment, duration: float, mass: float) -> Assessment:
    motion = first.motion
    given, robot = motion.robot.payload, motion.robot
    shape = {} if given is None else {"com": given.com}
    if given is not None and given.mass:
        shape["inertia"] = given.inertia * (mass / given.mass)
    robot = robot.with_payload(Payload(mass=mass, **shape) if mass else None)
    moved = compute_motion(robot, stretched(motion.trajectory, duration / motion.trajectory.duration))
    return assess(moved, dwell=first.dwell, floor=first.floor, tool_limits=first.tool_limits)


def _store_one(columns: Columns, row: int, one: Assessment) -> None:
    rows = slice(row, row + 1)
    moved = most_used_first(check for check in one.all_checks if not check.is_range)
    _put(columns, "feasible", rows, one.is_feasible)
    _put(columns, "certificate", rows, "undecided" if one.undecided else "resolved")
    if moved:
        _put(columns, "governing_joint", rows, moved[0].joint)
        _put(columns, "governing_quantity", rows, moved[0].quantity)
        _put(columns, "utilisation", rows, moved[0].utilisation)
    for name in _MAGNITUDES:
        peaks = one.peak(name)[0]
        _put(columns, f"margin_{name}", rows, np.fmin.reduce(one.margins[name]))
        for j, peak in enumerate(peaks):
            _put(columns, f"peak_{_CALLED[name]}_{j + 1}", rows, peak)
    for j, rms in enumerate(one.rms_torque):
        _put(columns, f"rms_torque_{j + 1}", rows, rms)
