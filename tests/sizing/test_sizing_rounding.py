"""What rounding must not decide in sizing: temperatures, ratios, returned energy, the wear of a joint that rests."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from helpers.places import SHARE, UR5
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

import puma_septic as ps
from puma_septic.cli import main
from puma_septic.errors import NoSolution, PumaSepticError
from puma_septic.limit_check import LimitCheck, most_used_first
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._gearbox import expected_life
from puma_septic.sizing._joint_selection import select_joint
from puma_septic.sizing._load_cases import JointCase
from puma_septic.sizing._thermal import steady_cycle, thermal_equation
from puma_septic.sizing._winding import regeneration

RESISTANCES, CONSTANTS = np.array([1.5, 3.0]), np.array([20.0, 600.0])


def series(coefficients: np.ndarray, breaks: tuple[float, ...] = (0.0, 1.0, 3.0, 3.5)) -> Piecewise:
    return Piecewise(breaks=np.array(breaks), coefficients=coefficients[:, :, None])


def steady(loss: Piecewise, *, copper: float = 0.0, constants: np.ndarray = CONSTANTS) -> Piecewise:
    return steady_cycle(*thermal_equation(loss, RESISTANCES[: len(constants)], constants, copper=copper))


# ---- winding temperature


@pytest.mark.parametrize("size", [1e-26, 1e-3, 1.0])
def test_a_loss_that_is_noise_is_solved_in_a_few_pieces(size: float) -> None:
    """Where a joint's torque is rounding, its loss is a series of high degree whose terms do not fall.

    Halving went on without end: instants were rounded to the clock, which short pieces far from t = 0 saw as new noise.
    """
    noise = size * np.random.default_rng(1).standard_normal((261, 3))
    loss = series(noise, (100.0, 100.5, 101.0, 101.2))
    rise = steady(loss)
    assert len(rise.breaks) - 1 < 60
    # Without growth of the resistance the mean rise is that of the mean loss.
    expected = loss.integral()(101.2)[0] * RESISTANCES.sum()
    assert rise.integral()(101.2)[0] == pytest.approx(expected, rel=1e-9, abs=0)


@pytest.mark.parametrize("start", [1e3, 1e5, 1.7e9])
def test_temperature_does_not_depend_on_the_clock(start: float) -> None:
    """1.7e9 s is a time stamp of today."""
    loss = np.array([[50.0, 5.0], [20.0, -5.0], [3.0, 1.0]])
    early, late = (steady(series(loss, (t, t + 1.0, t + 4.0)), copper=0.00393) for t in (0.0, start))
    np.testing.assert_allclose(late.extrema().max, early.extrema().max, rtol=1e-12)


@settings(max_examples=25, deadline=None)
@given(
    losses=st.lists(st.one_of(st.just(0.0), st.floats(-30, 2).map(lambda x: 10.0**x)), min_size=2, max_size=2),
    constants=st.tuples(st.floats(0.05, 100.0), st.floats(10.0, 1e5)),
)
def test_a_steady_cycle_of_any_size_against_the_matrix_exponential(losses: list, constants: tuple) -> None:
    """Two steps of constant loss, 1 s and 3 s, from 1e-30 W to 100 W: the fixed point in closed form."""
    rise = steady(series(np.array([losses]), (0.0, 1.0, 4.0)), constants=np.array(constants))
    (r0, r1), (c0, c1) = RESISTANCES, np.array(constants) / RESISTANCES
    matrix = np.array([[-1 / r0 / c0, 1 / r0 / c0], [1 / r0 / c1, -(1 / r0 + 1 / r1) / c1]])
    first, second = expm(matrix), expm(3 * matrix)
    rests = [np.linalg.solve(matrix, [-loss / c0, 0.0]) for loss in losses]
    kept = second @ (np.eye(2) - first) @ rests[0] + (np.eye(2) - second) @ rests[1]
    expected = np.linalg.solve(np.eye(2) - second @ first, kept)
    # The fixed point divides by what a cycle changes, down to 4 s of 1e5 s; expm rounds at 1e-16.
    np.testing.assert_allclose(rise(0.0), expected, rtol=1e-8, atol=1e-13 * max(losses))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("constants", "message"),
    [
        ([1e-9, 600.0], r"cannot be resolved at t = \S+ s: its loss and time constants are out of proportion"),
        ([1e-29], "cannot be resolved at t = 0 s"),
        ([20.0, 1e18], "comes too little nearer to its steady state in one cycle"),
    ],
)
def test_time_constants_that_no_motor_has_end_after_bounded_work(constants: list, message: str) -> None:
    with pytest.raises(PumaSepticError, match=message) as caught:
        steady(series(np.array([[50.0, 5.0, 1.0]])), constants=np.array(constants))
    assert not isinstance(caught.value, NoSolution)


def test_a_winding_far_beyond_its_power_runs_away_without_being_solved() -> None:
    """1e200 W: the growth within one cycle cannot be written as a number, but it is growth."""
    with pytest.raises(NoSolution, match="runs away"):
        steady(series(np.array([[1e200, 3.0, 0.0]])), copper=0.00393)


# ---- one joint beside the others


@cache
def there_and_back(noise: float, joint: int = 3) -> ps.Cycle:
    """A PUMA's palletising move during which one joint stands still but for `noise` rad at its points."""
    robot = ps.load_robot()
    points = np.array(
        [
            [0.0, 0.6, -2.2, 0.0, 0.3, 0.0], [0.4, 1.2, -2.6, 0.0, 0.6, 0.0], [0.4, 1.0, -2.2, 0.0, 0.3, 0.0],
            [0.4, 1.2, -2.6, 0.0, 0.6, 0.0], [1.5, 1.2, -2.6, 0.0, 0.6, 0.0], [1.5, 1.0, -2.2, 0.0, 0.3, 0.0],
        ]
    )  # fmt: skip
    points[:, joint] += noise * np.random.default_rng(0).standard_normal(6)
    times = [0.0, 1.0, 1.8, 2.6, 4.0, 5.0]
    there = ps.compute_motion(robot, ps.profiles.quintic_spline(points, times, joint_names=robot.joint_names))
    return ps.cycle.with_return(there, dwell=0.5, robot_back=robot.with_payload(ps.Payload(mass=0.0)))


