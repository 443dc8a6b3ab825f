"""Which column of a file is what, and in which unit."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, final

from puma_septic.errors import InputError

__all__ = ["UNITS", "Column", "Layout", "is_unit", "laid_out", "unit_of"]

# Factors to SI: rad = pi/180 deg (SI brochure, 9th edition, table 8).
_DEGREE: Final = 0.017453292519943295
UNITS: Final[Mapping[str, Mapping[str, float]]] = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "position": {"rad": 1.0, "deg": _DEGREE, "m": 1.0, "mm": 1e-3},
    "velocity": {"rad/s": 1.0, "deg/s": _DEGREE, "m/s": 1.0, "mm/s": 1e-3},
    "effort": {"N m": 1.0, "Nm": 1.0, "N": 1.0},
    "current": {"A": 1.0, "mA": 1e-3},
}
_TIMES: Final = ("t", "time", "timestamp", "stamp")
# Words beside a joint's name, before or behind it.
_WORDS: Final[Mapping[str, str]] = {
    "position": "position", "pos": "position", "q": "position", "actual_q": "position",
    "velocity": "velocity", "vel": "velocity", "qd": "velocity", "speed": "velocity",
    "effort": "effort", "torque": "effort", "tau": "effort",
    "current": "current", "amps": "current",
}  # fmt: skip
# Derived signals, and marks, of samples.csv files: no joints.
_OTHERS: Final = ("acceleration", "jerk", "side")
_BESIDE: Final = r"[ _./:-]+"
_UNIT: Final = re.compile(r"^(.*?)\s*[\[(]([^\[\]()]*)[\])]$")


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One column of a file that is read.

    Attributes
    ----------
    index : int
    name : str
        As the file calls it.
    quantity : str
    joint : str
        Empty for the time.
    unit : str
        Empty where nobody has said it.
    """

    index: int
    name: str
    quantity: str
    joint: str = ""
    unit: str = ""

    @property
    def factor(self) -> float:
        """To SI; what has no unit is in SI."""
        return UNITS[self.quantity][self.unit] if self.unit else 1.0


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """The columns that are read, and the names of those that are not."""

    columns: tuple[Column, ...]
    ignored: tuple[str, ...]

    def of(self, quantity: str) -> dict[str, Column]:
        """The columns of a quantity by joint."""
        return {column.joint: column for column in self.columns if column.quantity == quantity}

    @property
    def joints(self) -> tuple[str, ...]:
        """Joints with a position, in the order of the file."""
        return tuple(self.of("position"))


def is_unit(text: str) -> bool:
    """Whether a cell is nothing but a unit, as in a row of units below the header."""
    return any(text.strip().strip("[]()") in units for units in UNITS.values())


def unit_of(quantity: str, text: str, where: str) -> str:
    """A unit of this quantity.

    Raises
    ------
    InputError
        For another one.
    """
    if text not in UNITS[quantity]:
        raise InputError(f"{where}: {text!r} is no unit of {quantity}; valid: {', '.join(UNITS[quantity])}")
    return text


def laid_out(
    where: str,
    header: Sequence[str],
    *,
    joints: Sequence[str] | None,
    chosen: Mapping[str, str],
    unit_row: Sequence[str] = (),
    units: Sequence[str] = (),
) -> Layout:
    """What each column of a header is.

    Parameters
    ----------
    where : str
        File and row, for messages.
    joints : sequence of str, optional
        The robot's; without, every column that is not the time and not named by another quantity is a joint.
    chosen : mapping
        From "time", "JOINT", "JOINT.velocity", "JOINT.effort" or "JOINT.current" to the name of a column, with a unit
        in brackets where that is to be said: ``{"time": "stamp[ms]", "elbow": "q3[deg]"}``.
    unit_row : sequence of str
        Units below the header.
    units : sequence of str
        Of all columns that have none of their own.

    Raises
    ------
    InputError
        For a header without time or a joint, names that are used twice, choices and units that do not fit.
    """
    names = [_name_and_unit(cell)[0] for cell in header]
    below = [*unit_row, *[""] * len(header)]
    spelt = [_name_and_unit(cell)[1] or below[k].strip().strip("[]()") for k, cell in enumerate(header)]
    found = _chosen(where, header, names, chosen, joints)
    # Whoever names joints one by one means these.
    joints = joints or [column.joint for column in found if column.quantity == "position"]
    taken = {column.index for column in found}
    known = {(column.quantity, column.joint) for column in found}
    for index, quantity, joint in _recognised(names, joints or ()):
        if index not in taken and (quantity, joint) not in known:
            found.append(Column(index=index, name=header[index], quantity=quantity, joint=joint))
            known.add((quantity, joint))
        elif index not in taken and quantity in ("time", "position"):
            raise InputError(
                f"{where}, column {index + 1}: the name {header[index]!r} is used twice; each needs its own"
            )
    columns = [_with_unit(where, column, spelt[column.index], units) for column in found]
    layout = Layout(
        columns=tuple(sorted(columns, key=lambda column: column.index)),
        ignored=tuple(name for k, name in enumerate(header) if k not in {column.index for column in columns}),
    )
    _check(where, header, layout, joints)
    return layout


