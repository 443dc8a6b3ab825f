"""Options in place of a task's section ``conditions``. Standard library alone."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError

from puma_septic.cli._numbers import finite, not_negative, positive, share

__all__ = ["CONDITIONS", "add_conditions"]

# Keys of a task's section of conditions that are one number, and what they are.
_NUMBERS = {
    "cycles_per_minute": (positive, "N", "cycle rate: what the moves leave of the time is rest"),
    "ambient_celsius": (finite, "C", "temperature of the surroundings (default: 40)"),
    "altitude": (positive, "M", "above sea level"),
    "bus_voltage": (positive, "V", "that reaches the motors"),
    "continuous_current": (positive, "A", "of each drive, in the measure of the torque constants"),
    "peak_current": (positive, "A", "of each drive, for a short time"),
    "continuous_power": (positive, "W", "that each drive can deliver, on average"),
    "peak_power": (positive, "W", "that each drive can deliver for a short time"),
    "brake_resistor_power": (positive, "W", "that each brake resistor bears"),
    "momentary_torque": (positive, "NM", "of a collision, at the gearboxes' outputs"),
    "required_life_hours": (positive, "H", "that the gearboxes are to last"),
    "max_inertia_ratio": (positive, "X", "largest ratio of load to rotor inertia that is accepted"),
}
CONDITIONS = (*_NUMBERS, "brake_at_rest", "margins", "own_masses")
"""The options that replace what a task's section `conditions` says."""


def add_conditions(parser: ArgumentParser) -> None:
    """An option for each condition."""
    group = parser.add_argument_group("conditions", "in place of those of the task")
    for name, (kind, metavar, meaning) in _NUMBERS.items():
        group.add_argument(f"--{name.replace('_', '-')}", type=kind, metavar=metavar, help=meaning)
    group.add_argument(
        "--brake-at-rest", action="store_true", default=None, help="brakes hold the arm while it rests, not the motors"
    )
    group.add_argument(
        "--margin",
        dest="margins",
        action="append",
        type=_margin,
        metavar="SHARE",
        help="what must be left of each limit, such as 0.2; or of one check, 'gearbox life=0.1' (repeatable)",
    )
    group.add_argument(
        "--supply-current",
        type=positive,
        metavar="A",
        help="that the bus of the whole arm can deliver, at --bus-voltage",
    )
    group.add_argument("--supply-power", type=positive, metavar="W", help="that the bus of the whole arm can deliver")
    group.add_argument(
        "--own-masses", nargs="+", type=not_negative, metavar="KG",
        help="with --masses: of the drives that the robot's model includes already, one for each joint",
    )  # fmt: skip


def _margin(text: str) -> tuple[str, float]:
    name, equals, value = text.rpartition("=")
    if equals and not name.strip():
        raise ArgumentTypeError(f"{text!r} is not SHARE or CHECK=SHARE")
    return (name.strip() or "all", share(value))
