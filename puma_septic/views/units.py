"""The units that a reader wants: degrees for radians, revolutions per minute for the speeds of joints.

Documents stay in SI units; what is changed is what text and tables show of them.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Final, final

from puma_septic.errors import InputError, did_you_mean

__all__ = ["SI", "UNIT_NAMES", "Units"]

UNIT_NAMES: Final = ("rad", "deg", "rpm")
_NUMBER: Final = r"-?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?"
_UNIT: Final = r"rad(?:\^2/s\^5|/s(?:\^[23]|²|³)?)?"
# A number, or a range in brackets or words, with its unit behind it; not "N m s/rad".
_PROSE: Final = re.compile(rf"(?<![\w.])((?:\[{_NUMBER}, |{_NUMBER} (?:to|and) )?{_NUMBER}\]?)(\s+)({_UNIT})(?![\w^/])")
_HEAD: Final = re.compile(rf"\[({_UNIT})\]")
_SHARE: Final = re.compile(rf"({_NUMBER})(?! ?%|\d|\.\d)")


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class Units:
    """What angles and the joints' speeds are shown in.

    Attributes
    ----------
    angle : {"rad", "deg"}
    is_rpm : bool
        Speeds of turning joints in revolutions per minute.
    """

    angle: str = "rad"
    is_rpm: bool = False

    @classmethod
    def named(cls, names: Sequence[str]) -> Units:
        """Those with these names, such as "deg" and "rpm".

        Raises
        ------
        InputError
            For another name, and for two units of the angle.
        """
        unknown = [name for name in names if name not in UNIT_NAMES]
        if unknown:
            raise InputError(
                f"unknown unit {unknown[0]!r}; valid: {', '.join(UNIT_NAMES)}{did_you_mean(unknown, UNIT_NAMES)}"
            )
        if {"rad", "deg"} <= set(names):
            raise InputError("angles are shown in rad or in deg, not in both")
        return cls(angle="deg" if "deg" in names else "rad", is_rpm="rpm" in names)

    def of(self, unit: str) -> tuple[float, str]:
        """Factor and name of what a unit becomes.

        Examples
        --------
        >>> Units(angle="deg").of("rad/s^2")
        (57.29577951308232, 'deg/s^2')
        >>> round(Units(is_rpm=True).of("rad/s")[0], 4), SI.of("N m")
        (9.5493, (1.0, 'N m'))
        """
        if self.is_rpm and unit == "rad/s":
            return 30.0 / pi, "rpm"
        if self.angle == "deg" and (unit == "rad" or unit.startswith(("rad/s", "rad^2/"))):
            return (180.0 / pi) ** (2 if unit.startswith("rad^2") else 1), unit.replace("rad", "deg")
        return 1.0, unit

    def prose(self, text: str) -> str:
        """A text whose quantities are written with their units.

        Examples
        --------
        >>> Units(angle="deg").prose("joint2 position 1.5708 rad, 0.1 rad beyond [-1.5, 1.5] rad")
        'joint2 position 90 deg, 5.73 deg beyond [-85.94, 85.94] deg'
        """
        return _PROSE.sub(self._quantity, text)

    def column(self, head: str, cells: Sequence[str]) -> tuple[str, list[str]]:
        """A column of a table whose head has its unit in brackets; percentages stay.

        Examples
        --------
        >>> Units(angle="deg").column("position [rad]", ["-0.5 .. 1.0 (80 %)", "0"])
        ('position [deg]', ['-28.65 .. 57.3 (80 %)', '0'])
        """
        found = _HEAD.search(head)
        factor, unit = self.of(found[1]) if found else (1.0, "")
        if found is None or factor == 1.0:
            return head, list(cells)
        changed = [_SHARE.sub(lambda one: _scaled(one[1], factor), cell) for cell in cells]
        return head.replace(found[0], f"[{unit}]"), changed

    def table(self, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> tuple[list[str], list[list[str]]]:
        """Heads and rows with every column in these units."""
        columns = [self.column(head, [row[k] for row in rows]) for k, head in enumerate(heads)]
        return [head for head, _ in columns], [[cells[n] for _, cells in columns] for n in range(len(rows))]

    def _quantity(self, match: re.Match[str]) -> str:
        factor, unit = self.of(match[3])
        if factor == 1.0:
            return match[0]
        return f"{re.sub(_NUMBER, lambda one: _scaled(one[0], factor), match[1])}{match[2]}{unit}"


SI: Final = Units()


def _scaled(text: str, factor: float) -> str:
    """A number times a factor, with as many significant digits as it had, four to six."""
    digits = len(re.sub(r"e.*", "", text).replace("-", "").replace(".", "").lstrip("0"))
    value = float(text) * factor
    return f"{value:.{min(max(digits, 4), 6)}g}" if not value or 1e-4 <= abs(value) < 1e6 else f"{value:.3e}"
