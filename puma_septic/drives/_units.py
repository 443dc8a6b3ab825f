"""Units as data sheets print them: what one of them is in SI units."""

from __future__ import annotations

import re
from functools import cache
from math import isclose, pi
from typing import Final

__all__ = ["current_measure", "si_size"]

# Exponents of kg, m, s, A, K.
Dimension = tuple[int, int, int, int, int]
_ZERO: Final[Dimension] = (0, 0, 0, 0, 0)
_POUND, _INCH, _GRAVITY = 0.45359237, 0.0254, 9.80665  # kg, m (international yard and pound), m/s^2 (CGPM 1901)
_FORCE: Final[Dimension] = (1, 1, -2, 0, 0)
_TURN: Final = 2 * pi
_SYMBOLS: Final[dict[str, tuple[float, Dimension]]] = {
    "kg": (1.0, (1, 0, 0, 0, 0)), "g": (1e-3, (1, 0, 0, 0, 0)), "lb": (_POUND, (1, 0, 0, 0, 0)),
    "lbm": (_POUND, (1, 0, 0, 0, 0)), "m": (1.0, (0, 1, 0, 0, 0)), "in": (_INCH, (0, 1, 0, 0, 0)),
    "ft": (12 * _INCH, (0, 1, 0, 0, 0)), "s": (1.0, (0, 0, 1, 0, 0)), "sec": (1.0, (0, 0, 1, 0, 0)),
    "min": (60.0, (0, 0, 1, 0, 0)), "h": (3600.0, (0, 0, 1, 0, 0)), "A": (1.0, (0, 0, 0, 1, 0)),
    "K": (1.0, (0, 0, 0, 0, 1)), "N": (1.0, _FORCE), "kgf": (_GRAVITY, _FORCE), "kp": (_GRAVITY, _FORCE),
    "gf": (1e-3 * _GRAVITY, _FORCE), "lbf": (_POUND * _GRAVITY, _FORCE), "ozf": (_POUND * _GRAVITY / 16, _FORCE),
    "J": (1.0, (1, 2, -2, 0, 0)), "W": (1.0, (1, 2, -3, 0, 0)), "V": (1.0, (1, 2, -3, -1, 0)),
    "ohm": (1.0, (1, 2, -3, -2, 0)), "H": (1.0, (1, 2, -2, -2, 0)), "hp": (745.69987, (1, 2, -3, 0, 0)),
    "rad": (1.0, _ZERO), "deg": (pi / 180, _ZERO), "arcmin": (pi / 10800, _ZERO), "arcsec": (pi / 648000, _ZERO),
    "rpm": (_TURN / 60, (0, 0, -1, 0, 0)), "rev": (_TURN, _ZERO), "r": (_TURN, _ZERO), "U": (_TURN, _ZERO),
    "turn": (_TURN, _ZERO), "%": (0.01, _ZERO), "oz": (_POUND / 16, (1, 0, 0, 0, 0)),
    # In the United States ounces and pounds of torque are those of force.
    "oz-force": (_POUND * _GRAVITY / 16, _FORCE), "lb-force": (_POUND * _GRAVITY, _FORCE),
    "C": (1.0, (0, 0, 0, 0, 1)),
}  # fmt: skip
_SPELT: Final = {"oz-force": "oz", "lb-force": "lb"}
_PREFIXES: Final = {"m": 1e-3, "k": 1e3, "u": 1e-6, "n": 1e-9, "c": 1e-2, "M": 1e6, "d": 0.1}
_PREFIXED: Final = frozenset({"g", "m", "s", "A", "N", "V", "ohm", "H", "W", "J", "rpm", "rad"})
_ANGULAR: Final = frozenset({"rad", "deg", "arcmin", "arcsec", "rpm", "rev", "r", "U", "turn"})
_PLAIN: Final = {
    "\u00b2": "^2", "\u00b3": "^3", "\u207b\u00b9": "^-1", "\u207b\u2074": "^-4", "\u2126": "ohm", "\u03a9": "ohm",
    "\u00b5": "u", "\u03bc": "u", "\u00b0C": "C", "\u2103": "C", "degC": "C", "deg C": "C", "\u00b0": "deg",
    "\u2212": "-", "Ohms": "ohm", "Ohm": "ohm", "ohms": "ohm", "lbs": "lb", "min-1": "min^-1", "s-1": "s^-1",
}  # fmt: skip
# In which measure a current or voltage is printed: not part of the unit, see the columns current and voltage.
_MEASURE: Final = re.compile(r"[ _]?\(?(?<![a-zA-Z])?(?:rms|RMS|eff|pk|peak|DC|dc|AC|ac)\)?(?=$|[ /*.)\]])")
_AMPERES: Final = re.compile(r"A[ _]?\(?(rms|RMS|eff|pk|peak)\)?$")
_FACTOR: Final = re.compile(r"^(?:[x×*]\s*)?(10\^-?\d+|1?e-?\d+|\d+(?:\.\d+)?(?:e-?\d+)?)(?![\d/])[ *·]*")
_DIGIT: Final = re.compile(r"(?<=[A-Za-z])(-?\d)")


