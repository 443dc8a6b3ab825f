"""Motors, gearboxes and the electronics that feed them."""

from puma_septic.drives.drivetrain import Drivetrain
from puma_septic.drives.reading import load_drivetrains, own_drivetrains
from puma_septic.drives.values import Drive, Friction, Gearbox, Motor

__all__ = ["Drive", "Drivetrain", "Friction", "Gearbox", "Motor", "load_drivetrains", "own_drivetrains"]
