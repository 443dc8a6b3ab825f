"""One call for all profiles, and what is said of them beside their functions."""

from __future__ import annotations

import inspect

import numpy as np
import pytest

from puma_septic import profiles
from puma_septic.errors import InputError

POINTS = np.array([[0.0, 0.6], [0.3, 0.7], [0.5, 0.2], [0.9, 0.9]])
TIMES = np.array([0.0, 1.0, 2.5, 3.0])
LIMITS = {"max_velocity": 1.0, "max_acceleration": 2.0, "max_jerk": 9.0}
NAMES = [info.name for info in profiles.available()]


@pytest.mark.parametrize("name", NAMES)
def test_every_profile_is_made_by_one_call(name: str) -> None:
    """Three rooms held the signature against what they had, and one knew `double_s` by name."""
    blended = "blend_time" in profiles.family(name).options
    options = {"blend_time": 0.2} if blended else {}
    move = profiles.make(name, POINTS, TIMES, limits=LIMITS, options=options, joint_names=["a", "b"])
    assert (move.profile, move.joint_names) == (name, ("a", "b"))
    assert profiles.family(name).takes_times(options) == (name != "double_s")
    if name != "double_s":
        np.testing.assert_array_equal(move.times, TIMES)


@pytest.mark.parametrize("name", NAMES)
def test_a_row_stands_beside_its_function(name: str) -> None:
    family = profiles.family(name)
    assert family.function is getattr(profiles, name)
    module = inspect.getmodule(family.function)
    assert getattr(module, name.upper()) is family.info
    assert "Returns\n-------\nTrajectory" in (inspect.getdoc(family.function) or "")


def test_options_say_otherwise() -> None:
    slow = profiles.make("double_s", POINTS, TIMES, limits=LIMITS, options={"max_velocity": 0.1})
    assert slow.extrema(1).peak.max() == pytest.approx(0.1, rel=1e-12)
    own = profiles.make("lspb", POINTS, TIMES, options={"max_velocity": 0.1, "blend_time": 0.1})
    assert own.duration > 3.0
    assert not profiles.family("lspb").takes_times({"max_velocity": 0.1})
    quintics = profiles.make("quintic", POINTS, TIMES, options={"velocities": np.zeros((4, 2))})
    np.testing.assert_array_equal(quintics.position.coefficients, profiles.quintic(POINTS, TIMES).position.coefficients)


def test_mstraj_is_what_the_paper_calls_lspb() -> None:
    assert profiles.mstraj is profiles.lspb
    assert profiles.family("mstraj") is profiles.family("lspb")
    assert profiles.make("mstraj", POINTS, TIMES, options={"blend_time": 0.2}).via_miss.any()
    assert set(profiles.names()) == {*NAMES, "mstraj"}


def test_unknown_names_and_options_list_the_valid_ones() -> None:
    with pytest.raises(InputError, match=r"unknown profile 'spline'; valid: 'linear', .*'mstraj'"):
        profiles.make("spline", POINTS, TIMES)
    with pytest.raises(InputError, match=r"unknown option 'speed' of profile 'cubic'; valid: velocities$"):
        profiles.make("cubic", POINTS, TIMES, options={"speed": 1.0})
    with pytest.raises(InputError, match=r"unknown option 'times' of profile 'linear'; valid: none$"):
        profiles.make("linear", POINTS, TIMES, options={"times": TIMES})
    with pytest.raises(InputError, match="double_s needs max_velocity"):
        profiles.make("double_s", POINTS, TIMES)
    with pytest.raises(InputError, match=r"times: must increase strictly, but times\[0\] = 1 s is followed by 0 s"):
        profiles.make("lspb", POINTS[:2], [1.0, 0.0], options={"blend_time": 0.1})
