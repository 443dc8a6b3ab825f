"""Public functions and values, called rightly but for one argument: an error of our own, or a finite answer."""

from __future__ import annotations

import dataclasses
import inspect
import os
import shutil
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Mapping
from datetime import UTC, datetime, timedelta
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any, Final

import numpy as np

import puma_septic as ps
from campaign.moves import POINTS, ROOT, cycle, move, puma
from campaign.outputs import inputs
from campaign.rules import message_faults

_Q: Final = [0.1, 0.6, -2.2, 0.1, 0.3, 0.1]
_REST: Final = [0.0] * 6
# In place of an argument, whatever it is.
_ANY: Final = (
    None, True, "x", "0.5", b"1", float("nan"), float("inf"), float("-inf"), -1, 0, 1, -0.5, 1e308, -1e308, 1e300,
    1e150, 1e-320, 10**400, 1 + 2j, [], (), {}, [[]], [[1.0], [2.0, 3.0]], ["a"], [None], object(), Decimal("0.1"),
    Fraction(1, 3), np.array(0.5), np.array([1.0, np.nan]), np.ma.masked_array([1.0, 2.0], mask=[True, False]),
    np.array(["1", "2"]), np.array([object()]), datetime(2026, 1, 1, tzinfo=UTC), timedelta(seconds=1), range(3),
    Path("x"), lambda: 1, set(), int, "\x1b[2J", "x" * 5000, "\u202e", {"a": 1}, np.zeros((0, 6)),
    np.zeros((2, 2, 2, 2)), slice(1), NotImplemented,
)  # fmt: skip


def _motion() -> ps.Motion:
    return ps.compute_motion(puma(), move())


def _four() -> dict[str, Any]:
    points = np.array(
        [_Q, [0.3, 0.8, -2.4, 0.2, 0.4, 0.2], [0.5, 1.0, -2.6, 0.1, 0.5, 0.1], [0.8, 1.1, -2.5, 0, 0.3, 0]]
    )
    return {"points": points, "times": [0.0, 1.0, 2.5, 4.0]}


# Of these NaN is a number that is not known.
_MAY_BE_UNKNOWN: Final = ("Limits", "Actuator", "Friction", "Motor", "Gearbox", "Drive", "Supply", "Robot.with_limits")


