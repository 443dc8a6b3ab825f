"""Each picture described once: what is drawn, in data coordinates, by whatever draws it.

A `Picture` has panels, a panel curves, marks, limits and bars; `puma_septic.plots` draws it with matplotlib,
`puma_septic.report` as SVG. Pictures of comparisons, optimisations, sizings and the paper are in modules of their own,
since what they show takes longer to load than a motion takes to draw.

To add one, write a function that returns a `Picture`, and name it where those of its kind are listed
(`motion_pictures`, `sizing_pictures`): page and files follow.
"""

from puma_septic.pictures._elements import ASPECT, Bar, Curve, Entry, Mark, Panel, Picture, Rule, bars, chart
from puma_septic.pictures._motion import (
    assessment_pictures,
    derivative_picture,
    motion_pictures,
    profile_entries,
    singularity_picture,
    tool_picture,
    torque_picture,
    torque_speed_picture,
    torque_split_picture,
    via_places,
)
from puma_septic.pictures._samples import Samples, Track, samples_of, track_of
from puma_septic.pictures._styles import HUES, LIMIT, PROFILES, Dot, Fill, Hue, Line, cause_lines, profile_line
from puma_septic.pictures._units import in_units
from puma_septic.pictures._utilisation import utilisation_picture

__all__ = [
    "ASPECT",
    "HUES",
    "LIMIT",
    "PROFILES",
    "Bar",
    "Curve",
    "Dot",
    "Entry",
    "Fill",
    "Hue",
    "Line",
    "Mark",
    "Panel",
    "Picture",
    "Rule",
    "Samples",
    "Track",
    "assessment_pictures",
    "bars",
    "cause_lines",
    "chart",
    "derivative_picture",
    "in_units",
    "motion_pictures",
    "profile_entries",
    "profile_line",
    "samples_of",
    "singularity_picture",
    "tool_picture",
    "torque_picture",
    "torque_speed_picture",
    "torque_split_picture",
    "track_of",
    "utilisation_picture",
    "via_places",
]
