"""Checks at the door: what comes in is a finite float64 array of the right shape, or an InputError that says why."""

from __future__ import annotations

import datetime
from collections import deque
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.validation import (
    checked_array,
    checked_choice,
    checked_each,
    checked_flag,
    checked_number,
    checked_times,
    n_dimensions,
    read_only,
)


def test_an_array_is_copied_to_read_only_float64() -> None:
    given = np.array([[1, 2], [3, 4]])
    array = checked_array("points", given, (None, 2))
    assert array.dtype == np.float64
    given[0, 0] = 9
    assert array[0, 0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        array[0, 0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        read_only([1.0])[0] = 2.0


@pytest.mark.parametrize(
    "value",
    [
        [1, 2],
        (1.0, 2.0),
        np.float32([1, 2]),
        [Fraction(1), 2],
        range(1, 3),
        [np.int8(1), 2],
        [Decimal(1), 2.0],
        [np.array(1), np.float32(2)],
        np.array([1, Fraction(2)], dtype=object),
        deque([1, 2]),
    ],
)
def test_any_kind_of_real_numbers_will_do(value: object) -> None:
    assert checked_array("q", value, (2,)).tolist() == [1.0, 2.0]  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ([1.0, np.nan], r"^q\[1\] = nan rad is not a finite number$"),
        ([1.0, -np.inf], r"^q\[1\] = -inf rad is not a finite number$"),
        ([None, 1.0], r"^q\[0\] = nan rad is not a finite number$"),
        ([1.0], r"^q: shape \(1,\) is not \(2,\)$"),
        ([[1.0, 2.0]], r"^q: shape \(1, 2\) is not \(2,\)$"),
        (3.0, r"^q: shape \(\) is not \(2,\)$"),
        ([[1.0], [1.0, 2.0]], r"^q: expected numbers of shape \(2,\), got \[\[1.0\], \[1.0, 2.0\]\]$"),
        ("12", r"^q: expected numbers of shape \(2,\), got '12'$"),
        # float() reads all of these as numbers, and NumPy with it.
        (["1", "2"], r"^q: expected numbers of shape \(2,\), got \['1', '2'\]$"),
        ([True, False], r"^q: expected numbers .*, got \[True, False\]$"),
        (np.array([1 + 2j, 3]), r"^q: expected numbers"),
        ([1 + 2j, 3], r"^q: expected numbers"),
        ([10**400, 1], r"^q: expected numbers"),
        ({"a": 1}, r"^q: expected numbers of shape \(2,\), got \{'a': 1\}$"),
        (np.array(["2020-01-01", "2020-01-02"], dtype="datetime64[D]"), r"^q: expected numbers"),
    ],
)
def test_what_is_no_array_of_that_shape_is_refused(value: object, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        checked_array("q", value, (2,), unit="rad")  # type: ignore[arg-type]


def test_nan_may_be_allowed_infinity_never() -> None:
    assert np.isnan(checked_array("limits", [np.nan, None], (2,), allow_nan=True)).all()  # type: ignore[list-item]
    with pytest.raises(ps.InputError, match=r"limits\[1\] = inf is not a finite number"):
        checked_array("limits", [np.nan, np.inf], (2,), allow_nan=True)


def test_an_error_is_a_value_error_too() -> None:
    with pytest.raises(ValueError, match="is not a finite number"):
        checked_array("q", np.nan, ())


def test_a_long_value_is_not_printed_in_full() -> None:
    with pytest.raises(ps.InputError, match=r"^q: expected numbers of shape \(n,\), got \['x', .*\.\.\.\]$") as caught:
        checked_array("q", ["x"] * 10_000, (None,))
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize("value", [2, 2.0, np.float64(2), np.array(2), np.int64(2), Fraction(2)])
def test_a_number(value: object) -> None:
    number = checked_number("mass", value, unit="kg", above=0.0)
    assert number == 2.0
    assert type(number) is float


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (True, r"^mass: expected a number in kg, got True$"),
        (np.True_, r"^mass: expected .*, got (np\.)?True"),
        ("2", r"^mass: expected a number in kg, got '2'$"),
        (None, r"^mass: expected a number in kg, got None$"),
        ([2.0], r"^mass: shape \(1,\) is not \(\)$"),
        (np.nan, r"^mass = nan kg is not a finite number$"),
        (np.inf, r"^mass = inf kg is not a finite number$"),
        (0.0, r"^mass = 0 kg must be greater than 0 kg$"),
    ],
)
def test_what_is_no_number_is_refused(value: object, message: str) -> None:
    with pytest.raises(ps.InputError, match=message):
        checked_number("mass", value, unit="kg", above=0.0)


def test_bounds_of_a_number() -> None:
    assert checked_number("margin", 0, at_least=0.0, at_most=1.0) == 0.0
    with pytest.raises(ps.InputError, match=r"^margin = -0\.1 must be at least 0$"):
        checked_number("margin", -0.1, at_least=0.0)
    with pytest.raises(ps.InputError, match=r"^margin = 2 must be at most 1$"):
        checked_number("margin", 2, at_most=1.0)