@pytest.mark.parametrize("noise", [1e-16, 1e-13, 1e-10])
def test_a_joint_that_rests_but_for_rounding_is_sized_as_one_that_rests(noise: float) -> None:
    """Points from numeric inverse kinematics differ by 1e-10 rad and less where they should be equal.

    The choice once never came back; where it did, friction was charged and ratios up to 2.8e14 were recommended.
    """
    catalogue = ps.built_in_catalogue()
    still, nearly = (
        select_joint(
            [JointCase(name="", share=1.0, load=ps.sizing.joint_load(there_and_back(size), 3))],
            catalogue,
            3,
            rank="mass",
            keep=3,
            places=None,
        )
        for size in (0.0, noise)
    )
    assert nearly.explanation == still.explanation == "140 of 140 pairs are strong enough"
    for one, other in zip(nearly.kept, still.kept, strict=True):
        assert (one.motor, one.gearbox) == (other.motor, other.gearbox)
        assert one.demands.peak_speed.size == one.demands.mean_speed == 0.0
        assert np.isnan(one.demands.average_load_torque)
        assert one.demands.rms_by_cause["friction"] == one.demands.rms_by_cause["rotor"] == 0.0
        assert one.demands.rms_torque == pytest.approx(other.demands.rms_torque, rel=1e-9)
        assert one.demands.peak_temperature_rise.size == pytest.approx(
            other.demands.peak_temperature_rise.size, rel=1e-9
        )


