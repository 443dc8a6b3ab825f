"""Via times: known optima, structure against differences, constraints, determinism, fronts, least time, messages."""

from __future__ import annotations

import json

import numpy as np
import pytest
from helpers.moves import POINTS, TIMES
from hypothesis import given, settings
from hypothesis import strategies as st

import puma_septic as ps
from puma_septic import profiles
from puma_septic.limit_check import AT_LIMIT
from puma_septic.objectives import OBJECTIVES, Candidate
from puma_septic.optimisation import ParetoFront
from puma_septic.optimisation._analytic import SQUARES, best_free_values, gradient_by_times
from puma_septic.optimisation._variables import MakeTrajectory, checked_variables
from puma_septic.validation import Array


def value(name: str, trajectory: ps.Trajectory) -> float:
    return OBJECTIVES[name].value(Candidate(trajectory=trajectory))


# Optima of the septic with T = 9 s, found beforehand by a dense search: via times to 1e-3 s, gain in whole per cent.
@pytest.mark.parametrize(
    ("objective", "times", "per_cent"),
    [("integral_of_squared_jerk", [2.667, 6.333], 37), ("peak_jerk", [2.901, 6.099], 61)],
)
def test_the_papers_septic_from_its_own_times(objective: str, times: list[float], per_cent: int) -> None:
    result = ps.optimise_via_times(ps.septic, POINTS, TIMES, objective=objective, restarts=0)
    np.testing.assert_allclose(result.times[1:3], times, rtol=0, atol=1e-3)
    assert round(100 * result.improvement) == per_cent
    assert result.start_value == pytest.approx(value(objective, ps.septic(POINTS, TIMES)), rel=1e-12)
    assert result.value == pytest.approx(value(objective, ps.septic(POINTS, result.times)), rel=1e-12)


@pytest.mark.parametrize("objective", ["integral_of_squared_jerk", "peak_jerk"])
def test_no_neighbour_on_a_dense_grid_is_better(objective: str) -> None:
    best = ps.optimise_via_times(ps.septic, POINTS, TIMES, objective=objective, restarts=0).value
    scan = [
        value(objective, ps.septic(POINTS, [0.0, t1, t2, 9.0]))
        for t1 in np.linspace(0.6, 7.8, 19)
        for t2 in np.linspace(1.0, 8.4, 19)
        if t2 - t1 > 0.3
    ]
    assert best <= min(scan)


def test_every_search_ends_in_the_same_place_here() -> None:
    result = ps.optimise_via_times(ps.septic, POINTS, TIMES, objective="peak_jerk", restarts=3)
    assert len(result.ends) == 4
    np.testing.assert_allclose(result.ends, result.value, rtol=1e-6)
    assert "the best of 4 searches, 4 of which ended here" in result.statement


@pytest.mark.slow
def test_the_same_seed_gives_the_same_result_and_progress_is_told() -> None:
    told: list[tuple[int, int]] = []
    points = [[0.0, 0.0], [1.0, 0.2], [0.5, 0.9], [0.2, 1.0], [1.0, 1.5]]
    results = [
        ps.optimise_via_times(
            profiles.quintic_spline,
            points,
            8.0,
            objective="peak_acceleration",
            restarts=1,
            seed=3,
            progress=lambda done, total: told.append((done, total)),
        )
        for _ in range(2)
    ]
    np.testing.assert_array_equal(results[0].times, results[1].times)
    assert results[0].ends == results[1].ends
    assert told == [(1, 2), (2, 2)] * 2


@pytest.mark.parametrize(
    ("make", "objective"),
    [
        (ps.septic, "integral_of_squared_jerk"),
        (ps.septic, "integral_of_squared_acceleration"),
        (profiles.single_polynomial, "integral_of_squared_jerk"),
        (profiles.quintic_spline, "integral_of_squared_jerk"),
        (profiles.cubic_spline, "integral_of_squared_acceleration"),
    ],
)
def test_gradients_from_the_structure_are_those_of_differences(make: object, objective: str) -> None:
    by_times = gradient_by_times(make, objective)  # type: ignore[arg-type]
    assert by_times is not None
    times = np.array([0.0, 2.2, 5.5, 9.0])
    exact = by_times(make(POINTS, times))  # type: ignore[operator]
    for k in (1, 2):
        ahead, behind = times.copy(), times.copy()
        ahead[k], behind[k] = times[k] + 1e-5, times[k] - 1e-5
        slope = (value(objective, make(POINTS, ahead)) - value(objective, make(POINTS, behind))) / 2e-5  # type: ignore[operator]
        # Central differences of step 1e-5: truncation and rounding are both about 1e-9 of the value.
        assert exact[k - 1] == pytest.approx(slope, rel=1e-6, abs=1e-6)


