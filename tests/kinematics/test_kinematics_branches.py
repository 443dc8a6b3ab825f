"""Closed forms of other arms than the PUMA: all branches, their names, arms off their drawing, singularities."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from helpers.arms import EXAMPLES
from helpers.six_axis_arms import ARMS, KR5, QUARTER, TX60, UR10E, arm, modified, standard

import puma_septic as ps
from puma_septic.kinematics._chain import chain_to
from puma_septic.kinematics._closed_form import closed_form
from puma_septic.kinematics._least_squares import is_solved, levenberg_marquardt
from puma_septic.kinematics._poses import checked_poses
from puma_septic.kinematics._six_axes import SixAxes, six_axes
from puma_septic.kinematics._six_axis_branches import six_axis_branches

TURN = 2.0 * np.pi
NAMES = ("ur5", "ur10e", "puma560", "tx60", "m1013", "kr5", "irb1200")


def apart(q: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Largest difference of each row modulo a turn."""
    return np.abs((q - other + np.pi) % TURN - np.pi).max(axis=-1)


@pytest.fixture
def robots(tmp_path: Path) -> dict[str, ps.Robot]:
    made = {name: arm(tmp_path, name) for name in ARMS}
    return {**made, "ur5": ps.load_robot(EXAMPLES["ur5"]), "puma560": ps.load_robot()}


def assert_random_starts_find_no_other(robot: ps.Robot, poses: int, starts: int) -> tuple[int, int]:
    """Return how many branches the closed form has, and how many different ones random starts have found."""
    rng = np.random.default_rng(6)
    q = rng.uniform(-np.pi, np.pi, (poses, 6))
    targets = ps.forward_kinematics(robot, q)
    batch = ps.inverse_kinematics_batch(robot, targets)
    assert len(set(batch.configurations)) == 8
    assert batch.residual[batch.exists].max() < 1e-10
    met = np.zeros((poses, 8), dtype=bool)
    for k in range(poses):
        first = np.concatenate((q[k : k + 1], rng.uniform(-np.pi, np.pi, (starts, 6))))
        found, left = levenberg_marquardt(robot, checked_poses("T", targets[k : k + 1]), first)
        found = found[is_solved(left)]
        gaps = apart(found[:, None], batch.q[k, batch.exists[k]])
        # What is solved to 1e-10 is as far from the branch as that over the Jacobian's smallest singular value.
        softest = np.linalg.svd(ps.jacobian(robot, found), compute_uv=False)[:, -1]
        assert (gaps.min(axis=1) < 1e-7 + 1e-9 / softest).all() or not batch.is_complete[k], f"pose {k}"
        met[k, np.flatnonzero(batch.exists[k])[np.unique(gaps.argmin(axis=1))]] = True
    return int(batch.exists.sum()), int(met.sum())


@pytest.mark.parametrize("name", NAMES)
def test_every_branch_is_found(robots: dict[str, ps.Robot], name: str) -> None:
    """32 starts found 452 of 489 branches within limits; the closed form has each that random starts find."""
    branches, met = assert_random_starts_find_no_other(robots[name], poses=3, starts=60)
    assert branches >= met > 0.8 * branches


@pytest.mark.study
@pytest.mark.parametrize("name", NAMES)
def test_every_branch_of_200_poses_is_found(robots: dict[str, ps.Robot], name: str) -> None:
    """All that 2,000 random starts find, named, below 1e-10: the whole of it, minutes of CPU for each arm."""
    branches, met = assert_random_starts_find_no_other(robots[name], poses=200, starts=2000)
    assert branches >= met > 0.99 * branches


@pytest.mark.parametrize("name", NAMES)
def test_the_pose_of_any_posture_has_it_among_its_branches(robots: dict[str, ps.Robot], name: str) -> None:
    """2,000 postures; 6 to 12 % of poses once lacked the very posture that they were made from."""
    robot = robots[name]
    q = np.random.default_rng(2).uniform(-np.pi, np.pi, (2000, 6))
    batch = ps.inverse_kinematics_batch(robot, ps.forward_kinematics(robot, q))
    gaps = np.where(batch.exists, apart(batch.q, q[:, None]), np.inf).min(axis=1)
    softest = np.linalg.svd(ps.jacobian(robot, q), compute_uv=False)[:, -1]
    assert ((gaps < 1e-9 / softest) | ~batch.is_complete).all()
    assert (batch.reachable | ~batch.is_complete).all()
    reached = ps.forward_kinematics(robot, batch.q[batch.exists])
    target = np.repeat(ps.forward_kinematics(robot, q), batch.exists.sum(axis=1), axis=0)
    assert np.abs(reached - target).max() < 1e-10


