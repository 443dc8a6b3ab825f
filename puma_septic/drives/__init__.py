"""Motors, gearboxes and the electronics that feed them; catalogues to choose from."""

from puma_septic.drives._catalogue import Catalogue, Pair
from puma_septic.drives._catalogue_files import BUILT_IN, built_in_catalogue, load_catalogue
from puma_septic.drives._drive import Drive
from puma_septic.drives._drivetrain import Drivetrain
from puma_septic.drives._gearbox import Gearbox
from puma_septic.drives._least_set import LEAST_SET, lacking, lacking_of_pairs, names_of
from puma_septic.drives._motor import Motor
from puma_septic.drives._stage import LinearStage
from puma_septic.drives._supply import Supply
from puma_septic.friction import Friction

__all__ = [
    "BUILT_IN",
    "LEAST_SET",
    "Catalogue",
    "Drive",
    "Drivetrain",
    "Friction",
    "Gearbox",
    "LinearStage",
    "Motor",
    "Pair",
    "Supply",
    "built_in_catalogue",
    "lacking",
    "lacking_of_pairs",
    "load_catalogue",
    "names_of",
]
