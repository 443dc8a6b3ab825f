"""Doors that refuse what the tests of their rooms do not bring: each with its text."""

from __future__ import annotations

import builtins
import hashlib
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec, module_from_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import matplotlib.figure
import numpy as np
import pinocchio as pin
import pytest
from helpers.arms import branched_arm
from helpers.ros_messages import small_move
from helpers.urdf_texts import DRIVES, load, replaced

import puma_septic as ps
from puma_septic import plots
from puma_septic.cli import main
from puma_septic.files import sha256_of
from puma_septic.kinematics._chain import _axis
from puma_septic.limits import payload_and_duration, payload_diagram
from puma_septic.optimisation._torque_cuts import least_duration
from puma_septic.optimum import _jerk_limited, _time_optimal
from puma_septic.outputs import write_file
from puma_septic.profiles._integration import smooth_series
from puma_septic.ros import read_joint_state
from puma_septic.sizing import Conditions
from puma_septic.sizing._task_cases import cycle_case
from puma_septic.sizing._thermal import steady_cycle
from puma_septic.task import make_task, resolve_cycle
from puma_septic.testing import assert_feasible, assert_trajectory_ok
from puma_septic.vibration import stiffness_for
from puma_septic.viewer import _server as server

ROBOT = ps.load_robot()
MOTION = ps.compute_motion(ROBOT, small_move(ROBOT))
MOTOR = ps.Motor(name="M", rotor_inertia=1e-4, peak_torque=1.0, continuous_torque=0.5, max_speed=400.0)
GEARBOX = ps.Gearbox(name="G", ratio=100.0, efficiency=0.8)
ONE_JOINT = ps.Limits(position=[[-1.0, 1.0]], velocity=[1.0], acceleration=[1.0], jerk=[1.0], effort=[1.0])
SKEW = [[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: ps.Catalogue(motors=[MOTOR], gearboxes=[GEARBOX], drives=[ps.Drive(), ps.Drive()]),
            "2 drives for 1 motors: expected one of each",
        ),
        (lambda: ps.Piecewise.fit("sin", [0.0, 1.0]), "f: expected a function of time, got 'sin'"),
        (
            lambda: ps.fit_trajectory([0.0, 1.0], [[0.0, 0.0], [1.0, 1.0]], continuous=[True] * 3),
            "continuous: expected True or False, or one of them for each of 2 joints",
        ),
        (lambda: ps.Actuator(gear_ratio=0.0), "gear_ratio = 0: the ratio of motor speed to joint speed cannot be zero"),
        (lambda: replace(ROBOT, drivetrains=ROBOT.drivetrains[:1]), "actuators: 1 given for 6 joints"),
        (
            lambda: replace(ROBOT, limits=ONE_JOINT),
            "limits: given for 1 joints, the arm has 6",
        ),
        (lambda: ps.Payload(mass=1.0, inertia=SKEW), "a payload's inertia matrix must be symmetric"),
        (lambda: replace(small_move(ROBOT), resolution=-1e-6), r"resolution = -1e-06 must be at least 0"),
        (
            lambda: small_move(ROBOT).position.positive_spans(),
            "positive_spans: one component is needed, the function has 6",
        ),
        (lambda: write_file("a\0b", ""), r"'a\\x00b': cannot be written: .*embedded null"),
        (lambda: sha256_of(Path("none")), "none: cannot be read: .*No such file"),
        (lambda: ps.load_task(f"{300 * 'a'}.yaml"), "cannot read this task file: .*name too long"),
        (lambda: ps.Drivetrain(with_brake=1), "with_brake = 1: expected True or False"),  # type: ignore[arg-type]
        (lambda: ps.assess(MOTION, tool_limits=0.25), r"tool_limits: expected paths\.ToolLimits, got 0\.25"),
        (
            lambda: ps.assess_cycle(ps.Cycle(steps=[MOTION]), names=["there", "back"]),
            "names: 2 names for 1 steps; one for each is needed",
        ),
        (lambda: MOTION.torque.stepwise(np.ones((9, 1))), r"values: shape \(9, 1\) is not \(1, p\), a row for each"),
        (lambda: Conditions(margins={"torque": 0.1}), "margins: unknown check 'torque'; valid: all, physics"),
        (lambda: Conditions(margins=1.0), r"margin of all = 1\.0: must be less than 1"),
        (lambda: Conditions(bus_voltage=-24.0), "bus_voltage = -24 V must be greater than 0 V"),
        (lambda: Conditions(stages={"joint1": 3}), "stages: joint 'joint1': expected a LinearStage, got int"),
        (lambda: payload_diagram([], [0.1]), "motions: at least one is needed"),
        (lambda: payload_diagram(MOTION, [0.1], direction=[0, 0, 0]), "direction: expected three numbers, not all 0"),
        (lambda: payload_and_duration(MOTION, [1.0, 2.0], [0.5]), "2 durations and 1 masses: expected one of each"),
        (lambda: ps.within_limits("septic", [[0.0]], max_velocity=1.0), "septic needs at least 2 points, got 1"),
        (
            lambda: ps.within_limits("trapezoidal", [[0.0], [1.0], [1.0]], max_velocity=1.0, max_acceleration=1.0),
            "trapezoidal: points 1 and 2 are the same, so that any duration is long enough",
        ),
        (lambda: ps.acceleration_limits(ROBOT, speeds=-1.0), "speeds = -1 must be at least 0"),
    ],
)  # fmt: skip
def test_values_and_files(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        call()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('tool = "tip"', "tool = 5", r"tool = 5 is not text"),
        ("xyz = [0.0, 0.0, 0.45]", "", r"origins\.elbow: xyz is missing"),
        ("origins.elbow", "origins.wrist", r"arm\.toml: unknown joint 'wrist'; valid: shoulder, elbow, mount"),
    ],
)
def test_actuator_files(old: str, new: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ps.ModelError, match=message):
        load(tmp_path, drives=replaced(old, new, DRIVES), parameters="worn")