def current_measure(text: str) -> str:
    """In which measure the amperes of a printed unit are: "rms", "peak", or "" where it does not say.

    Examples
    --------
    >>> current_measure("Nm/A_rms"), current_measure("N m/Apk"), current_measure("mNm/A")
    ('rms', 'peak', '')
    """
    found = _AMPERES.search(text)
    if found is None:
        return ""
    return "peak" if found[1].lower() in ("pk", "peak") else "rms"


@cache
def si_size(text: str, target: str) -> float:
    """How many of an SI unit a printed unit is.

    A speed without an angle, ``1/min``, is in turns. Ounces and pounds in torques are those of force.

    Parameters
    ----------
    text : str
        Such as "kgf cm", "oz-in", "Nm/A_rms", "10^-4 kg m^2", "min^-1".
    target : str
        The SI unit of the quantity, such as "N m", "rad/s"; "" for a ratio.

    Returns
    -------
    float

    Raises
    ------
    ValueError
        For a unit that is not known, or of another quantity.

    Examples
    --------
    >>> round(si_size("kgf cm", "N m"), 7), round(si_size("oz-in", "N m"), 8)
    (0.0980665, 0.00706155)
    >>> si_size("1/min", "rad/s") == si_size("rpm", "rad/s")
    True
    """
    own, wanted, _ = _readings(target)[0]
    found = [(size, angular) for size, dimension, angular in _readings(text) if dimension == wanted]
    sizes = [size * (_TURN if target == "rad/s" and not angular else 1.0) / own for size, angular in found]
    # A temperature is no difference of two.
    is_other = target == "degC" and "C" not in text
    if is_other or not sizes or not all(isclose(size, sizes[0]) for size in sizes):
        raise ValueError(f"unknown unit {text!r}; expected one of {target or 'a ratio'}")
    return sizes[0]


Reading = tuple[float, Dimension, bool]


@cache
def _readings(text: str) -> list[Reading]:
    """All ways to read a unit: its size, its dimension, and whether an angle is in it."""
    for printed, plain in _PLAIN.items():
        text = text.replace(printed, plain)
    text = _MEASURE.sub("", text.strip())
    factor = 1.0
    if match := _FACTOR.match(text):
        number = match[1]
        is_power = number.startswith("10^")
        factor = 10.0 ** int(number[3:]) if is_power else float(f"1{number}" if number[0] == "e" else number)
        text = text[match.end() :]
    readings: list[Reading] = [(factor, _ZERO, False)]
    for k, part in enumerate(text.split("/")):
        sign = -1 if k else 1
        readings = [_combined(one, other, sign) for one in readings for other in _product(part.strip(" ()"))]
    return readings


def _product(text: str) -> list[Reading]:
    """Readings of factors side by side, "kg cm^2" or "oz-in-s2"."""
    if text in ("", "1"):
        return [(1.0, _ZERO, False)]
    text = _DIGIT.sub(r"^\1", text)
    factors = [one for one in re.split(r"[ .*·]+|-(?!\d)", text) if one]
    readings: list[Reading] = [(1.0, _ZERO, False)]
    for factor in factors:
        readings = [_combined(one, other, 1) for one in readings for other in _run(factor)]
    return readings


def _run(text: str) -> list[Reading]:
    """Readings of symbols without a space, "Nm", "kgcm^2"."""
    if not text:
        return [(1.0, _ZERO, False)]
    readings: list[Reading] = []
    for symbol, (size, dimension) in _SYMBOLS.items():
        printed = _SPELT.get(symbol, symbol)
        prefixes = {"": 1.0, **(_PREFIXES if symbol in _PREFIXED else {})}
        for prefix, scale in prefixes.items():
            if not text.startswith(prefix + printed):
                continue
            rest = text[len(prefix + printed) :]
            power = re.match(r"\^(-?\d)", rest)
            exponent = int(power[1]) if power else 1
            one = _raised((scale * size, dimension, symbol in _ANGULAR), exponent)
            readings += [_combined(one, other, 1) for other in _run(rest[power.end() :] if power else rest)]
    return readings


def _raised(reading: Reading, exponent: int) -> Reading:
    size, (kg, m, s, a, k), angular = reading
    return size**exponent, (exponent * kg, exponent * m, exponent * s, exponent * a, exponent * k), angular


def _combined(one: Reading, other: Reading, sign: int) -> Reading:
    size, (kg, m, s, a, k), angular = one
    size_2, (kg_2, m_2, s_2, a_2, k_2), angular_2 = _raised(other, sign)
    return size * size_2, (kg + kg_2, m + m_2, s + s_2, a + a_2, k + k_2), angular or angular_2
