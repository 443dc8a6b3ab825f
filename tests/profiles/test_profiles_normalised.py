"""The normalised table, and the paper's task by nine methods, against reference numbers to their printed
digits."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
from helpers.places import REFERENCE
from numpy.typing import NDArray
from scipy.interpolate import BPoly, CubicSpline, KroghInterpolator, make_interp_spline

from puma_septic import profiles
from puma_septic.trajectory import Trajectory

TABLE = tomllib.loads((REFERENCE / "profiles_table.toml").read_text())
POINTS, TIMES = np.array(TABLE["paper"]["points"]), np.array(TABLE["paper"]["times"])
ROWS = {row.profile: row for row in profiles.normalised_table()}


def holds(value: float, reference: float | str) -> bool:
    """A number is exact (to rounding, amplified by three derivatives), a string right to its last digit."""
    if isinstance(reference, float):
        return abs(value - reference) <= 1e-11 * max(1.0, abs(reference))
    if reference == "inf":
        return value == np.inf
    # Half a unit of the last digit, and a little for a printed value that was itself rounded at a tie.
    return abs(value - float(reference)) <= 0.501 * 10.0 ** -len(reference.partition(".")[2])


@pytest.mark.parametrize("reference", TABLE["normalised"], ids=lambda row: row["profile"])
def test_coefficients_of_the_normalised_table(reference: dict[str, float | str]) -> None:
    row = ROWS[str(reference["profile"])]
    for name in reference.keys() - {"profile", "continuity"}:
        assert holds(getattr(row, name), reference[name]), (name, getattr(row, name), reference[name])
    assert row.continuity == reference["continuity"]


def test_quintic_has_the_least_integral_of_jerk_squared_720_of_its_class() -> None:
    # Flash and Hogan 1985; with v = a = 0 at both ends the integral of jerk^2 is 720 h^2 / T^5.
    assert ROWS["quintic 3-4-5"].rms_jerk ** 2 == pytest.approx(720, rel=1e-12)
    others = [row for row in ROWS.values() if row.profile != "quintic 3-4-5"]
    assert all(row.rms_jerk**2 > 720 for row in others)


def paper_methods() -> dict[str, Trajectory]:
    p = profiles
    given = {name: getattr(p, name)(POINTS, TIMES) for name in (
        "septic", "quintic_spline", "poly_434", "cubic_spline", "septic_spline", "quintic", "classic_septic",
    )}  # fmt: skip
    given["lspb"] = p.lspb(POINTS, durations=np.diff(TIMES), blend_time=1.0)
    given["trapezoidal"] = p.trapezoidal(POINTS, TIMES, blend_time=1.0)
    return given


METHODS = paper_methods()


@pytest.mark.parametrize("reference", TABLE["joint_1"], ids=lambda row: row["method"])
def test_joint_1_of_the_papers_task(reference: dict[str, object]) -> None:
    move = METHODS[str(reference["method"])]
    steps = [k for k in (1, 2, 3) if move.jumps(k).sizes[:, :1].any()]
    impulse = any(k < 3 for k in steps)
    acceleration, jerk = move.derivative(2), move.derivative(3)
    measured = {
        "velocity": move.extrema(1).peak[0],
        "acceleration": move.extrema(2).peak[0],
        "rms_acceleration": np.sqrt(acceleration.inner(acceleration)[0] / 9),
        "jerk": np.inf if impulse else move.extrema(3).peak[0],
        "jerk_squared": np.inf if impulse else jerk.inner(jerk)[0],
        "overshoot": move.overshoot[0],
        "miss": move.via_miss[0],
    }
    for name in reference.keys() & measured.keys():
        assert holds(float(measured[name]), reference[name]), (name, measured[name])  # type: ignore[arg-type]
    for end, printed in zip(np.abs(move([0.0, 9.0], order=3)[:, 0]), reference.get("end_jerks", []), strict=False):  # type: ignore[call-overload]
        assert holds(float(end), printed)
    # Class of the whole row, which joint 1 of lspb and trapezoidal shows too.
    assert f"C{min(steps, default=4) - 1}" == reference["continuity"]


def test_joint_5_of_the_septic() -> None:
    septic, reference = METHODS["septic"], TABLE["joint_5"]
    for order, name in enumerate(("velocity", "acceleration", "jerk"), start=1):
        assert holds(float(septic.extrema(order).peak[4]), reference[name])
    assert holds(float(septic.overshoot[4]), reference["overshoot"])


def scipy_twin(name: str, orders: int) -> list[NDArray[np.float64]]:
    """The derivatives 0 ... 3 of the same family by SciPy, at times between the breaks."""
    rest = [(k, np.zeros(6)) for k in range(1, orders + 1)]
    match name:
        case "cubic_spline":
            f = CubicSpline(TIMES, POINTS, bc_type="clamped")
        case "quintic_spline" | "septic_spline":
            f = make_interp_spline(TIMES, POINTS, k=2 * orders + 1, bc_type=(rest, rest))
        case "quintic" | "classic_septic" | "cubic":
            f = BPoly.from_derivatives(TIMES, [[q, *np.zeros((orders, 6))] for q in POINTS])
        case _:
            x, rows = np.repeat(TIMES, [3, 1, 1, 3]), np.zeros((8, 6))
            rows[[0, 3, 4, 5]] = POINTS
            krogh = KroghInterpolator(x, rows)
            return [krogh(GRID) if k == 0 else krogh.derivative(GRID, k) for k in range(4)]
    return [f(GRID, nu=k) for k in range(4)]


# Never on a via, where the higher derivatives may step.
GRID = np.linspace(0.0, 9.0, 180, endpoint=False) + 0.0123


@pytest.mark.parametrize(
    ("name", "orders"),
    [
        ("septic", 2),
        ("cubic", 1),
        ("cubic_spline", 1),
        ("quintic", 2),
        ("quintic_spline", 2),
        ("classic_septic", 3),
        ("septic_spline", 3),
    ],
)
def test_all_joints_agree_with_scipy(name: str, orders: int) -> None:
    move = getattr(profiles, name)(POINTS, TIMES)
    for order, twin in enumerate(scipy_twin(name, orders)):
        # Rounding of three derivatives of a Krogh or Bernstein form over 9 s.
        assert np.abs(move(GRID, order) - twin).max() < 1e-10


def test_all_joints_of_the_blends_by_quadrature_of_their_acceleration() -> None:
    """Second way: the acceleration written down from Craig's recipe, integrated twice on a grid that meets
    its steps."""
    move = METHODS["trapezoidal"]
    speeds = np.diff(POINTS, axis=0) / np.array([[1.5], [4.0], [2.5]])
    steps = np.diff(np.vstack([np.zeros(6), speeds, np.zeros(6)]), axis=0)
    starts = np.array([0.0, 1.5, 5.5, 8.0])
    middles = (np.arange(9000) + 0.5) * 1e-3
    acceleration = sum(((middles >= s) & (middles < s + 1))[:, None] * dv for s, dv in zip(starts, steps, strict=True))
    v = np.cumsum(acceleration, axis=0) * 1e-3
    q = POINTS[0] + np.cumsum(v - acceleration * 5e-4, axis=0) * 1e-3
    ends = middles + 5e-4
    # Sums of 9,000 terms.
    assert np.abs(move(ends[:-1], order=1) - v[:-1]).max() < 1e-11
    assert np.abs(move(ends[:-1]) - q[:-1]).max() < 1e-11


def test_joints_of_poly_434_satisfy_its_14_equations_in_powers_of_time() -> None:
    """Second way: Fu, Gonzalez and Lee's system, written in powers of the time since each segment's start."""
    T = np.diff(TIMES)

    def row(segment: int, order: int, t: float) -> NDArray[np.float64]:
        out = np.zeros(14)
        first, size = (0, 5, 9)[segment], (5, 4, 5)[segment]
        for k in range(order, size):
            out[first + k] = np.prod(np.arange(k, k - order, -1)) * t ** (k - order)
        return out

    zero = np.zeros(6)
    system = [(row(0, 0, 0), POINTS[0]), (row(0, 0, T[0]), POINTS[1]), (row(1, 0, 0), POINTS[1])]
    system += [(row(1, 0, T[1]), POINTS[2]), (row(2, 0, 0), POINTS[2]), (row(2, 0, T[2]), POINTS[3])]
    for k in (1, 2):
        system += [(row(0, k, 0), zero), (row(2, k, T[2]), zero)]
        system += [(row(i, k, T[i]) - row(i + 1, k, 0), zero) for i in (0, 1)]
    c = np.linalg.solve(np.array([a for a, _ in system]), np.array([b for _, b in system]))
    powers = METHODS["poly_434"].power_coefficients()
    # The condition number of the system in powers of t is about 1e4.
    assert np.abs(powers[0, :5] - c[:5]).max() < 1e-11
    assert np.abs(powers[1, :4] - c[5:9]).max() < 1e-11
    assert np.abs(powers[2, :5] - c[9:]).max() < 1e-11