def test_rounding_beside_the_arm_s_largest_is_zero() -> None:
    """A torque is resolved to 1e-11 of the arm's largest; what is smaller is not shown as a number."""
    cycle = there_and_back(1e-13)
    load = ps.sizing.joint_load(cycle, 3)
    assert not load.moves
    assert load.velocity.extrema().peak[0] == load.acceleration.extrema().peak[0] == 0.0
    assert np.abs(cycle.trajectory.extrema(1).max[3]) > 0
    text = str(ps.size(cycle))
    assert "e-1" not in text
    moving = ps.sizing.joint_load(cycle, 4)
    assert moving.moves
    np.testing.assert_allclose(moving.velocity.extrema().peak[0], cycle.trajectory.derivative(1).extrema().peak[4])


def test_a_ratio_without_bound_is_told_so() -> None:
    """What turns nothing may have any ratio above what its torque needs: no upper end of 280229959297776."""
    selection = ps.size(there_and_back(1e-13), catalogue=ps.built_in_catalogue(), keep=1)
    rows = {line.split()[0]: line.split() for line in str(selection).splitlines() if "INVENTED" in line}
    assert rows["joint4"][-3:-1] == ["any", "above"]
    assert rows["joint2"][-2] == "to"


def test_of_two_limits_that_are_used_alike_the_first_is_named() -> None:
    """A peak torque and a curve that begins at it are used alike but for the last digit, which once chose the words."""

    def used(quantity: str, demand: float) -> LimitCheck:
        return LimitCheck.of_magnitude(
            joint="elbow", quantity=quantity, demand=demand, limit=3.0, unit="N m", time=0.0, kind="physics"
        )

    one, other = used("motor torque", 1.0), used("motor torque at speed", 1.0 + 1e-15)
    assert other.utilisation > one.utilisation
    assert [c.quantity for c in most_used_first([one, other])] == ["motor torque", "motor torque at speed"]
    assert most_used_first([one, used("motor torque at speed", 1.1)])[0].demand == 1.1
    assert most_used_first([one, used("motor torque at speed", np.inf)])[0].utilisation == np.inf


NUMBERS = ("rms_torque", "mean_speed", "rms_current", "average_load_torque", "expected_life_hours")
PEAKS = ("peak_load_torque", "peak_torque", "peak_speed", "peak_power", "peak_drawn_power", "peak_temperature_rise")


@pytest.mark.slow
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), resting=st.sets(st.integers(0, 5), max_size=3))
def test_an_input_changed_by_1e_12_changes_no_demand_by_more(seed: int, resting: set) -> None:
    """Joints that rest or move, points a few 1e-12 rad apart: no friction turns up, no limit's use jumps.

    The slope of a demand by a point is of its own order for moves of a second and a radian, for a gearbox's life, which
    falls with a cube, a few times that: of 458 seeded moves the largest relative change was 1.7e-9.
    """
    rng = np.random.default_rng(seed)
    robot, catalogue = ps.load_robot(), ps.built_in_catalogue()
    points = np.array([0.0, 0.6, -2.2, 0.0, 0.5, 0.0]) + 0.5 * rng.standard_normal((5, 6))
    points[:, list(resting)] = points[0, list(resting)]
    train = catalogue.drivetrain(int(rng.integers(catalogue.n_pairs)), 0)
    found = []
    for noise in (0.0, 1e-12):
        changed = points + noise * rng.standard_normal(points.shape)
        there = ps.compute_motion(robot, ps.profiles.quintic_spline(changed, [0.0, 1.0, 2.2, 3.0, 4.1]))
        sizing = ps.size(ps.cycle.with_return(there, dwell=0.5), drivetrains=[train] * 6)
        found.append(
            [[getattr(d, name) for name in NUMBERS] + [getattr(d, name).size for name in PEAKS] for d in sizing.demands]
        )
    largest = np.nanmax(np.where(np.isinf(found[0]), 0.0, found[0]), axis=0)
    for j in range(6):
        np.testing.assert_array_equal(np.isnan(found[1][j]), np.isnan(found[0][j]))
        for value, before, scale in zip(found[1][j], found[0][j], largest, strict=True):
            assert value == before or abs(value - before) <= 1e-8 * max(before, 1e-6 * scale) or np.isnan(value)


