"""What public values show of themselves: a line in a terminal, a small card in a notebook, a table in pandas."""

from __future__ import annotations

import inspect
from html.parser import HTMLParser

import numpy as np
import pytest
from helpers.public_values import ONE_OF_EACH, VALUES, assessment

import puma_septic as ps


class Tags(HTMLParser):
    """Tags that are opened and never closed."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert not any(name.startswith("on") for name, _ in attrs)
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_every_public_type_is_looked_at() -> None:
    public = {name: getattr(ps, name) for name in ps.__all__}
    types = {name for name, one in public.items() if inspect.isclass(one) and not issubclass(one, Exception)}
    assert types == set(VALUES)


@pytest.mark.parametrize("name", ONE_OF_EACH)
def test_a_value_is_one_line_and_a_card(name: str) -> None:
    """The repr of a selection had 743,646 characters in 21,107 lines; a failing test showed all of it."""
    value = VALUES[name]()
    line = repr(value)
    assert line.startswith(f"<{name}: ")
    assert line.endswith(">")
    assert len(line) <= 160
    assert "\n" not in line
    html = value._repr_html_()
    assert Tags(html).open == []
    assert "<b>" not in html
    if name == "Replay":
        value.close()


def test_what_is_always_needed_goes_without_its_name() -> None:
    motion = assessment().motion
    assert ps.Dwell(0.5).duration == 0.5
    assert ps.Payload(2.0).mass == 2.0
    assert ps.Cycle([motion, ps.Dwell(0.5)]).duration == 2.5


def test_dir_has_public_names_alone() -> None:
    """It had TYPE_CHECKING, annotations and import_module between the functions."""
    assert dir(ps) == sorted(ps.__all__)


def test_metrics_become_data_frames() -> None:
    table = assessment().to_dataframe()
    np.testing.assert_array_equal(table["peak_torque"], assessment().peak_torque)
    assert list(table.index) == list(ps.load_robot().joint_names)
    compared = VALUES["Comparison"]()
    rows = compared.to_dataframe()
    assert list(rows.index) == list(compared.ranking)
    assert rows.loc["linear", "peak_acceleration"] == np.inf


@pytest.mark.slow
def test_sizings_become_data_frames() -> None:
    sizing = VALUES["Sizing"]()
    assert set(sizing.to_dataframe()["joint"]) == set(sizing.cycle.joint_names)
    pairs = VALUES["Selection"]().to_dataframe()
    assert {"joint", "motor", "gearbox", "mass"} <= set(pairs.columns)


def test_without_pandas_it_is_said_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(ImportError, match=r"python -m pip install 'puma-septic\[pandas\]'"):
        assessment().to_dataframe()
