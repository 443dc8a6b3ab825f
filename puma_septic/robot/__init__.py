"""Robots: the values they are made of, their drivetrains, and how they are loaded."""

from puma_septic.robot._actuator import Actuator
from puma_septic.robot._components import Limits, Payload, Wrench
from puma_septic.robot._drivetrains import load_drivetrains, load_electronics, own_drivetrains
from puma_septic.robot._loading import load_robot, robot_files
from puma_septic.robot._mimic import Mimic, inertia_matrices
from puma_septic.robot._model import Robot
from puma_septic.robot._names import is_robot_path, named_robots

__all__ = [
    "Actuator",
    "Limits",
    "Mimic",
    "Payload",
    "Robot",
    "Wrench",
    "inertia_matrices",
    "is_robot_path",
    "load_drivetrains",
    "load_electronics",
    "load_robot",
    "named_robots",
    "own_drivetrains",
    "robot_files",
]
