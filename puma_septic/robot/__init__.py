"""Robots: the values they are made of, and how they are loaded."""

from puma_septic.robot.loading import load_robot, robot_files
from puma_septic.robot.model import Robot
from puma_septic.robot.values import Actuator, Limits, Payload, Wrench

__all__ = ["Actuator", "Limits", "Payload", "Robot", "Wrench", "load_robot", "robot_files"]
