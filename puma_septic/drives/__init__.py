"""Motors, gearboxes and the electronics that feed them; catalogues to choose from."""

from puma_septic.drives._catalogue import Catalogue, Pair
from puma_septic.drives._catalogue_files import BUILT_IN, built_in_catalogue, load_catalogue
from puma_septic.drives._drivetrain import Drivetrain
from puma_septic.drives._least_set import LEAST_SET, lacking, lacking_of_pairs, names_of
from puma_septic.drives._parts import Drive, Gearbox, Motor
from puma_septic.friction import Friction

__all__ = [
    "BUILT_IN",
    "LEAST_SET",
    "Catalogue",
    "Drive",
    "Drivetrain",
    "Friction",
    "Gearbox",
    "Motor",
    "Pair",
    "built_in_catalogue",
    "lacking",
    "lacking_of_pairs",
    "load_catalogue",
    "names_of",
]