# ---- one thermal model that cannot be solved


def hopeless() -> ps.Motor:
    return ps.Motor(
        name="hopeless", torque_constant=0.1, resistance=1.0, max_winding_celsius=120.0, rotor_inertia=1e-5,
        thermal_resistances=[1.5], thermal_time_constants=[1e-29],
    )  # fmt: skip


def test_one_joint_s_thermal_model_does_not_end_the_others_answer() -> None:
    cycle = there_and_back(0.0)
    trains = list(ps.load_drivetrains(cycle.robot))
    good = replace(hopeless(), thermal_time_constants=[30.0])
    trains = [replace(train, motor=replace(train.motor, **_electric(good))) for train in trains]
    trains[2] = replace(trains[2], motor=replace(trains[2].motor, **_electric(hopeless())))
    sizing = ps.size(cycle, drivetrains=trains)
    (line,) = [line for line in sizing.not_assessed if line.startswith("winding temperature rise")]
    assert "cannot be resolved at t = " in line
    assert line.endswith("(joint3)")
    assert [c.joint for c in sizing.checks if c.quantity == "winding temperature rise"] == [
        name for name in cycle.joint_names if name != "joint3"
    ]
    assert "cannot be resolved" in str(sizing)


def _electric(motor: ps.Motor) -> dict[str, object]:
    names = (
        "torque_constant", "resistance", "max_winding_celsius", "thermal_resistances", "thermal_time_constants",
    )  # fmt: skip
    return {name: getattr(motor, name) for name in names}


def test_a_pair_whose_heat_cannot_be_told_is_not_chosen_for_it() -> None:
    """Its bounds leave the winding open, and the winding cannot be solved: unknown never wins."""
    load = ps.sizing.joint_load(there_and_back(0.0), 1)
    good = replace(hopeless(), name="good", thermal_time_constants=[1e5], max_winding_celsius=1000.0)
    catalogue = ps.Catalogue(
        motors=[
            replace(motor, rotor_inertia=1e-4, max_speed=1e4, peak_torque=1e4, continuous_torque=1e3)
            for motor in (hopeless(), good)
        ],
        gearboxes=[
            ps.Gearbox(
                name="G", ratio=100.0, efficiency=0.8, inertia=1e-5, max_average_torque=1e4, max_repeated_torque=1e4
            )
        ],
    )
    found = select_joint([JointCase(name="", share=1.0, load=load)], catalogue, 0, rank="mass", keep=None, places=None)
    assert found.is_feasible.tolist() == [False, True]
    assert found.reasons[0] == "winding temperature rise (cannot be assessed)"
    assert [c.motor for c in found.kept] == ["good"]


# ---- other ratios of what may be rounding


def test_a_cycle_that_gives_back_what_it_takes_does_not_fill_the_bus_for_ever() -> None:
    """Without losses energy comes back to the last digit; whichever way that digit fell, "unbounded" was decided."""
    for rounding in (-1e-14, 0.0, 1e-14):
        found = regeneration(np.array([30.0, -30.0 - rounding]), storable=40.0, periodic=True)
        assert found.stored == pytest.approx(30.0, rel=1e-12)
        assert found.braked == 0.0
    assert regeneration(np.array([30.0, -30.1]), storable=40.0, periodic=True).stored == np.inf


def test_life_under_a_torque_whose_cube_is_no_number() -> None:
    life = expected_life(7000.0, rated_torque=1e150, rated_speed=200.0, average_torque=5e149, average_speed=400.0)
    assert life == pytest.approx(7000 * 0.5 * 8)
    assert expected_life(7e3, rated_torque=1e-9, rated_speed=1.0, average_torque=1e150, average_speed=1.0) == 0.0