def test_bounds_of_an_array() -> None:
    """The number that is farthest beyond is named, by its place or by its joint; NaN, where it may be, keeps all."""
    rates = [[3.0, 1e-31], [2.0, 4.0]]
    assert checked_array("rates", [[3.0, 1e-30], [2.0, np.nan]], (2, 2), allow_nan=True, above=0.0)[0, 1] == 1e-30
    assert checked_array("none", np.empty((0, 2)), (None, 2), above=0.0, at_most=1.0).shape == (0, 2)
    for bounds, message in (
        ({"above": 0.0}, r"^rates\[0, 1\] = 1e-31 Hz must be at least 1e-30 Hz; slower$"),
        ({"above": 2.5}, r"^rates\[0, 1\] = 1e-31 Hz must be greater than 2.5 Hz; slower$"),
        ({"at_least": 1.0}, r"^rates\[0, 1\] = 1e-31 Hz must be at least 1 Hz; slower$"),
        (
            {"at_most": 2.5, "labels": ("joint 'a'", "joint 'b'")},
            r"^joint 'b': rates\[1\] = 4 Hz must be at most 2.5 Hz",
        ),
    ):
        with pytest.raises(ps.InputError, match=message):
            checked_array("rates", rates, (2, 2), unit="Hz", remedy="; slower", **bounds)  # type: ignore[arg-type]


def test_one_number_for_all_or_one_for_each() -> None:
    assert checked_each("v", 2, 3).tolist() == [2.0, 2.0, 2.0]
    assert checked_each("v", [1, 2, 3], 3, above=0.0).tolist() == [1.0, 2.0, 3.0]
    with pytest.raises(ps.InputError, match=r"^v: shape \(2,\) is not \(3,\)$"):
        checked_each("v", [1, 2], 3)


@pytest.mark.parametrize("value", ["no", 0, 1, None, np.array([True, False]), [], 1.0], ids=repr)
def test_a_flag_is_true_or_false(value: Any) -> None:
    """`inverse_dynamics(friction="no")` had friction, and an array in its place was NumPy's ValueError."""
    assert checked_flag("x", np.False_) is False
    rest = [0.0] * 6
    for call in (
        lambda: ps.inverse_dynamics(PUMA, rest, rest, rest, friction=value),
        lambda: ps.forward_dynamics(PUMA, rest, rest, rest, friction=value),
        lambda: ps.write_report("report.html", ps.assess(PUMA, ps.quintic_segments(REST, [0.0, 1.0])), overwrite=value),
        lambda: ps.Dwell(1.0, holding_brake=value),
    ):
        with pytest.raises(ps.InputError, match=r"^(friction|overwrite|holding_brake) = .*: expected True or False$"):
            call()


def test_a_list_that_holds_itself() -> None:
    endless: list[Any] = [1.0]
    endless.append(endless)
    assert n_dimensions(endless) == -1
    with pytest.raises(ps.InputError, match=r"^q: expected numbers of shape \(2,\), got \["):
        checked_array("q", endless, (2,))


def test_times() -> None:
    assert checked_times("times", [0, 1, 5]).tolist() == [0.0, 1.0, 5.0]
    with pytest.raises(
        ps.InputError, match=r"^times: must increase strictly, but times\[1\] = 2 s is followed by 2 s$"
    ):
        checked_times("times", [0, 2, 2, 1])
    with pytest.raises(ps.InputError, match=r"times\[2\] = 2 s is followed by 1 s"):
        checked_times("times", [0, 1, 2, 1])
    with pytest.raises(ps.InputError, match=r"^times: shape \(2,\) is not \(3,\)$"):
        checked_times("times", [0, 1], 3)


def test_times_that_print_alike_are_told_apart() -> None:
    with pytest.raises(ps.InputError, match=r"1234567\.2 s is followed by 1234567\.1 s"):
        checked_times("times", [0.0, 1234567.2, 1234567.1])


def test_a_choice_lists_what_is_valid() -> None:
    assert checked_choice("profile", "lspb", ["septic", "lspb"]) == "lspb"
    with pytest.raises(ps.InputError, match=r"^unknown profile 'spline'; valid: 'septic', 'lspb'$"):
        checked_choice("profile", "spline", ["septic", "lspb"])


# ---- what NumPy would take for numbers

