"""Verdicts by bounds: those of single assessments, wherever a limit lies."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.random import Generator

import puma_septic as ps
from puma_septic.batch import _verdicts
from puma_septic.batch._stack import LEAST_DEGREE, Part, refined, stacked


def septics(rng: Generator, count: int, n_joints: int = 6, reach: float = 0.7) -> list[ps.Trajectory]:
    return [ps.septic(points, [0.0, 3.0, 6.0, 9.0]) for points in rng.uniform(-reach, reach, (count, 4, n_joints))]


def test_verdicts_are_those_of_assess_many(puma: ps.Robot, rng: Generator) -> None:
    """Two ways, on motions of which about half are feasible."""
    moves = septics(rng, 300, reach=0.9)
    verdicts, many = ps.judge_many(puma, moves), ps.assess_many(puma, moves)
    assert (verdicts.is_feasible == many.is_feasible).all()
    assert 0.2 < verdicts.is_feasible.mean() < 0.8
    assert (verdicts.certificate == "proved").mean() > 0.9
    assert verdicts.n_searched < 60


def assert_no_wrong_proof(robot: ps.Robot, moves: list[ps.Trajectory], rng: Generator, quantity: str) -> None:
    """Limits a little above or below the peak of one joint: what is proved has the verdict of the peak."""
    many = ps.assess_many(robot, moves)
    for k, move in enumerate(moves):
        near = rng.choice([-1, 1]) * 10.0 ** rng.uniform(-7, -0.5)
        peak = getattr(many, "peak_torque" if quantity == "effort" else f"peak_{quantity}")[k]
        limit = np.full(robot.n_joints, np.nan)
        j = int(rng.integers(robot.n_joints))
        limit[j] = peak[j] * (1 + near)
        unlimited = np.full((robot.n_joints, 2), np.nan)
        others = {name: np.full(robot.n_joints, np.nan) for name in ("velocity", "acceleration", "jerk", "effort")}
        limited = robot.with_limits(position=unlimited, **others | {quantity: limit})
        verdict = ps.judge_many(limited, [move])
        assert verdict.is_feasible[0] == (near > 0), (k, near)
        assert verdict.n_searched or abs(near) > 1e-7


def test_limits_near_the_peak_are_never_proved_wrongly(puma: ps.Robot, rng: Generator) -> None:
    for quantity in ("velocity", "acceleration", "jerk", "effort"):
        assert_no_wrong_proof(puma, septics(rng, 15), rng, quantity)


@pytest.mark.slow
def test_a_thousand_limits_near_the_peak(puma: ps.Robot, rng: Generator) -> None:
    for robot in (puma, ps.load_robot("panda")):
        assert_no_wrong_proof(robot, septics(rng, 500, robot.n_joints), rng, "effort")


def test_bounds_of_the_torque_hold_at_every_degree(puma: ps.Robot, rng: Generator) -> None:
    """What a series leaves out is taken from the fall of its coefficients: held against the peaks of 200 motions."""
    moves = septics(rng, 200, reach=1.2)
    peak = ps.assess_many(puma, moves).peak_torque
    stack, proved = stacked(moves), 0
    for multiple in (1, 2, 4):
        part = Part(multiple, np.arange(len(moves)), 0, np.empty((0, len(moves), 6)))
        values = refined(puma, stack, part)
        assert len(values) == LEAST_DEGREE * multiple + 1
        inner, outer = _verdicts._torque_ranges(puma, stack, values, multiple)
        assert (_verdicts._taken(inner) <= peak * (1 + 1e-12)).all()
        bound = np.abs(outer).max(axis=0)
        assert (bound >= peak * (1 - 1e-12)).all()
        proved = int(np.isfinite(bound).sum())
    assert proved > 0.95 * peak.size


def test_steps_rests_and_doubts(puma: ps.Robot, rng: Generator) -> None:
    """Unbounded jerk breaks a known limit of it and no other; a step of velocity and degrees for radians go alone."""
    points = 0.3 * rng.uniform(-1, 1, (2, 6))
    cubic = ps.profiles.make("cubic", points, [0.0, 3.0])
    calm = puma.with_limits(jerk=np.full(6, np.nan))
    assert ps.judge_many(calm, [cubic]).is_feasible[0] == ps.assess(calm, cubic).is_feasible
    jerky = ps.judge_many(puma.with_limits(jerk=np.full(6, 1e9)), [cubic])
    assert (jerky.is_feasible[0], jerky.certificate[0]) == (False, "proved")
    linear = ps.profiles.make("linear", points, [0.0, 3.0])
    degrees = ps.septic(np.degrees(septics(rng, 1)[0].points), [0, 3, 6, 9.0])
    verdicts = ps.judge_many(puma, [linear, degrees])
    assert verdicts.is_feasible.tolist() == [False, False]
    assert verdicts.certificate.tolist() == ["resolved", "undecided"]
    assert verdicts.n_searched == 2
    resting = points.copy()
    resting[:, 2] = 0.1
    rest = ps.quintic_segments(resting, [0.0, 2.0])
    assert ps.judge_many(puma, [rest]).is_feasible[0] == ps.assess(puma, rest).is_feasible


def test_an_arm_without_known_torque_is_judged_by_its_motion(puma: ps.Robot, rng: Generator) -> None:
    unknown = puma.with_limits(effort=np.full(6, np.nan))
    move = septics(rng, 1, reach=0.3)
    assert ps.judge_many(unknown, move).certificate[0] == "proved"
    assert ps.judge_many(unknown, move).is_feasible[0]


def test_messages(puma: ps.Robot) -> None:
    with pytest.raises(ps.InputError, match="trajectories: at least one is needed"):
        ps.judge_many(puma, [])
