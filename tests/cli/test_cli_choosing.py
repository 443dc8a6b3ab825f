"""compare, optimise, profiles: what they print, write and refuse."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.cli import _optimise, main
from puma_septic.profiles import available


def printed(arguments: list[str], capsys: pytest.CaptureFixture[str], code: int = 0) -> str:
    assert main(arguments) == code
    out, err = capsys.readouterr()
    assert err == ""
    return out


def test_profiles_tells_the_options_of_one(capsys: pytest.CaptureFixture[str]) -> None:
    """Errors of tasks knew the options of a profile; no command told them."""
    text = " ".join(printed(["profiles", "lspb"], capsys).split())
    assert "Options: durations (optional), max_velocity (optional), blend_time (required)" in text
    assert "In a task: profiles: [{name: lspb, blend_time: ...}]" in text
    assert "degree (default: 5)" in printed(["profiles", "bspline"], capsys)
    document = json.loads(printed(["profiles", "cubic", "--format", "json"], capsys))
    assert [row["name"] for row in document["profiles"]] == ["cubic"]
    assert main(["profiles", "quintc"]) == 2
    assert "did you mean 'quintic'?" in capsys.readouterr().err


def test_profiles_lists_all_of_them(capsys: pytest.CaptureFixture[str]) -> None:
    text = printed(["profiles", "--normalised"], capsys)
    assert max(map(len, text.splitlines())) <= 100
    for info in available():
        assert f"\n{info.name} " in text
    assert "classic septic 4-5-6-7" in text
    document = json.loads(printed(["profiles", "--format", "json", "--normalised"], capsys))
    assert [row["name"] for row in document["profiles"]] == [info.name for info in available()]
    assert document["normalised"][0]["jerk"] == "unbounded"


def test_compare_takes_the_tasks_options(capsys: pytest.CaptureFixture[str]) -> None:
    text = printed(["compare", "paper-turned", "--profile", "septic", "--profile", "lspb"], capsys)
    assert "Task 'paper-turned', robot 'puma560'" in text
    assert max(map(len, text.splitlines())) <= 100
    assert "misses by" in text
    assert "trapezoidal" not in text


def test_compare_sets_the_gap_beside_each_profile(capsys: pytest.CaptureFixture[str]) -> None:
    """The least duration of each, over that of the quickest motion along its path; without --reference neither."""
    arguments = ["compare", "paper-turned", "--profile", "quintic"]
    text = printed([*arguments, "--reference"], capsys)
    assert any(line.rstrip().endswith("gap") for line in text.splitlines())
    assert max(map(len, text.splitlines())) <= 100
    gap = json.loads(printed([*arguments, "--reference", "--format", "json"], capsys))["profiles"][0]["gap"]
    assert gap["ratio"] == gap["least_duration"] / gap["reference_duration"] > 1
    assert "gap" not in json.loads(printed([*arguments, "--format", "json"], capsys))["profiles"][0]


@pytest.mark.slow
def test_compare_writes_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "out"
    arguments = ["compare", "--profile", "septic", "--profile", "quintic", "--objective", "peak_jerk"]
    csv = printed([*arguments, "--format", "csv", "--out", str(target)], capsys)
    assert sorted(path.name for path in target.iterdir()) == [
        "comparison.csv", "comparison.json", "comparison.png", "comparison.svg", "report.html",
    ]  # fmt: skip
    assert (target / "comparison.csv").read_text() == csv
    document = json.loads((target / "comparison.json").read_text())
    assert document["pareto_optimal"] == ["septic"]


def test_optimise_finds_the_papers_via_times(capsys: pytest.CaptureFixture[str]) -> None:
    """Exit code 1: the paper's own points are beyond a position limit, whatever the via times."""
    text = printed(["optimise", "--objective", "peak_jerk", "--restarts", "0"], capsys, code=1)
    assert "septic, peak_jerk: 60.8 % lower" in text
    assert "not held: position (joint5 0.2441 rad beyond its bound" in " ".join(text.split())


