"""The campaign finds what it is there for: faults that are planted in a loaded robot, in a message and in a file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import puma_septic as ps
from campaign import fuzz_urdf
from campaign.arms import PUMA, random_tree
from campaign.kills import killed
from campaign.mechanics import Arm, mass_matrix_and_torque
from campaign.outputs import Output, fault_of
from campaign.rules import MAX_MESSAGE, UnsoundError, Verdict, message_faults, verdict_of
from campaign.runner import Format, run_cases, smaller
from campaign.urdf_oracle import check_robot
from campaign.urdf_text import Body, read


def planted(change: Callable[[pin.Model], None]) -> ps.Robot:
    """The PUMA as its URDF has it, with a fault in Pinocchio's model."""
    robot = ps.load_robot(PUMA)
    model = robot.bare_model.copy()
    change(model)
    return replace(robot, bare_model=model)


def with_inertia(model: pin.Model, body: pin.Inertia) -> None:
    model.inertias[3] = body


FAULTS: dict[str, Callable[[pin.Model], None]] = {
    # What Pinocchio does to an inertia with a number that it cannot read: the mass stays, the tensor is zero.
    "inertia": lambda model: with_inertia(
        model, pin.Inertia(model.inertias[3].mass, model.inertias[3].lever, np.zeros((3, 3)))
    ),
    "mass": lambda model: with_inertia(model, pin.Inertia(1.01 * model.inertias[3].mass, *_rest(model))),
    "centre|inertia": lambda model: with_inertia(
        model,
        pin.Inertia(
            model.inertias[3].mass, model.inertias[3].lever + np.array([0, 0, 1e-6]), model.inertias[3].inertia
        ),
    ),
    "place": lambda model: model.jointPlacements.__setitem__(
        4, model.jointPlacements[4] * pin.SE3(np.eye(3), np.array([0.0, 0.0, 1e-6]))
    ),
    "torque": lambda model: setattr(model.gravity, "linear", np.array([0.0, 0.0, -9.80665])),
}


def _rest(model: pin.Model) -> tuple[np.ndarray, np.ndarray]:
    return model.inertias[3].lever, model.inertias[3].inertia


@pytest.mark.parametrize("found", FAULTS)
def test_the_oracle_finds_a_planted_fault(found: str) -> None:
    data = PUMA.read_bytes()
    check_robot(ps.load_robot(PUMA), data, {})
    with pytest.raises(UnsoundError, match=rf"\A({found}):"):
        check_robot(planted(FAULTS[found]), data, {})


def test_the_oracle_finds_limits_and_joints_that_are_not_the_texts() -> None:
    robot, data = ps.load_robot(PUMA), PUMA.read_bytes()
    with pytest.raises(UnsoundError, match=r"\Alimits: velocity limit of 'joint2'"):
        check_robot(robot.with_limits(velocity=robot.limits.velocity * [1, 2, 1, 1, 1, 1]), data, {})
    with pytest.raises(UnsoundError, match=r"\Ajoints:"):
        check_robot(ps.load_robot(PUMA, locked={"joint6": 0.1}), data, {})
    check_robot(ps.load_robot(PUMA, locked={"joint6": 0.1}), data, {"joint6": 0.1})
    unclear = data.replace(b"<axis", b"<mimic joint='x' offset='a'/><axis", 1)
    with pytest.raises(UnsoundError, match=r"\Aunclear: accepted, though 'a' is not 1 numbers"):
        check_robot(robot, unclear, {})


def test_an_inertia_that_is_none_must_not_be_used_and_a_sound_one_must() -> None:
    robot, data = ps.load_robot(PUMA), PUMA.read_bytes()
    start = data.index(b"<mass value=")
    unreadable = data[:start] + data[start:].replace(b'<mass value="', b'<mass value="x', 9)
    with pytest.raises(UnsoundError, match=r"\Ainertia that is none: used of link"):
        check_robot(robot, unreadable, {})
    with pytest.raises(UnsoundError, match=r"\Ainertia left out: of link 'link2'"):
        check_robot(replace(robot, unusable_inertia={"link2": "planted"}), data, {})


