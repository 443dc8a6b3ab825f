"""The choices for a whole arm that no other beats: against all combinations, and how they are shown."""

from __future__ import annotations

import json
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from helpers.duty import paper_motion

import puma_septic as ps
from puma_septic.cli import main
from puma_septic.pictures.sizing import arm_front_picture


@cache
def selection() -> ps.Selection:
    cycle = ps.cycle.with_return(paper_motion(loaded=True), dwell=0.5)
    full = ps.built_in_catalogue()
    few = ps.Catalogue(motors=full.motors[::2], gearboxes=full.gearboxes[::4], drives=full.drives[::2])
    return ps.size(cycle, catalogue=few, keep=None)


def beaten(points: np.ndarray) -> np.ndarray:
    """Whether each point has another that is no worse in all, and better in one."""
    better = (points[:, None] <= points[None]).all(axis=2) & (points[:, None] < points[None]).any(axis=2)
    return better.any(axis=0)


@pytest.mark.slow
def test_the_front_is_that_of_all_combinations() -> None:
    """Joint by joint the front was known; of sums over the joints nobody told one."""
    sizes = []
    for joint in selection().joints:
        own = np.array([[c.mass, c.cost, c.stress] for c in joint.kept])
        sizes.append(own[~beaten(own)])
    every = [
        (sum(mass for mass, _, _ in chosen), sum(cost for _, cost, _ in chosen), max(use for _, _, use in chosen))
        for chosen in product(*sizes)
    ]
    points = np.unique(np.round(every, 9), axis=0)
    found = [(choice.mass, choice.cost, choice.stress) for choice in selection().front()]
    np.testing.assert_allclose(found, points[~beaten(points)], rtol=1e-8)
    assert len(found) > 3
    for choice in selection().front():
        for candidate, joint in zip(choice.candidates, selection().joints, strict=True):
            assert candidate.demands.load.joint == joint.joint
            assert joint.why(candidate.motor, candidate.gearbox).endswith("is strong enough")
        assert choice.margin == pytest.approx(1 - choice.stress)  # without margins that are asked for


@pytest.mark.slow
def test_its_picture_has_a_point_for_each_choice() -> None:
    front = selection().front()
    picture = arm_front_picture(front)
    mass, cost = picture.panels
    assert [mark.x for mark in mass.marks] == [choice.mass for choice in front]
    assert [mark.y for mark in cost.marks] == [100 * choice.margin for choice in front]
    assert len(ps.plots.plot_arm_front(front).axes) == 2
    assert [panel.message for panel in arm_front_picture(()).panels] == ["no mass is known", "no cost is known"]


@pytest.mark.slow
def test_it_is_an_option_of_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["size", "--catalogue", "example", "--keep", "1", "--front", "--out", str(tmp_path / "out"), "--no-png"]
    assert main(asked) == 0
    text = capsys.readouterr().out
    assert "Choices for the whole arm that no other beats in mass, cost and margin together:" in text
    document = json.loads((tmp_path / "out" / "sizing.json").read_text(encoding="utf-8"))
    first = document["front"][0]
    assert first["mass"] == document["totals"]["mass"]  # the choice by mass is the lightest
    assert [pair["joint"] for pair in first["pairs"]] == [joint["name"] for joint in document["joints"]]
    assert (tmp_path / "out" / "arm-front.svg").is_file()
    assert "Choices for the whole arm" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert main(["size", "--front"]) == 2
    assert "--front goes with --catalogue" in capsys.readouterr().err