def test_which_poses_have_how_many(robots: dict[str, ps.Robot]) -> None:
    """A UR arm's pose has 2, 4, 6 or 8 branches; an arm whose axes 1 and 2 meet has them all or none."""
    q = np.random.default_rng(4).uniform(-np.pi, np.pi, (500, 6))
    counts = {}
    for name in ("ur10e", "tx60", "kr5"):
        batch = ps.inverse_kinematics_batch(robots[name], ps.forward_kinematics(robots[name], q))
        counts[name] = set(batch.exists.sum(axis=1).tolist())
        assert batch.is_complete.all()
    assert counts == {"ur10e": {2, 4, 6, 8}, "tx60": {8}, "kr5": {4, 8}}


def test_the_general_form_is_the_pumas(rng: np.random.Generator) -> None:
    """Two ways to the same branches, with the same names: Paul & Zhang's formulas, and subproblems."""
    puma = ps.load_robot()
    form = six_axes(chain_to(puma))
    assert form is not None
    assert form.kind == "spherical wrist"
    q = rng.uniform(-np.pi, np.pi, (300, 6))
    poses = ps.forward_kinematics(puma, q)
    batch = ps.inverse_kinematics_batch(puma, poses)
    assert form.configurations == batch.configurations
    found = six_axis_branches(form, checked_poses("T", poses), None).q.reshape(6, 8, -1)
    # The square root of rounding where two branches nearly meet.
    assert apart(found.transpose(2, 1, 0), batch.q).max() < 1e-7


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.slow
def test_names_hold_along_a_motion(robots: dict[str, ps.Robot], name: str) -> None:
    """Along straight ways in joint space a posture keeps its branch's name unless it passes a singularity."""
    robot, rng, kept = robots[name], np.random.default_rng(5), 0
    for _ in range(12):
        q = np.linspace(*rng.uniform(-np.pi, np.pi, (2, 6)), 400)
        batch = ps.inverse_kinematics_batch(robot, ps.forward_kinematics(robot, q))
        which = np.where(batch.exists, apart(batch.q, q[:, None]), np.inf).argmin(axis=1)
        # Between two samples the determinant changes sign where a singularity is passed, and is small where two are.
        determinant = np.linalg.det(ps.jacobian(robot, q))
        small = (np.abs(determinant) < 1e-4 * np.abs(determinant).max()) | ~batch.is_complete
        smooth = (determinant[1:] * determinant[:-1] > 0) & ~(small[1:] | small[:-1])
        assert (which[1:] == which[:-1])[smooth].all()
        kept += int(smooth.sum())
    assert kept > 3500


def test_a_ur_arms_names_are_its_geometry(robots: dict[str, ps.Robot]) -> None:
    """Seen from axis 1 towards the wrist, the right arm's plane passes on the right; up is above shoulder to wrist."""
    robot = robots["ur10e"]
    solutions = ps.inverse_kinematics(robot, ps.forward_kinematics(robot, [0.4, -1.1, 1.5, -1.9, -1.4, 0.2]))
    assert len(solutions.q) == 8
    shoulder, elbow, wrist, last = (
        ps.forward_kinematics(robot, solutions.q, frame=f"l{k}")[:, :3, 3] for k in (2, 3, 4, 6)
    )
    plane = ps.forward_kinematics(robot, solutions.q, frame="l2")[:, :3, 2]
    for k, name in enumerate(solutions.configurations):
        # Where the arm's plane is, from axis 1, and the way ahead to the last axis, both horizontal.
        beside = plane[k] * ((wrist[k] + (last[k] - wrist[k]) * 0) @ plane[k] + UR10E[3][2])
        side = np.cross(last[k] * (1, 1, 0), beside)[2]
        assert (side < 0) == name.startswith("right"), name
        line = wrist[k] - shoulder[k]
        above = (elbow[k] - shoulder[k])[2] - line[2] * ((elbow[k] - shoulder[k]) @ line) / (line @ line)
        assert (above > 0) == ("-up-" in name), name
        assert (np.sin(solutions.q[k, 4]) > 0) == name.endswith("noflip")


