"""Numbers that no arm has: refused with their place, without a warning, and nothing that is not finite comes out."""

from __future__ import annotations

import subprocess
import sys
import textwrap
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.task import make_task
from puma_septic.validation import LARGEST, checked_number, checked_times

PUMA = ps.load_robot()
REST = [0.0, 0.5, -2.5, 0.0, 0.7, 0.0]
MOVE = ps.quintic_segments([REST, [0.1] * 6], [0.0, 1.0])


@pytest.fixture(autouse=True)
def _no_warnings() -> Iterator[None]:
    """NumPy's warnings on stderr were the only sign of tables with nan and inf."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        yield


CALLS: dict[str, Callable[[float], Any]] = {
    "q": lambda x: ps.inverse_dynamics(PUMA, [x] * 6, REST, REST),
    "v": lambda x: ps.inverse_dynamics(PUMA, REST, [x] * 6, REST),
    "a": lambda x: ps.torque_terms(PUMA, REST, REST, [x] * 6),
    "tau": lambda x: ps.forward_dynamics(PUMA, REST, REST, [x] * 6),
    "payload": lambda x: ps.Payload(x),
    "com": lambda x: ps.Payload(1.0, com=[x, 0.0, 0.0]),
    "inertia": lambda x: ps.Payload(1.0, inertia=np.eye(3) * x),
    "wrench": lambda x: ps.Wrench(force=[x, 0.0, 0.0]),
    "gravity": lambda x: ps.load_robot(gravity=[0.0, 0.0, x]),
    "dwell": lambda x: ps.assess(PUMA, MOVE, dwell=x),
    "points": lambda x: ps.quintic_segments([REST, [x] * 6], [0.0, 1.0]),
    "times": lambda x: ps.quintic_segments([REST, [0.1] * 6], [0.0, x]),
    "pose": lambda x: ps.inverse_kinematics(PUMA, np.eye(4) * x),
    "poses": lambda x: ps.inverse_kinematics_batch(PUMA, np.eye(4)[None] * x),
    "max_velocity": lambda x: ps.profiles.double_s(
        [[0.0], [1.0]], max_velocity=x, max_acceleration=1.0, max_jerk=1.0
    ),
    "frequency": lambda x: ps.residual_vibration(MOVE, [x]),
    "masses": lambda x: ps.payload_sweep(ps.compute_motion(PUMA, MOVE), [x]),
    "com of a sweep": lambda x: ps.payload_sweep(ps.compute_motion(PUMA, MOVE), [1.0], com=[x, 0.0, 0.0]),
    "durations": lambda x: ps.duration_sweep(ps.compute_motion(PUMA, MOVE), [x]),
    "motor": lambda x: ps.Motor(peak_torque=x),
    "ratio": lambda x: ps.Gearbox(ratio=x),
    "fit": lambda x: ps.fit_trajectory([0.0, 1.0, 2.0], [[0.0], [x], [0.0]]),
}  # fmt: skip


@pytest.mark.parametrize("value", [1e31, 1e150, 1e300, -1e300, sys.float_info.max])
@pytest.mark.parametrize("name", CALLS)
def test_what_no_quantity_is_is_refused(name: str, value: float) -> None:
    """`inverse_dynamics` with a velocity of 1e300 was nan, a payload's inertia of 1e308 percentages of 300 digits."""
    with pytest.raises(ps.InputError, match=r"beyond 1e\+30|must be|not a rigid|orthonormal|cannot|rotation"):
        CALLS[name](value)


