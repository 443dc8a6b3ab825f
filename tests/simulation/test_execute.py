"""Profiles side by side: the value, its document, the command, the report and the pictures."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.cli import _execute, _execute_answer, main
from puma_septic.pictures.execution import execution_pictures, spectrum_picture, stops_picture
from puma_septic.simulation import LAWS, Gains, stop_table

POINTS, TIMES = [[0.0] * 6, [0.1, -0.1, 0.1, 0.1, -0.1, 0.2]], [0.0, 0.3]


@cache
def executed() -> ps.Execution:
    moves = {name: ps.profiles.make(name, POINTS, TIMES) for name in ("linear", "bang_bang", "quintic_segments")}
    return ps.execute(ps.load_robot(), moves, controller="feedforward", settle=0.1)


@cache
def task_file(folder: Path) -> Path:
    path = folder / "short.yaml"
    path.write_text(
        "name: short\nrobot: {source: puma560}\npoints:\n"
        "  - {joints: [0, 0, 0, 0, 0, 0]}\n  - {joints: [0.1, -0.1, 0.1, 0.1, -0.1, 0.2]}\ntimes: [0, 0.3]\n"
        "profiles: [{name: quintic_segments}, {name: cycloidal}]\n",
        encoding="utf-8",
    )
    return path


def test_a_step_of_the_velocity_cannot_be_followed_and_the_rest_hardly_differs() -> None:
    """With the planned torque fed forward: a smooth profile is not better for being smooth, but for its size."""
    errors = [executed()[name].metrics.tool_peak_error for name in executed().simulations]
    assert errors[0] > 100 * max(errors[1:])
    assert max(errors[1:]) < 1e-4
    assert not executed().has_diverged
    assert [run["name"] for run in executed().to_dict()["runs"]] == list(executed().simulations)


def test_the_text_and_the_table_say_what_the_document_has() -> None:
    text = str(executed())
    assert "Simulated: feedforward at 1000 Hz, bandwidth 5 Hz, rigid gears" in text
    assert "From samples" in " ".join(text.split())
    assert max(map(len, text.splitlines())) <= 110
    lines = executed().to_csv().splitlines()
    assert lines[0].startswith("profile,duration,diverged_at,joint,peak_error")
    assert len(lines) == 1 + 3 * 7


def test_the_executed_trajectory_is_that_of_the_samples() -> None:
    simulation = executed()["quintic_segments"]
    again = simulation.executed
    inside = simulation.t <= again.duration
    assert again(simulation.t[inside]) == pytest.approx(simulation.q[inside], abs=2e-5)
    assert again(simulation.t[inside], 1) == pytest.approx(simulation.v[inside], abs=5e-3)
    assert again.profile == "quintic_segments, executed"


@pytest.mark.slow
def test_the_command_tells_simulates_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    task = str(task_file(tmp_path))
    assert main(["execute", task, "--settle", "0.1", "--controller", "pd", "--format", "json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["schema"] == "puma-septic/execution/1"
    assert document["controller"]["law"] == "pd"
    out = tmp_path / "out"
    arguments = ["--settle", "0.1", "--joint-frequency", "12", "--profile", "cycloidal", "--payload", "1"]
    assert main(["execute", task, *arguments, "--unknown-payload", "--out", str(out)]) == 0
    text = capsys.readouterr().out
    assert "elastic gears" in text
    assert "Stiffness of the joints, assumed" in text
    assert "The controller's model is another than the arm." in text
    files = {path.name for path in out.iterdir()}
    assert {"execution.json", "execution.csv", "report.html", "samples-cycloidal.csv", "tracking.svg"} <= files
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "cycloidal, executed" in page
    assert "cycloidal, planned" in page


@pytest.mark.slow
def test_the_command_ends_with_1_where_an_arm_diverges(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Of gains that the command cannot have: the arm's limits are taken away."""

    def unstable(robot: ps.Robot, moves: Mapping[str, ps.Trajectory], **_: Any) -> ps.Execution:
        gains = Gains(np.full(6, 1e6), np.full(6, 1e5), np.zeros(6))
        return ps.execute(robot.with_limits(effort=np.nan), moves, controller=ps.Controller(law="pd", gains=gains))

    monkeypatch.setattr(_execute_answer, "execute", unstable)
    task, out = str(task_file(tmp_path)), tmp_path / "out"
    assert main(["execute", task, "--out", str(out)]) == 1
    text = capsys.readouterr().out
    assert "diverged at" in text
    assert "cycloidal: Diverged at t = " in text
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "Diverged from the plan: " in page


def test_the_command_refuses_a_rate_that_does_not_divide(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    task = str(task_file(tmp_path))
    assert main(["execute", task, "--rate", "777"]) == 2
    assert "rate = 777 Hz: the motion of 0.3 s is 233.1 control periods" in capsys.readouterr().err


def test_the_command_knows_the_laws() -> None:
    assert set(_execute._LAWS) == set(LAWS) - {"none"}


def test_pictures(puma: ps.Robot) -> None:
    tracking, spectrum = execution_pictures(executed())
    assert [panel.title for panel in tracking.panels] == ["tool", *puma.joint_names]
    assert len(spectrum.panels[0].curves) == 3
    assert len(spectrum_picture({"one": executed()["linear"].trajectory}).legend) == 1
    stops = stops_picture(stop_table(puma, load=2.5, fractions=(0.5, 1.0)))
    assert len(stops.panels) == 6
    assert "not a safety function" in stops.footnote


def test_figures(puma: ps.Robot) -> None:
    assert len(ps.plots.plot_tracking(executed()).axes) == 7
    moves = {name: one.trajectory for name, one in executed().simulations.items()}
    assert len(ps.plots.plot_residual_vibration(moves).axes) == 1
    assert len(ps.plots.plot_stops(stop_table(puma, load=2.5, fractions=(1.0,))).axes) == 3


def test_nothing_to_execute(puma: ps.Robot) -> None:
    with pytest.raises(ps.InputError, match=r"an execution needs at least one trajectory"):
        ps.execute(puma, {})
    with pytest.raises(ps.InputError, match=r"unknown executed trajectory 'cubic'; valid: 'linear'"):
        executed()["cubic"]


def test_residual_vibration_of_the_simulation_is_that_of_the_spectrum(puma: ps.Robot) -> None:
    """One elastic joint far from the others, followed exactly: its deflection after the end is the closed form's."""
    rotors = [ps.Actuator(gear_ratio=one.gear_ratio, rotor_inertia=one.rotor_inertia) for one in puma.actuators]
    robot = puma.with_actuators(rotors).with_limits(effort=np.nan)
    quick = ps.quintic_segments([[0.0] * 6, [0.1, 0.0, 0.0, 0.0, 0.0, 0.0]], [0.0, 0.1])
    elastic = ps.ElasticJoints.of_frequency(robot, quick.points[0], [8.0, *[200.0] * 5], damping_ratio=0.0)
    stiff = ps.Controller(law="computed_torque", rate=np.inf, bandwidth=60.0)
    result = ps.simulate(robot, quick, controller=stiff, elastic=elastic, settle=0.15, step=1e-4)
    exact = ps.residual_vibration(quick, 8.0)[0]
    assert result.metrics.residual_vibration[0] == pytest.approx(exact, rel=0.1)