def test_arms_without_an_offset_have_a_front_and_a_back(robots: dict[str, ps.Robot]) -> None:
    """In front of axis 1 with the elbow up, as a KUKA or ABB arm stands ready; behind, it reaches over its back."""
    for name, ahead in (("kr5", 1), ("irb1200", -1)):
        robot = robots[name]
        form = closed_form(robot)
        assert isinstance(form, SixAxes)
        assert form.arms == ("front", "back")
        ready = next(
            q
            for q in np.random.default_rng(0).uniform(-np.pi, np.pi, (5000, 6)) * (0, 1, 1, 0.2, 1, 0.2)
            if _stands_ready(robot, q, ahead)
        )
        solutions = ps.inverse_kinematics(robot, ps.forward_kinematics(robot, ready))
        k = int(apart(solutions.q, ready).argmin())
        assert solutions.configurations[k].startswith("front-up")


def _stands_ready(robot: ps.Robot, q: np.ndarray, ahead: int) -> bool:
    """Elbow up and ahead, wrist further ahead: along x where the KUKA's axis 2 lies, against it where the ABB leans."""
    shoulder, elbow, wrist = (ps.forward_kinematics(robot, q, frame=f"l{k}")[:3, 3] for k in (2, 3, 5))
    over, out = elbow - shoulder, wrist - shoulder
    return bool(0.1 < over[0] * ahead < out[0] * ahead - 0.2 and over[2] > max(0.2, out[2]))


@pytest.mark.parametrize("signs", [(-1, 1, 1, 1, 1, 1), (1, -1, 1, 1, 1, 1), (-1, -1, -1, 1, 1, 1)])
@pytest.mark.parametrize("name", ["tx60", "ur10e", "kr5"])
def test_arm_and_elbow_do_not_depend_on_how_axes_point(tmp_path: Path, name: str, signs: tuple[int, ...]) -> None:
    """KUKA's axis 1 points down: the same arm with another sign of a joint has the same names."""
    plain, turned = arm(tmp_path, name), arm(tmp_path, f"{name}-turned", ARMS[name], signs=signs)
    pose = ps.forward_kinematics(plain, [0.4, -1.1, 1.3, -0.9, 0.7, 0.2])
    expected, found = ps.inverse_kinematics(plain, pose), ps.inverse_kinematics(turned, pose)
    assert found.configurations == expected.configurations
    assert apart(found.q * signs, expected.q).max() < 1e-9


def test_a_file_with_right_angles_of_1_571_is_solved_on_its_model(robots: dict[str, ps.Robot]) -> None:
    """Doosan's M1013: its wrist axes miss one point by 0.01 mm, and answers are those of the file, not the drawing."""
    robot = robots["m1013"]
    form = closed_form(robot)
    assert isinstance(form, SixAxes)
    assert 1e-6 < form.deviation < 1e-4
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (200, 6))
    batch = ps.inverse_kinematics_batch(robot, ps.forward_kinematics(robot, q))
    assert batch.residual[batch.exists].max() < 1e-10
    assert batch.is_complete.mean() > 0.9
    # Close to where two branches meet this arm may have both or neither, which is not called complete.
    near = [0.3, -0.5, 1.2, 0.4, 1e-4, 0.2]
    solutions = ps.inverse_kinematics(robot, ps.forward_kinematics(robot, near))
    assert not solutions.is_complete
    assert solutions.extent.endswith("branches found close to a singularity")


def test_an_arm_far_from_both_patterns_has_no_closed_form(tmp_path: Path) -> None:
    """A wrist 80 mm wide; six axes of which 1 and 2 are parallel; five joints."""
    wide = standard([*KR5[:4], (0.08, -QUARTER, 0.0), KR5[5]])
    parallel = standard([(0.3, 0.0, 0.4), *KR5[1:]])
    for k, places in enumerate((wide, parallel, standard(KR5)[1:])):
        assert closed_form(arm(tmp_path, f"none-{k}", places)) is None


