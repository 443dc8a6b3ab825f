"""One tolerance in every verdict: what is at its limit is kept, in assessments, test suites and sizing alike."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace
from math import inf, nan

import numpy as np
import pytest

import puma_septic as ps
from puma_septic.assessment import limit_checks
from puma_septic.limit_check import AT_LIMIT, LimitCheck, most_used_first
from puma_septic.testing import assert_feasible

HOME = [0.3, -0.5, 0.2, 0.1, 0.4, -0.3]


def sized(demand: float) -> bool:
    check = LimitCheck.of_magnitude(
        joint="joint1",
        quantity="motor torque",
        demand=demand,
        limit=1.0,
        unit="N m",
        time=0.0,
        kind="physics",
        source="test",
    )
    return not check.is_violated


@pytest.mark.parametrize(("share", "is_kept"), [(0.5, True), (1.5, False)])
def test_every_verdict_has_the_same_tolerance(puma: ps.Robot, share: float, is_kept: bool) -> None:
    """Assessment and sizing were strict to 1e-12, profiles reach their limits to 2e-10, optimisers stopped at 1e-6."""
    move = ps.quintic_segments([HOME, [q + 0.5 for q in HOME]], [0.0, 2.0])
    beyond = 1 + share * AT_LIMIT
    highest = ps.assess(puma, move).position.max
    bounds = np.stack([np.full(6, -np.pi), highest - share * AT_LIMIT], axis=1)
    for robot in (
        # 15/8 d/T and 10/sqrt(3) d/T^2: peaks of the rest-to-rest quintic.
        puma.with_limits(velocity=15 / 8 * 0.5 / 2 / beyond),
        puma.with_limits(acceleration=10 / np.sqrt(3) * 0.5 / 4 / beyond),
        puma.with_limits(position=bounds),
    ):
        assessment = ps.assess(robot, move)
        assert assessment.is_feasible == is_kept
        if is_kept:
            assert_feasible(assessment)
        else:
            with pytest.raises(AssertionError, match="6 limits are not kept"):
                assert_feasible(assessment)
    assert sized(beyond) == is_kept


def test_double_s_at_the_limits_of_the_robot_keeps_them(puma: ps.Robot) -> None:
    """Its rounding, up to 2e-10 of a limit, made 57 of 200 such motions 'infeasible': 'jerk 193 is 100 % of 193'."""
    reach, rng = puma.limits.position, np.random.default_rng(0)
    for _ in range(20):
        limits = {
            "velocity": rng.uniform(0.5, 3.0, 6).round(2),
            "acceleration": rng.uniform(1.0, 20.0, 6).round(1),
            "jerk": rng.uniform(10.0, 300.0, 6).round(),
        }
        points = rng.uniform(reach[:, 0], reach[:, 1], (20, 6)).round(2)
        move = ps.profiles.double_s(points, **{f"max_{name}": limit for name, limit in limits.items()})
        demands = {name: move.peak(order) for order, name in enumerate(limits, start=1)}
        checks = limit_checks(puma.with_limits(**limits), move.extrema(0), demands)
        assert [str(check) for check in checks if check.is_violated and check.quantity != "position"] == []


def torque(demand: float = 30.0, limit: float = 40.0, time: float = 0.25) -> LimitCheck:
    return LimitCheck.of_magnitude(
        joint="elbow", quantity="effort", demand=demand, limit=limit, unit="N m", time=time, source="maker"
    )


def position(bounds: tuple[float, float], reach: tuple[float, float] = (-1.0, 2.0)) -> LimitCheck:
    return LimitCheck.of_position(joint="elbow", bounds=bounds, reach=reach, times=(0.25, 0.5), unit="rad")


def height(height: float) -> LimitCheck:
    return LimitCheck.of_height(part="wrist", height=height, floor=0.5, time=0.25)


SENTENCES = {
    "elbow torque 30 N m at t = 0.25 s is 75 % of 40 N m": torque(),
    "elbow torque 30 N m is 75 % of 40 N m": torque(time=nan),  # a mean has no instant
    "elbow torque 30 N m at t = 0.25 s of 'lift' is 75 % of 40 N m (rule of thumb)": replace(
        torque(), case="lift", kind="rule of thumb"
    ),
    "elbow torque unbounded at t = 0.25 s, limit 40 N m": torque(demand=inf),
    "elbow torque unbounded at t = 0.25 s, whatever the limit (physics)": replace(
        torque(demand=inf, limit=nan), kind="physics"
    ),
    "elbow life 2 at t = 0.25 s is 80 % of 2.5": LimitCheck.of_magnitude(
        joint="elbow", quantity="life", demand=2.0, limit=2.5, unit="", time=0.25
    ),
    "elbow position 2 rad at t = 0.5 s is 0.5 rad from its bound 2.5 rad": position((-3.0, 2.5)),
    "elbow position -1 rad at t = 0.25 s is 0.5 rad beyond its bound -0.5 rad": position((-0.5, nan)),
    "wrist height 0.75 m at t = 0.25 s is 0.25 m above the floor at 0.5 m": height(0.75),
    "wrist height 0.25 m at t = 0.25 s is 0.25 m below the floor at 0.5 m": height(0.25),
}


@pytest.mark.parametrize("text", SENTENCES)
def test_each_kind_of_check_has_its_sentence(text: str) -> None:
    assert str(SENTENCES[text]) == text
    assert repr(SENTENCES[text]) == f"<LimitCheck: {text}>"


@pytest.mark.parametrize(
    ("check", "utilisation", "margin"),
    [
        (torque(), 0.75, 0.25),
        (torque(demand=50.0), 1.25, -0.25),
        (torque(limit=0.0), inf, -inf),
        (torque(demand=0.0, limit=0.0), inf, -inf),  # what may do nothing at all is no limit that can be kept
        (torque(demand=inf, limit=nan), inf, -inf),
        (position((-1.5, 4.5)), 2.5 / 3, 0.5),  # middle 1.5, half the range 3
        (position((-4.0, 1.0)), 3.5 / 2.5, -1.0),
        (position((-1.5, 2.5)), 1.5 / 2, 0.5),  # as near to both
        (position((nan, 2.0)), 0.0, 0.0),
        (position((nan, 2.0 - AT_LIMIT / 2)), 0.0, -AT_LIMIT / 2),
        (position((nan, 2.0 - 2 * AT_LIMIT)), inf, -2 * AT_LIMIT),
        (height(0.75), 0.0, 0.25),
        (height(0.5 - AT_LIMIT / 2), 0.0, -AT_LIMIT / 2),
        (height(0.25), inf, -0.25),
    ],
)
def test_utilisation_and_margin(check: LimitCheck, utilisation: float, margin: float) -> None:
    # Positions a nanoradian apart are known to their own rounding, 4e-16.
    assert check.utilisation == pytest.approx(utilisation, rel=1e-15)
    assert check.margin == pytest.approx(margin, rel=1e-6, abs=1e-15)
    assert check.is_violated == (margin < -AT_LIMIT)
    # A margin that is asked for is a share of a magnitude; a distance from a bound or floor it does not concern.
    for asked in (0.0, 0.25, 0.26):
        assert check.keeps(asked) == (not check.is_violated if check.is_range else margin >= asked)


def test_a_check_tells_where_it_comes_from() -> None:
    facts = {
        "joint": "elbow", "quantity": "effort", "demand": 30.0, "limit": 40.0, "unit": "N m", "time": 0.25,
        "utilisation": 0.75, "margin": 0.25, "kind": "joint limit", "source": "maker",
    }  # fmt: skip
    assert torque().to_dict() == facts
    assert replace(torque(), case="lift").to_dict() == {**facts, "case": "lift"}
    assert (height(0.75).source, position((-3.0, 2.5)).source) == ("floor", "")
    with pytest.raises(FrozenInstanceError):
        torque().margin = 1.0  # type: ignore[misc]


def test_of_checks_that_are_used_alike_the_first_one_governs() -> None:
    """Rounding once chose which of two equal joints was told as the worst."""
    first, second, more = torque(30.0), torque(30.0 * (1 + 1e-12)), torque(30.001)
    assert most_used_first([first, second, more]) == (more, first, second)
    assert most_used_first([second, first, torque(inf)])[1:] == (second, first)