# ---- a first user's job

PALLET = """name: palletising
robot: {{source: {urdf}, tool: tool0, package_dirs: [{share}]}}
points:
  - {{name: home,        position: [0.35, 0.0, 0.45],  rpy_deg: [180, 0, 0]}}
  - {{name: above pick,  position: [0.45, -0.35, 0.35], rpy_deg: [180, 0, 0]}}
  - {{name: pick,        position: [0.45, -0.35, 0.10], rpy_deg: [180, 0, 0]}}
  - {{name: lift,        position: [0.45, -0.35, 0.35], rpy_deg: [180, 0, 0]}}
  - {{name: above place, position: [0.45, 0.35, 0.35], rpy_deg: [180, 0, 0]}}
  - {{name: place,       position: [0.45, 0.35, 0.05], rpy_deg: [180, 0, 0]}}
times: [0, 1, 1.8, 2.6, 4, 5]
profiles: [quintic_spline]
payload: {{mass: 3.0, com: [0, 0, 0.08]}}
"""
# Values of the kind that data sheets of frameless motors and strain-wave gears have; nobody sells these.
MOTORS = """key,max_cont_torque[N m],max_int_torque[N m],max_int_speed[rpm],inertia[kg cm^2],mass[kg],k_t[N m/A],\
R[ohm],V[V],T_max[degC],Rth1[K/W],tau_w[s]
F38,0.18,0.55,6000,0.025,0.14,0.05,0.9,48,120,3.2,20
F60,0.85,2.6,5000,0.16,0.42,0.11,0.45,48,120,1.6,30
"""
GEARS = """key,ratio,T_A[N m],T_R[N m],mass[kg],inertia[kg cm^2],efficiency[%],n_in_max[rpm],n_in_av[rpm],T_M[N m]
H14-100,100,11,28,0.4,0.03,75,8500,3500,54
H25-160,160,108,176,1.3,0.41,74,5600,3500,314
"""


def test_a_first_user_s_arm_and_parts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A UR5 whose wrist stands still to 1e-12 rad: a ZeroDivisionError and exit code 1, or no answer at all, once."""
    task, motors, gears = (tmp_path / name for name in ("pallet.yaml", "motors.csv", "gears.csv"))
    task.write_text(PALLET.format(urdf=UR5, share=SHARE), encoding="utf-8")
    motors.write_text(MOTORS, encoding="utf-8")
    gears.write_text(GEARS, encoding="utf-8")
    code = main(["size", str(task), "--catalogue", str(motors), str(gears), "--dwell", "0.5", "--keep", "1", "-vv"])
    out = capsys.readouterr().out
    assert code == 0
    lines = [line.rstrip() for line in out.splitlines() if "H14-100" in line or "H25-160" in line]
    rows = {line.split()[0]: line.split() for line in reversed(lines)}  # the first table is that of the choice
    assert rows["shoulder_lift_joint"][1:3] == ["F60", "H25-160"]
    assert rows["wrist_2_joint"][1:3] == ["F38", "H14-100"]
    # In a part of the table of its own, where the terminal is narrow.
    assert any(line.startswith("wrist_2_joint") and line.rstrip().endswith("any above 1") for line in out.splitlines())
    assert "e-1" not in out


def test_a_first_user_s_branch_is_below_the_base_and_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The automatic branch puts the elbow 13 cm below the base: no word of it, and 2.242e-12 rad/s in the table."""
    task = tmp_path / "pallet.yaml"
    task.write_text(PALLET.format(urdf=UR5, share=SHARE), encoding="utf-8")
    assert main(["assess", str(task), "-v"]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "Lowest point: elbow_joint, 0.131 m below the base at 5.000 s" in out
    assert "e-1" not in out
