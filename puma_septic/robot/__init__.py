"""Robots: the values they are made of, their drivetrains, and how they are loaded."""

from puma_septic.robot._actuator import Actuator
from puma_septic.robot._drivetrains import load_drivetrains, own_drivetrains
from puma_septic.robot.loading import load_robot, robot_files
from puma_septic.robot.model import Robot
from puma_septic.robot.values import Limits, Payload, Wrench

__all__ = [
    "Actuator",
    "Limits",
    "Payload",
    "Robot",
    "Wrench",
    "load_drivetrains",
    "load_robot",
    "own_drivetrains",
    "robot_files",
]