def test_an_actuator_file_without_a_set(tmp_path: Path) -> None:
    with pytest.raises(ps.ModelError, match=r"neither drives nor limits; expected a table \[parameters\.NAME"):
        load(tmp_path, drives='schema = 1\nrobot = "arm"\n')


def test_an_actuator_file_that_is_no_utf8(tmp_path: Path) -> None:
    (tmp_path / "arm.toml").write_bytes(DRIVES.replace("catalogue", "für").encode("latin-1"))
    with pytest.raises(ps.ModelError, match=r"arm\.toml, line 7: this actuator file is not UTF-8 text \(invalid"):
        load(tmp_path, actuators=tmp_path / "arm.toml")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"0 0 0.5"', '"0 0 0.5" quat_xyzw="0 0 0 2"', "quat_xyzw='0 0 0 2': its norm is 2, not 1"),
        ("ixy=", "iyx=", "<inertia> of link 'upper': unknown attribute 'iyx'; did you mean 'ixy'"),
    ],
)
def test_urdf_files(old: str, new: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ps.ModelError, match=message):
        load(tmp_path, replaced(old, new))


def test_joints_that_no_urdf_has() -> None:
    """Pinocchio knows joints that turn and slide at once; a chain of ours has none."""
    model = pin.Model()
    model.addJoint(0, pin.JointModelHZ(0.1), pin.SE3.Identity(), "screw")
    model.addJoint(0, pin.JointModelSpherical(), pin.SE3.Identity(), "ball")
    with pytest.raises(ps.ModelError, match="joint 'screw': a screw joint; only revolute and prismatic joints"):
        _axis(model, 1)
    with pytest.raises(ps.ModelError, match="joint 'ball': 3 degrees of freedom; only revolute and prismatic joints"):
        _axis(model, 2)


# ---- ROS


def test_a_state_file_of_two_documents(tmp_path: Path) -> None:
    state = "name: [a]\nposition: [0.0]\n---\n"
    (tmp_path / "state.yaml").write_text(2 * state, encoding="utf-8")
    with pytest.raises(ps.InputError, match=r"one JointState is expected, it has 2 documents"):
        read_joint_state(tmp_path / "state.yaml")


@pytest.mark.parametrize(
    ("state", "message"),
    [
        ("name: [a, b]\nposition: []\n", "state.yaml: position is empty"),
        ("name: [a, '...']\nposition: [0.0]\n", r"name ends in '\.\.\.': .* record it with --full-length"),
    ],
)
def test_state_files(state: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "state.yaml").write_text(state, encoding="utf-8")
    with pytest.raises(ps.InputError, match=message):
        read_joint_state(tmp_path / "state.yaml")


def test_a_motion_that_few_points_do_not_hold(tmp_path: Path) -> None:
    move = ps.septic([[0.0] * 6, [1.0] * 6, [2.0] * 6, [0.0] * 6], [0.0, 1.0, 2.0, 3.0])
    with pytest.raises(
        ps.InputError, match="points do not bring the controller's motion within 1e-19 of this one; allow"
    ):
        ps.write_joint_trajectory(tmp_path / "a.yaml", move, joint_names=ROBOT.joint_names, tolerance=1e-19)