def test_a_ur_arms_free_joint_stays_near(robots: dict[str, ps.Robot]) -> None:
    """With q5 = 0 axes 4 and 6 are parallel: joint 6 is 0, or that of q_near, and the rest follows."""
    robot = robots["ur10e"]
    q = np.array([0.5, -1.2, 1.4, -0.6, 0.0, 0.3])
    pose = ps.forward_kinematics(robot, q)
    near = ps.inverse_kinematics(robot, pose, q_near=q)
    k = int(apart(near.q, q).argmin())
    np.testing.assert_allclose(near.q[k], q, rtol=0, atol=1e-7)
    assert "wrist" in near.singular[k]
    free = ps.inverse_kinematics(robot, pose)
    assert any("wrist" in kinds and abs(row[5]) < 1e-12 for row, kinds in zip(free.q, free.singular, strict=True))
    assert free.residual.max() < 1e-10


@pytest.mark.parametrize("name", ["ur10e", "tx60", "kr5"])
def test_stretched_elbow_is_still_in_reach(robots: dict[str, ps.Robot], name: str) -> None:
    """On the very edge, where rounding alone puts the pose outside."""
    robot = robots[name]
    form = closed_form(robot)
    assert isinstance(form, SixAxes)
    turn = np.arctan2(np.cross(form.fore, form.upper) @ form.axes[2], form.fore @ form.upper)
    q = np.random.default_rng(0).uniform(-1, 1, (50, 6))
    q[:, 2] = turn
    found = ps.inverse_kinematics_batch(robot, ps.forward_kinematics(robot, q))
    assert found.reachable.all()
    assert (found.singular[:, :, 1] & found.exists).any(axis=1).all()
    assert found.residual[found.exists].max() < 1e-10


def test_batch_is_the_single_call_repeated(robots: dict[str, ps.Robot], rng: np.random.Generator) -> None:
    robot = robots["ur10e"]
    q = rng.uniform(-np.pi, np.pi, (10, 6))
    poses = ps.forward_kinematics(robot, q)
    poses[0, :3, 3] *= 50.0
    batch = ps.inverse_kinematics_batch(robot, poses, q_near=q)
    assert batch.reachable.tolist() == [False] + [True] * 9
    assert batch.out_of_reach[0] > 1.0
    assert not batch.out_of_reach[1:].any()
    for k in range(1, 10):
        one = ps.inverse_kinematics(robot, poses[k], q_near=q[k])
        np.testing.assert_allclose(batch.q[k, batch.exists[k]], one.q, rtol=0, atol=1e-12)
        assert one.configurations == tuple(np.array(batch.configurations)[batch.exists[k]])
        assert one.is_complete
        assert one.starts == 0
    with pytest.raises(ps.NoSolution, match=r"no joint positions found .*; the nearest q = .* leaves .* m and"):
        ps.inverse_kinematics(robot, poses[0])


def test_another_joint_that_does_not_carry_the_tool_rests(tmp_path: Path) -> None:
    """A branch of the tree beside the arm: mid-range, or where q_near has it."""
    places = modified(TX60)
    robot = arm(tmp_path, "tx60", places)
    text = (tmp_path / "tx60.urdf").read_text()
    side = (
        '<link name="side"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        '</inertial></link><joint name="aside" type="revolute"><parent link="l2"/><child link="side"/>'
        '<axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>'
    )
    (tmp_path / "beside.urdf").write_text(text.replace("</robot>", f"{side}</robot>"))
    beside = ps.load_robot(tmp_path / "beside.urdf", tool="tool")
    q, which = np.array([0.4, -1.1, 1.3, -0.9, 0.7, 0.2]), beside.joint_index("aside")
    poses = np.tile(ps.forward_kinematics(robot, q), (3, 1, 1))
    batch = ps.inverse_kinematics_batch(beside, poses)
    assert batch.q.shape == (3, 8, 7)
    assert (batch.q[:, :, which] == 0.5).all()
    near = np.tile(np.insert(q, which, 0.0), (3, 1))
    near[:, which] = [0.1, 0.2, 0.3]
    batch = ps.inverse_kinematics_batch(beside, poses, q_near=near)
    np.testing.assert_array_equal(batch.q[:, :, which], np.repeat([[0.1], [0.2], [0.3]], 8, axis=1))
    assert np.abs(batch.q[1] - near[1]).max(axis=1).min() < 1e-9
