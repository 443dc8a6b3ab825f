"""Joint trajectories of robot arms: the torque they need, checked against what the motors can do.

The public names are loaded when they are first used, so that importing the package and
``puma-septic --help`` answer at once.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Final

from puma_septic._version import __version__

# A public name has one line here, for the interpreter, and one below, for the type checker.
_HOMES: Final = {
    "AccelerationLimits": "worst_case",
    "Actuator": "robot",
    "Assessment": "assessment",
    "Catalogue": "drives",
    "Comparison": "comparison",
    "Controller": "simulation",
    "Cycle": "cycle",
    "CycleAssessment": "cycle",
    "Drive": "drives",
    "Drivetrain": "drives",
    "Dwell": "cycle",
    "ElasticJoints": "simulation",
    "Execution": "simulation",
    "Friction": "friction",
    "Gearbox": "drives",
    "IkSolutions": "kinematics",
    "InputError": "errors",
    "JointTrajectoryError": "ros",
    "LeastTime": "optimisation",
    "Limits": "robot",
    "LinearStage": "drives",
    "ManyAssessments": "batch",
    "ManyVerdicts": "batch",
    "MaximumPayload": "limits",
    "MinimumDuration": "limits",
    "ModelError": "errors",
    "Motion": "motion",
    "Motor": "drives",
    "NoSolution": "errors",
    "OptimisedTimes": "optimisation",
    "ParetoFront": "optimisation",
    "Payload": "robot",
    "PayloadPolygon": "limits",
    "Piecewise": "piecewise",
    "PumaSepticError": "errors",
    "Replay": "viewer",
    "ResolvedCycle": "task",
    "ResolvedTask": "task",
    "Robot": "robot",
    "Selection": "sizing",
    "Simulation": "simulation",
    "Sizing": "sizing",
    "Supply": "drives",
    "Sweep": "limits",
    "Task": "task",
    "Trajectory": "trajectory",
    "TrajectoryCheck": "gate",
    "WorstHolding": "worst_case",
    "Wrench": "robot",
    "acceleration_limits": "worst_case",
    "assess": "assessment",
    "assess_cycle": "cycle",
    "assess_many": "batch",
    "assess_task": "task",
    "built_in_catalogue": "drives",
    "check_trajectory": "gate",
    "compare": "comparison",
    "compute_motion": "motion",
    "cycle": "cycle",
    "doctor": "doctor",
    "execute": "simulation",
    "duration_sweep": "limits",
    "fit_residual": "logs",
    "fit_trajectory": "logs",
    "forward_dynamics": "dynamics",
    "forward_kinematics": "kinematics",
    "inverse_dynamics": "dynamics",
    "inverse_kinematics": "kinematics",
    "inverse_kinematics_batch": "kinematics",
    "jacobian": "kinematics",
    "judge_many": "batch",
    "least_stretch": "gate",
    "least_time": "optimisation",
    "load_catalogue": "drives",
    "load_drivetrains": "robot",
    "load_robot": "robot",
    "load_study": "study",
    "load_task": "task",
    "lowest_points": "kinematics",
    "lspb": "profiles",
    "make_study": "study",
    "maximum_payload": "limits",
    "minimum_duration": "limits",
    "motion_limits": "limits",
    "optimise_via_times": "optimisation",
    "own_drivetrains": "robot",
    "paper": "paper",
    "pareto_front": "optimisation",
    "paths": "paths",
    "payload_diagram": "limits",
    "payload_duration_map": "limits",
    "payload_over_duration": "limits",
    "payload_polygon": "limits",
    "payload_sweep": "limits",
    "plots": "plots",
    "profiles": "profiles",
    "quintic_segments": "profiles",
    "read_csv_trajectory": "logs",
    "read_joint_trajectories": "ros",
    "read_joint_trajectory": "ros",
    "read_log": "logs",
    "replay": "viewer",
    "replay_html": "viewer",
    "report_html": "report.page",
    "residual_vibration": "vibration",
    "resolve_cycle": "task",
    "resolve_task": "task",
    "run_study": "study",
    "septic": "profiles",
    "simulate": "simulation",
    "simulation": "simulation",
    "stop": "simulation",
    "size": "sizing",
    "sizing": "sizing",
    "study_map": "study",
    "summarise_study": "study",
    "time_optimal": "optimum",
    "tool_motion": "kinematics",
    "tool_move": "paths",
    "torque_terms": "dynamics",
    "torque_uncertainty": "limits",
    "vibration": "vibration",
    "within_limits": "limits",
    "worst_holding_torque": "worst_case",
    "write_joint_trajectory": "ros",
    "write_replay": "viewer",
    "write_report": "report.page",
}

__all__ = ["__version__", *_HOMES]

if TYPE_CHECKING:
    from puma_septic import cycle as cycle
    from puma_septic import doctor as doctor
    from puma_septic import paper as paper
    from puma_septic import paths as paths
    from puma_septic import plots as plots
    from puma_septic import profiles as profiles
    from puma_septic import simulation as simulation
    from puma_septic import sizing as sizing
    from puma_septic import vibration as vibration
    from puma_septic.assessment import Assessment as Assessment
    from puma_septic.assessment import assess as assess
    from puma_septic.batch import ManyAssessments as ManyAssessments
    from puma_septic.batch import ManyVerdicts as ManyVerdicts
    from puma_septic.batch import assess_many as assess_many
    from puma_septic.batch import judge_many as judge_many
    from puma_septic.comparison import Comparison as Comparison
    from puma_septic.comparison import compare as compare
    from puma_septic.cycle import Cycle as Cycle
    from puma_septic.cycle import CycleAssessment as CycleAssessment
    from puma_septic.cycle import Dwell as Dwell
    from puma_septic.cycle import assess_cycle as assess_cycle
    from puma_septic.drives import Catalogue as Catalogue
    from puma_septic.drives import Drive as Drive
    from puma_septic.drives import Drivetrain as Drivetrain
    from puma_septic.drives import Gearbox as Gearbox
    from puma_septic.drives import LinearStage as LinearStage
    from puma_septic.drives import Motor as Motor
    from puma_septic.drives import Supply as Supply
    from puma_septic.drives import built_in_catalogue as built_in_catalogue
    from puma_septic.drives import load_catalogue as load_catalogue
    from puma_septic.dynamics import forward_dynamics as forward_dynamics
    from puma_septic.dynamics import inverse_dynamics as inverse_dynamics
    from puma_septic.dynamics import torque_terms as torque_terms
    from puma_septic.errors import InputError as InputError
    from puma_septic.errors import ModelError as ModelError
    from puma_septic.errors import NoSolution as NoSolution
    from puma_septic.errors import PumaSepticError as PumaSepticError
    from puma_septic.friction import Friction as Friction
    from puma_septic.gate import TrajectoryCheck as TrajectoryCheck
    from puma_septic.gate import check_trajectory as check_trajectory
    from puma_septic.gate import least_stretch as least_stretch
    from puma_septic.kinematics import IkSolutions as IkSolutions
    from puma_septic.kinematics import forward_kinematics as forward_kinematics
    from puma_septic.kinematics import inverse_kinematics as inverse_kinematics
    from puma_septic.kinematics import inverse_kinematics_batch as inverse_kinematics_batch
    from puma_septic.kinematics import jacobian as jacobian
    from puma_septic.kinematics import lowest_points as lowest_points
    from puma_septic.kinematics import tool_motion as tool_motion
    from puma_septic.limits import MaximumPayload as MaximumPayload
    from puma_septic.limits import MinimumDuration as MinimumDuration
    from puma_septic.limits import PayloadPolygon as PayloadPolygon
    from puma_septic.limits import Sweep as Sweep
    from puma_septic.limits import duration_sweep as duration_sweep
    from puma_septic.limits import maximum_payload as maximum_payload
    from puma_septic.limits import minimum_duration as minimum_duration
    from puma_septic.limits import motion_limits as motion_limits
    from puma_septic.limits import payload_diagram as payload_diagram
    from puma_septic.limits import payload_duration_map as payload_duration_map
    from puma_septic.limits import payload_over_duration as payload_over_duration
    from puma_septic.limits import payload_polygon as payload_polygon
    from puma_septic.limits import payload_sweep as payload_sweep
    from puma_septic.limits import torque_uncertainty as torque_uncertainty
    from puma_septic.limits import within_limits as within_limits
    from puma_septic.logs import fit_residual as fit_residual
    from puma_septic.logs import fit_trajectory as fit_trajectory
    from puma_septic.logs import read_csv_trajectory as read_csv_trajectory
    from puma_septic.logs import read_log as read_log
    from puma_septic.motion import Motion as Motion
    from puma_septic.motion import compute_motion as compute_motion
    from puma_septic.optimisation import LeastTime as LeastTime
    from puma_septic.optimisation import OptimisedTimes as OptimisedTimes
    from puma_septic.optimisation import ParetoFront as ParetoFront
    from puma_septic.optimisation import least_time as least_time
    from puma_septic.optimisation import optimise_via_times as optimise_via_times
    from puma_septic.optimisation import pareto_front as pareto_front
    from puma_septic.optimum import time_optimal as time_optimal
    from puma_septic.paths import tool_move as tool_move
    from puma_septic.piecewise import Piecewise as Piecewise
    from puma_septic.profiles import lspb as lspb
    from puma_septic.profiles import quintic_segments as quintic_segments
    from puma_septic.profiles import septic as septic
    from puma_septic.report.page import report_html as report_html
    from puma_septic.report.page import write_report as write_report
    from puma_septic.robot import Actuator as Actuator
    from puma_septic.robot import Limits as Limits
    from puma_septic.robot import Payload as Payload
    from puma_septic.robot import Robot as Robot
    from puma_septic.robot import Wrench as Wrench
    from puma_septic.robot import load_drivetrains as load_drivetrains
    from puma_septic.robot import load_robot as load_robot
    from puma_septic.robot import own_drivetrains as own_drivetrains
    from puma_septic.ros import JointTrajectoryError as JointTrajectoryError
    from puma_septic.ros import read_joint_trajectories as read_joint_trajectories
    from puma_septic.ros import read_joint_trajectory as read_joint_trajectory
    from puma_septic.ros import write_joint_trajectory as write_joint_trajectory
    from puma_septic.simulation import Controller as Controller
    from puma_septic.simulation import ElasticJoints as ElasticJoints
    from puma_septic.simulation import Execution as Execution
    from puma_septic.simulation import Simulation as Simulation
    from puma_septic.simulation import execute as execute
    from puma_septic.simulation import simulate as simulate
    from puma_septic.simulation import stop as stop
    from puma_septic.sizing import Selection as Selection
    from puma_septic.sizing import Sizing as Sizing
    from puma_septic.sizing import size as size
    from puma_septic.study import load_study as load_study
    from puma_septic.study import make_study as make_study
    from puma_septic.study import run_study as run_study
    from puma_septic.study import study_map as study_map
    from puma_septic.study import summarise_study as summarise_study
    from puma_septic.task import ResolvedCycle as ResolvedCycle
    from puma_septic.task import ResolvedTask as ResolvedTask
    from puma_septic.task import Task as Task
    from puma_septic.task import assess_task as assess_task
    from puma_septic.task import load_task as load_task
    from puma_septic.task import resolve_cycle as resolve_cycle
    from puma_septic.task import resolve_task as resolve_task
    from puma_septic.trajectory import Trajectory as Trajectory
    from puma_septic.vibration import residual_vibration as residual_vibration
    from puma_septic.viewer import Replay as Replay
    from puma_septic.viewer import replay as replay
    from puma_septic.viewer import replay_html as replay_html
    from puma_septic.viewer import write_replay as write_replay
    from puma_septic.worst_case import AccelerationLimits as AccelerationLimits
    from puma_septic.worst_case import WorstHolding as WorstHolding
    from puma_septic.worst_case import acceleration_limits as acceleration_limits
    from puma_septic.worst_case import worst_holding_torque as worst_holding_torque
else:  # hidden from the type checker, which would take every misspelt name for an attribute

    def __getattr__(name: str) -> object:
        """Load a public name from its home; a module that is public itself is its own home."""
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        home = _HOMES[name]
        module = import_module(f"{__name__}.{home}")
        globals()[name] = value = module if home == name else getattr(module, name)
        return value


def __dir__() -> list[str]:
    return sorted(__all__)