def test_the_bound_is_far_above_any_arm() -> None:
    assert checked_number("mass", LARGEST) == LARGEST
    with pytest.raises(ps.InputError, match=r"^mass = 1.1e\+30 kg is beyond 1e\+30, as no quantity of an arm is$"):
        checked_number("mass", 1.1e30, unit="kg")
    with pytest.raises(ps.InputError, match=r"^limit = 1e-31 N must be at least 1e-30 N$"):
        checked_number("limit", 1e-31, unit="N", above=0.0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda x: ps.residual_vibration(MOVE, [2.0, x]), r"frequency\[1\]"),
        (lambda x: ps.profiles.double_s([[0.0], [1.0]], max_velocity=1, max_acceleration=x, max_jerk=1), "max_acc"),
        (lambda x: ps.within_limits("quintic", [[0.0], [1.0]], max_velocity=x), "max_velocity"),
        (lambda x: ps.lspb([[0.0], [1.0]], durations=[x], blend_time=0.0), r"durations\[0\]"),
        (lambda x: PUMA.with_limits(effort=x), r"effort limit\[0\]"),
        (lambda x: ps.Controller(bandwidth=[1.0, x]), r"bandwidth\[1\]"),
        (lambda x: ps.Gearbox(stiffness=[x]), r"stiffness\[0\]"),
        (lambda x: ps.sizing.Conditions(bus_voltage=[x]), r"bus_voltage\[0\]"),
        (lambda x: ps.sizing.bearing_life(x, equivalent=1.0, mean_speed=1.0), "dynamic_load"),
        (lambda x: ps.paths.circle(np.eye(4), centre=[1, 0, 0], axis=[0, 0, 1], angle=x), "the magnitude of angle"),
    ],
)
def test_what_is_too_small_to_divide_by_is_refused(call: Callable[[float], Any], message: str) -> None:
    """A limit of 1e-320 ended in overflows of NumPy, whose warnings were all that was to be seen."""
    with pytest.raises(ps.InputError, match=rf"^{message}.* = 1e-310 .*must be at least 1e-30"):
        call(1e-310)


def test_no_frequency_no_family_no_limits() -> None:
    with pytest.raises(ps.InputError, match=r"^frequency: at least one natural frequency is needed, in Hz$"):
        ps.residual_vibration(MOVE, [])
    with pytest.raises(ps.InputError, match=r"^unknown family \[\]; valid: "):
        ps.within_limits([], [[0.0], [1.0]], max_velocity=1.0)  # type: ignore[arg-type]
    with pytest.raises(ps.InputError, match=r"^acceleration limit: shape \(0,\) is not \(1,\)$"):
        ps.Limits(position=[[0, 1]], velocity=[1], acceleration=[], jerk=[1], effort=[1])  # type: ignore[arg-type]


def test_what_is_not_known_of_a_bearing_stays_unknown() -> None:
    assert np.isnan(ps.sizing.bearing_life(np.nan, equivalent=1.0, mean_speed=1.0))
    assert ps.sizing.bearing_life(1e4, equivalent=0.0, mean_speed=1.0) == np.inf
    assert np.isnan(ps.sizing.equivalent_load(1.0, 1.0, 1.0, diameter=np.nan))
    with pytest.raises(ps.InputError, match=r"^tilting = -1 N m must be at least 0 N m$"):
        ps.sizing.equivalent_load(1.0, 1.0, -1.0, diameter=0.1)
    with pytest.raises(ps.InputError, match=r"^time_constant = 0 s must be greater than 0 s$"):
        ps.sizing.overload_time(2.0, 0.0)


def test_a_limit_may_be_as_large_as_a_float() -> None:
    """FLT_MAX and DBL_MAX stand for "none" in some robot descriptions."""
    free = PUMA.with_limits(velocity=3.4028235e38, effort=sys.float_info.max)
    assert ps.assess(free, MOVE).is_feasible


def test_times_that_no_clock_tells_apart() -> None:
    with pytest.raises(ps.InputError, match=r"t\[0\] = 0 s and t\[1\] = 1e-200 s are too close to each other"):
        checked_times("t", [0.0, 1e-200, 1.0])


def test_a_log_with_such_stamps_or_values(tmp_path: Path) -> None:
    """1e-150 s apart was a LinAlgError, 1e-300 s a ValueError of SciPy, both with the code of a broken limit."""
    for step in ("1e-300", "1e-160", "1e-13"):
        (tmp_path / "a.csv").write_text(f"t,joint1\n0,0\n{step},1\n1,0\n")
        with pytest.raises(ps.InputError, match=r"row 3, column 't': .* does not come after 0 s"):
            ps.read_log(tmp_path / "a.csv")
    (tmp_path / "a.csv").write_text("t,joint1\n0,0\n1,1e300\n2,0\n")
    with pytest.raises(ps.InputError, match=r"row 3, column 'joint1': '1e300' is not a finite number up to 1e\+30"):
        ps.read_log(tmp_path / "a.csv")


