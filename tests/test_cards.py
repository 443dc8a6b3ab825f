"""What public values show of themselves: a line in a terminal, a small card in a notebook, a table in pandas."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cache
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.task import make_task, resolve_cycle

CYCLE = {
    "name": "there and back",
    "points": [
        {"name": "home", "joints": [0.0, 0.5, -2.5, 0.0, 0.7, 0.0]},
        {"name": "side", "joints": [0.3, 0.8, -2.5, 0.0, 0.7, 0.0]},
    ],
    "cycle": [
        {"to": "side", "duration": 1.0, "profile": "quintic"},
        {"dwell": 0.2},
        {"to": "home", "duration": 1.0, "profile": "quintic"},
    ],
}
VIAS = [[0.0] * 6, [0.4] * 6, [0.5] * 6]


@cache
def assessment() -> ps.Assessment:
    return ps.assess(ps.load_robot(), ps.profiles.quintic_spline(VIAS, [0.0, 1.0, 2.0]))


@cache
def cycle() -> ps.Cycle:
    return ps.cycle.with_return(assessment().motion, dwell=0.5)


@cache
def task() -> ps.ResolvedTask:
    return ps.resolve_task(ps.load_task("paper-turned"))


@cache
def whole_cycle() -> Any:
    return resolve_cycle(make_task(CYCLE))


def hop() -> ps.Trajectory:
    return ps.quintic_segments([[0.0] * 6, [0.02] * 6], [0.0, 0.1])


def pose() -> Any:
    return ps.forward_kinematics(ps.load_robot(), [0.3, 0.8, -2.9, 0.0, 0.7, 0.0])


# A maker of each public type; the reprs of errors are those of all exceptions.
VALUES: dict[str, Callable[[], Any]] = {
    "AccelerationLimits": lambda: ps.acceleration_limits(ps.load_robot(), gap=0.5),
    "Actuator": lambda: ps.load_robot().actuators[0],
    "Assessment": assessment,
    "Catalogue": lambda: ps.built_in_catalogue("example"),
    "Comparison": lambda: ps.compare(ps.load_robot(), VIAS, [0.0, 1.0, 2.0], profiles=["quintic", "linear"]),
    "Controller": lambda: ps.Controller(law="pd", rate=500.0),
    "Cycle": cycle,
    "CycleAssessment": lambda: ps.assess_cycle(cycle()),
    "Drive": lambda: ps.Drive(name="amplifier", bus_voltage=48.0),
    "Drivetrain": lambda: ps.own_drivetrains(ps.load_robot())[0],
    "Dwell": lambda: ps.Dwell(0.5),
    "ElasticJoints": lambda: ps.ElasticJoints.of_frequency(ps.load_robot(), [0.0] * 6, 12.0),
    "Execution": lambda: ps.execute(ps.load_robot(), {"quintic": hop()}, settle=0.0),
    "Friction": lambda: ps.Friction(viscous=0.1, coulomb=[0.3, -0.3]),
    "Gearbox": lambda: ps.Gearbox(ratio=100.0),
    "IkSolutions": lambda: ps.inverse_kinematics(ps.load_robot(), pose()),
    "LeastTime": lambda: ps.least_time(
        ps.profiles.cubic_spline, VIAS, [0.0, 1.0, 2.0], robot=ps.load_robot(), restarts=0
    ),
    "Limits": lambda: ps.load_robot().limits,
    "LinearStage": lambda: ps.LinearStage(kind="screw", travel_per_turn=0.01, efficiency=0.9),
    "ManyAssessments": lambda: ps.assess_many(ps.load_robot(), [hop()]),
    "MaximumPayload": lambda: ps.maximum_payload(assessment().motion),
    "MinimumDuration": lambda: ps.minimum_duration(assessment().motion),
    "Motion": lambda: assessment().motion,
    "Motor": lambda: ps.Motor(name="<b>F60</b>", rotor_inertia=1e-4, peak_torque=3.0),
    "OptimisedTimes": lambda: ps.optimise_via_times(
        ps.profiles.quintic_spline, [[0.0], [0.4], [1.0]], [0.0, 1.0, 2.0], restarts=0
    ),
    "ParetoFront": lambda: ps.pareto_front(
        ps.profiles.quintic_spline,
        [[0.0], [0.4], [1.0]],
        [0.0, 1.0, 2.0],
        objectives=["integral_of_squared_jerk", "overshoot"],
        size=3,
    ),
    "PayloadPolygon": lambda: ps.payload_polygon(ps.load_robot(), [[0.0, 0.5, -2.5, 0.0, 0.7, 0.0]]),
    "Payload": lambda: ps.Payload(2.0),
    "Piecewise": lambda: assessment().motion.torque,
    "Replay": lambda: ps.replay(assessment(), open_browser=False),
    "ResolvedCycle": lambda: ps.resolve_cycle(ps.load_task("paper-straight")),
    "ResolvedTask": task,
    "Robot": ps.load_robot,
    "Selection": lambda: ps.size(cycle(), catalogue=ps.built_in_catalogue("example")),
    "Simulation": lambda: ps.simulate(ps.load_robot(), hop(), settle=0.0),
    "Sizing": lambda: ps.size(cycle()),
    "Supply": lambda: ps.Supply(name="48 V", bus_voltage=48.0),
    "Sweep": lambda: ps.duration_sweep(assessment().motion, [2.0, 3.0]),
    "Task": lambda: ps.load_task("paper"),
    "Trajectory": lambda: assessment().motion.trajectory,
    "TrajectoryCheck": lambda: ps.check_trajectory(ps.load_robot(), assessment().motion.trajectory),
    "WorstHolding": lambda: ps.worst_holding_torque(ps.load_robot()),
    "Wrench": lambda: ps.Wrench(force=[0.0, 0.0, 5.0]),
}
SLOW = ("Execution", "Simulation", "Selection", "Sizing", "ParetoFront", "Replay", "AccelerationLimits")
ONE_OF_EACH = [pytest.param(name, marks=[pytest.mark.slow] if name in SLOW else []) for name in VALUES]


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
