"""Digits of a catalogue are ASCII ones, as in every other file."""

from __future__ import annotations

import pytest

from puma_septic.drives._table_file import _value


@pytest.mark.parametrize("cell", ["\u0661", "0:0.5; 1_00:0.4", "0:\u0661; 1:0.4"])
def test_no_digits_of_another_script(cell: str) -> None:
    """`float` takes the Arabic-Indic 1 and 1_00 for numbers, and a pattern's \\d the former."""
    with pytest.raises(ValueError, match=r"^(no number)?$"):
        _value(cell, None, "rad/s:N m" if ":" in cell else "kg", False)
