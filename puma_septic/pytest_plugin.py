"""The pytest plug-in: the assertions of `puma_septic.testing` as fixtures, loaded where a test asks for one."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

import pytest

__all__ = ["assert_feasible", "assert_trajectory_ok"]


@pytest.fixture(scope="session")
def assert_feasible() -> Callable[..., None]:
    """`puma_septic.testing.assert_feasible`: fail unless an assessment keeps its limits."""
    return _assertion("assert_feasible")


@pytest.fixture(scope="session")
def assert_trajectory_ok() -> Callable[..., None]:
    """`puma_septic.testing.assert_trajectory_ok`: fail unless a planned trajectory may go to the robot."""
    return _assertion("assert_trajectory_ok")


def _assertion(name: str) -> Callable[..., None]:
    # Pytest loads every plug-in at every start; NumPy and Pinocchio wait until a test needs them.
    testing: Any = import_module("puma_septic.testing")
    function: Callable[..., None] = getattr(testing, name)
    return function
