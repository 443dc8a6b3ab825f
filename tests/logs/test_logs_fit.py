"""Motions made elsewhere: interpolation, smoothing with its residual told, CSV files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from puma_septic import profiles
from puma_septic.errors import InputError
from puma_septic.logs import fit_residual, fit_trajectory, read_csv_trajectory
from puma_septic.trajectory import Trajectory

Array = NDArray[np.float64]


@pytest.fixture
def motion(rng: np.random.Generator) -> Trajectory:
    """A septic of three joints, the second still."""
    points = rng.normal(size=(4, 3))
    points[:, 1] = 0.3
    return profiles.septic(points, [0.0, 2.0, 6.0, 9.0])


def test_samples_of_a_motion_give_it_back(motion: Trajectory) -> None:
    """Fourth order of accuracy and better: 91 samples of a polynomial of degree 7 leave 1e-7 between them."""
    t = np.linspace(0, 9, 91)
    fitted = fit_trajectory(t, motion(t), joint_names=("a", "b", "c"))
    between = np.linspace(0, 9, 1000)
    assert fit_residual(fitted).max.max() < 1e-14
    assert np.abs(fitted(between) - motion(between)).max() < 1e-6
    assert np.abs(fitted(between, 3) - motion(between, 3)).max() < 1e-2
    assert [len(fitted.jumps(k).times) for k in (1, 2)] == [0, 0]
    assert not fitted.position.coefficients[1:, :, 1].any()
    assert fitted.joint_names == ("a", "b", "c")


def test_interpolation_is_the_quintic_spline(rng: np.random.Generator) -> None:
    """Two implementations: SciPy's banded B-spline collocation and our own conditions segment by segment."""
    t, q = np.cumsum(rng.uniform(0.5, 1.5, 12)), rng.normal(size=(12, 2))
    one, other = fit_trajectory(t, q, ends="rest"), profiles.quintic_spline(q, t)
    grid = np.linspace(t[0], t[-1], 300)
    for order in range(4):
        assert np.abs(one(grid, order) - other(grid, order)).max() < 1e-12 * 60**order


def test_velocities_of_a_planner_are_kept_and_the_jerk_is_continuous(motion: Trajectory) -> None:
    t = np.array([0.0, 0.8, 2.0, 3.1, 5.0, 7.7, 9.0])
    fitted = fit_trajectory(t, motion(t), v=motion(t, 1))
    assert np.abs(fitted(t) - motion(t)).max() < 1e-12
    assert np.abs(fitted(t, 1) - motion(t, 1)).max() < 1e-12
    # Steps of the jerk at the ends only, against rest.
    assert set(fitted.jumps(3).times.tolist()) <= {0.0, 9.0}
    assert len(fitted.jumps(2).times) == 0
    fuller = fit_trajectory(t, motion(t), v=motion(t, 1), a=motion(t, 2))
    assert np.abs(fuller(t, 2) - motion(t, 2)).max() < 1e-11
    two = fit_trajectory(t[[0, -1]], motion(t[[0, -1]]), v=motion(t[[0, -1]], 1))
    assert np.abs(two(4.5) - profiles.quintic(motion(t[[0, -1]]), [0.0, 9.0])(4.5)).max() < 1e-14


@pytest.mark.parametrize("rows", [76, 151, 1001])
def test_velocities_beside_positions_hide_no_step_of_the_acceleration(rows: int) -> None:
    """Quintics with a continuous jerk and no acceleration at the ends made 38 % too much of a trapezoid."""
    move = profiles.trapezoidal([[0.0], [1.0]], [0.0, 1.5], blend_time=0.4)
    t = np.linspace(0.0, 1.5, rows)
    fitted = fit_trajectory(t, move(t), v=move(t, 1))
    assert fitted.peak(2)[0] == pytest.approx(move.peak(2)[0], rel=2e-6)


def test_a_motion_with_velocities_moves_at_its_ends_where_they_say_so() -> None:
    """It was taken for one from rest to rest, and its torque for unbounded; a turn of an encoder for motion."""
    move = profiles.quintic([[0.0], [6.0]], [0.0, 2.0])
    t = np.array([0.5, 0.8, 1.4, 1.9, 2.0])
    fitted = fit_trajectory(t, (move(t) + np.pi) % (2 * np.pi) - np.pi, v=move(t, 1), continuous=[True])
    assert (fitted.rest_before, fitted.rest_after) == (False, True)
    assert fitted(t, 1) == pytest.approx(move(t, 1), abs=1e-12)
    assert fitted.peak(2)[0] < 2 * move.peak(2)[0]
    move, whole = profiles.classic_septic([[0.0], [6.0]], [0.0, 2.0]), np.linspace(0.0, 2.0, 5)
    for ends, rests in (("rest", (True, True)), ("moving", (False, False)), ("auto", (True, True))):
        found = fit_trajectory(whole, move(whole), v=move(whole, 1), ends=ends)  # type: ignore[arg-type]
        assert (found.rest_before, found.rest_after) == rests


def test_smoothing_holds_the_residual_and_removes_noise(motion: Trajectory, rng: np.random.Generator) -> None:
    t, noise = np.linspace(0, 9, 2001), 1e-3
    q = motion(t) + noise * rng.standard_normal((2001, 3))
    fitted = fit_trajectory(t, q, smoothing=1.05 * noise)
    residual = fit_residual(fitted)
    assert (residual.rms <= 1.05 * noise).all()
    assert (residual.rms > 0.9 * noise).all()
    assert (residual.max == fitted.via_miss).all()
    # Averaging over about 100 samples for each coefficient leaves well under half the noise.
    assert np.abs(fitted(t) - motion(t)).max() < 0.6 * noise
    assert [len(fitted.jumps(k).times) for k in (1, 2)] == [0, 0]
    assert len(fitted.breaks) < 60


