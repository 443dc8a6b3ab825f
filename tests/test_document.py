"""Documents: what JSON and CSV have no words for, and that a view shows nothing but its document."""

from __future__ import annotations

import csv
import io
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic.document import SCHEMAS, csv_text, numeric, plain, to_json
from puma_septic.views import assessment, comparison, profiles, robot, sizing
from puma_septic.views.layout import laid_out


def read(document: dict) -> dict:
    """As another program gets it."""
    return json.loads(to_json(document))


@given(st.floats())
def test_numeric_undoes_plain(value: float) -> None:
    assert numeric(plain(value)) == pytest.approx(value, rel=0, abs=0, nan_ok=True)


def test_arrays_mappings_and_texts_are_plain() -> None:
    values = {"peak": np.array([[1.0, np.inf], [np.nan, -np.inf]]), "mass": np.float64(2.5), "name": "elbow"}
    assert plain(values) == {
        "peak": [[1.0, "unbounded"], [None, "-unbounded"]],
        "mass": 2.5,
        "name": "elbow",
    }


def test_a_text_is_no_number() -> None:
    with pytest.raises(KeyError, match="elbow"):
        numeric("elbow")


def test_each_schema_is_named_once_with_its_number() -> None:
    assert all(name == f"puma-septic/{kind}/1" for kind, name in SCHEMAS.items())


@pytest.mark.parametrize("text", ["=1+1", "+1 or so", "-cmd|' /C calc'!A0", "@SUM(A1)", "\t=1", "\r=1", "\n=1",
                                  "＝1", "＋1", "－1", "＠A1"])  # fmt: skip
def test_no_cell_is_a_formula(text: str) -> None:
    """Two writers had guards with different rules, a third one had none."""
    ((cell,),) = csv.reader(io.StringIO(csv_text([[text]]), newline=""))
    assert cell == f"'{text}".replace("\r", "\n")


@pytest.mark.parametrize("text", ["-0.5", "+1e-3", "-unbounded", "joint-1", "a=b", ""])
def test_numbers_and_plain_words_stay(text: str) -> None:
    assert next(csv.reader([csv_text([[text, "x"]])])) == [text, "x"]


def test_what_is_not_known_is_empty() -> None:
    assert csv_text([[None, 1.5, True]]) == ",1.5,True\n"


def test_views_show_the_document_alone(puma: ps.Robot) -> None:
    """Read back from its JSON, a document makes the same texts, to the letter, as the value it came from."""
    vias = [[0.0] * 6, [0.5] * 6, [0.9] * 6]
    loaded = puma.with_payload(ps.Payload(mass=1.0))
    smooth = ps.assess(loaded, ps.profiles.quintic_spline(vias, [0.0, 1.0, 2.0]), dwell=0.5)
    steps = ps.assess(loaded, ps.profiles.linear(vias, [0.0, 1.0, 2.0]))
    for one in (smooth, steps):
        document = read(one.to_dict())
        assert assessment.text(document) == str(one)
        assert assessment.html(document) == one._repr_html_()
    labels = ["a", "b"]
    both = [one.to_dict() for one in (smooth, steps)]
    for show in (profiles.text, profiles.html, profiles.sentence):
        assert show([read(one) for one in both], labels) == show(both, labels)
    compared = ps.compare(loaded, vias, [0.0, 1.0, 2.0], profiles=["quintic", "linear"])
    for show, shown in ((lambda it: laid_out(comparison.text(it)), str), (comparison.csv, lambda it: it.to_csv())):
        assert show(read(compared.to_dict())) == shown(compared)
    sized = ps.size(ps.cycle.with_return(smooth.motion, dwell=0.5))
    assert sizing.text(read(sized.to_dict())) == str(sized)
    assert robot.html(read(loaded.to_dict())) == loaded._repr_html_()
