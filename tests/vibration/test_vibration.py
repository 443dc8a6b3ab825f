"""Residual vibration: closed forms, an oscillator integrated in time, shapers, nulls, natural frequencies."""

from __future__ import annotations

import numpy as np
import pytest
from helpers.moves import POINTS, TIMES
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import puma_septic as ps
from puma_septic.piecewise import Piecewise
from puma_septic.vibration import (
    Shaper,
    input_shaper,
    natural_frequencies,
    nulling_durations,
    residual_vibration,
    shaped,
    stiffness_for,
)

Array = np.ndarray


def bang_bang(duration: float) -> ps.Trajectory:
    """1 rad by constant acceleration and as much deceleration."""
    a = 4 / duration**2
    h = duration / 2
    position = Piecewise.from_power(
        [0.0, h, duration], [[[0.0], [0.5]], [[0.0], [a * h * h]], [[a * h * h / 2], [-a * h * h / 2]]]
    )
    return ps.Trajectory(position=position, points=[[0.0], [1.0]], times=[0.0, duration])


def constant_acceleration(duration: float, acceleration: float) -> ps.Trajectory:
    """From rest on, an excerpt that ends moving."""
    position = Piecewise.from_power(
        [0.0, duration], np.array([0.0, 0.0, acceleration * duration**2 / 2])[:, None, None]
    )
    end = acceleration * duration**2 / 2
    return ps.Trajectory(position=position, points=[[0.0], [end]], times=[0.0, duration], rest_after=False)


