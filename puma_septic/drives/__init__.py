"""Motors, gearboxes and the electronics that feed them; catalogues to choose from."""

from puma_septic.drives._friction import Friction
from puma_septic.drives.catalogue import Catalogue, Pair
from puma_septic.drives.catalogue_files import BUILT_IN, built_in_catalogue, load_catalogue
from puma_septic.drives.drivetrain import Drivetrain
from puma_septic.drives.reading import load_drivetrains, own_drivetrains
from puma_septic.drives.values import Drive, Gearbox, Motor

__all__ = [
    "BUILT_IN",
    "Catalogue",
    "Drive",
    "Drivetrain",
    "Friction",
    "Gearbox",
    "Motor",
    "Pair",
    "built_in_catalogue",
    "load_catalogue",
    "load_drivetrains",
    "own_drivetrains",
]
