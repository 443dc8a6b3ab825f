"""Where things lie: this checkout, the tests' own numbers, and the robots of example-robot-data."""

from __future__ import annotations

from pathlib import Path

import pinocchio as pin

TESTS = Path(__file__).parents[1]
ROOT = TESTS.parent
DOCS = ROOT / "docs"
# Numbers taken from elsewhere, each with its source.
REFERENCE = TESTS / "reference"
GOLDEN = TESTS / "golden" / "files"
# example-robot-data 6 has files only, no Python module; they lie under the same prefix as Pinocchio.
SHARE = Path(pin.__file__).parents[4] / "share"
ROBOTS = SHARE / "example-robot-data" / "robots"
UR5 = ROBOTS / "ur_description" / "urdf" / "ur5_robot.urdf"
PANDA = ROBOTS / "panda_description" / "urdf" / "panda.urdf"  # seven joints and two fingers
KINOVA = ROBOTS / "kinova_description" / "robots" / "kinova.urdf"  # continuous joints