def calls() -> dict[str, tuple[Callable[..., Any], dict[str, Any]]]:
    """A right call of everything public that computes in well below a second, by its name."""
    robot, motion, four = puma(), _motion(), _four()
    state = {"q": _Q, "v": [0.1] * 6, "a": [0.2] * 6}
    T = ps.forward_kinematics(robot, _Q)
    line = ps.paths.line(T, _shifted(T, 0.05))
    train = ps.load_drivetrains(robot)[1]
    return {
        "load_robot": (ps.load_robot, {
            "source": "puma560", "parameters": "rtb", "limits": "corke", "tool": "flange", "package_dirs": (),
            "locked": {"joint6": 0.0}, "links": {"link6": ps.Payload(mass=0.1)}, "gravity": (0.0, 0.0, -9.81),
        }),
        "Robot.with_limits": (robot.with_limits, {"velocity": 1.0, "jerk": [9.0] * 6, "position": [[-3.0, 3.0]] * 6}),
        "Robot.with_payload": (robot.with_payload, {"payload": ps.Payload(mass=1.0)}),
        "Robot.with_wrench": (robot.with_wrench, {"wrench": ps.Wrench(force=[1, 2, 3])}),
        "Robot.with_tool": (robot.with_tool, {"tool": "flange"}),
        "Robot.with_actuators": (robot.with_actuators, {"actuators": robot.actuators}),
        "Robot.with_drivetrains": (robot.with_drivetrains, {"drivetrains": robot.drivetrains}),
        "Robot.joint_index": (robot.joint_index, {"name": "joint2"}),
        "Payload": (ps.Payload, {"mass": 1.0, "com": [0, 0, 0.1], "inertia": np.eye(3) * 0.1}),
        "Wrench": (ps.Wrench, {"force": [1, 2, 3], "torque": [0.1, 0, 0], "axes": "tool"}),
        "Limits": (ps.Limits, {
            "position": [[-1.0, 1.0]] * 2, "velocity": [1.0, 1.0], "acceleration": [1.0, 1.0], "jerk": [1.0, 1.0],
            "effort": [1.0, 1.0], "source": "s",
        }),
        "Actuator": (ps.Actuator, {
            "gear_ratio": 10.0, "rotor_inertia": 1e-4, "viscous_friction": 1e-3, "coulomb_friction": [0.1, -0.1],
            "source": "s",
        }),
        "Friction": (ps.Friction, {"viscous": 0.1, "coulomb": [0.2, -0.2], "stribeck_velocity": 0.1, "static": [0.3,
            -0.3]}),
        "Motor": (ps.Motor, {
            "name": "m", "rotor_inertia": 1e-4, "torque_constant": 0.2, "resistance": 1.5, "peak_torque": 3.0,
            "continuous_torque": 1.0, "max_speed": 400.0, "peak_curve": [], "mass": 1.0,
            "thermal_resistances": [1.0, 2.0], "thermal_time_constants": [20.0, 600.0], "max_winding_celsius": 130.0,
        }),
        "Gearbox": (ps.Gearbox, {
            "ratio": 50.0, "name": "g", "kind": "strain wave", "efficiency": 0.8, "inertia": 1e-5,
                "rated_torque": 20.0,
            "max_repeated_torque": 60.0, "max_input_speed": 700.0, "stiffness": [3e4], "mass": 1.0,
        }),
        "Drive": (ps.Drive, {"name": "d", "bus_voltage": 48.0, "peak_current": 20.0, "continuous_current": 10.0}),
        "Supply": (ps.Supply, {"bus_voltage": 48.0, "peak_power": 900.0, "continuous_power": 500.0}),
        "Drivetrain": (ps.Drivetrain, {"motor": train.motor, "gearbox": train.gearbox, "drive": train.drive}),
        "load_drivetrains": (ps.load_drivetrains, {"robot": robot, "path": None}),
        "own_drivetrains": (ps.own_drivetrains, {"robot": robot}),
        "built_in_catalogue": (ps.built_in_catalogue, {"name": "puma560"}),
        "load_catalogue": (ps.load_catalogue, {"motors": "m.csv", "gearboxes": "g.csv"}),
        "load_task": (ps.load_task, {"source": "paper"}),
        "resolve_task": (ps.resolve_task, {"task": ps.load_task("paper")}),
        "resolve_cycle": (ps.resolve_cycle, {"task": ps.load_task("paper-straight")}),
        "assess_task": (ps.assess_task, {"task": ps.load_task("paper")}),
        "make_study": (ps.make_study, {
            "data": {"name": "s", "task": "paper-turned", "axes": {"payload": [0, 1]}}, "origin": "o", "folder": ".",
        }),
        "read_log": (ps.read_log, {"path": "log.csv", "robot": robot, "units": (), "repeated": "refuse",
            "max_gap": 1.0}),
        "fit_trajectory": (ps.fit_trajectory, {
            "t": np.linspace(0, 2, 60), "q": move()(np.linspace(0, 2, 60)), "smoothing": 1e-6, "ends": "auto",
            "joint_names": list(puma().joint_names), "resolution": 1e-9,
        }),
        "read_joint_trajectory": (ps.read_joint_trajectory, {"path": "plan.yaml", "robot": robot, "index": None}),
        "forward_kinematics": (ps.forward_kinematics, {"robot": robot, "q": _Q, "frame": "flange"}),
        "jacobian": (ps.jacobian, {"robot": robot, "q": _Q}),
        "lowest_points": (ps.lowest_points, {"robot": robot, "q": [_Q]}),
        "tool_motion": (ps.tool_motion, {"robot": robot, **state}),
        "inverse_kinematics": (ps.inverse_kinematics, {
            "robot": robot, "T_world_tool": T, "constrain": "pose", "tolerance": 1e-9, "q_near": _Q, "starts": 4,
        }),
        "inverse_kinematics_batch": (ps.inverse_kinematics_batch, {"robot": robot, "T_world_tool": [T], "q_near": _Q}),
        "inverse_dynamics": (ps.inverse_dynamics, {"robot": robot, **state, "friction": True}),
        "forward_dynamics": (ps.forward_dynamics, {"robot": robot, "q": _Q, "v": _REST, "tau": [1.0] * 6,
            "friction": True}),
        "torque_terms": (ps.torque_terms, {"robot": robot, **state}),
        "worst_holding_torque": (ps.worst_holding_torque, {"robot": robot, "payload": ps.Payload(mass=1.0),
            "gap": 0.5}),
        "septic": (ps.septic, {**four, "start_velocity": _REST, "end_acceleration": _REST,
            "joint_names": list("abcdef")}),
        "lspb": (ps.lspb, {"points": four["points"], "durations": [1.0, 1.5, 1.5], "blend_time": 0.3}),
        "quintic_segments": (ps.quintic_segments, {**four, "velocities": [_REST] * 4, "accelerations": [_REST] * 4}),
        "profiles.double_s": (ps.profiles.double_s, {
            "points": POINTS, "max_velocity": 1.0, "max_acceleration": 2.0, "max_jerk": 30.0,
        }),
        "profiles.trapezoidal": (ps.profiles.trapezoidal, {**four, "blend_time": 0.2}),
        "profiles.bspline": (ps.profiles.bspline, {**four, "degree": 5}),
        "profiles.bspline_control": (ps.profiles.bspline_control, {**four, "degree": 3}),
        "profiles.polynomial_blends": (ps.profiles.polynomial_blends, {**four, "blend_time": 0.3, "degree": 5}),
        "profiles.bezier": (ps.profiles.bezier, four),
        "profiles.cubic_spline": (ps.profiles.cubic_spline, four),
        "profiles.make": (ps.profiles.make, {"name": "septic", **four}),
        "within_limits": (ps.within_limits, {
            "family": "quintic", "points": POINTS, "max_velocity": 1.0, "max_acceleration": 2.0, "max_jerk": 30.0,
        }),
        "Trajectory.__call__": (move(), {"t": 0.5, "order": 1}),
        "Trajectory.extrema": (move().extrema, {"order": 1}),
        "Trajectory.jumps": (move().jumps, {"order": 2}),
        "Piecewise.__call__": (motion.torque, {"t": [0.5, 1.0]}),
        "Piecewise.split": (motion.torque.split, {"times": [0.5]}),
        "compute_motion": (ps.compute_motion, {"robot": robot, "trajectory": move()}),
        "assess": (ps.assess, {"what": robot, "trajectory": move(), "dwell": 0.5, "floor": -1.0}),
        "assess_many": (ps.assess_many, {"robot": robot, "trajectories": [move()]}),
        "check_trajectory": (ps.check_trajectory, {
            "robot": robot, "trajectory": move(), "start": POINTS[0], "start_tolerance": 0.01,
                "allow": ("limit_unknown",),
        }),
        "least_stretch": (ps.least_stretch, {"robot": robot, "trajectory": move()}),
        "cycle.with_return": (ps.cycle.with_return, {"motion": motion, "dwell": 0.5}),
        "Cycle": (ps.Cycle, {"steps": cycle().steps}),
        "Dwell": (ps.Dwell, {"duration": 0.5, "holding_brake": False, "payload": ps.Payload(mass=1.0)}),
        "assess_cycle": (ps.assess_cycle, {"cycle": cycle(), "names": None, "floor": -2.0}),
        "size": (ps.size, {"cycle": cycle(), "drivetrains": ps.load_drivetrains(robot), "keep": 2, "rank": "mass"}),
        "minimum_duration": (ps.minimum_duration, {"motion": motion}),
        "maximum_payload": (ps.maximum_payload, {"motion": motion, "com": [0, 0, 0.1], "gyration": np.eye(3) * 0.01}),
        "duration_sweep": (ps.duration_sweep, {"motion": motion, "durations": [2.0, 3.0]}),
        "payload_sweep": (ps.payload_sweep, {"motion": motion, "masses": [0.0, 1.0], "com": [0, 0, 0.1]}),
        "payload_duration_map": (ps.payload_duration_map, {"motion": motion, "durations": [2.0, 3.0], "masses": [0.0,
            1.0]}),
        "payload_polygon": (ps.payload_polygon, {"robot": robot, "q": _Q, "direction": (0.0, 0.0, 1.0)}),
        "torque_uncertainty": (ps.torque_uncertainty, {
            "motion": motion, "mass": 0.1, "com": 0.01, "inertia": 0.1, "rotor": 0.1, "friction": 0.1, "samples": 8,
        }),
        "residual_vibration": (ps.residual_vibration, {"trajectory": move(), "frequency": [2.0, 5.0],
            "damping": 0.05}),
        "stop": (ps.stop, {"motion": motion, "t": 1.0, "category": 0, "brake_torque": [90.0] * 6,
            "reaction_time": 0.1}),
        "Controller": (ps.Controller, {
            "law": "pd", "bandwidth": 5.0, "damping_ratio": 0.7, "rate": 1000.0, "delay": 0.0,
                "encoder_resolution": 0.0,
        }),
        "paths.line": (ps.paths.line, {"T_from": T, "T_to": _shifted(T, 0.05)}),
        "paths.at_speed": (ps.paths.at_speed, {"path": line, "speed": 0.1, "acceleration": 0.5, "jerk": 5.0}),
        "replay_html": (ps.replay_html, {"what": motion, "title": "t", "labels": ("a",), "point_names": ("p", "q")}),
        "report_html": (ps.report_html, {"what": ps.assess(motion), "title": "t", "notes": ("n",)}),
    }  # fmt: skip