def integrated(move: ps.Trajectory, frequency: float, damping: float) -> Array:
    """The amplitude of each joint's oscillator at the end, by an adaptive Runge-Kutta method between the breaks."""
    omega, n = 2 * np.pi * frequency, move.n_joints
    state = np.zeros(2 * n)
    for left, right in zip(move.breaks[:-1], move.breaks[1:], strict=True):

        def slope(t: float, y: Array, last: float = right) -> Array:
            a = move(min(t, np.nextafter(last, 0.0)), 2)
            return np.concatenate([y[n:], -a - 2 * damping * omega * y[n:] - omega**2 * y[:n]])

        state = solve_ivp(slope, (left, right), state, method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
    x, v = state[:n], state[n:]
    damped = omega * np.sqrt(1 - damping**2)
    return np.hypot(x, (v + damping * omega * x) / damped)


@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_the_spectrum_is_that_of_an_integrated_oscillator(damping: float) -> None:
    move = ps.septic(POINTS, TIMES)
    for frequency in (0.13, 0.9):
        exact = residual_vibration(move, frequency, damping=damping)
        assert exact == pytest.approx(integrated(move, frequency, damping), abs=1e-6 * exact.max())


def test_an_oscillator_after_blends_whose_acceleration_steps() -> None:
    move = ps.profiles.make("trapezoidal", [[0.0], [1.0]], [0.0, 1.0], options={"blend_time": 0.3})
    assert len(move.jumps(2).times) == 4
    for frequency in (0.7, 2.3):
        exact = residual_vibration(move, frequency)
        assert exact == pytest.approx(integrated(move, frequency, 0.0), rel=1e-6)


def test_constant_acceleration() -> None:
    """``A T |sin(w T / 2)| / (w T / 2) / w``, zero where the duration is a whole number of periods."""
    duration, acceleration = 0.4, 3.0
    frequency = np.array([1e-6, 0.3, 1.0, 2.5, 5.0, 333.3])
    omega = 2 * np.pi * frequency
    known = acceleration * duration * np.abs(np.sinc(frequency * duration)) / omega
    found = residual_vibration(constant_acceleration(duration, acceleration), frequency)[:, 0]
    assert found == pytest.approx(known, rel=1e-12, abs=1e-15)
    assert found[3] < 1e-15 * acceleration  # one period, T = 1 / f
    assert found[4] < 1e-15 * acceleration


def test_bang_bang() -> None:
    """``4 A sin^2(w T / 4) / w^2``, zero where each half is a whole number of periods (of 1 rad: A = 4 / T^2)."""
    duration = 0.5
    frequency = np.array([0.01, 0.7, 3.1, 4.0, 8.0])
    omega = 2 * np.pi * frequency
    known = 16 / duration**2 * np.sin(omega * duration / 4) ** 2 / omega**2
    found = residual_vibration(bang_bang(duration), frequency)[:, 0]
    assert found == pytest.approx(known, rel=1e-11, abs=1e-14)
    assert found[3:].max() < 1e-14


def test_cycloidal() -> None:
    """Of 1 rad in T, with p = 2 pi / T: a = (p / T) sin(p t) leaves ``2 p^2 |sin(w T / 2)| / (T w |w^2 - p^2|)``."""
    duration = 0.8
    move = ps.profiles.cycloidal([[0.0], [1.0]], [0.0, duration])
    frequency = np.array([0.05, 0.4, 1.1, 1.9, 7.3, 40.0])
    omega, own = 2 * np.pi * frequency, 2 * np.pi / duration
    known = 8 * np.pi**2 / duration**3 * np.abs(np.sin(omega * duration / 2)) / (omega * np.abs(omega**2 - own**2))
    assert residual_vibration(move, frequency)[:, 0] == pytest.approx(known, rel=1e-8, abs=1e-14)


def test_a_step_of_the_velocity_is_an_impulse() -> None:
    """Constant speed of 1 rad in 1 s: two impulses, ``2 |sin(w T / 2)| / w``."""
    move = ps.profiles.make("linear", [[0.0], [1.0]], [0.0, 1.0])
    frequency = np.array([0.2, 0.5, 1.0, 3.25])
    known = 2 * np.abs(np.sin(np.pi * frequency)) / (2 * np.pi * frequency)
    assert residual_vibration(move, frequency)[:, 0] == pytest.approx(known, rel=1e-12, abs=1e-15)


@given(
    frequency=st.floats(0.05, 50.0),
    damping=st.floats(0.0, 0.9),
    factor=st.floats(0.1, 10.0),
    start=st.floats(-5.0, 5.0),
)
def test_a_slower_motion_and_a_slower_oscillator(frequency: float, damping: float, factor: float, start: float) -> None:
    """Stretching time by k and the period by k leaves the deflection as it is; when it happens does not matter."""
    move = ps.quintic_segments([[0.0, 1.0], [1.0, -1.0], [0.5, 0.0]], [0.0, 0.3, 0.8])
    later = ps.quintic_segments(move.points, start + factor * move.times)
    one = residual_vibration(move, frequency, damping=damping)
    other = residual_vibration(later, frequency / factor, damping=damping)
    reach = 10 / min(1.0, frequency) / frequency
    assert other == pytest.approx(one, rel=1e-9, abs=1e-12 * reach)


def test_splitting_an_interval_changes_nothing() -> None:
    """Small and large products of frequency and interval meet.

    A rounding of 3 rad in the coefficient of degree 7, differentiated twice on an interval of 0.175 s, is up to
    3 eps 784 (2 / 0.175)^2 = 7e-11 rad/s^2; 51 intervals, of any sign, add up to 9e-11 rad/s. A joint that is still has
    it, too.
    """
    move = ps.septic(POINTS, TIMES)
    split = ps.Trajectory(
        position=move.position.split(np.linspace(0.15, 8.9, 50)),
        points=move.points,
        times=move.times,
    )
    frequency = np.array([1e-3, 0.5, 20.0, 1000.0])
    one, other = residual_vibration(move, frequency), residual_vibration(split, frequency)
    omega = 2 * np.pi * frequency[:, None]
    assert (np.abs(one - other) <= 1e-10 / omega).all()


@pytest.mark.parametrize("damping", [0.0, 0.03])
@pytest.mark.parametrize("name", ["zv", "zvd", "zvdd"])
def test_shaped_motions_leave_nothing_at_their_mode(name: str, damping: float) -> None:
    move = ps.lspb([[0.0], [1.0]], durations=[0.5], blend_time=0.1)
    gentle = shaped(move, input_shaper(name, 5.0, damping=damping))
    left = residual_vibration(move, 5.0, damping=damping)[0]
    assert left > 1e-3
    assert residual_vibration(gentle, 5.0, damping=damping)[0] < 1e-13
    beside = {key: residual_vibration(shaped(move, input_shaper(key, 5.0)), 5.5)[0] for key in ("zv", "zvd", "zvdd")}
    assert beside["zv"] > 3 * beside["zvd"] > 9 * beside["zvdd"]


def test_a_shaped_motion_is_the_sum_of_its_copies_and_is_assessed_like_any_other(puma: ps.Robot) -> None:
    move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [1.0, 2.0])
    zvd = input_shaper("zvd", 4.0, damping=0.1)
    gentle = shaped(move, zvd)
    t = np.linspace(gentle.breaks[0], gentle.breaks[-1], 101)
    copies = [move(np.clip(t - delay, 1.0, 2.0)) for delay in zvd.delays]
    assert gentle(t) == pytest.approx(np.tensordot(zvd.weights, copies, 1), abs=1e-14)
    assert gentle.breaks[0] == 1.0
    assert gentle.profile == "quintic_segments, zvd 4 Hz"
    slower = ps.assess(puma, gentle).peak_torque
    assert (slower <= ps.assess(puma, move).peak_torque + 1e-9).all()


