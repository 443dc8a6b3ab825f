"""The pytest plug-in: the package's assertions as fixtures."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import pytest
from helpers.places import ROOT
from helpers.ros_messages import small_move

import puma_septic as ps
from puma_septic.testing import assert_trajectory_ok

SUITE = """
import puma_septic as ps

def test_plan(assert_trajectory_ok):
    assert_trajectory_ok("good.yaml", ps.load_robot(), allow=["limit_unknown"])

def test_fast(assert_trajectory_ok):
    assert_trajectory_ok("fast.yaml", ps.load_robot(), allow=["limit_unknown"])

def test_motion(assert_feasible):
    assert_feasible(ps.assess(ps.load_robot(), ps.quintic_segments([[0.0] * 6, [0.5] * 6], [0.0, 2.0])))
"""


def test_the_entry_point_is_the_plug_in() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    plugin = import_module(project["entry-points"]["pytest11"]["puma_septic"])
    assert set(plugin.__all__) == {"assert_feasible", "assert_trajectory_ok"}


@pytest.mark.slow
def test_a_suite_uses_its_fixtures(puma: ps.Robot, tmp_path: Path) -> None:
    """In a process of its own, where the installed package's entry point loads the plug-in.

    Named once more with ``-p``, pytest refuses a plug-in that its entry point has loaded already.
    """
    ps.write_joint_trajectory(tmp_path / "good.yaml", small_move(puma))
    ps.write_joint_trajectory(tmp_path / "fast.yaml", small_move(puma, 0.4))
    (tmp_path / "test_cell.py").write_text(SUITE)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    # Options meant for this run, such as a measurement of coverage, are not the inner one's.
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTEST_", "COV"))}
    run = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert "1 failed, 2 passed" in run.stdout
    assert "effort_limit: joint1 torque 101.5 N m" in run.stdout
    assert "fast.yaml: violated, 3 reasons" in run.stdout


def test_starting_pytest_loads_nothing_that_takes_time() -> None:
    code = "import sys, puma_septic.pytest_plugin; print(*{'numpy', 'pinocchio'} & set(sys.modules))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == ""


def test_a_file_that_cannot_be_read_is_an_error_not_a_failure(puma: ps.Robot, tmp_path: Path) -> None:
    with pytest.raises(ps.InputError, match="does not exist"):
        assert_trajectory_ok(tmp_path / "none.yaml", puma)
