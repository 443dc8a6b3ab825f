"""Every JSON document is as docs/schemas.json publishes it; conftest.py holds what other tests write against it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from helpers.duty import paper_motion
from helpers.moves import POINTS, TIMES
from helpers.places import DOCS, GOLDEN
from helpers.ros_messages import small_move
from helpers.schemas import SCHEMA, assert_documented
from jsonschema import Draft202012Validator

import puma_septic as ps
from puma_septic.cli import main
from puma_septic.document import SCHEMAS
from puma_septic.drives import Catalogue
from puma_septic.paper import reproduce

MAKERS: dict[str, Callable[[], dict[str, Any]]] = {
    "accelerations": lambda: ps.acceleration_limits(ps.load_robot(), region=_corner()).to_dict(),
    "assessment": lambda: ps.assess(paper_motion()).to_dict(),
    "comparison": lambda: ps.compare(ps.load_robot(), POINTS, TIMES, profiles=["septic", "linear"]).to_dict(),
    "execution": lambda: ps.execute(ps.load_robot(), {"small": small_move(ps.load_robot(), 0.2)}, settle=0.0).to_dict(),
    "least-time": lambda: ps.least_time(ps.septic, POINTS, TIMES, max_velocity=2.0, restarts=0).to_dict(),
    "maximum-payload": lambda: ps.maximum_payload(_quick_motion()).to_dict(),
    "minimum-duration": lambda: ps.minimum_duration(_quick_motion()).to_dict(),
    "optimisation": lambda: ps.optimise_via_times(ps.septic, POINTS, TIMES, restarts=0).to_dict(),
    "paper": lambda: reproduce(runs=1).to_dict(),
    "pareto-front": lambda: ps.pareto_front(
        ps.septic, POINTS, TIMES, objectives=["overshoot", "integral_of_squared_jerk"], size=3
    ).to_dict(),
    "robot": lambda: ps.load_robot().with_payload(ps.Payload(mass=2.0)).to_dict(),
    "selection": lambda: ps.size(_cycle(), catalogue=_few_parts()).to_dict(),
    "simulation": lambda: ps.simulate(ps.load_robot(), small_move(ps.load_robot()), settle=0.0).to_dict(),
    "sizing": lambda: ps.size(_cycle()).to_dict(),
    "stops": lambda: ps.simulation.stop_table(ps.load_robot(), load=2.5, fractions=(1.0,)).to_dict(),
    "study-summary": lambda: _summary(),
    "sweep": lambda: ps.payload_duration_map(_quick_motion(), [0.5, 1.0], [0.0, 2.0, 4.0]).to_dict(),
}
COMMANDS = {
    "assess": ["assess", "paper-turned", "--profile", "septic"],
    "assess-log": ["assess", "--csv", "log.csv"],
    "check": ["check", "--robot", "puma560", "plan.yaml", "--allow", "limit_unknown"],
    "cycle": ["assess", "paper-straight"],
    "doctor": ["doctor", "puma560"],
    "ik": ["ik", "paper"],
    "limits": ["limits", "paper-turned", "--profile", "septic"],
    "profiles": ["profiles", "--normalised"],
}


def _corner() -> dict[str, tuple[float, float]]:
    return dict.fromkeys(ps.load_robot().joint_names, (0.0, 0.2))


def _cycle() -> ps.Cycle:
    return ps.cycle.with_return(paper_motion(), dwell=0.5)


def _summary() -> dict[str, Any]:
    study = ps.make_study({"task": "paper-turned", "axes": {"duration": [8, 9], "payload": [0, 1]}})
    with TemporaryDirectory() as folder:
        ps.run_study(study, folder, workers=1)
        return ps.summarise_study(folder).to_dict()


def _quick_motion() -> ps.Motion:
    return ps.compute_motion(ps.load_robot(), ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 1.0]))


def _few_parts() -> Catalogue:
    """Some of the built-in parts, so that some joints find a pair and some none."""
    every = ps.built_in_catalogue()
    return Catalogue(motors=every.motors[:3], gearboxes=every.gearboxes[:3])


def test_the_schema_is_one_itself_and_names_each_document() -> None:
    Draft202012Validator.check_schema(SCHEMA)
    named = {one["$ref"].rpartition("/")[2] for one in SCHEMA["oneOf"]}
    assert named == {*MAKERS, *COMMANDS} == set(SCHEMAS)
    assert {SCHEMA["$defs"][kind]["properties"]["schema"]["const"] for kind in named} == {
        SCHEMAS[kind] for kind in named
    }


def test_each_document_has_its_words_in_the_documentation() -> None:
    page = (DOCS / "json.md").read_text(encoding="utf-8")
    told = set(re.findall(r"`(puma-septic/[\w-]+/\d+)`", page))
    assert told == set(SCHEMAS.values())


@pytest.mark.parametrize("path", sorted(GOLDEN.glob("*.json")), ids=lambda path: path.stem)
def test_golden_documents(path: Path) -> None:
    assert_documented(json.loads(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize("kind", MAKERS)
def test_documents_of_values(kind: str) -> None:
    document = json.loads(json.dumps(MAKERS[kind](), allow_nan=False))
    assert document["schema"] == SCHEMAS[kind]
    assert_documented(document)


@pytest.mark.parametrize("kind", COMMANDS)
def test_documents_of_commands(
    kind: str, puma: ps.Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    ps.write_joint_trajectory("plan.yaml", small_move(puma))
    rows = [f"{0.1 * k},{','.join(['0.1'] * 6)}" for k in range(10)]
    Path("log.csv").write_text("\n".join([f"t,{','.join(puma.joint_names)}", *rows]) + "\n", encoding="utf-8")
    main([*COMMANDS[kind], "--format", "json"])
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == SCHEMAS[kind]
    assert_documented(document)


def test_a_key_that_nobody_described_is_found() -> None:
    """The published schema lets keys come; the tests' does not, or a new one would never be described."""
    document = ps.load_robot().to_dict()
    Draft202012Validator(SCHEMA).validate({**document, "colour": "orange"})
    with pytest.raises(AssertionError, match=r"'colour' was unexpected"):
        assert_documented({**document, "colour": "orange"})
    with pytest.raises(AssertionError, match=r"\$\.name: 5 is not of type 'string'"):
        assert_documented({**document, "name": 5})