def test_optimise_respects_limits_and_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["optimise", "paper-turned", "--objective", "peak_velocity", "--restarts", "0"]
    kept = [*arguments, "--respect", "velocity", "--respect", "effort", "--respect", "position"]
    assert "Limits respected: position, velocity, effort; not assessed:" in printed(kept, capsys)


def test_optimise_takes_another_profile_with_what_it_leaves_free(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = [
        "optimise",
        "--profile",
        "quintic",
        "--free",
        "velocities",
        "--free",
        "accelerations",
        "--restarts",
        "0",
    ]
    document = json.loads(printed([*arguments, "--format", "json"], capsys, code=1))
    assert len(document["free_values"]["velocities"]) == 4
    assert document["limits"]["not_held"]
    assert document["improvement"] > 0.9


@pytest.mark.slow
def test_optimise_two_objectives_gives_a_front(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "out"
    arguments = [
        "optimise",
        "--objective",
        "peak_jerk",
        "--objective",
        "overshoot",
        "--points",
        "4",
        "--out",
        str(target),
    ]
    assert "Pareto front over the via times" in printed(arguments, capsys, code=1)
    assert sorted(path.name for path in target.iterdir()) == [
        "front.png", "front.svg", "optimisation.json", "report.html",
    ]  # fmt: skip


def test_optimise_duration_gives_the_least_time(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["optimise", "gasparetto-zanotto", "--objective", "duration", "--free", "free_knots", "--restarts", "0"]
    text = printed(arguments, capsys)
    assert "least time 8.5310 s" in text
    assert "feasible by exact extrema: yes" in " ".join(text.split())


# A first user's job: 2.5 kg or 5 kg at the flange, four points in joint space, or the first and last of another two.
HEAVY = """name: heavy
robot: {source: puma560, tool: flange}
points:
  - {joints: [0.0, 0.6, -2.2, 0.0, 0.3, 0.0]}
  - {joints: [0.4, 1.2, -2.6, 0.0, 0.6, 0.0]}
  - {joints: [1.5, 1.2, -2.6, 0.0, 0.6, 0.0]}
  - {joints: [1.9, 0.6, -2.2, 0.0, 0.3, 0.0]}
times: [0, 0.9, 2.1, 3.0]
profiles: [septic]
payload: {mass: 2.5, com: [0,0,0.1]}
"""


@pytest.fixture
def heavy(tmp_path: Path) -> Path:
    path = tmp_path / "heavy.yaml"
    path.write_text(HEAVY)
    return path


def test_least_time_holds_effort(heavy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """'feasible: yes' and exit 0 once came with joint 2 at 109.7 % of its torque."""
    arguments = ["optimise", str(heavy), "--objective", "duration", "--restarts", "0"]
    text = " ".join(printed(arguments, capsys).split())
    assert "Limits respected: position, velocity, effort" in text
    assert "feasible by exact extrema: yes" in text
    text = " ".join(printed([*arguments, "--respect", "velocity"], capsys, code=1).split())
    assert "not held: effort (joint2 at 109.7 %)" in text
    assert "feasible by exact extrema: no" in text


@pytest.mark.slow
def test_least_time_that_weight_rules_out_says_why(heavy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    heavy.write_text(HEAVY.replace("mass: 2.5", "mass: 5.0"))
    arguments = ["optimise", str(heavy), "--profile", "quintic", "--objective", "duration", "--restarts", "0"]
    assert main(arguments) == 2
    assert "no duration keeps the effort limit of joint 'joint2'" in capsys.readouterr().err
    text = " ".join(printed([*arguments, "--respect", "velocity"], capsys, code=1).split())
    assert "not held: effort (joint2 at 154.6 %, joint5 at 118.3 %" in text


def test_least_time_of_two_points(heavy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lines = HEAVY.splitlines(keepends=True)
    heavy.write_text("".join(lines[:5] + lines[7:]).replace("0, 0.9, 2.1, 3.0", "0, 1").replace("septic", "quintic"))
    arguments = ["optimise", str(heavy), "--objective", "duration", "--out", str(tmp_path / "out")]
    assert "feasible by exact extrema: yes" in " ".join(printed(arguments, capsys).split())


def test_optimise_reads_and_writes_points_in_degrees(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The same task in rad has the same optimum; what is written keeps the points in degrees and gives its times."""
    degrees = np.array([[0.0, 34, -126, 0, 17, 0], [57, 68, -149, 11, 34, 6], [90, 34, -126, 0, 17, 0]])
    found = []
    for key, points in (("joints_deg", degrees), ("joints", np.deg2rad(degrees))):
        task, best = tmp_path / f"{key}.yaml", tmp_path / f"best_{key}.yaml"
        task.write_text(
            f"name: {key}\nrobot: {{source: puma560}}\ntimes: [0, 1, 2]\nprofiles: [quintic_spline]\npoints:\n"
            + "".join(f"  - {{{key}: {row}}}\n" for row in points.tolist())
        )
        arguments = ["optimise", str(task), "--restarts", "0", "--format", "json", "--write", str(best)]
        found.append(json.loads(printed(arguments, capsys))["optimum"])
        assert f"{key}: [" in best.read_text()
        again = ["optimise", str(best), "--restarts", "0", "--format", "json"]
        assert json.loads(printed(again, capsys))["start"]["times"] == pytest.approx(found[-1]["times"], rel=1e-12)
    assert found[0]["times"] == pytest.approx(found[1]["times"], rel=1e-6)
    assert found[0]["value"] == pytest.approx(found[1]["value"], rel=1e-9)


def test_an_optimum_that_no_task_says_is_not_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is written is read again; here it comes back as another motion."""
    points = "".join(f"  - {{joints: [{x}, 0.5, -2.5, 0, 0.7, 0]}}\n" for x in (0, 0.2, 0.5))
    (tmp_path / "t.yaml").write_text(f"name: t\ntimes: [0, 1, 2]\nprofiles: [quintic_spline]\npoints:\n{points}")
    monkeypatch.setattr(_optimise, "_is_same", lambda *_: False)
    assert main(["optimise", str(tmp_path / "t.yaml"), "--restarts", "0", "--write", str(tmp_path / "best.yaml")]) == 2
    assert "best.yaml: no task says this optimum, of which more than times was free; .json" in capsys.readouterr().err
    assert not (tmp_path / "best.yaml").exists()


def test_optimise_lspb_passes_durations(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["optimise", "--profile", "lspb", "--objective", "peak_acceleration", "--restarts", "0"]
    assert "lspb, peak_acceleration" in printed(arguments, capsys, code=1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["compare", "--profile", "septik"], "unknown profile 'septik'; valid:"),
        (["compare", "--objective", "jerk"], "unknown objective 'jerk'; valid:"),
        (["compare", "papre"], "unknown task 'papre'"),
        (["optimise", "--objective", "jerk"], "unknown objective 'jerk'; valid:"),
        (["optimise", "--profile", "septic", "--profile", "lspb"], "one profile is optimised at a time"),
        (["optimise", "--profile", "cubic", "--objective", "peak_jerk"], "unbounded for profile cubic"),
        (["optimise", "--respect", "position", "--restarts", "0"], "no via times were found that keep the constraints"),
        (["optimise", "--respect", "torque"], "unknown limit 'torque'; valid: 'position'"),
        (["optimise", "--objective", "duration", "--restarts", "0"], "joint5 position -1.989 rad at t = 0 s is 0.2441"),
        (["optimise", "--free", "velocities"], "septic has no free velocities"),
        (["optimise", "--max-overshoot", "nan"], "max_overshoot = nan rad is not a finite number"),
        (["profiles", "--format", "sarif"], "invalid choice: 'sarif'"),
    ],
)
def test_bad_input_is_one_line_on_stderr(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert message in err


def test_branches_are_sorted_and_tell_their_manipulability(capsys: pytest.CaptureFixture[str]) -> None:
    """`ik` had no order but that of the names, and told nothing of how far a posture is from singular ones."""
    pose = ["ik", "--robot", "ur5", "--position", "0.4", "0.1", "0.3", "--rpy-deg", "0", "180", "0"]
    assert main([*pose, "--sort", "manipulability", "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    branches = document["poses"][0]["branches"]
    ease = [one["manipulability"] for one in branches]
    assert ease == pytest.approx(sorted(ease, reverse=True), rel=1e-9)
    # Yoshikawa's measure of six joints is the magnitude of the Jacobian's determinant.
    robot = ps.load_robot("ur5")
    determinants = [abs(np.linalg.det(ps.jacobian(robot, np.array(one["q"])))) for one in branches]
    assert ease == pytest.approx(determinants, rel=1e-9)
    assert main([*pose, "--sort", "height"]) == 0
    text = capsys.readouterr().out
    assert text.index("left-up-flip") < text.index("left-down-noflip")
    assert text.count("All 8 branches.") == 1  # a note below a table that is continued is no row of it


@pytest.mark.slow
def test_a_margin_means_the_same_everywhere(capsys: pytest.CaptureFixture[str]) -> None:
    """`--margin` was known to `assess` alone. A motion that the velocity stops takes 1 / (1 - margin) times as long."""
    least = {}
    for margin in ("0", "0.2"):
        main(["limits", "paper-turned", "--profile", "septic", "--margin", margin, "--format", "json"])
        least[margin] = json.loads(capsys.readouterr().out)["profiles"][0]["fastest"]["duration"]
    assert least["0.2"] == pytest.approx(least["0"] / 0.8, rel=1e-9)
    task = ps.resolve_task(ps.load_task("paper-turned"))
    slower = ps.septic(task.points, np.array(task.times) * least["0.2"] / task.times[-1])
    assessment = ps.assess(task.robot, slower)
    assert not assessment.keeps(0.2 - 1e-9)
    assert assessment.keeps(0.2 + 1e-9)
    assert main(["compare", "paper-turned", "--margin", "0.2", "--format", "json"]) == 0
    rows = {one["name"]: one for one in json.loads(capsys.readouterr().out)["profiles"]}
    assert not rows["septic"]["is_feasible"]  # 86 % of a velocity limit
    assert rows["cubic_spline"]["is_feasible"]
    assert main(["optimise", "--margin", "1"]) == 2
    assert "--margin 1 leaves nothing of the limits" in capsys.readouterr().err


CELL = """
name: cell
robot: {source: puma560}
points:
  - {joints: [0.0, 0.6, -2.2, 0.0, 0.3, 0.0]}
  - {joints: [1.2, 1.0, -2.4, 0.0, 0.6, 0.0]}
times: [0, 2.0]
profiles: [quintic]
"""


@pytest.mark.slow
def test_a_margin_keeps_the_tools_limits_in_reserve_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`assess --margin` held the tool to it; what `optimise`, `limits` and `compare` found within it broke it there."""
    task, best = tmp_path / "cell.yaml", tmp_path / "best.yaml"
    task.write_text(CELL + "tool_limits: {speed: 0.5}\n")
    asked = ["--margin", "0.2"]
    printed(["optimise", str(task), "--objective", "duration", "--write", str(best), *asked], capsys)
    assert "speed: 0.5" in best.read_text()
    assert "kept with 20 % to spare" in printed(["assess", str(best), *asked], capsys)
    found = json.loads(printed(["limits", str(task), *asked, "--format", "json"], capsys))["profiles"][0]["fastest"]
    assert found["duration"] == pytest.approx(ps.load_task(best).times[-1], rel=1e-6)
    assert found["governing"]["limit"] == pytest.approx(0.4)
    row = json.loads(printed(["compare", str(best), *asked, "--format", "json"], capsys))["profiles"]
    assert next(one["is_feasible"] for one in row if one["name"] == "quintic")
    for command in (["compare"], ["limits"], ["optimise", "--objective", "duration"]):
        folder = tmp_path / command[0]
        arguments = [command[0], str(task), *command[1:], *asked, "--format", "json", "--no-png", "--out", str(folder)]
        assert json.loads(printed(arguments, capsys))["margin"] == 0.2
        assert json.loads(next(folder.glob("*.json")).read_text())["margin"] == 0.2
        assert "20 % of the limits of joints and tool kept in reserve" in (folder / "report.html").read_text()


def test_an_excerpt_is_one_everywhere(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`rest_before: false` reached `assess`; `compare` and `optimise` saw a step of velocity at each end."""
    task = tmp_path / "cell.yaml"
    task.write_text(CELL.replace("quintic", "linear") + "rest_before: false\nrest_after: false\n")
    printed(["assess", str(task)], capsys)
    rows = json.loads(printed(["compare", str(task), "--profile", "linear", "--format", "json"], capsys))["profiles"]
    assert rows[0]["is_feasible"]
    assert rows[0]["overall"]["peak_acceleration"] == 0
    for command in (["limits"], ["optimise", "--objective", "duration"]):
        main([command[0], str(task), *command[1:]])
        out, err = capsys.readouterr()
        assert "no stretch keeps the velocity with which the motion starts or ends" in " ".join(f"{out}{err}".split())


def test_the_report_of_an_optimum_knows_the_cell(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Its page judged the motion without floor and tool: feasible, where the command ended with 1."""
    task = tmp_path / "cell.yaml"
    task.write_text(CELL + "tool_limits: {speed: 0.5}\n")
    folder = tmp_path / "out"
    arguments = ["optimise", str(task), "--objective", "duration", "--no-png", "--out", str(folder)]
    printed(arguments, capsys)
    assert "governing: tool speed" in (folder / "report.html").read_text()


DEGREES = """<robot name="p"><link name="a"/><link name="b"><inertial><mass value="1"/><origin xyz="0.1 0 0"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 -1 0"/>
<limit effort="20" velocity="100" lower="0" upper="0"/></joint></robot>"""


def test_points_that_may_be_degrees_leave_optimise_undecided(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`assess` asked whether 90 rad are degrees, exit code 3; `optimise` called the same points feasible, with 0."""
    (tmp_path / "p.urdf").write_text(DEGREES)
    task = tmp_path / "p.yaml"
    task.write_text(
        "name: p\nrobot: {source: p.urdf}\npoints: [{joints: [0]}, {joints: [45]}, {joints: [90]}]\n"
        "times: [0, 5, 10]\nprofiles: [quintic_spline]\n"
    )
    for objective in ("duration", "integral_of_squared_jerk"):
        arguments = ["optimise", str(task), "--objective", objective, "--restarts", "0"]
        assert "\nUndecided: points in degrees? j reaches 90 rad" in printed(arguments, capsys, 3)
        document = json.loads(printed([*arguments, "--format", "json"], capsys, 3))
        assert document["undecided"]
        assert not document.get("is_feasible", False)


@pytest.mark.parametrize(
    ("asked", "why"),
    [("floor: 1.0", "below the floor at 1 m; that is violated at any speed"), ("dwell: 1.0", "effort limit of joint2")],
)
def test_a_reference_is_none_where_no_duration_helps(
    asked: str, why: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A least duration stood beside a profile that breaks the floor, or cannot be held in the dwell, at any."""
    task = tmp_path / "down.yaml"
    task.write_text(
        "name: down\nrobot: {source: puma560}\npoints:\n  - {joints: [0, 0.9, -2.2, 0, 0.3, 0]}\n"
        "  - {joints: [0.1, 0.3, -2.2, 0, 0.3, 0]}\ntimes: [0, 4.0]\nprofiles: [quintic]\n"
        f"payload: {{mass: 3.0, com: [0, 0, 0.1]}}\nlimits: {{effort: [56, 66, 52, 10, 10, 10]}}\n{asked}\n"
    )
    arguments = ["compare", str(task), "--profile", "quintic", "--reference", "--format", "json"]
    gap = json.loads(printed(arguments, capsys))["profiles"][0]["gap"]
    assert why in gap["reason"]
    main(["limits", str(task), "--reference", "--format", "json"])
    one = json.loads(capsys.readouterr().out)["profiles"][0]
    assert one["reference"]["reason"] == one["why_not_fastest"] != ""
