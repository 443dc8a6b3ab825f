"""Load cases of a task: how many they are, whom they concern, what the arm carries, and how long they take."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.urdf_texts import ARM

import puma_septic as ps
from puma_septic.sizing import LoadCase, cycle_case, load_cases_of
from puma_septic.task import make_task, resolve_cycle, resolve_task


def task(folder: Path, **more: Any) -> dict[str, Any]:
    """A move of 1 s with 2 kg; the whole cycle, back with an empty hand, takes 2 s."""
    (folder / "arm.urdf").write_text(ARM, encoding="utf-8")
    return {
        "name": "carry", "robot": {"source": str(folder / "arm.urdf"), "tool": "tip"}, "times": [0.0, 1.0],
        "points": [{"joints": [0.2, 0.3]}, {"joints": [0.8, 0.9]}], "profiles": ["quintic"],
        "payload": {"mass": 2.0}, **more,
    }  # fmt: skip


def mass(case: LoadCase, step: int = 0) -> float:
    motion = case.cycle.steps[step]
    assert isinstance(motion, ps.Motion)
    return 0.0 if motion.robot.payload is None else motion.robot.payload.mass


def cases(folder: Path, *sections: dict[str, Any], **more: Any) -> tuple[LoadCase, ...]:
    return load_cases_of(resolve_task(make_task(task(folder, load_cases=list(sections), **more))))


def test_without_a_list_the_cycle_is_the_only_case(tmp_path: Path) -> None:
    (case,) = load_cases_of(resolve_task(make_task(task(tmp_path, dwell=0.5))))
    assert (case.name, case.share, case.joints, case.is_rare, case.cycle.duration) == ("", 1.0, (), False, 3.0)
    assert (mass(case), mass(case, 2)) == (2.0, 0.0)
    (one_way,) = load_cases_of(resolve_task(make_task(task(tmp_path))), one_way=True)
    assert one_way.cycle.duration == 1.0


def test_each_kind_of_case(tmp_path: Path) -> None:
    """What generates cases for single joints, and what is rare, comes last: the first case is the one that is drawn."""
    found = cases(
        tmp_path,
        {"name": "held", "kind": "worst pose", "payload": {"mass": 4.0}},
        {"name": "stop", "kind": "emergency stop", "time": 0.25},
        {"name": "carried", "share": 0.7, "payload": {"mass": 1.0}},
        {"name": "range", "kind": "payload range", "masses": [0.5, 3.0], "way": "one way"},
    )
    assert [(c.name, c.share, c.joints, mass(c)) for c in found] == [
        ("carried", 0.7, (), 1.0),
        ("range, 0.5 kg", 1.0, (), 0.5),
        ("range, 3 kg", 1.0, (), 3.0),
        ("held", 0.0, ("shoulder",), 4.0),
        ("held", 0.0, ("elbow",), 4.0),
        ("stop", 0.0, ("shoulder",), 2.0),
        ("stop", 0.0, ("elbow",), 2.0),
    ]
    assert [c.is_rare for c in found] == [False] * 5 + [True] * 2
    # A pose is held as long as the cycle takes; a stop takes its time.
    assert [c.cycle.duration for c in found] == pytest.approx([2.0, 1.0, 1.0, 2.0, 2.0, 0.25, 0.25])
    assert all(c.note.startswith("from t = ") and c.note.endswith(" s, category 1") for c in found[5:])
    # Both links and the load stretched out level: 3 kg at 0.2 m, 3 kg at 0.6 m and 4 kg at 0.7 m.
    assert found[3].cycle.load_torque.extrema().peak[0] == pytest.approx(9.81 * (0.6 + 1.8 + 2.8), rel=1e-3)


@pytest.mark.parametrize(("category", "is_powered"), [(0, False), (1, True)])
def test_a_stop_of_category_0_is_done_by_the_brakes(tmp_path: Path, category: int, is_powered: bool) -> None:
    """IEC 60204-1, 9.2.2."""
    stop = {"name": "stop", "kind": "emergency stop", "time": 0.25, "category": category}
    assert [case.is_powered for case in cases(tmp_path, {"name": "c"}, stop)] == [True, is_powered, is_powered]


def test_a_case_may_be_the_cycle_of_another_task_of_the_arm(tmp_path: Path) -> None:
    other = "\n".join(
        ["name: other", f"robot: {{source: {tmp_path / 'arm.urdf'}}}", "points: [{joints: [0, 0]}, {joints: [1, 1]}]",
         "times: [0, 3]", "profiles: [quintic]"]
    )  # fmt: skip
    (tmp_path / "other.yaml").write_text(other, encoding="utf-8")
    first, second = cases(tmp_path, {"name": "own"}, {"name": "other", "task": str(tmp_path / "other.yaml")})
    assert (first.cycle.duration, second.cycle.duration, mass(second)) == (2.0, 6.0, 0.0)
    (tmp_path / "other.yaml").write_text(other.replace(str(tmp_path / "arm.urdf"), "puma560").replace(
        "[0, 0]", "[0, 0, 0, 0, 0, 0]").replace("[1, 1]", "[1, 1, 1, 1, 1, 1]"), encoding="utf-8")  # fmt: skip
    with pytest.raises(ps.InputError, match=r"load case 'other': .*other\.yaml is a task of another arm"):
        cases(tmp_path, {"name": "own"}, {"name": "other", "task": str(tmp_path / "other.yaml")})


def test_one_case_must_be_a_cycle(tmp_path: Path) -> None:
    with pytest.raises(ps.InputError, match="load_cases: one of them must be of the kind 'cycle'"):
        cases(tmp_path, {"name": "held", "kind": "worst pose"})


def job(folder: Path, **conditions: Any) -> LoadCase:
    text = task(folder, conditions=conditions)
    for key in ("times", "profiles", "payload"):
        del text[key]
    text["points"] = [{"name": "home", **text["points"][0]}, {"name": "there", **text["points"][1]}]
    steps = [{"move": "joint", "to": "there", "duration": 1.0}, {"move": "joint", "to": "home", "duration": 1.0}]
    return cycle_case(resolve_cycle(make_task({**text, "cycle": steps})))


def test_a_cycle_rate_leaves_the_rest_of_a_job_s_time_for_a_rest(tmp_path: Path) -> None:
    bare = job(tmp_path).cycle
    assert len(bare.steps) == 2
    exact = job(tmp_path, cycles_per_minute=60 / bare.duration).cycle
    assert len(exact.steps) == 2
    slow = job(tmp_path, cycles_per_minute=12, brake_at_rest=True).cycle
    assert slow.duration == pytest.approx(5.0, rel=1e-15)
    assert isinstance(slow.steps[-1], ps.Dwell)
    assert slow.steps[-1].holding_brake
    with pytest.raises(
        ps.InputError,
        match=r"cycles_per_minute = 40: a cycle has 1\.5 s, but this one takes 2 s; at most 30 cycles a minute",
    ):
        job(tmp_path, cycles_per_minute=40)


def test_a_case_is_a_cycle_of_joints_that_it_has(tmp_path: Path) -> None:
    (case,) = load_cases_of(resolve_task(make_task(task(tmp_path))))
    with pytest.raises(ps.InputError, match="load case 'c': expected a Cycle, got int"):
        LoadCase(name="c", cycle=1)  # type: ignore[arg-type]
    with pytest.raises(ps.InputError, match="load case 'c': unknown joint 'wrist'; valid: shoulder, elbow"):
        LoadCase(name="c", cycle=case.cycle, joints=("wrist",))
    with pytest.raises(ps.InputError, match="share of load case 'c' = -1 must be at least 0"):
        LoadCase(name="c", cycle=case.cycle, share=-1.0)


def test_lives_in_a_mix_add_up_by_what_each_case_uses() -> None:
    """Palmgren and Miner: half the time at 1000 h and half at 3000 h use up 1/2000 + 1/6000 an hour: 1500 h."""
    shared = ps.sizing._load_cases.shared_life
    assert shared(np.array([1000.0, 3000.0]), np.array([0.5, 0.5])) == pytest.approx(1500.0, rel=1e-15)
    assert shared(np.array([1000.0, np.nan]), np.array([1.0, 0.0])) == 1000.0  # no time, no wear
    assert shared(np.array([np.inf, np.inf]), np.array([0.5, 0.5])) == np.inf
