"""What an optimiser returns keeps its limits by a full assessment, or names those it does not hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from helpers.urdf_texts import ARM, INERTIAL, load

import puma_septic as ps
from puma_septic import profiles
from puma_septic.optimisation import OptimisedTimes
from puma_septic.validation import Array

HOME = np.array([0.3, -0.5, 0.2, 0.1, 0.4, -0.3])
MAKES = (ps.septic, profiles.quintic_spline, profiles.septic_spline, profiles.quintic)
QUANTITIES = ("position", "velocity", "acceleration", "jerk", "effort")
OBJECTIVES = (
    "integral_of_squared_jerk",
    "integral_of_squared_acceleration",
    "peak_velocity",
    "peak_acceleration",
    "peak_jerk",
    "overshoot",
    "rms_torque",
    "peak_torque_utilisation",
)


@dataclass(frozen=True)
class Case:
    """A task whose limits leave one random timing just feasible, so that they bind at most optima."""

    make: Callable[..., ps.Trajectory]
    points: Array
    times: Array
    objective: str
    quantity: str
    robot: ps.Robot

    def solve(self) -> OptimisedTimes:
        return ps.optimise_via_times(
            self.make,
            self.points,
            self.times,
            objective=self.objective,
            robot=self.robot,
            keep=[self.quantity],
            restarts=0,
        )


def constrained(puma: ps.Robot, seed: int) -> Case:
    rng = np.random.default_rng(seed)
    make = MAKES[rng.integers(len(MAKES))]
    n = 4 if make is ps.septic else int(rng.integers(4, 6))
    points = HOME + rng.uniform(-0.6, 0.6, (n, 6))
    total = rng.uniform(3.0, 8.0)
    known = total * np.concatenate([[0.0], np.cumsum(rng.dirichlet(np.full(n - 1, 8.0)))])
    quantity, objective = QUANTITIES[rng.integers(5)], OBJECTIVES[rng.integers(8)]
    of_known = ps.assess(puma, make(points, known))
    if quantity == "position":
        reach = of_known.position
        robot = puma.with_limits(position=np.stack([reach.min - 1e-4, reach.max + 1e-4], axis=1))
    else:
        peak = getattr(of_known, f"peak_{'torque' if quantity == 'effort' else quantity}")
        robot = puma.with_limits(**{quantity: 1.0001 * peak})
    return Case(make, points, np.linspace(0.0, total, n), objective, quantity, robot)


def is_binding_and_kept(case: Case) -> bool:
    """Whether the limit stops the optimum; asserts that it is kept by an assessment made from outside."""
    result = case.solve()
    assessment = ps.assess(case.robot, case.make(case.points, result.times))
    assert [str(check) for check in assessment.violations if check.quantity == case.quantity] == []
    assert result.verdict.failures == ()
    assert f"limits respected: {case.quantity}" in result.statement
    return bool(np.nanmin(assessment.margins[case.quantity]) < 1e-6)


@pytest.mark.slow
def test_constrained_optima_pass_assess(puma: ps.Robot) -> None:
    """Nine of ten optima with an active limit once exceeded it by up to 1e-6, and `assess` called them infeasible."""
    binding = [is_binding_and_kept(constrained(puma, seed)) for seed in (1, 4, 6, 8, 10, 12, 20, 26, 40, 50)]
    assert all(binding)


@pytest.mark.slow
def test_a_hundred_random_constrained_optima_pass_assess(puma: ps.Robot) -> None:
    binding = [is_binding_and_kept(constrained(puma, seed)) for seed in range(100)]
    assert sum(binding) > 50


# Known points of the paper with the tool turned, all within their limits; times in s.
REFERENCES = {"overshoot": (2.8, 6.2), "peak_jerk": (2.6, 6.4), "peak_velocity": (3.0, 6.0)}


@pytest.mark.parametrize(
    ("objective", "quantity"),
    [("overshoot", "velocity"), ("overshoot", "effort"), ("peak_jerk", "acceleration"), ("peak_velocity", "position")],
)
def test_the_papers_optima_under_active_limits_pass_assess(objective: str, quantity: str) -> None:
    resolved = ps.resolve_task(ps.load_task("paper-turned"))
    known = ps.assess(resolved.robot, ps.septic(resolved.points, [0.0, *REFERENCES[objective], 9.0]))
    if quantity == "position":
        limits = {"position": np.stack([known.position.min - 1e-4, known.position.max + 1e-4], axis=1)}
    else:
        limits = {quantity: 1.0001 * getattr(known, f"peak_{'torque' if quantity == 'effort' else quantity}")}
    robot = resolved.robot.with_limits(**limits)
    case = Case(ps.septic, resolved.points, resolved.times, objective, quantity, robot)
    assert is_binding_and_kept(case)


def test_limits_that_were_not_respected_are_assessed_and_named() -> None:
    """In 3 s the paper's septic exceeds velocity and effort; only what was asked for is kept, the rest is named."""
    resolved = ps.resolve_task(ps.load_task("paper-turned"))
    result = ps.optimise_via_times(
        ps.septic, resolved.points, 3.0, objective="peak_velocity", robot=resolved.robot, restarts=0
    )
    violated = ps.assess(resolved.robot, result.trajectory).violations
    worst = next(check for check in violated if check.quantity == "velocity")
    assert not result.verdict.is_feasible
    assert f"velocity ({worst.joint} at {100 * worst.utilisation:.1f} %" in result.statement
    assert result.to_dict()["limits"]["is_feasible"] is False
    assert "acceleration limit (unknown for all joints)" in str(result).replace("\n", " ")


def test_a_front_respects_limits_by_assessment_and_names_the_others() -> None:
    resolved = ps.resolve_task(ps.load_task("paper-turned"))
    objectives = ("integral_of_squared_jerk", "overshoot")
    free = ps.pareto_front(
        ps.septic, resolved.points, resolved.times, objectives=objectives, robot=resolved.robot, size=3
    )
    assert [verdict.is_feasible for verdict in free.verdicts].count(False) >= 1
    assert "position" in str(free)
    kept = ps.pareto_front(
        ps.septic,
        resolved.points,
        resolved.times,
        objectives=objectives,
        robot=resolved.robot,
        keep=["position"],
        size=3,
    )
    for trajectory in kept.trajectories:
        assert ps.assess(resolved.robot, trajectory).is_feasible
    assert "Limits respected: position." in str(kept)


def test_without_inertia_all_but_effort_is_assessed(tmp_path: Path) -> None:
    """A kinematic optimum does not need torque."""
    robot = load(tmp_path, ARM.replace(INERTIAL, ""))
    points = [[0.0, 0.0], [0.5, 1.0], [1.0, 0.5], [0.5, 0.0]]
    result = ps.optimise_via_times(ps.septic, points, 1.0, objective="peak_velocity", robot=robot, restarts=0)
    assert "effort (no inertia is known beyond shoulder, elbow)" in result.statement
    assert {check.quantity for check in result.verdict.checks} == {"position", "velocity"}
