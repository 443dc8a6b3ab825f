"""Right calls of what is public, which the campaign then spoils in one argument; each takes well below a second.

Left out is what is only a result (its arguments are ours), what takes seconds or listens until it is told to stop
(`acceleration_limits`, `motion_limits`, `pareto_front`, `time_optimal`, `paper.reproduce`, `run_study`, `replay`,
`simulation.stop_table`), what reads the folder of a study, and the plots, which take our own results.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, Final

import numpy as np

import puma_septic as ps
from campaign.moves import POINTS, cycle, move, puma

Calls = dict[str, tuple[Callable[..., Any], dict[str, Any]]]

_Q: Final = [0.1, 0.6, -2.2, 0.1, 0.3, 0.1]
_REST: Final = [0.0] * 6


def calls() -> Calls:
    """A right call of everything public that is quick, by its name."""
    return _arms() | _parts() | _files() | _mechanics() | _profiles() | _paths() | _questions()


def _arms() -> Calls:
    robot = puma()
    return {
        "load_robot": (ps.load_robot, {
            "source": "puma560", "actuators": None, "parameters": "rtb", "limits": "corke", "tool": "flange",
            "package_dirs": (), "locked": {"joint6": 0.0}, "links": {"link6": ps.Payload(mass=0.1)},
            "gravity": (0.0, 0.0, -9.81),
        }),
        "Robot.with_limits": (robot.with_limits, {"velocity": 1.0, "jerk": [9.0] * 6, "position": [[-3.0, 3.0]] * 6,
            "limits": robot.limits}),
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
            "effort": [1.0, 1.0], "torque_rate": [1.0, 1.0], "source": "s",
        }),
        "Actuator": (ps.Actuator, {
            "gear_ratio": 10.0, "rotor_inertia": 1e-4, "viscous_friction": 1e-3, "coulomb_friction": [0.1, -0.1],
            "source": "s",
        }),
        "Friction": (ps.Friction, {"viscous": 0.1, "coulomb": [0.2, -0.2], "stribeck_velocity": 0.1, "static": [0.3,
            -0.3]}),
        "load_drivetrains": (ps.load_drivetrains, {"robot": robot, "path": None}),
        "own_drivetrains": (ps.own_drivetrains, {"robot": robot}),
    }  # fmt: skip


def _parts() -> Calls:
    train = ps.load_drivetrains(puma())[1]
    return {
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
        "built_in_catalogue": (ps.built_in_catalogue, {"name": "puma560"}),
        "load_catalogue": (ps.load_catalogue, {"motors": "m.csv", "gearboxes": "g.csv"}),
        "LinearStage": (ps.LinearStage, {
            "kind": "screw", "travel_per_turn": 0.01, "name": "s", "efficiency": 0.9, "inertia": 1e-5,
            "friction_force": 10.0, "max_force": 9e3, "max_speed": 1.0, "mass": 2.0,
        }),
        "Catalogue": (ps.Catalogue, {
            "motors": (train.motor,), "gearboxes": (train.gearbox,), "drives": (train.drive,),
        }),
        "Conditions": (ps.sizing.Conditions, {
            "ambient_celsius": 30.0, "bus_voltage": 48.0, "continuous_current": 5.0, "altitude": 500.0,
            "momentary_torque": 90.0, "required_life_hours": 2e4, "with_brake": True, "stages": {}, "supply": None,
            "margins": {"motor torque": 0.1},
        }),
        "sizing.accelerating_factor": (ps.sizing.accelerating_factor, {"continuous_torque": 1.0, "inertia": 1e-4}),
        "sizing.average_torque": (ps.sizing.average_torque, {
            "torques": [150.0, 82.0], "speeds": [10.0, 20.0], "durations": [0.2, 3.0], "exponent": 3.0,
        }),
        "sizing.bearing_life": (ps.sizing.bearing_life, {
            "dynamic_load": 2e4, "equivalent": 3e3, "mean_speed": 5.0,
        }),
        "sizing.equivalent_load": (ps.sizing.equivalent_load, {
            "axial": 100.0, "radial": 200.0, "tilting": 50.0, "diameter": 0.1,
        }),
        "sizing.allowed_momentary_peaks": (ps.sizing.allowed_momentary_peaks, {"input_speed": 300.0, "duration": 0.2}),
        "sizing.overload_time": (ps.sizing.overload_time, {"overload": 2.0, "time_constant": 600.0}),
    }  # fmt: skip


def _files() -> Calls:
    robot, motion = puma(), _motion()
    return {
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
        "load_study": (ps.load_study, {"path": "study.yaml"}),
        "read_csv_trajectory": (ps.read_csv_trajectory, {"path": "log.csv", "max_gap": 1.0}),
        "read_joint_trajectories": (ps.read_joint_trajectories, {
            "path": "plan.yaml", "robot": robot, "start": None, "topic": None,
        }),
        "fit_residual": (ps.fit_residual, {"trajectory": move()}),
        "write_joint_trajectory": (ps.write_joint_trajectory, {
            "path": "written.yaml", "trajectory": move(), "joint_names": robot.joint_names, "effort": motion.torque,
            "tolerance": 1e-5, "overwrite": True,
        }),
        "write_replay": (ps.write_replay, {
            "path": "written.html", "what": motion, "labels": ("a",), "title": "t", "point_names": ("p", "q"),
            "overwrite": True,
        }),
        "write_report": (ps.write_report, {
            "path": "report.html", "what": ps.assess(motion), "title": "t", "overwrite": True,
        }),
        "replay_html": (ps.replay_html, {"what": motion, "title": "t", "labels": ("a",), "point_names": ("p", "q")}),
        "report_html": (ps.report_html, {"what": ps.assess(motion), "title": "t", "notes": ("n",)}),
    }  # fmt: skip


def _mechanics() -> Calls:
    robot = puma()
    state = {"q": _Q, "v": [0.1] * 6, "a": [0.2] * 6}
    T = ps.forward_kinematics(robot, _Q)
    return {
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
    }  # fmt: skip


def _profiles() -> Calls:
    four, motion = _four(), _motion()
    return {
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
        "profiles.bang_bang": (ps.profiles.bang_bang, four),
        "profiles.cubic": (ps.profiles.cubic, four),
        "profiles.cycloidal": (ps.profiles.cycloidal, four),
        "profiles.harmonic": (ps.profiles.harmonic, four),
        "profiles.linear": (ps.profiles.linear, four),
        "profiles.modified_sine": (ps.profiles.modified_sine, four),
        "profiles.modified_trapezoidal": (ps.profiles.modified_trapezoidal, four),
        "profiles.quintic": (ps.profiles.quintic, four),
        "profiles.quintic_spline": (ps.profiles.quintic_spline, four),
        "profiles.septic_spline": (ps.profiles.septic_spline, four),
        "profiles.poly_434": (ps.profiles.poly_434, four),
        "profiles.poly_353": (ps.profiles.poly_353, four),
        "profiles.classic_septic": (ps.profiles.classic_septic, four),
        "profiles.single_polynomial": (ps.profiles.single_polynomial, {
            **four, "start_velocity": _REST, "end_acceleration": _REST,
        }),
        "profiles.cubic_spline_free_knots": (ps.profiles.cubic_spline_free_knots, four),
        "profiles.trigonometric_spline": (ps.profiles.trigonometric_spline, {**four, "angle": 0.7}),
        "profiles.family": (ps.profiles.family, {"name": "septic"}),
        "Trajectory": (ps.Trajectory, {
            "position": move().position, "points": POINTS, "times": [0.0, 2.0], "profile": "p",
            "joint_names": list(puma().joint_names), "rest_before": True, "rest_after": True, "resolution": 0.0,
            "doubts": ("d",), "remarks": ("r",),
        }),
        "Piecewise": (ps.Piecewise, {"breaks": [0.0, 1.0], "coefficients": [[[1.0]], [[0.5]]]}),
        "Piecewise.from_power": (ps.Piecewise.from_power, {"breaks": [0.0, 1.0], "powers": [[[1.0]], [[0.5]]]}),
        "Piecewise.fit": (partial(ps.Piecewise.fit, _column), {"breaks": [0.0, 1.0], "tolerance": 1e-9}),
    }  # fmt: skip


def _paths() -> Calls:
    robot = puma()
    T = ps.forward_kinematics(robot, _Q)
    line = ps.paths.line(T, _shifted(T, 0.05))
    law = ps.paths.in_time(line, 1.0)
    return {
        "paths.line": (ps.paths.line, {"T_from": T, "T_to": _shifted(T, 0.05)}),
        "paths.arc": (ps.paths.arc, {
            "T_from": T, "via": T[:3, 3] + [0.03, 0.0, 0.03], "T_to": T[:3, 3] + [0.0, 0.0, 0.06],
            "orientation": "held",
        }),
        "paths.circle": (ps.paths.circle, {
            "T_from": T, "centre": T[:3, 3] + [0.0, 0.0, 0.03], "axis": [1.0, 0.0, 0.0], "angle": 3.0,
            "orientation": "held",
        }),
        "paths.polyline": (ps.paths.polyline, {
            "poses": [T, _shifted(T, 0.05), _shifted(_shifted(T, 0.05), 0.05, 0)], "zone": 0.01,
        }),
        "Path.frames": (line.frames, {"s": [0.0, 0.01]}),
        "paths.in_time": (ps.paths.in_time, {
            "path": line, "duration": 1.0, "profile": "quintic_segments", "options": {},
        }),
        "paths.at_speed": (ps.paths.at_speed, {"path": line, "speed": 0.1, "acceleration": 0.5, "jerk": 5.0}),
        "paths.follow": (ps.paths.follow, {
            "robot": robot, "path": line, "branch": None, "start": _Q, "constrain": "pose",
        }),
        "paths.timed": (ps.paths.timed, {"way": ps.paths.follow(robot, line), "law": law}),
        "tool_move": (ps.tool_move, {"robot": robot, "path": line, "law": law, "start": _Q, "constrain": "pose"}),
        "paths.tool_rates": (ps.paths.tool_rates, {"robot": robot, "trajectory": move()}),
        "paths.ToolLimits": (ps.paths.ToolLimits, {
            "speed": 1.0, "acceleration": 5.0, "jerk": 50.0, "angular_speed": 2.0, "source": "s",
        }),
    }  # fmt: skip


def _questions() -> Calls:
    robot, motion = puma(), _motion()
    three = [_Q, [0.3, 0.8, -2.4, 0.2, 0.4, 0.2], [0.5, 1.0, -2.6, 0.1, 0.5, 0.1]]
    return {
        "compute_motion": (ps.compute_motion, {"robot": robot, "trajectory": move()}),
        "assess": (ps.assess, {
            "what": robot, "trajectory": move(), "dwell": 0.5, "floor": -1.0,
            "tool_limits": ps.paths.ToolLimits(speed=2.0),
        }),
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
        "judge_many": (ps.judge_many, {"robot": robot, "trajectories": [move()]}),
        "compare": (ps.compare, {
            "robot": robot, "points": POINTS, "times": [0.0, 2.0], "profiles": ["quintic_segments"], "options": {},
            "beside": {"mine": move()}, "dwell": 0.1, "floor": -1.0, "objectives": ("integral_of_squared_jerk",),
        }),
        "cycle.way_back": (ps.cycle.way_back, {"motion": motion, "robot": robot}),
        "doctor.doubts": (ps.doctor.doubts, {"robot": robot}),
        "doctor.examine": (ps.doctor.examine, {"robot": robot}),
        "LoadCase": (ps.sizing.LoadCase, {
            "name": "c", "cycle": cycle(), "share": 0.5, "joints": ("joint2",), "is_rare": False, "is_powered": True,
            "note": "n",
        }),
        "sizing.joint_load": (ps.sizing.joint_load, {"cycle": cycle(), "j": 1}),
        "sizing.load_cases_of": (ps.sizing.load_cases_of, {
            "resolved": ps.resolve_task(ps.load_task("paper")), "one_way": True,
        }),
        "sizing.with_drive_masses": (ps.sizing.with_drive_masses, {
            "robot": robot, "masses": [1.0] * 6, "placement": "before",
        }),
        "payload_over_duration": (ps.payload_over_duration, {
            "motion": motion, "durations": [2.0, 3.0], "com": [0, 0, 0.1], "gyration": np.eye(3) * 0.01,
        }),
        "payload_diagram": (ps.payload_diagram, {
            "motions": [motion], "offsets": [0.0, 0.1], "direction": (0.0, 0.0, 1.0),
        }),
        "least_time": (ps.least_time, {
            "make": ps.quintic_segments, "points": POINTS, "times": [0.0, 2.0], "robot": robot, "max_velocity": 2.0,
            "max_acceleration": [9.0] * 6, "max_jerk": 90.0, "restarts": 0, "seed": 1,
        }),
        "optimise_via_times": (ps.optimise_via_times, {
            "make": ps.profiles.cubic_spline, "points": three, "times": [0.0, 1.0, 2.0],
            "objective": "integral_of_squared_acceleration", "free": (), "max_overshoot": 0.1, "keep": (),
            "restarts": 0, "seed": 1, "dwell": 0.1,
        }),
        "vibration.Shaper": (ps.vibration.Shaper, {"weights": [0.5, 0.5], "delays": [0.0, 0.1], "name": "zv"}),
        "vibration.input_shaper": (ps.vibration.input_shaper, {"name": "zv", "frequency": 5.0, "damping": 0.05}),
        "vibration.shaped": (ps.vibration.shaped, {
            "trajectory": move(), "shaper": ps.vibration.input_shaper("zv", 5.0),
        }),
        "vibration.natural_frequencies": (ps.vibration.natural_frequencies, {
            "robot": robot, "q": _Q, "stiffness": [1e4] * 6,
        }),
        "vibration.stiffness_for": (ps.vibration.stiffness_for, {"robot": robot, "q": _Q, "frequency": 10.0}),
        "vibration.nulling_durations": (ps.vibration.nulling_durations, {
            "trajectory": move(), "frequency": 2.0, "longest": 3.0,
        }),
        "ElasticJoints": (ps.ElasticJoints, {"stiffness": [1e4] * 6, "damping": [9.0] * 6, "source": "s"}),
        "ElasticJoints.of_frequency": (ps.ElasticJoints.of_frequency, {
            "robot": robot, "q": _Q, "frequency": 10.0, "damping_ratio": 0.05,
        }),
        "simulate": (ps.simulate, {
            "robot": robot, "trajectory": _short(), "controller": "pd", "elastic": None, "settle": 0.01, "step": None,
            "rest_speed": 0.01,
        }),
        "execute": (ps.execute, {
            "robot": robot, "trajectories": {"a": _short()}, "controller": "pd", "settle": 0.01, "rest_speed": 0.01,
        }),
    }  # fmt: skip


def _motion() -> ps.Motion:
    return ps.compute_motion(puma(), move())


def _four() -> dict[str, Any]:
    points = np.array(
        [_Q, [0.3, 0.8, -2.4, 0.2, 0.4, 0.2], [0.5, 1.0, -2.6, 0.1, 0.5, 0.1], [0.8, 1.1, -2.5, 0, 0.3, 0]]
    )
    return {"points": points, "times": [0.0, 1.0, 2.5, 4.0]}


def _short() -> ps.Trajectory:
    return ps.quintic_segments(np.array([_Q, np.add(_Q, 0.01)]), [0.0, 0.05], joint_names=puma().joint_names)


def _column(t: np.ndarray) -> np.ndarray:
    return np.sin(t)[:, None]


def _shifted(T: np.ndarray, by: float, axis: int = 2) -> np.ndarray:
    moved = np.array(T)
    moved[axis, 3] += by
    return moved
