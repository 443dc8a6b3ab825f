"""The page "six-axis arm, 5 kg, 12 cycles a minute": from nothing to the report, in one command."""

from __future__ import annotations

import csv
import json
from contextlib import chdir
from pathlib import Path

import pytest
from helpers.pages import blocks, commands, example_files

import puma_septic as ps
from puma_septic.cli import main

PAGE, SHEETS = "docs/howto/six_axis_arm.md", "docs/howto/data_sheets.md"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the page's command has been run."""
    folder = tmp_path_factory.mktemp("arm")
    example_files(folder, PAGE)
    (line,) = [line for line in commands(PAGE) if line.startswith("puma-septic")]
    with chdir(folder):
        assert main(line.split()[1:]) == 0
    return folder


@pytest.mark.slow
def test_the_report_names_what_was_chosen(folder: Path) -> None:
    """In the first report of a selection a search for the chosen parts found none, in page, checks or figures."""
    document = json.loads((folder / "review" / "sizing.json").read_text(encoding="utf-8"))
    page = (folder / "review" / "report.html").read_text(encoding="utf-8")
    bill = list(csv.DictReader((folder / "review" / "bill-of-material.csv").open(encoding="utf-8")))
    chosen = {(joint["kept"][0]["motor"], joint["kept"][0]["gearbox"]) for joint in document["joints"]}
    for part in {part for pair in chosen for part in pair}:
        assert part in page
        assert any(row["name"] == part for row in bill)
    assert sum(int(row["count"]) for row in bill) == 12
    # The three joints of the wrist have one size.
    assert (
        len({tuple(sorted(joint["kept"][0][k] for k in ("motor", "gearbox"))) for joint in document["joints"][3:]}) == 1
    )
    mass = sum(float(row["count"]) * float(row["mass [kg]"]) for row in bill)
    assert document["totals"]["mass"] == pytest.approx(mass)
    order = [page.index(title) for title in ("Bill of material", "Conditions", "Load cases", "The best pairs")]
    assert order == sorted(order)
    assert page.index("Chosen, with the governing limit of each joint") < order[0]
    for told in ("cycles_per_minute", "motors.csv", "gearboxes.csv", "brake_at_rest", "required_life_hours"):
        assert told in page


@pytest.mark.slow
def test_the_pair_with_an_open_cell_is_not_chosen(folder: Path) -> None:
    """The lightest gear does not tell its efficiency: it won before, as if it had no losses."""
    document = json.loads((folder / "review" / "sizing.json").read_text(encoding="utf-8"))
    for joint in document["joints"]:
        assert all(candidate["gearbox"] != "S17-open" for candidate in joint["kept"])
    assert any(joint["unknowns"] for joint in document["joints"])
    assert "not decidable" in document["verdict"]


@pytest.mark.slow
def test_each_check_names_its_load_case(folder: Path) -> None:
    document = json.loads((folder / "review" / "sizing.json").read_text(encoding="utf-8"))
    cases = {case["name"] for case in document["load_cases"]}
    checks = [check for joint in document["sizing"]["joints"] for check in joint["checks"]]
    assert {check["case"] for check in checks if check["quantity"] != "gearbox life"} <= cases
    lift = {check["quantity"]: check for check in checks if check["joint"] == "shoulder_lift_joint"}
    assert lift["RMS motor torque at mean speed"]["case"] == "stretched"
    assert lift["gearbox momentary peak torque"]["case"] == "stop"


def test_the_data_sheets_of_the_page_are_those_of_the_file(tmp_path: Path) -> None:
    """The page shows the columns of docs/howto/data_sheets.csv that fit it."""
    (text,) = [block.text for block in blocks(SHEETS) if block.language == "csv"]
    (tmp_path / "m.csv").write_text(text, encoding="utf-8")
    (tmp_path / "g.csv").write_text("key,ratio,mass,inertia,efficiency\nG,1,0,0,1\n", encoding="utf-8")
    shown = ps.load_catalogue(tmp_path / "m.csv", tmp_path / "g.csv").motors
    kept = ps.load_catalogue(
        Path(__file__).parents[2] / "docs" / "howto" / "data_sheets.csv", tmp_path / "g.csv"
    ).motors
    for one, other in zip(shown, kept, strict=True):
        assert repr(one).partition("source")[0] == repr(other).partition("source")[0]