NO_NUMBERS = {
    "text": ["0.5", "1"],
    "bytes": [b"1"],
    "complex": [1 + 2j],
    "truth": [True, False],
    "truth among numbers": [True, 0.5],
    "truth in a row": [[0.0, np.True_]],
    "truth in an array among rows": [np.array([True]), [1.0]],
    "text among objects": np.array([0.5, "1"], dtype=object),
    "dates": [np.datetime64("2020-01-01")],
    "spans of time": [datetime.timedelta(1)],
    "nothing": [None],
    "rows of different lengths": [[0.0], [0.0, 1.0]],
    "huge integers": [10**400],
    "a mapping": {"a": 1.0},
    "masked": np.ma.array([0.0, 1.0], mask=[True, False]),
    "a list with a masked one": [np.ma.masked, 1.0],
    "a list of masked rows": [np.ma.array([0.0], mask=[True]), np.ma.array([1.0])],
}
PUMA = ps.load_robot()
REST = [[0.0] * 6, [0.0] * 6]
MOVE = ps.quintic_segments([[0.0], [1.0]], [0.0, 2.0])
TAKES_AN_ARRAY: dict[str, Callable[[Any], Any]] = {
    "trajectory at times": MOVE,
    "function at times": MOVE.position,
    "from_power": lambda x: ps.Piecewise.from_power([0.0, 1.0], x),
    "breaks": lambda x: ps.Piecewise.from_power(x, [[[1.0]]]),
    "points": lambda x: ps.quintic_segments(x, [0.0, 1.0]),
    "times": lambda x: ps.quintic_segments(REST, x),
    "durations": lambda x: ps.lspb(REST, durations=x, blend_time=0.1),
    "start_velocity": lambda x: ps.profiles.cubic_spline(REST, [0.0, 1.0], start_velocity=x),
    "max_velocity": lambda x: ps.profiles.double_s(REST, max_velocity=x, max_acceleration=1.0, max_jerk=1.0),
    "q": lambda x: ps.inverse_dynamics(PUMA, x, REST, REST),
    "v": lambda x: ps.inverse_dynamics(PUMA, REST, x, REST),
    "a": lambda x: ps.torque_terms(PUMA, REST, REST, x),
    "forward_kinematics": lambda x: ps.forward_kinematics(PUMA, x),
    "jacobian": lambda x: ps.jacobian(PUMA, x),
    "pose": lambda x: ps.inverse_kinematics(PUMA, x),
    "limits": lambda x: PUMA.with_limits(velocity=x),
    "com": lambda x: ps.Payload(1.0, com=x),
    "wrench": lambda x: ps.Wrench(force=x),
    "friction": lambda x: ps.Friction(coulomb=x),
    "friction's torque": lambda x: ps.Friction(viscous=1.0, coulomb=[0.0, 0.0]).torque(x, 0.0),
    "gravity": lambda x: ps.load_robot(gravity=x),
    "peak_curve": lambda x: ps.Motor(peak_curve=x),
    "conditions": lambda x: ps.sizing.Conditions(ambient_celsius=x),
    "bandwidth": lambda x: ps.Controller(law="pd", bandwidth=x),
    "sweep": lambda x: ps.duration_sweep(ps.compute_motion(PUMA, ps.quintic_segments(REST, [0.0, 1.0])), x),
}


@pytest.mark.parametrize("kind", NO_NUMBERS)
@pytest.mark.parametrize("name", TAKES_AN_ARRAY)
def test_what_is_no_array_of_numbers_is_refused_everywhere(name: str, kind: str) -> None:
    """Times "0.5" and b"1" were taken, of 1 + 2j the real part, of a masked array what is behind the mask.

    Rows of different lengths, text in limits and huge integers were NumPy's own errors.
    """
    if kind == "nothing" and name in ("conditions", "limits"):
        pytest.skip("None is unknown there")
    read_as_nan = r"= nan.* is (not a finite number|outside)|shape \(1,\) is not \(|is unknown for all joints"
    refused = read_as_nan if kind == "nothing" else r"expected numbers.*, got|are masked"
    with pytest.raises(ps.InputError, match=refused):
        TAKES_AN_ARRAY[name](NO_NUMBERS[kind])


@pytest.mark.parametrize("value", [1 + 2j, "0.5", b"1", True, None, datetime.timedelta(1), np.ma.masked], ids=repr)
def test_a_time_is_a_number(value: Any) -> None:
    with pytest.raises(ps.InputError, match=r"t: (expected numbers|some of its numbers are masked)"):
        MOVE(value)


def test_a_mask_that_hides_nothing_is_no_matter() -> None:
    points = np.ma.array([[0.0], [1.0]], mask=np.zeros((2, 1)))
    assert ps.quintic_segments(points, [0.0, 1.0]).points.tolist() == [[0.0], [1.0]]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (lambda t: np.ones((len(t), 1)) * 1j, "expected numbers, got array"),
        (lambda t: [["1"]] * len(t), "expected numbers, got"),
        (lambda _: [[1.0], [2.0, 3.0]], "expected numbers, got"),
        (lambda _: None, "expected numbers, got None"),
        (lambda _: [[1.0]], r"has shape \(1, 1\) at \d+ times"),
    ],
)  # fmt: skip
def test_a_function_to_be_fitted_returns_numbers(values: Callable[[Any], Any], message: str) -> None:
    with pytest.raises(ps.InputError, match=f"the function to be fitted:? {message}"):
        ps.Piecewise.fit(values, [0.0, 1.0])
