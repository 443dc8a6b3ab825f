"""The formulas of sizing one by one: gears, winding temperature, returned energy, ratios, curves."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

import puma_septic as ps
from puma_septic.errors import NoSolution
from puma_septic.piecewise import Piecewise
from puma_septic.sizing._gearbox import expected_life
from puma_septic.sizing._thermal import heating, overload_time, steady_cycle, thermal_equation
from puma_septic.sizing._torque_speed import largest_ratio
from puma_septic.sizing._winding import regeneration

# Closed forms of a few operations: what differs is rounding, some hundred times.
EXACT = 1e-12


def steps(breaks: list[float], values: list[float]) -> Piecewise:
    return Piecewise(breaks=breaks, coefficients=np.array(values)[None, :, None])


# ---- gears


def test_average_torque_of_the_published_example() -> None:
    """FSG-25 in the makers' scheme: 150, 82, 130, 0 N m; 0.2, 3, 0.3, 0.2 s; 10, 20, 10, 0 1/min: 89 N m printed."""
    found = ps.sizing.average_torque([150, 82, 130, 0], [10, 20, 10, 0], [0.2, 3, 0.3, 0.2])
    assert round(found, 2) == 89.39
    # By hand: (150^3 2 + 82^3 60 + 130^3 3) / 65 = 714 281.2; its cube root.
    assert found == pytest.approx(((150**3 * 2 + 82**3 * 60 + 130**3 * 3) / 65) ** (1 / 3), rel=EXACT)


def test_a_rest_and_the_direction_do_not_change_the_average() -> None:
    plain = ps.sizing.average_torque([10, 20], [5, 5], [1, 1])
    assert ps.sizing.average_torque([-10, 20, 99], [5, -5, 0], [1, 1, 7]) == pytest.approx(plain, rel=EXACT)
    assert ps.sizing.average_torque([7, 7], [1, 3], [2, 5]) == pytest.approx(7.0, rel=EXACT)