def test_nulls_of_symmetrical_motions() -> None:
    """Bang-bang at T = 2 k / f, double zeros; a cycloidal move at T = k / f from two on; a blend at its own period."""
    assert nulling_durations(bang_bang(1.0), 4.0, longest=1.6)[0] == pytest.approx([0.5, 1.0, 1.5], rel=1e-6)
    cycloidal = ps.profiles.cycloidal([[0.0, 0.0], [1.0, 0.0]], [0.0, 3.0])
    moving, still = nulling_durations(cycloidal, 4.0, longest=1.3)
    assert moving == pytest.approx([0.5, 0.75, 1.0, 1.25], rel=1e-9)
    assert len(still) == 0


def test_nulls_are_where_the_stretched_motion_leaves_nothing() -> None:
    move = ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0])
    durations = nulling_durations(move, 3.0, longest=2.0)[0]
    assert len(durations) >= 4
    for duration in durations:
        same = ps.quintic_segments([[0.0], [1.0]], [0.0, duration])
        beside = ps.quintic_segments([[0.0], [1.0]], [0.0, duration * 1.05])
        assert residual_vibration(same, 3.0)[0] < 1e-9 * residual_vibration(beside, 3.0)[0]


def test_an_asymmetrical_motion_has_minima_and_no_null() -> None:
    move = ps.septic(POINTS, TIMES)
    assert all(len(durations) == 0 for durations in nulling_durations(move, 0.5, longest=9.0))


def test_natural_frequencies_of_a_pendulum_and_of_a_posture(puma: ps.Robot) -> None:
    """K from a frequency gives it back for each joint alone; coupled joints have one mode below the lowest of them."""
    posture = [0.0, -0.5, 0.3, 0.0, 0.4, 0.0]
    stiffness = stiffness_for(puma, posture, 12.0)
    modes = natural_frequencies(puma, posture, stiffness)
    assert (np.diff(modes) >= 0).all()
    assert modes[0] < 12.0 < modes[-1]
    heavier = puma.with_payload(ps.Payload(mass=2.5))
    assert natural_frequencies(heavier, posture, stiffness)[0] < modes[0]
    along = natural_frequencies(puma, np.tile(posture, (3, 1)), stiffness)
    assert along == pytest.approx(np.tile(modes, (3, 1)))


def test_bad_input(puma: ps.Robot) -> None:
    move = ps.quintic_segments([[0.0], [1.0]], [0.0, 1.0])
    for wrong, message in (
        (lambda: residual_vibration(move, 0.0), r"frequency = 0 Hz must be greater than 0 Hz"),
        (lambda: residual_vibration(move, [1.0, -2.0]), r"frequency\[1\] = -2 Hz must be greater than 0 Hz"),
        (lambda: residual_vibration(move, 1.0, damping=1.0), r"damping = 1: .* below 1 is needed"),
        (lambda: residual_vibration(move, 1.0, damping=-0.1), r"damping = -0.1 must be at least 0"),
        (lambda: input_shaper("zvx", 1.0), r"unknown shaper 'zvx'; valid: 'zv', 'zvd', 'zvdd'"),
        (lambda: Shaper(weights=[0.5, 0.6], delays=[0.0, 0.1]), r"weights = \[0.5, 0.6\]: their sum must be 1"),
        (lambda: Shaper(weights=[0.5, 0.5], delays=[0.1, 0.2]), r"delays = \[0.1, 0.2\] s: the first must be 0"),
        (lambda: shaped(move.excerpt, input_shaper("zv", 1.0)), r"from rest to rest; this one is an excerpt"),
        (lambda: nulling_durations(move, 1e3, longest=100.0), r"longest = 100 s is 100000 periods of 1000 Hz"),
        (
            lambda: natural_frequencies(puma, [0.0] * 6, [-1.0] + [1.0] * 5),
            r"joint 'joint1': stiffness = -1 N m/rad must be greater than 0",
        ),
        (
            lambda: natural_frequencies(puma, [0.0] * 6, [1e-12] + [1e4] * 5),  # were infinite, as of rigid joints
            r"stiffness: 1e-12 and 10000 N m/rad are more than 1e\+08 times apart",
        ),
    ):
        with pytest.raises(ps.InputError, match=message):
            wrong()