def test_a_structure_that_is_not_known_gives_no_gradient() -> None:
    assert gradient_by_times(profiles.poly_434, "integral_of_squared_jerk") is None
    assert gradient_by_times(profiles.quintic_spline, "integral_of_squared_acceleration") is None
    assert gradient_by_times(ps.septic, "peak_jerk") is None


@st.composite
def tasks(draw: st.DrawFn) -> tuple[Array, Array]:
    """Five points of two joints, unevenly timed, and a third joint that stays still."""
    rows = draw(st.lists(st.tuples(st.floats(-2, 2), st.floats(-2, 2)), min_size=5, max_size=5))
    durations = draw(st.lists(st.floats(0.4, 3.0), min_size=4, max_size=4))
    points = np.column_stack([np.array(rows), np.full(5, 0.7)])
    return points, np.concatenate([[0.0], np.cumsum(durations)])


@given(tasks())
@settings(max_examples=25)
def test_quintics_with_the_best_via_values_are_the_minimum_jerk_spline(task: tuple[Array, Array]) -> None:
    points, times = task
    best = best_free_values(profiles.quintic, points, times, free=("velocities", "accelerations"), order=3)
    spline = profiles.quintic_spline(points, times)
    # Both systems are well conditioned for segments within a factor of 10.
    np.testing.assert_allclose(best["velocities"][1:-1], spline(times[1:-1], 1), rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(best["accelerations"][1:-1], spline(times[1:-1], 2), rtol=1e-8, atol=1e-8)


@given(tasks())
@settings(max_examples=25)
def test_cubics_with_the_best_via_velocities_are_the_cubic_spline(task: tuple[Array, Array]) -> None:
    points, times = task
    best = best_free_values(profiles.cubic, points, times, free=("velocities",), order=2)
    np.testing.assert_allclose(
        best["velocities"][1:-1], profiles.cubic_spline(points, times)(times[1:-1], 1), rtol=1e-8, atol=1e-9
    )


@given(tasks(), st.floats(-2, 2), st.floats(-2, 2), st.floats(-2, 2))
@settings(max_examples=25)
def test_any_variables_are_valid_times(task: tuple[Array, Array], a: float, b: float, c: float) -> None:
    points, times = task
    variables = checked_variables(profiles.quintic_spline, points, times, ())
    made = variables.times(np.array([a, b, c]))
    assert (np.diff(made) >= 0.99 * variables.least * (times[-1] - times[0])).all()
    assert (made[0], made[-1]) == (times[0], times[-1])
    np.testing.assert_allclose(variables.times(variables.encode(made)), made, rtol=0, atol=1e-9 * times[-1])


def test_free_velocities_reach_what_the_spline_reaches() -> None:
    """Cubics with free via velocities and the cubic spline are the same family for this objective."""
    objective = "integral_of_squared_acceleration"
    free = ps.optimise_via_times(profiles.cubic, POINTS, TIMES, objective=objective, free=["velocities"], restarts=0)
    spline = ps.optimise_via_times(profiles.cubic_spline, POINTS, TIMES, objective=objective, restarts=0)
    assert free.value == pytest.approx(spline.value, rel=1e-8)
    assert free.start_value > spline.start_value
    np.testing.assert_allclose(free.free_values["velocities"][:, 3], 0.0, atol=1e-12)
    assert SQUARES[objective] == 2


@pytest.mark.slow
def test_free_velocities_are_searched_for_where_no_linear_system_gives_them() -> None:
    result = ps.optimise_via_times(
        profiles.quintic,
        POINTS[:, :1],
        TIMES,
        objective="peak_jerk",
        free=["velocities", "accelerations"],
        max_overshoot=0.0,
        restarts=0,
    )
    assert result.trajectory.overshoot[0] <= AT_LIMIT
    assert result.value < 0.3 * result.start_value  # far better than stopping at the vias
    np.testing.assert_allclose(result.trajectory(result.times, 1), result.free_values["velocities"], atol=1e-9)


def test_an_overshoot_bound_is_kept_and_costs_something() -> None:
    free = ps.optimise_via_times(ps.septic, POINTS, TIMES, restarts=0)
    bound = ps.optimise_via_times(ps.septic, POINTS, TIMES, max_overshoot=0.7, restarts=0)
    assert free.trajectory.overshoot.max() > 1.0
    assert bound.trajectory.overshoot.max() == pytest.approx(0.7, abs=2e-6)
    assert bound.value > free.value


def test_limits_are_kept_where_asked(puma: ps.Robot) -> None:
    robot = puma.with_limits(velocity=1.1)
    result = ps.optimise_via_times(
        ps.septic, POINTS, TIMES, objective="integral_of_squared_jerk", robot=robot, keep=["velocity"], restarts=0
    )
    assert (result.trajectory.peak(1)[0] <= 1.1 * (1 + AT_LIMIT)).all()


def test_the_least_excess_is_the_least_overshoot() -> None:
    """Linearised, contradicting bounds once stopped the search at its start, and 0.818 rad was called the least."""
    points = [
        [0.0, 0.1, 0.2, 0.3, 0.4, 0.5],
        [1.0, 0.5, 0.3, 0.2, 0.1, 0.0],
        [0.5, -0.5, 0.3, 0.2, 0.1, 0.0],
        [0.2, 0.5, 0.3, 0.2, 0.1, 1.0],
    ]
    least = ps.optimise_via_times(ps.septic, points, TIMES, objective="overshoot", restarts=0).value
    with pytest.raises(ps.NoSolution, match=r"the least excess is 0\.1116") as caught:
        ps.optimise_via_times(ps.septic, points, TIMES, max_overshoot=0.0, restarts=0)
    # The two searches end at a kink, each to about the root of its tolerance.
    assert caught.value.residual == pytest.approx(least, rel=1e-4)
    kept = ps.optimise_via_times(ps.septic, points, TIMES, max_overshoot=least + 1e-4, restarts=0)
    assert (kept.trajectory.overshoot <= least + 1e-4 + AT_LIMIT).all()


@pytest.mark.slow
def test_constraints_that_cannot_be_kept_say_by_how_much(puma: ps.Robot) -> None:
    """Joint 5 is beyond its limit at the first point itself, whatever the via times."""
    with pytest.raises(ps.NoSolution, match="no via times were found that keep the constraints") as caught:
        ps.optimise_via_times(ps.septic, POINTS, TIMES, robot=puma, keep=["position"], restarts=0)
    low = puma.limits.position[4, 0]
    assert caught.value.residual >= low + 1.9895 - 1e-9
    assert caught.value.q.shape == (6,)


def test_torque_objectives_run_on_the_robot(puma: ps.Robot) -> None:
    result = ps.optimise_via_times(
        ps.septic, POINTS, TIMES, objective="peak_torque_utilisation", robot=puma, max_overshoot=1.0, restarts=0
    )
    assert result.value < result.start_value
    assert result.trajectory.overshoot.max() <= 1.0 + AT_LIMIT
    assert (result.trajectory.n_joints, result.objective.unit) == (6, "1")


def test_lspb_takes_part_by_a_function_of_its_own() -> None:
    def make(points: Array, times: Array) -> ps.Trajectory:
        return ps.lspb(points, durations=np.diff(times), blend_time=1.0)

    result = ps.optimise_via_times(make, POINTS, TIMES, objective="peak_acceleration", restarts=1)
    assert result.value < result.start_value
    assert (np.diff(result.times) >= 1.0).all()  # segments shorter than the blend are refused on the way


def test_texts_and_documents() -> None:
    result = ps.optimise_via_times(ps.septic, POINTS, TIMES, restarts=0)
    text = str(result)
    assert "36.6 % lower" in text
    assert max(map(len, text.splitlines())) <= 100
    document = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    assert document["optimum"]["times"] == pytest.approx([0.0, 2.667, 6.333, 9.0], abs=1e-3)


@pytest.fixture(scope="module")
def front() -> ParetoFront:
    return ps.pareto_front(ps.septic, POINTS, TIMES, objectives=("integral_of_squared_jerk", "overshoot"), size=6)


@pytest.mark.slow
def test_a_front_runs_between_the_single_optima(front: ParetoFront) -> None:
    jerk, overshoot = front.values.T
    assert (np.diff(jerk) > 0).all()
    assert (np.diff(overshoot) < 0).all()
    best = ps.optimise_via_times(ps.septic, POINTS, TIMES, restarts=0)
    assert jerk[0] == pytest.approx(best.value, rel=1e-6)
    least = ps.optimise_via_times(ps.septic, POINTS, TIMES, objective="overshoot", restarts=2)
    assert overshoot[-1] == pytest.approx(least.value, rel=1e-4)


def test_a_front_is_not_beaten_by_a_scan(front: ParetoFront) -> None:
    """Within a thousandth: each point of the front is a local optimum of its own weighting."""
    names = [objective.name for objective in front.objectives]
    for t1 in np.linspace(1.0, 5.0, 15):
        for t2 in np.linspace(t1 + 0.5, 8.0, 15):
            move = ps.septic(POINTS, [0.0, t1, t2, 9.0])
            row = np.array([value(name, move) for name in names])
            assert not (row < front.values * (1 - 1e-3)).all(axis=1).any()


def test_a_front_keeps_its_values_and_its_start(front: ParetoFront) -> None:
    for trajectory, row in zip(front.trajectories, front.values, strict=True):
        for objective, number in zip(front.objectives, row, strict=True):
            assert value(objective.name, trajectory) == pytest.approx(number, rel=1e-12)
    assert front.start_values[0] == pytest.approx(9.080, abs=5e-4)  # the integral of jerk^2 of the paper's times
    assert max(map(len, str(front).splitlines())) <= 100
    json.dumps(front.to_dict(), allow_nan=False)


@pytest.mark.slow
def test_three_objectives_and_more_vias() -> None:
    points = [[0.0, 0.0], [1.0, 0.2], [0.5, 0.9], [0.2, 1.0], [1.0, 1.5]]
    front = ps.pareto_front(
        profiles.quintic_spline,
        points,
        8.0,
        objectives=("integral_of_squared_jerk", "peak_velocity", "overshoot"),
        size=4,
    )
    assert front.values.shape[1] == 3
    assert front.times.shape[1] == 5
    for row in front.values:
        others = [other for other in front.values if other is not row]
        assert not any((other <= row).all() and (other < row).any() for other in others)


@pytest.mark.slow
@given(st.floats(0.2, 3.0), st.floats(5.0, 100.0))
@settings(max_examples=10)
def test_least_time_of_one_move_split_in_two(h: float, limit: float) -> None:
    """Through a via on the way, the minimum-jerk move from rest to rest has its peak jerk 60 h/T^3 at the ends."""
    result = ps.least_time(profiles.quintic_spline, [[0.0], [h / 2], [h]], 1.0, max_jerk=limit, restarts=0)
    assert result.is_feasible
    assert result.duration <= (60 * h / limit) ** (1 / 3) * (1 + 1e-9)


def test_least_time_reaches_a_limit_exactly_and_scales_with_them() -> None:
    once = ps.least_time(profiles.quintic_spline, POINTS, TIMES, max_velocity=2.0, max_jerk=5.0, restarts=0)
    assert once.is_feasible
    assert np.nanmax(once.utilisation) == pytest.approx(1.0, abs=1e-11)
    # Twice as quick: velocity twice, jerk eight times.
    twice = ps.least_time(profiles.quintic_spline, POINTS, TIMES, max_velocity=4.0, max_jerk=40.0, restarts=0)
    assert twice.duration == pytest.approx(once.duration / 2, rel=1e-6)
    assert once.duration < once.start.duration


@pytest.mark.slow
def test_least_time_with_free_velocities() -> None:
    free = ps.least_time(
        profiles.quintic, POINTS[:, :1], TIMES, max_acceleration=1.0, free=["velocities", "accelerations"], restarts=0
    )
    stops = ps.least_time(profiles.quintic, POINTS[:, :1], TIMES, max_acceleration=1.0, restarts=0)
    assert free.is_feasible
    assert stops.is_feasible
    assert free.duration < stops.duration


def fixed_blend(points: Array, times: Array) -> ps.Trajectory:
    return ps.lspb(points, durations=np.diff(times), blend_time=0.05)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ps.optimise_via_times(ps.septic, POINTS[:2], [0.0, 9.0]), "no via times: got 2 points"),
        (lambda: ps.optimise_via_times(ps.septic, POINTS, [0.0, 6.0, 2.0, 9.0]), "must increase strictly"),
        (lambda: ps.optimise_via_times(ps.septic, POINTS, -1.0), "a total time must be positive"),
        (lambda: ps.optimise_via_times(ps.septic, POINTS, TIMES, objective="snap"), "unknown objective 'snap'; valid:"),
        (
            lambda: ps.optimise_via_times(profiles.cubic, POINTS, TIMES, objective="peak_jerk"),
            "peak_jerk is unbounded for profile cubic",
        ),
        (lambda: ps.optimise_via_times(ps.septic, POINTS, TIMES, objective="energy"), "need a robot: give robot=..."),
        (
            lambda: ps.optimise_via_times(ps.septic, POINTS, TIMES, free=["velocities"]),
            "septic has no free velocities; it has: none",
        ),
        (lambda: ps.optimise_via_times(ps.septic, POINTS, TIMES, free=["times"]), "unknown free quantity 'times'"),
        (lambda: ps.optimise_via_times(ps.septic, POINTS, TIMES, keep=["velocity"]), "the robot is needed"),
        (
            lambda: ps.optimise_via_times(ps.septic, POINTS, TIMES, robot=ps.load_robot(), keep=["jerk"]),
            "no jerk limit of robot 'puma560' is known",
        ),
        (
            lambda: ps.optimise_via_times(ps.septic, POINTS, TIMES, max_overshoot=-0.1),
            "max_overshoot = -0.1 rad must be at least 0 rad",
        ),
        (
            lambda: ps.optimise_via_times(ps.septic, POINTS, TIMES, restarts=1.5),
            "restarts = 1.5: expected a whole number from 0 to 10000",
        ),
        (lambda: ps.optimise_via_times(ps.septic, POINTS[:, :5], TIMES, robot=ps.load_robot()), "5 joints, but robot"),
        (lambda: ps.pareto_front(ps.septic, POINTS, TIMES, objectives=["overshoot"]), "2 to 3 are needed, got 1"),
        (
            lambda: ps.pareto_front(ps.septic, POINTS, TIMES, objectives=["overshoot", "peak_jerk"], size=2),
            "size = 2: expected a whole number from 3 to 1000",
        ),
        (lambda: ps.least_time(ps.septic, POINTS, TIMES), "without a limit there is no least time"),
        (lambda: ps.least_time(ps.septic, POINTS, TIMES, max_jerk=0.0), r"max_jerk = 0 must be greater than 0"),
        (
            lambda: ps.least_time(profiles.cubic_spline, POINTS, TIMES, max_jerk=5.0, restarts=0),
            "profile cubic_spline has unbounded derivatives that are limited",
        ),
        (
            lambda: ps.least_time(ps.septic, np.zeros((4, 1)), TIMES, max_jerk=5.0),
            "no joint with a limit moves",
        ),
        (
            lambda: ps.least_time(fixed_blend, POINTS, TIMES, max_acceleration=5.0, restarts=0),
            "profile lspb does not scale with its times",
        ),
    ],
)
def test_bad_input(call: object, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        call()  # type: ignore[operator]


def test_a_given_total_time_is_no_objective() -> None:
    with pytest.raises(ps.InputError, match="objective 'duration': the total time stays as given; least_time"):
        ps.optimise_via_times(ps.septic, POINTS, TIMES, objective="duration")


@pytest.mark.parametrize("make", [ps.profiles.double_s, ps.profiles.lspb])
def test_a_profile_that_takes_no_times_or_needs_more_is_refused(make: MakeTrajectory) -> None:
    """It ended in a bare TypeError."""
    with pytest.raises(ps.InputError, match=f"{make.__name__} cannot be made from points and times alone"):
        ps.optimise_via_times(make, [[0.0], [1.0], [2.0]], [0.0, 1.0, 2.0], objective="integral_of_squared_jerk")