def test_own_mechanics_of_a_pendulum() -> None:
    """A rod of 2 kg whose centre hangs 0.25 m below a hinge: m r^2 + I, and m g r where it lies."""
    rod = Body(2.0, np.array([0.0, 0.0, -0.25]), np.diag([0.04, 0.04, 0.001]), True)
    text = read(
        b'<robot name="p"><link name="base"/><link name="rod"/><joint name="j" type="continuous"><parent link="base"/>'
        b'<child link="rod"/><axis xyz="0 2 0"/></joint></robot>'
    )
    lying = Arm(text, ("j",), {}).motion(np.array([np.pi / 2]), np.zeros(1), np.zeros(1))
    matrix, torque, _, _ = mass_matrix_and_torque(lying, {"rod": rod})
    assert matrix.item() == pytest.approx(2 * 0.25**2 + 0.04, rel=1e-14)
    assert torque.item() == pytest.approx(2 * 9.81 * 0.25, rel=1e-14)


def test_random_trees_are_sound(tmp_path: Path) -> None:
    """Unchanged, they are accepted, and every number agrees: else mutated ones would tell nothing."""
    for seed in range(8):
        path = tmp_path / "tree.urdf"
        path.write_bytes(random_tree(np.random.default_rng(seed)))
        assert verdict_of(fuzz_urdf.check, path) == Verdict("accepted")


@pytest.mark.parametrize(
    ("message", "fault"),
    [
        ("joint 'elbow': 3.20 rad", ""),
        ("two faults:\n  (1) a\n  (2) b", ""),
        ("a \x1b[2J", "holds U+001B"),
        ("a \u202eb", "holds U+202E"),
        ("a\tb", ""),
        ("x" * (MAX_MESSAGE + 1), "2,001 characters"),
        (" ", "empty"),
    ],
)
def test_messages_that_cannot_be_shown(message: str, fault: str) -> None:
    assert message_faults(message) == fault


def test_verdicts_and_smaller_files(tmp_path: Path) -> None:
    """An exception that is not ours is told with its place, and the file is cut down to what causes it."""

    def read_badly(path: Path) -> None:
        if b"#" in path.read_bytes():
            raise KeyError("planted")

    one = Format("planted", ".txt", lambda rng: bytes(rng.integers(65, 90, 60, dtype=np.uint8)) + b"#" * 3, read_badly)
    data = one.make(np.random.default_rng(0))
    path = tmp_path / "case.txt"
    path.write_bytes(data)
    verdict = verdict_of(one.check, path)
    assert (verdict.outcome, verdict.place) == ("raw", "KeyError in ?")
    assert smaller(one, data, verdict) == b"#"


def test_a_crash_and_a_refusal_are_told_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A case that ends its process costs that case only; the next one runs in another process."""
    monkeypatch.setattr("campaign.runner.RESULTS", tmp_path)

    def fall(path: Path) -> None:
        if path.read_bytes() == b"1":
            import os

            os._exit(3)
        raise ps.InputError("planted")

    tally = run_cases(Format("fall", ".txt", lambda rng: b"%d" % (rng.random() < 0.5), fall), range(6), 1)
    assert tally.cases == 6
    assert set(tally.outcomes) == {"crash", "refused"}
    assert all(path.read_bytes() == b"1" for path in tally.kept)


def test_half_files_are_seen(tmp_path: Path) -> None:
    """What a killed writer would leave of each kind of file."""
    for name, whole in (
        ("a.html", "<p></html>\n"),
        ("a.json", '{"a": 1}'),
        ("a.csv", "a\n1234\n"),
        ("a.svg", "<svg></svg>"),
    ):
        path = tmp_path / name
        path.write_text(whole, encoding="utf-8")
        assert fault_of(path) == ""
        path.write_text(whole[: len(whole) // 2], encoding="utf-8")
        assert fault_of(path)


def by_one_name_after_another(_: Output, target: Path, *__: str) -> int:
    """How an empty folder was filled."""
    target.mkdir(exist_ok=True)
    for name in "ab":
        (target / f".{name}").write_text(name)
    for name in "ab":
        (target / f".{name}").replace(target / name)
    return 0


@pytest.mark.parametrize(("number", "outcome"), [(0, "killed: as before"), (1, "killed: in part"), (2, "ended before")])
def test_a_kill_between_two_names_finds_half_a_folder(
    number: int, outcome: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Output, "run", by_one_name_after_another)
    assert killed(Output("planted", ()), tmp_path / "result", {"a", "b"}, number=number) == outcome