@pytest.mark.parametrize(
    ("torques", "speeds", "durations", "message"),
    [
        ([1, 2], [1], [1, 1], r"speeds: shape \(1,\) is not \(2,\)"),
        ([1, 2], [1, 1], [1, -1], r"durations\[1\] = -1 s must be at least 0 s"),
        ([1, np.nan], [1, 1], [1, 1], r"torques\[1\] = nan N m is not a finite number"),
        ([1, 2], [0, 0], [1, 1], "nothing turns in this cycle"),
    ],
)
def test_a_table_that_is_no_cycle_is_refused(torques: list, speeds: list, durations: list, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        ps.sizing.average_torque(torques, speeds, durations)


def test_life_falls_with_the_cube_of_torque_and_with_speed() -> None:
    """At twice the rated torque and half the rated speed, 2 / 8 of 7000 h."""
    rated = {"rated_torque": 10.0, "rated_speed": 200.0}
    assert expected_life(7000.0, **rated, average_torque=20.0, average_speed=100.0) == pytest.approx(1750.0, rel=EXACT)
    assert expected_life(7000.0, **rated, average_torque=0.0, average_speed=100.0) == np.inf


def test_momentary_peaks_are_counted_by_turns_of_the_wave_generator() -> None:
    """10^4 / (2 n i t): 30 1/min at the output, ratio 100, 0.2 s are ten turns of the input: 500 times."""
    assert ps.sizing.allowed_momentary_peaks(30 * 100 * np.pi / 30, 0.2) == pytest.approx(500.0, rel=EXACT)
    assert ps.sizing.allowed_momentary_peaks(1e-3, 1e-3) == 1e4


# ---- winding temperature


def test_overload_time_of_a_cold_winding() -> None:
    """0.2877 time constants, ln(4 / 3), at twice the continuous current: where the heating curve crosses the limit."""
    assert overload_time(2.0, 1.0) == pytest.approx(np.log(4 / 3), rel=EXACT)
    assert round(overload_time(2.0, 1.0), 4) == 0.2877
    assert overload_time(1.0, 5.0) == np.inf
    limit, resistance, constant = 80.0, 2.0, 35.0
    loss = steps([0.0, 30.0], [2.0**2 * limit / resistance])
    equation = thermal_equation(loss, np.array([resistance]), np.array([constant]))
    rise = heating(*equation, np.zeros(1))
    crossing = (rise - steps([0.0, 30.0], [limit])).roots()[0]
    assert crossing == pytest.approx([overload_time(2.0, constant)], rel=1e-11)


@pytest.mark.parametrize("constant", [0.05, 3.0, 40.0, 1e6])
def test_peak_of_a_periodic_intermittent_duty(constant: float) -> None:
    """S3: ``P R (1 - exp(-t_on / tau)) / (1 - exp(-T / tau))`` at the end of the load, for any time constant."""
    on, cycle, power, resistance = 2.0, 10.0, 25.0, 1.6
    loss = steps([0.0, on, cycle], [power, 0.0])
    rise = steady_cycle(*thermal_equation(loss, np.array([resistance]), np.array([constant])))
    expected = power * resistance * np.expm1(-on / constant) / np.expm1(-cycle / constant)
    found = rise.extrema()
    assert found.max[0] == pytest.approx(expected, rel=EXACT)
    # A fast winding is at its peak to rounding before the load ends.
    assert found.t_max[0] == on or constant < 1
    assert rise(0.0)[0] == pytest.approx(rise(cycle)[0], rel=EXACT)


def test_continuous_duty_with_a_resistance_that_grows() -> None:
    """S1: ``theta = R_th P / (1 - alpha R_th P)``, P at the ambient as reference."""
    power, resistance, alpha = 20.0, 3.0, 0.0039
    equation = thermal_equation(steps([0.0, 5.0], [power]), np.array([resistance]), np.array([11.0]), copper=alpha)
    expected = resistance * power / (1 - alpha * resistance * power)
    assert steady_cycle(*equation)(2.0)[0] == pytest.approx(expected, rel=EXACT)
    # Reference 20 K below the ambient: the loss at the ambient is 1 + 20 alpha of that at the reference.
    equation = thermal_equation(
        steps([0.0, 5.0], [power]), np.array([resistance]), np.array([11.0]), copper=alpha, excess=20.0
    )
    expected = resistance * power * (1 + 20 * alpha) / (1 - alpha * resistance * power)
    assert steady_cycle(*equation)(2.0)[0] == pytest.approx(expected, rel=EXACT)


def test_a_winding_that_runs_away_has_no_steady_cycle() -> None:
    """``alpha R_th P > 1``: above 1 / 0.0039 / 3 = 85.47 W."""
    resistance, constant = np.array([3.0]), np.array([11.0])
    below = thermal_equation(steps([0.0, 5.0], [85.0]), resistance, constant, copper=0.0039)
    assert steady_cycle(*below)(0.0)[0] > 1e4
    above = thermal_equation(steps([0.0, 5.0], [86.0]), resistance, constant, copper=0.0039)
    with pytest.raises(NoSolution, match="the winding's temperature runs away"):
        steady_cycle(*above)


def test_two_nodes_against_an_ordinary_integrator() -> None:
    """A wavy loss, growing resistance, from cold; LSODA at 1e-11 is the reference, 1e-8 its own error."""
    breaks = np.array([0.0, 2.0, 7.0])
    loss = Piecewise.from_power(breaks, [[[5.0], [90.0]], [[40.0], [0.0]], [[30.0], [-60.0]], [[-50.0], [20.0]]])
    r, tau, alpha, excess = np.array([1.5, 4.0]), np.array([3.0, 60.0]), 0.0039, 20.0
    rise = heating(*thermal_equation(loss, r, tau, copper=alpha, excess=excess), np.zeros(2))
    capacity = tau / r

    def slope(t: float, theta: np.ndarray) -> list[float]:
        heat = loss(min(t, 7.0))[0] * (1 + alpha * (theta[0] + excess))
        outward = (theta[0] - theta[1]) / r[0]
        return [(heat - outward) / capacity[0], (outward - theta[1] / r[1]) / capacity[1]]

    state = np.zeros(2)
    for a, b in ((0.0, 2.0 - 1e-15), (2.0, 7.0)):
        state = solve_ivp(slope, (a, b), state, method="LSODA", rtol=1e-11, atol=1e-11).y[:, -1]
        np.testing.assert_allclose(rise(b), state, rtol=1e-8)


def test_the_steady_cycle_of_two_nodes_is_what_many_cycles_lead_to() -> None:
    loss = steps([0.0, 1.0, 4.0], [120.0, 3.0])
    equation = thermal_equation(loss, np.array([1.0, 2.0]), np.array([0.5, 20.0]), copper=0.0039, excess=15.0)
    state = np.zeros(2)
    for _ in range(200):  # 800 s are forty of the slower time constant; the growing resistance makes it longer
        state = heating(*equation, state)(4.0)
    steady = steady_cycle(*equation)
    np.testing.assert_allclose(steady(0.0), state, rtol=1e-8)
    # Without growth of the resistance the mean rise is that of the mean loss.
    constant = steady_cycle(*thermal_equation(loss, np.array([1.0, 2.0]), np.array([0.5, 20.0])))
    mean = constant.integral()(4.0) / 4.0
    mean_loss = (120.0 + 3 * 3.0) / 4
    np.testing.assert_allclose(mean, [mean_loss * 3.0, mean_loss * 2.0], rtol=EXACT)


# ---- returned energy


@pytest.mark.parametrize(
    ("flows", "storable", "stored", "braked"),
    [
        ([30.0, -20.0], 5.0, 20.0, 15.0),  # one burst: E - storable
        ([30.0, -20.0], 25.0, 20.0, 0.0),
        ([30.0, -10.0, 10.0, -10.0], 8.0, 10.0, 4.0),  # drawn again in between: two bursts of 10, each 2 over
        ([-4.0, 12.0, -6.0], 8.0, 10.0, 2.0),  # the last burst goes on into the next cycle's first: 6 + 4
        ([5.0, -20.0], 8.0, np.inf, 15.0),  # more returned than drawn: what a cycle returns net is braked
        ([30.0], 0.0, 0.0, 0.0),
    ],
)
def test_the_bus_stores_what_fits_and_brakes_the_rest(
    flows: list, storable: float, stored: float, braked: float
) -> None:
    found = regeneration(np.array(flows), storable=storable, periodic=True)
    assert (found.stored, found.braked) == (stored, braked)


def test_a_single_run_begins_with_an_empty_bus() -> None:
    found = regeneration(np.array([-4.0, 9.0, -6.0]), storable=5.0, periodic=False)
    assert (found.stored, found.braked) == (6.0, 1.0)


# ---- ratios


@settings(max_examples=25)
@given(
    a=st.lists(st.floats(-20, 20), min_size=4, max_size=4),
    tau=st.lists(st.floats(-50, 50), min_size=4, max_size=4),
    ratio=st.floats(5, 200),
    efficiency=st.floats(0.3, 1.0),
)
def test_identity_of_the_accelerating_factor(a: list, tau: list, ratio: float, efficiency: float) -> None:
    """``tau_m_rms^2 / J = beta / eta + (tau_rms / (eta N sqrt J) - sqrt J N a_rms)^2``, of four equal parts."""
    inertia = 2e-4
    moments = _moments(np.array(a), np.array(tau))
    motor = inertia * ratio * np.array(a) + np.array(tau) / (ratio * efficiency)
    left = (motor**2).mean() / inertia
    torque, acceleration = np.sqrt(moments.torque_square), np.sqrt(moments.acceleration_square)
    gap = torque / (efficiency * ratio * np.sqrt(inertia)) - np.sqrt(inertia) * ratio * acceleration
    right = moments.load_factor / efficiency + gap**2
    # The right side is a difference of terms as large as their squares' sum.
    scale = 1e-12 * (torque**2 / (efficiency**2 * ratio**2 * inertia) + inertia * ratio**2 * acceleration**2) + 1e-12
    assert abs(left - right) <= scale


def _moments(a: np.ndarray, tau: np.ndarray, peak_speed: float = 2.0) -> ps.sizing.LoadMoments:
    return ps.sizing.LoadMoments(
        torque_square=float((tau**2).mean()),
        acceleration_square=float((a**2).mean()),
        product=float((a * tau).mean()),
        peak_speed=peak_speed,
    )


def test_the_optimal_ratio_is_where_a_search_finds_it() -> None:
    """Two parts by hand: a = 3, -1 rad/s^2 and tau = 12, 4 N m; J = 2e-4 kg m^2, eta = 0.8."""
    a, tau, inertia, efficiency = np.array([3.0, -1.0]), np.array([12.0, 4.0]), 2e-4, 0.8
    moments = _moments(a, tau)
    # tau_rms / a_rms = sqrt(80 / 5) = 4, so sqrt(4 / (0.8 * 2e-4)) = sqrt(25000).
    assert moments.optimal_ratio(inertia, efficiency=efficiency) == pytest.approx(np.sqrt(25000.0), rel=EXACT)

    def rms(ratio: float) -> float:
        return float(np.sqrt(((inertia * ratio * a + tau / (ratio * efficiency)) ** 2).mean()))

    found = minimize_scalar(rms, bounds=(20, 500), method="bounded", options={"xatol": 1e-8})
    assert found.x == pytest.approx(np.sqrt(25000.0), rel=1e-5)  # flat at its least: half the digits


def test_at_the_ends_of_the_window_the_motor_is_just_warm_enough() -> None:
    a, tau, inertia, efficiency = np.array([3.0, -1.0]), np.array([12.0, 4.0]), 2e-4, 0.8
    moments = _moments(a, tau)
    window = ps.sizing.ratio_window(moments, inertia=inertia, continuous_torque=0.14, efficiency=efficiency)
    assert window.least < window.optimal < window.most
    for ratio in (window.least, window.most):
        motor = inertia * ratio * a + tau / (ratio * efficiency)
        assert np.sqrt((motor**2).mean()) == pytest.approx(0.14, rel=EXACT)
    slow = ps.sizing.ratio_window(
        moments, inertia=inertia, continuous_torque=0.14, efficiency=efficiency, max_speed=2.0 * window.optimal
    )
    assert slow.most == pytest.approx(window.optimal, rel=EXACT)
    for impossible in ({"continuous_torque": 0.05}, {"continuous_torque": 0.14, "max_speed": window.least}):
        none = ps.sizing.ratio_window(moments, inertia=inertia, efficiency=efficiency, **impossible)
        assert none.is_empty
        assert np.isnan(none.least)


def test_a_load_without_motion_wants_the_largest_ratio() -> None:
    moments = _moments(np.zeros(2), np.array([8.0, 8.0]), peak_speed=0.0)
    window = ps.sizing.ratio_window(moments, inertia=1e-4, continuous_torque=0.4)
    assert window.least == pytest.approx(20.0, rel=EXACT)
    assert window.most == window.optimal == np.inf


# ---- curves


@settings(max_examples=25)
@given(st.integers(0, 2**32 - 1))
def test_the_largest_ratio_is_that_of_dense_samples_or_above(seed: int) -> None:
    """A random polynomial with a step over a positive one; samples miss by the square of their distance at most."""
    rng = np.random.default_rng(seed)
    breaks = np.array([0.0, 1.0, 2.5])
    f = Piecewise(breaks=breaks, coefficients=rng.normal(size=(6, 2, 1)))
    g = Piecewise(
        breaks=breaks, coefficients=np.concatenate([np.full((1, 2, 1), 3.0), 0.3 * rng.normal(size=(3, 2, 1))])
    )
    if g.extrema().min[0] <= 0.1:
        g = g + Piecewise(breaks=breaks, coefficients=np.full((1, 2, 1), 4.0))
    ratio, size, limit, time = largest_ratio(f, g)
    t = np.concatenate([np.linspace(a, np.nextafter(b, a), 20_001) for a, b in ((0.0, 1.0), (1.0, 2.5))])
    sampled = np.abs(f(t)[:, 0]) / g(t)[:, 0]
    assert sampled.max() * (1 - EXACT) <= ratio <= sampled.max() * (1 + 1e-5)
    assert size / limit == ratio
    beside = np.clip([time - 1e-12, time, time + 1e-12], 0.0, 2.5)
    assert np.abs(np.abs(f(beside)[:, 0]) / g(beside)[:, 0] - ratio).min() <= 1e-9 * ratio


def test_a_limit_that_reaches_zero_is_an_infinite_use() -> None:
    f, g = steps([0.0, 2.0], [1.0]), Piecewise.from_power([0.0, 2.0], [[[1.0]], [[-1.0]]])
    assert largest_ratio(f, g)[0] == np.inf