def test_a_bag_without_the_package_that_reads_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An optional dependency: the message says how to get it."""
    (tmp_path / "a.mcap").write_bytes(b"\x89MCAP0\r\n")
    real = builtins.__import__

    def without_rosbags(name: str, *rest: Any) -> Any:
        if name.startswith("rosbags"):
            raise ModuleNotFoundError(f"No module named {name!r}", name="rosbags")
        return real(name, *rest)

    monkeypatch.delitem(__import__("sys").modules, "puma_septic.ros._bags", raising=False)
    monkeypatch.setattr(builtins, "__import__", without_rosbags)
    with pytest.raises(ps.InputError, match=r'with the package rosbags: pip install "puma-septic\[ros\]"'):
        ps.read_joint_trajectory(tmp_path / "a.mcap", ROBOT)


def test_points_that_are_one_in_whole_nanoseconds(tmp_path: Path) -> None:
    move = ps.profiles.linear([[0.0], [1e-12], [2e-12]], [0.0, 1e-10, 1.0], joint_names=("a",))
    with pytest.raises(ps.InputError, match=r"points at 0 s and 1e-10 s are one in the message's nanoseconds"):
        ps.write_joint_trajectory(tmp_path / "a.yaml", move)


def test_what_is_undecided_fails_a_test() -> None:
    """A joint that turns by 90 may have been meant in degrees."""
    far = ps.quintic_segments([[0.0] * 6, [0.0] * 5 + [90.0]], [0, 500])
    with pytest.raises(AssertionError, match=r"^undecided: points in degrees\? joint6 reaches 90 rad"):
        assert_feasible(ps.assess(ROBOT, far), ignore=["joint6"])


def test_a_trajectory_that_may_not_go_to_the_robot_fails_a_test(tmp_path: Path) -> None:
    path = ps.write_joint_trajectory(tmp_path / "fast.yaml", small_move(ROBOT, 0.4))
    with pytest.raises(AssertionError, match=r"fast\.yaml: violated"):
        assert_trajectory_ok(path, ROBOT)


# ---- where the numbers have no answer


def test_functions_that_no_series_holds() -> None:
    with pytest.raises(ps.PumaSepticError, match=r"no Chebyshev series of degree 128 converges on \[-1, 2\] s"):
        smooth_series(np.abs, -1.0, 2.0)
    heating = ps.Piecewise.from_power([0.0, 1.0, 2.0], [[[800.0], [-900.0]]])
    source = ps.Piecewise.from_power([0.0, 1.0, 2.0], [[[1e300], [1e300]]])
    with pytest.raises(ps.PumaSepticError, match="the winding's temperature swings too far within one cycle to be"):
        steady_cycle(heating, source)


def test_a_torque_that_does_not_follow_its_duration() -> None:
    """A family whose motion stays the same, whatever duration it is asked for."""
    motion = ps.compute_motion(ROBOT, small_move(ROBOT, 0.2))
    same: Any = SimpleNamespace(motion=motion, trajectory=motion.trajectory)
    with pytest.raises(ps.InputError, match=r"profile \w+ does not scale with its times: its torque differs"):
        least_duration(lambda _: same, 0.0)


def test_knots_that_fall_together() -> None:
    """Vias of two units in the last place apart can be told apart, averages of five of them cannot."""
    times = np.append(0.0, 1.9127555772777218 + np.arange(11) * 2.0**-51)
    points = np.arange(12.0)[:, None]
    with pytest.raises(ps.InputError, match=r"degree 5 with segments of 4\.44089e-16 s .* by more than all of the"):
        ps.profiles.bspline(points, times, degree=5)


def test_a_cell_that_leaves_no_time_for_its_cycle() -> None:
    document = {**ps.load_task("paper-straight").document(), "conditions": {"cycles_per_minute": 60}}
    with pytest.raises(ps.InputError, match=r"a cycle has 1 s, but this one takes 18 s; at most 3\.333 cycles"):
        cycle_case(resolve_cycle(make_task(document)))


@pytest.mark.slow
def test_more_joints_than_can_be_bounded_at_once(tmp_path: Path) -> None:
    snake = branched_arm(tmp_path, np.random.default_rng(1), 20)
    with pytest.raises(ps.ModelError, match="no certified bound: 19 joints act together, more than can be bounded"):
        ps.worst_holding_torque(snake)


def test_a_slide_without_bounds_and_a_posture_without_inertia(tmp_path: Path) -> None:
    slide = replaced('name="elbow" type="revolute"', 'name="elbow" type="prismatic"')
    with pytest.raises(ps.InputError, match="region: joint 'elbow' slides and has no position limits; give its bounds"):
        ps.acceleration_limits(load(tmp_path, replaced('lower="-2.5" upper="2.5" ', "", slide)))
    rods = replaced('izz="0.05"', 'izz="0"', replaced('<axis xyz="0 1 0"/>', '<axis xyz="0 0 1"/>'), count=2)
    with pytest.raises(ps.InputError, match="joint 'shoulder' moves no inertia in this posture: no stiffness swings"):
        stiffness_for(load(tmp_path, rods), [0.0, 0.0], 10.0)


@pytest.mark.parametrize(
    ("home", "missing", "message"),
    [
        ("study._folder", "pyarrow", r"a study needs the packages pyarrow and duckdb: .* 'puma-septic\[study\]'"),
        ("optimum._time_optimal", "toppra", r"the reference needs toppra: .* 'puma-septic\[optimum\]'"),
    ],
)
def test_an_optional_package_that_is_not_there(
    home: str, missing: str, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    spec = find_spec(f"puma_septic.{home}")
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(ps.InputError, match=message):
        spec.loader.exec_module(module_from_spec(spec))  # type: ignore[union-attr, arg-type]


def test_what_toppra_and_copp_do_not_find(monkeypatch: pytest.MonkeyPatch) -> None:
    """Limits that no motion along the path keeps are found out before; here both give up."""

    def lost(*_: object) -> Any:
        raise _jerk_limited.copp_py.CoppError("infeasible")

    monkeypatch.setattr(_jerk_limited, "_solved", lost)
    with pytest.raises(ps.NoSolution, match="copp finds no motion along this path from rest to rest: infeasible"):
        ps.time_optimal(ps.compute_motion(ROBOT.with_limits(jerk=np.full(6, 40.0)), MOTION.trajectory))
    monkeypatch.setattr(_time_optimal.algorithm.TOPPRA, "compute_parameterization", lambda *_: (None, None, None))
    with pytest.raises(ps.NoSolution, match="toppra finds no motion along this path from rest to rest"):
        ps.time_optimal(MOTION)


# ---- at the edge


def test_axes_that_are_no_more() -> None:
    axes = matplotlib.figure.Figure().subplots(6)
    axes[0].remove()
    with pytest.raises(ps.InputError, match="ax: these axes have been removed from their figure"):
        plots.plot_torque(ps.assess(ROBOT, small_move(ROBOT)), ax=axes)


def test_a_machine_that_opens_no_port(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError("Too many open files")

    monkeypatch.setattr(server, "_Server", refuse)
    with pytest.raises(ps.InputError, match=r"no port of 127\.0\.0\.1 can be opened: Too many open files"):
        server.serve_page("<p>")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["optimise", "task.yaml"], "profile 'double_s' finds its own times; there are no via times to choose"),
        (["replay", "--csv", "log.csv", "--profile", "septic"], "--profile does not go with --csv"),
        (["size", "--csv", "log.csv", "--profile", "septic"], "--profile does not go with --csv"),
    ],
)
def test_command_lines(
    arguments: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    points = "\n".join(f"  - {{joints: [{0.1 * k}, 0, 0, 0, 0, 0]}}" for k in range(3))
    limits = "{name: double_s, max_velocity: 1, max_acceleration: 1, max_jerk: 1}"
    text = f"name: x\npoints:\n{points}\ntimes: [0, 1, 2]\nprofiles: [{limits}]\n"
    Path("task.yaml").write_text(text, encoding="utf-8")
    Path("log.csv").write_text("t,joint1\n0,0\n1,1\n", encoding="utf-8")
    assert main(arguments) == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_a_share_of_speeds_that_are_not_known(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = replaced('name="elbow" type="revolute"', 'name="elbow" type="continuous"')
    text = replaced('<limit lower="-2.5" upper="2.5" effort="20" velocity="4"/>', "", text)
    (tmp_path / "arm.urdf").write_text(text, encoding="utf-8")
    assert main(["accelerations", str(tmp_path / "arm.urdf"), "--speed", "0.5"]) == 2
    assert "--speed: no velocity limit for elbow" in capsys.readouterr().err


def test_an_output_that_is_closed_or_full(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    with monkeypatch.context() as closed:
        closed.setattr(sys, "stdout", None)
        assert main(["profiles"]) == 2
    assert "cannot write the result: the standard output is closed" in capsys.readouterr().err
    if not Path("/dev/full").exists():
        pytest.skip("a device of Linux that is always full")
    with Path("/dev/full").open("w") as full, monkeypatch.context() as no_space:
        no_space.setattr(sys, "stdout", full)
        assert main(["profiles"]) == 2
    assert "cannot write the result: No space left on device" in capsys.readouterr().err


def test_a_digest_is_that_of_the_bytes(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"abc")
    assert sha256_of(tmp_path / "a") == hashlib.sha256(b"abc").hexdigest()
