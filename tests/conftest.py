"""What all tests share: the robot, seeded randomness, the reference numbers, hypothesis profiles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

import puma_septic as ps

# A run finds the same examples every time, on any machine, however slow; to look for new ones:
# python -m pytest --hypothesis-profile explore
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.register_profile("explore", deadline=None, print_blob=True)
settings.load_profile("repeatable")


@pytest.fixture(scope="session")
def puma() -> ps.Robot:
    """The PUMA 560 as `load_robot()` gives it; immutable, so one is enough."""
    return ps.load_robot()


@pytest.fixture
def rng() -> np.random.Generator:
    """The same random numbers in each test."""
    return np.random.default_rng(560)


@pytest.fixture(scope="session")
def reference() -> Path:
    """The folder of numbers taken from elsewhere, each with its source."""
    return Path(__file__).parent / "reference"