def _name_and_unit(cell: str) -> tuple[str, str]:
    """``q1 [deg]`` is q1 in deg; a time may carry its unit behind a low line: ``time_ms``."""
    match = _UNIT.match(cell.strip())
    if match and is_unit(match[2]):
        return match[1], match[2].strip()
    name, line, unit = cell.strip().rpartition("_")
    if line and name.lower() in _TIMES and unit in UNITS["time"]:
        return name, unit
    return cell.strip(), ""


def _chosen(
    where: str, header: Sequence[str], names: Sequence[str], chosen: Mapping[str, str], joints: Sequence[str] | None
) -> list[Column]:
    columns = []
    for key, value in chosen.items():
        joint, dot, quantity = key.rpartition(".")
        if key == "time":
            quantity, joint = "time", ""
        elif not dot or quantity not in ("velocity", "effort", "current", "position"):
            quantity, joint = "position", key
        if joint and joints is not None and joint not in joints:
            raise InputError(f"columns: {key!r} names no joint; valid: time, {', '.join(joints)}, or one of these with"
                             " .velocity, .effort or .current")  # fmt: skip
        name, unit = (value, "") if value in header else _name_and_unit(value)
        places = [k for k, (cell, plain) in enumerate(zip(header, names, strict=True)) if name in (cell, plain)]
        if len(places) != 1:
            problem = "no column" if not places else f"{len(places)} columns"
            raise InputError(f"{where}: {problem} {name!r} for {key!r}; the columns are {', '.join(map(repr, header))}")
        if unit:
            unit_of(quantity, unit, f"columns: {key}={value}")
        columns.append(Column(index=places[0], name=header[places[0]], quantity=quantity, joint=joint, unit=unit))
    return columns


def _recognised(names: Sequence[str], joints: Sequence[str]) -> list[tuple[int, str, str]]:
    """Index, quantity and joint of every column whose name tells them."""
    read = [_split(name, joints) for name in names]
    # Where positions are named as such, a bare name is something else.
    spelt = any(quantity == "position" and explicit for quantity, _, explicit in read)
    found = []
    positions = {joint for quantity, joint, explicit in read if quantity == "position" and (explicit or not spelt)}
    for index, (quantity, joint, explicit) in enumerate(read):
        if quantity == "position":
            wanted = bool(explicit or not spelt or joints)
        else:
            wanted = quantity == "time" or (quantity in UNITS and joint in {*positions, *joints})
        if wanted and (quantity == "time" or not joints or joint in joints):
            found.append((index, quantity, joint))
    return found


def _split(name: str, joints: Sequence[str]) -> tuple[str, str, bool]:
    """Quantity, joint, and whether the quantity stands in the name."""
    if name in joints:
        return "position", name, False
    if name.lower() in _TIMES:
        return "time", "", True
    if not name:
        return "other", "", False
    for word, quantity in (*_WORDS.items(), *((other, "other") for other in _OTHERS)):
        for pattern in (rf"(?i:{word}){_BESIDE}(.+)", rf"(.+?){_BESIDE}(?i:{word})"):
            if match := re.fullmatch(pattern, name):
                return quantity, match[1], True
    return ("other" if name.lower() in _OTHERS else "position"), name, False


def _with_unit(where: str, column: Column, spelt: str, units: Sequence[str]) -> Column:
    """Its own unit, else the one beside its name, else the one that holds for all."""
    unit = column.unit or spelt
    if unit:
        unit_of(column.quantity, unit, f"{where}, column {column.name!r}")
    else:
        # "deg" says of a velocity that it is in deg/s.
        fits = [one for one in units if one in UNITS[column.quantity]]
        if column.quantity == "velocity":
            fits += [f"{one}/s" for one in units if f"{one}/s" in UNITS["velocity"]]
        unit = fits[0] if fits else ""
    return Column(index=column.index, name=column.name, quantity=column.quantity, joint=column.joint, unit=unit)


def _check(where: str, header: Sequence[str], layout: Layout, joints: Sequence[str] | None) -> None:
    columns = ", ".join(map(repr, header))
    if not layout.of("time") or not layout.joints:
        raise InputError(
            f"{where}: the header must name a time ({', '.join(_TIMES)}) and joints, but is {columns}; columns such as"
            " time=COLUMN, JOINT=COLUMN say which is which"
        )
    missing = [joint for joint in joints or () if joint not in layout.joints]
    if missing:
        raise InputError(
            f"{where}: no column for joint {', '.join(map(repr, missing))}; the columns are {columns}; columns such as"
            f" {missing[0]}=COLUMN say which it is"
        )