def test_a_joint_of_a_task_that_would_turn_for_ever() -> None:
    """A position of 1e15 rad asked for as many candidates as turns: MemoryError, OverflowError."""
    points = [{"joints": [0.0] * 6}, {"joints": [1e15, 0.0, 0.0, 0.0, 0.0, 0.0]}]
    task = make_task({"name": "a", "points": points, "durations": [1.0], "profiles": ["quintic"]})
    with pytest.raises(ps.InputError, match=r"a joint would turn 1.59e\+14 times from one to the next; at most 1000"):
        ps.resolve_task(task)


@pytest.mark.parametrize(("profile", "most"), [("single_polynomial", 200), ("bezier", 1000)])
def test_points_that_no_polynomial_goes_through(profile: str, most: int) -> None:
    """1,000 points took 75 s to be refused; 3,000 control points were an OverflowError."""
    with pytest.raises(ps.InputError, match=f"{profile} takes at most {most} points, got {most + 1}"):
        ps.profiles.make(profile, np.zeros((most + 1, 1)), np.arange(most + 1.0))


# ---- memory and time at the stated maximum

MEASURED = textwrap.dedent("""\
    import re, sys
    from pathlib import Path
    from puma_septic.cli import main
    code = main(sys.argv[1:])
    print(code, int(re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())[1]) // 1024, file=sys.stderr)
    """)


def memory_of(*arguments: str) -> tuple[int, int]:
    """Exit code and MB of a command; `getrusage` would count what the process that started it once had."""
    if not Path("/proc/self/status").exists():
        pytest.skip("the peak of a process is read from /proc")
    run = subprocess.run([sys.executable, "-c", MEASURED, *arguments], capture_output=True, text=True, check=True)
    code, megabytes = run.stderr.splitlines()[-1].split()
    return int(code), int(megabytes)


def task_of(count: int, profile: str) -> str:
    rng = np.random.default_rng(560)
    points = "".join(
        f"  - {{joints: [{a:.2f}, 0.5, -2.5, 0, {b:.2f}, 0]}}\n" for a, b in rng.uniform(0, 0.5, (count, 2))
    )
    return f"name: a\npoints:\n{points}durations: [{', '.join(['1'] * (count - 1))}]\nprofiles: [{profile}]\n"


@pytest.mark.slow
@pytest.mark.parametrize("profile", ["quintic_segments", "quintic_spline", "bspline", "cubic_spline", "linear"])
def test_a_task_of_a_thousand_points_takes_less_than_500_MB(profile: str, tmp_path: Path) -> None:  # noqa: N802
    """It took 620 to 1,270 MB: dense equations, then all cells of the tool's extrema at once."""
    (tmp_path / "a.yaml").write_text(task_of(1000, profile))
    code, megabytes = memory_of("assess", str(tmp_path / "a.yaml"))
    assert code in (0, 1)
    assert megabytes < 500


@pytest.mark.slow
def test_a_log_of_the_largest_size_takes_less_than_500_MB(tmp_path: Path) -> None:  # noqa: N802
    t = np.arange(200_000) / 1000
    q = 0.3 * np.sin(0.7 * t[:, None] * np.arange(1, 7))
    rows = np.column_stack([t, q])
    header = "t," + ",".join(PUMA.joint_names)
    np.savetxt(tmp_path / "a.csv", rows, fmt="%.6f", delimiter=",", header=header, comments="")
    assert (tmp_path / "a.csv").stat().st_size < 16_000_000
    code, megabytes = memory_of("assess", "--csv", str(tmp_path / "a.csv"))
    assert code in (0, 1, 3)
    assert megabytes < 500