def test_smoothing_takes_a_value_for_each_joint_and_leaves_a_still_joint_still(motion: Trajectory) -> None:
    t = np.linspace(0, 9, 301)
    fitted = fit_trajectory(t, motion(t), smoothing=[1e-3, 1e-9, 1e-2])
    assert (fit_residual(fitted).rms <= [1e-3, 1e-9, 1e-2]).all()
    assert not fitted.position.coefficients[1:, :, 1].any()


def test_fit_refuses(rng: np.random.Generator) -> None:
    t, q = np.arange(20.0), rng.normal(size=(20, 2))
    with pytest.raises(
        InputError, match=r"joint 'b': smoothing = 1e-06 rad is out of reach: with \d+ intervals for 20 samp"
    ):
        fit_trajectory(t, q, smoothing=[10.0, 1e-6], joint_names=("a", "b"))
    with pytest.raises(InputError, match=r"^smoothing = 0 rad must be greater than 0 rad; leave it out to interpolate"):
        fit_trajectory(t, q, smoothing=0.0)
    with pytest.raises(InputError, match="smoothing fits positions alone"):
        fit_trajectory(t, q, v=q, smoothing=0.1)
    with pytest.raises(InputError, match="a is given without v"):
        fit_trajectory(t, q, a=q)
    with pytest.raises(InputError, match=r"v: shape \(19, 2\) is not \(20, 2\)"):
        fit_trajectory(t, q, v=q[1:])
    with pytest.raises(InputError, match=r"t\[3\] = 3 s is followed by 3 s"):
        fit_trajectory([0, 1, 2, 3, 3], q[:5])
    with pytest.raises(InputError, match="q: at least 2 samples of one joint are needed"):
        fit_trajectory(t[:1], q[:1])


def write(folder: Path, text: str) -> Path:
    path = folder / "log.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_csv_becomes_a_log_and_a_trajectory(tmp_path: Path, motion: Trajectory) -> None:
    t = np.linspace(0, 9, 181)
    rows = [",".join(map(repr, row)) for row in np.column_stack([t, motion(t)]).tolist()]
    log = read_csv_trajectory(write(tmp_path, "\ufefft,waist, shoulder ,elbow\r\n" + "\r\n".join(rows) + "\r\n\r\n"))
    assert log.joint_names == ("waist", "shoulder", "elbow")
    assert (log.t == t).all()
    assert (log.q == motion(t)).all()
    fitted = fit_trajectory(log.t, log.q, joint_names=log.joint_names)
    assert np.abs(fitted(4.321) - motion(4.321)).max() < 1e-6


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "the file is empty"),
        (
            "0.0,1.0\n0.1,1.1\n",
            "row 1: the header must name a time ",
        ),
        ("t\n0.0\n0.1\n", "row 1: the header must name a time"),
        ("t,a,a\n0,1,2\n1,2,3\n", "row 1, column 3: the name 'a' is used twice"),
        ("t,a\n0,1\n", "1 rows of samples; at least two are needed"),
        ("t,a,b\n0,1,2\n0.1,,2\n0.2,1,2\n", "row 3, column 'a': the value is missing"),
        ("t,a,b\n0,1,2\n0.1,1\n0.2,1,2\n", "row 3 has 2 cells, the header 3"),
        ("t,a\n0,1\n0.1,fast\n", "row 3, column 'a': 'fast' is not a finite number"),
        ("t,a\n0,1\n0.1,nan\n", "row 3, column 'a': 'nan' is not a finite number"),
        ("t,a\n0,1\n0.1,1_000\n", "row 3, column 'a': '1_000' is not a finite number"),
        ("t,a\n0,1\n0.1,\u0661\n", "row 3, column 'a': '\u0661' is not a finite number"),  # Arabic-Indic 1
        ("t,a\n0,1\n0.1,2\n0.1,3\n", "row 4, column 't': 0.1 s does not come after 0.1 s in row 3"),
        ("t,a\n0,1\n0.2,2\n0.1,3\n", "row 4, column 't': 0.1 s does not come after 0.2 s in row 3"),
        ('t,a\n0,"1\n', "cannot be read as a CSV file"),
    ],
)
def test_csv_faults_are_named_by_row_and_column(tmp_path: Path, text: str, message: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(InputError) as caught:
        read_csv_trajectory(path)
    assert message in str(caught.value)
    assert str(path) in str(caught.value)


def test_csv_gap_in_time_and_unreadable_files(tmp_path: Path) -> None:
    path = write(tmp_path, "t,a\n0,1\n0.1,2\n0.9,3\n")
    assert len(read_csv_trajectory(path).t) == 3
    with pytest.raises(
        InputError, match=r"row 4, column 't': a gap of 0.8 s since row 3 is longer than max_gap = 0.15 s"
    ):
        read_csv_trajectory(path, max_gap=0.15)
    with pytest.raises(InputError, match="this CSV file does not exist"):
        read_csv_trajectory(tmp_path / "missing.csv")
    path.write_bytes(b"t,a\n0,\xff\xfe\n")
    with pytest.raises(InputError, match="not UTF-8 text: invalid start byte at byte 6"):
        read_csv_trajectory(path)
