"""What tolerances leave open of the torque."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import puma_septic as ps

ROD = """<robot name="rod"><link name="a"/><link name="b"><inertial><mass value="2"/><origin xyz="0.5 0 0"/>
<inertia ixx="0.01" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 -1 0"/>
<limit effort="{effort}" velocity="100" lower="-4" upper="4"/></joint></robot>"""


@pytest.fixture
def rod(tmp_path: Path) -> ps.Robot:
    (tmp_path / "rod.urdf").write_text(ROD.format(effort=10.5))
    return ps.load_robot(tmp_path / "rod.urdf")


def test_a_rod_by_hand(rod: ps.Robot) -> None:
    """Slowly past the horizontal a rod needs m g c = 2 * 9.81 * 0.5 N m; with c +- 0.02 m it is m g (c + 0.02).

    Mass alone does not enter: with m c as a parameter of its own, the weight is g m c.
    """
    motion = ps.compute_motion(rod, ps.quintic_segments([[-0.5], [0.5]], [0.0, 1000.0]))
    doubt = ps.torque_uncertainty(motion, com=0.02)
    assert doubt.nominal[0] == pytest.approx(9.81, rel=1e-6)
    # m c_z counts as well, by the sine of the angle: sqrt would be of a circle, a box adds |cos| + |sin|.
    angle = np.arctan(0.02 / 0.52)
    expected = 2 * 9.81 * (0.52 * np.cos(angle) + 0.02 * np.sin(angle))
    assert doubt.greatest[0] == pytest.approx(expected, rel=1e-5)
    assert doubt.least[0] == pytest.approx(2 * 9.81 * 0.48, rel=1e-5)
    assert ps.torque_uncertainty(motion, mass=0.1).greatest[0] == pytest.approx(9.81, rel=1e-5)


def test_which_datum_decides(rod: ps.Robot) -> None:
    motion = ps.compute_motion(rod, ps.quintic_segments([[-0.5], [0.5]], [0.0, 1000.0]))
    assert ps.torque_uncertainty(motion, com=0.02).verdicts == ("feasible",)
    doubt = ps.torque_uncertainty(motion, com=0.05, inertia=0.1)
    assert doubt.verdicts == ("open",)
    assert doubt.deciding == ("j m c_x",)
    weak = ps.compute_motion(rod.with_limits(effort=[5.0]), motion.trajectory)
    assert ps.torque_uncertainty(weak, com=0.02).verdicts == ("infeasible",)
    free = ps.compute_motion(rod.with_limits(effort=[np.nan]), motion.trajectory)
    assert ps.torque_uncertainty(free, com=0.02).verdicts == ("unknown",)


@pytest.mark.slow
def test_no_draw_exceeds_the_box_and_a_corner_attains_it(puma: ps.Robot, rng: np.random.Generator) -> None:
    """Law: quantiles rise to the greatest and stay below it; nominal values are those of the assessment."""
    robot = puma.with_payload(ps.Payload(mass=2.0, com=[0, 0, 0.1])).with_wrench(ps.Wrench(force=[3.0, 0, 1.0]))
    motion = ps.compute_motion(robot, ps.septic(rng.uniform(-0.7, 0.7, (4, 6)), [0, 1, 2, 3.0]))
    doubt = ps.torque_uncertainty(motion, mass=0.05, com=0.01, inertia=0.1, rotor=0.1, friction=0.3, samples=200)
    assert doubt.nominal == pytest.approx(ps.assess(motion).peak_torque, rel=1e-9)
    assert (doubt.least < doubt.nominal).all()
    assert (np.diff(doubt.quantiles, axis=0) >= 0).all()
    assert (doubt.quantiles[-1] < doubt.greatest).all()
    # Friction alone is known in closed form at each instant: a dense scan of |tau| + 0.3 |friction|.
    alone = ps.torque_uncertainty(motion, friction=0.3, samples=1)
    t = np.linspace(0, 3, 20_001)[1:-1]
    terms = motion.torque_terms
    spread = np.abs(terms.viscous(t)) + np.abs(terms.coulomb(t))
    dense = (np.abs(motion.torque(t)) + 0.3 * spread).max(axis=0)
    assert (alone.greatest >= dense * (1 - 1e-12)).all()
    assert alone.greatest == pytest.approx(dense, rel=1e-3)


@pytest.mark.parametrize("start", [0.0, 100.0])
def test_a_peak_at_a_step_is_told_by_the_side_that_has_it(rod: ps.Robot, start: float) -> None:
    """Bug: the least peak and the shares were read behind the step at which a bang-bang motion's torque is largest.

    Up to the step gravity and inertia add up, behind it they oppose each other. By hand: m g c cos q + (I + m c^2) a
    with I + m c^2 = 0.6 kg m^2 just before the middle, where q = 0.
    """
    move = ps.profiles.bang_bang([[-0.5], [0.5]], [start, start + 1.0])
    doubt = ps.torque_uncertainty(ps.compute_motion(rod, move), inertia=0.1)
    assert doubt.nominal[0] == pytest.approx(9.81 + 0.6 * 4.0)
    assert doubt.shares[0].sum() == pytest.approx(0.06 * 4.0)
    assert doubt.least[0] == pytest.approx(9.81 + 0.54 * 4.0)
    assert doubt.greatest[0] == pytest.approx(9.81 + 0.66 * 4.0)
    assert doubt.time[0] == pytest.approx(start + 0.5)


def test_messages(rod: ps.Robot) -> None:
    motion = ps.compute_motion(rod, ps.quintic_segments([[-0.5], [0.5]], [0.0, 10.0]))
    with pytest.raises(ps.InputError, match="give at least one tolerance above 0"):
        ps.torque_uncertainty(motion)
    with pytest.raises(ps.InputError, match="mass = -1"):
        ps.torque_uncertainty(motion, mass=-1.0)
    with pytest.raises(ps.InputError, match="samples = 0"):
        ps.torque_uncertainty(motion, mass=0.1, samples=0)


def test_a_step_of_velocity_is_infeasible_whatever_the_data(rod: ps.Robot) -> None:
    """The torque beside the steps was held against the limit: feasible, where an assessment has no bound."""
    motion = ps.compute_motion(rod, ps.profiles.linear([[-0.1], [0.1]], [0.0, 10.0]))
    doubt = ps.torque_uncertainty(motion, mass=0.01)
    assert doubt.verdicts == ("infeasible",)
    assert doubt.deciding == ()
    assert np.isinf([doubt.nominal, doubt.least, doubt.greatest]).all()
    within = ps.compute_motion(rod, ps.profiles.linear([[-0.1], [0.1]], [0.0, 10.0]).excerpt)
    assert ps.torque_uncertainty(within, mass=0.01).verdicts == ("feasible",)
