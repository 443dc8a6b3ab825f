"""Tables: what a reader sees of numbers and rows."""

from __future__ import annotations

from html.parser import HTMLParser

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from puma_septic.errors import InputError
from puma_septic.views.tables import html_table, number, text_table


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (186.4, "186.4"),
        (0.04567, "0.04567"),
        (9.99996, "10.00"),  # rounding adds a digit before the point, so one behind it goes
        (-0.0, "0"),
        (1234567.8, "1234568"),
        (1e7, "1.000e+07"),
        (5e-5, "5.000e-05"),
    ],
)
def test_numbers_are_written_to_four_digits(value: float, text: str) -> None:
    assert number(value) == text


@given(value=st.floats(1e-300, 1e300), digits=st.integers(1, 15))
def test_a_written_number_is_the_value_to_its_digits(value: float, digits: int) -> None:
    # Half a unit in the last digit, and a little for the division.
    assert float(number(value, digits)) == pytest.approx(value, rel=0.5001 * 10.0 ** (1 - digits))


def test_what_is_not_a_number_is_said_in_words() -> None:
    assert [number(value) for value in (np.inf, -np.inf, np.nan)] == ["unbounded", "-unbounded", "unknown"]


def test_columns_of_numbers_stand_right_and_words_left() -> None:
    rows = [["j1", np.float64(1.5), 3], ["elbow", np.nan, 12]]
    assert text_table(["joint", "peak", "n"], rows).splitlines() == [
        "joint       peak    n",
        "-------  -------  ---",
        "j1         1.500    3",
        "elbow    unknown   12",
    ]


def test_a_string_that_looks_like_a_number_is_left_as_written() -> None:
    assert "0.10" in text_table(["given"], [["0.10"]])


def test_no_rows_leave_the_headers() -> None:
    assert text_table(["joint", "limit"], []).split() == ["joint", "limit", "-------", "-------"]


def test_html_holds_the_cells_and_no_markup_of_theirs() -> None:
    """A joint's name comes from a file that somebody else wrote."""
    evil = "<script>alert('x')</script> & co"
    page = html_table([evil, "b"], [[evil, 1.0]], caption=evil)
    parser = _Reader()
    parser.feed(page)
    assert "script" not in parser.tags
    assert parser.texts == [evil, evil, "b", evil, "1.000"]


def test_html_without_a_caption_has_none() -> None:
    assert "<caption>" not in html_table(["a"], [["b"]])


@pytest.mark.parametrize("table", [text_table, html_table])
def test_a_row_of_another_length_is_refused(table) -> None:
    with pytest.raises(InputError, match="row 1: 1 cells for 2 columns"):
        table(["a", "b"], [["x", "y"], ["z"]])


class _Reader(HTMLParser):
    """Collects tags and non-blank texts."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.texts: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:  # noqa: ARG002
        self.tags.append(tag)

    def handle_data(self, data: str) -> None:
        if data.strip():
            self.texts.append(data.strip())