def run(count: int, seed: int) -> tuple[Counter[str], list[str]]:
    """So many calls with one bad argument, evenly over all arguments."""
    _files()
    table = _sound(calls())
    places = [(name, key) for name, (_, given) in table.items() for key in given]
    rng = np.random.default_rng([seed, 4])
    found: Counter[str] = Counter()
    kept = os.dup(1)
    examples: dict[str, str] = {}
    baseline = {name: _infinite(function(**given)) for name, (function, given) in table.items()}
    for k in range(count):
        name, key = places[k % len(places)]
        function, given = table[name]
        bad = _bad(rng, given[key], k // len(places))
        outcome, wrong = _called(function, {**given, key: bad}, baseline[name])
        if outcome == "not finite" and name in _MAY_BE_UNKNOWN and _has_nan(bad):
            outcome, wrong = "answer", ""
        found[outcome] += 1
        if wrong := wrong or _closed(kept):
            examples.setdefault(f"{name}({key}): {wrong}", _short(bad))
    return found, [f"{told}, of {example}" for told, example in examples.items()]


def _files() -> None:
    """What the calls read, in the current folder."""
    inputs()
    Path("plan.yaml").unlink(missing_ok=True)
    ps.write_joint_trajectory("plan.yaml", move())
    for name, kind in (("m.csv", "motors"), ("g.csv", "gearboxes")):
        shutil.copy(ROOT / "puma_septic" / "catalogues" / f"puma560_{kind}.csv", name)


def _sound(table: Mapping[str, tuple[Callable[..., Any], dict[str, Any]]]) -> dict[str, Any]:
    """The calls whose words the functions have; a function that changes its words must be changed here too."""
    for name, (function, given) in table.items():
        words = inspect.signature(function).parameters
        lacking = [
            key for key in given if key not in words and not any(p.kind is p.VAR_KEYWORD for p in words.values())
        ]
        if lacking:
            raise RuntimeError(f"{name} has no {', '.join(lacking)}, but {', '.join(words)}")
    return dict(table)


def _bad(rng: np.random.Generator, right: Any, turn: int) -> Any:
    """Another kind of value, or a right array with one number, its shape or its type changed."""
    try:
        array = np.array(right, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if not array.size or turn % 2:
        return _ANY[(turn // 2 + int(rng.integers(2))) % len(_ANY)]
    way = int(rng.integers(8))
    if way < 4 and array.ndim:
        array[tuple(int(rng.integers(n)) for n in array.shape)] = rng.choice(
            [np.nan, np.inf, -1e300, 1e150, 1e-300, -1.0]
        )
        return array
    return (
        array[..., None], array[:1] if array.ndim else -array, np.concatenate([array.ravel()] * 2),
            array.astype(complex) + 1j,
        np.ma.masked_array(array, mask=True), array.astype(str), array.astype(object), -array,
    )[int(rng.integers(8))]  # fmt: skip


def _called(function: Callable[..., Any], given: dict[str, Any], usual: set[str]) -> tuple[str, str]:
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("error", module="puma_septic")
            result = function(**given)
    except ps.PumaSepticError as error:
        return "own error", message_faults(str(error))
    except Exception as error:
        frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "puma_septic" in frame.filename]
        place = f"{Path(frames[-1].filename).name}:{frames[-1].name}" if frames else "outside"
        return "raw exception", f"{type(error).__name__} in {place}"
    strange = _infinite(result) - usual
    return ("not finite", f"not finite: {', '.join(sorted(strange))}") if strange else ("answer", "")


def _closed(kept: int) -> str:
    """Which of the process's own streams is closed, as a number in place of a path does; it is opened again."""
    closed = []
    for stream in (0, 1, 2):
        try:
            os.fstat(stream)
        except OSError:
            closed.append(str(stream))
            os.dup2(kept, stream)
    return f"closes stream {' and '.join(closed)}" if closed else ""


def _infinite(result: Any) -> set[str]:
    """Which arrays and numbers of an answer are not finite, one level deep; limits may be unknown."""
    if dataclasses.is_dataclass(result):
        parts = {field.name: getattr(result, field.name, None) for field in dataclasses.fields(result)}
    else:
        parts = {"result": result}
    return {
        name
        for name, value in parts.items()
        if isinstance(value, (float, np.ndarray))
        and np.asarray(value).dtype.kind in "fc"
        and not np.isfinite(value).all()
    }


def _has_nan(value: Any) -> bool:
    """Whether NaN was given, which is what such values have for what is not known; nothing behind a mask."""
    array = np.asarray(np.ma.getdata(value))
    return array.dtype.kind in "fc" and bool(np.isnan(array).any())


def _short(value: Any) -> str:
    return " ".join(ascii(value).split())[:60]


def _shifted(T: np.ndarray, by: float) -> np.ndarray:
    moved = np.array(T)
    moved[2, 3] += by
    return moved
