"""The table of quantities, and what is read off it elsewhere."""

from __future__ import annotations

import dataclasses

import pytest

import puma_septic as ps
from puma_septic.limit_check import LimitCheck
from puma_septic.quantities import MAGNITUDES, MOTION, QUANTITIES, typeset
from puma_septic.task._schema import LimitsSection


def test_each_quantity_is_a_limit_of_robots_and_tasks() -> None:
    """A new row needs its field in `Limits` and in the tasks' section, or it could not be given."""
    fields = {field.name for field in dataclasses.fields(ps.Limits)} - {"source"}
    assert fields == set(QUANTITIES) == set(LimitsSection.model_fields)


def test_motion_is_in_order_of_derivatives() -> None:
    assert MOTION == ("position", "velocity", "acceleration", "jerk")
    assert [QUANTITIES[name].order for name in MOTION] == [0, 1, 2, 3]
    assert "position" not in MAGNITUDES


def test_units() -> None:
    units = [(row.unit(is_prismatic=False), row.unit(is_prismatic=True)) for row in QUANTITIES.values()]
    assert units == [
        ("rad", "m"),
        ("rad/s", "m/s"),
        ("rad/s^2", "m/s^2"),
        ("rad/s^3", "m/s^3"),
        ("N m", "N"),
        ("N m/s", "N/s"),
    ]
    assert typeset("kg m^2/s^3") == "kg m²/s³"


def test_a_check_is_read_back_from_its_document() -> None:
    check = LimitCheck.of_magnitude(
        joint="unbounded", quantity="jerk", demand=float("inf"), limit=5.0, unit="rad/s^3", time=0.5, source="null"
    )
    again = LimitCheck.from_dict(check.to_dict())
    assert dataclasses.asdict(again) == dataclasses.asdict(check)
    assert (again.is_violated, again.keeps()) == (True, False)


@pytest.mark.parametrize(
    ("bounds", "reach", "limit", "margin", "utilisation"),
    [
        ((-1.0, 2.0), (-0.5, 1.25), -1.0, 0.5, 2 / 3),  # nearer to the lower bound
        ((-1.0, 2.0), (0.0, 2.6), 2.0, -0.6, 1.4),
        ((float("nan"), 2.0), (-9.0, 1.0), 2.0, 1.0, 0.0),  # of one bound no share is used
        ((-1.0, float("nan")), (-1.5, 9.0), -1.0, -0.5, float("inf")),
    ],
)
def test_positions_are_held_against_the_bound_they_come_nearest_to(
    bounds: tuple, reach: tuple, limit: float, margin: float, utilisation: float
) -> None:
    check = LimitCheck.of_position(joint="elbow", bounds=bounds, reach=reach, times=(0.0, 1.0), unit="rad")
    assert (check.limit, check.margin, check.utilisation) == pytest.approx((limit, margin, utilisation), rel=1e-15)
    # An angle is no share: a margin that is asked for changes nothing.
    assert check.keeps(0.9) == check.keeps() == (margin > 0)


def test_keeps_with_a_margin(puma: ps.Robot) -> None:
    # 15/8 d/T: peak velocity of the rest-to-rest quintic; 0.46875 rad/s.
    move = ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])
    assessment = ps.assess(puma.with_limits(velocity=0.5), move)
    assert assessment.keeps() == ()
    unmet = [check for check in assessment.keeps(margin=0.1) if check.quantity == "velocity"]
    assert [check.joint for check in unmet] == list(puma.joint_names)
    assert unmet[0].margin == pytest.approx(1 - 0.46875 / 0.5, rel=1e-12)
    with pytest.raises(ps.InputError, match=r"margin = 1.5 must be at most 1"):
        assessment.keeps(margin=1.5)


def test_the_effort_of_a_prismatic_joint_is_a_force() -> None:
    check = LimitCheck.of_magnitude(joint="rail", quantity="effort", demand=50.0, limit=40.0, unit="N", time=0.25)
    assert str(check) == "rail force 50 N at t = 0.25 s is 125 % of 40 N"
    of_a_motor = LimitCheck.of_magnitude(
        joint="rail", quantity="motor speed", demand=50.0, limit=40.0, unit="rad/s", time=0.25, kind="physics"
    )
    assert str(of_a_motor) == "rail motor speed 50 rad/s at t = 0.25 s is 125 % of 40 rad/s (physics)"
