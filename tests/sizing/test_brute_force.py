"""Verdicts and ranks of whole catalogues, with load cases, margins and gaps, against sums over samples."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from helpers.brute_force import TOO_CLOSE, lacks, stresses

import puma_septic as ps
from puma_septic.sizing._joint_selection import RANKS
from puma_septic.task import make_task, resolve_task

# Cells of a data sheet that are not filled in.
UNKNOWN = 0.15
MARGINS: dict[str, float] = {"all": 0.1, "motor torque": 0.25, "gearbox life": 0.0}


@cache
def load_cases() -> tuple[ps.sizing.LoadCase, ...]:
    """Two payloads with shares, a hold where the shoulder holds most, and an emergency stop of the base."""
    text = {
        "name": "cases",
        "points": [{"joints": [0.0, 0.6, -2.2, 0.0, 0.3, 0.0]}, {"joints": [1.5, 1.2, -2.6, 0.5, 0.8, 0.7]}],
        "times": [0.0, 0.9],
        "profiles": ["quintic"],
        "payload": {"mass": 2.5, "com": [0.0, 0.0, 0.1]},
        "conditions": {"cycles_per_minute": 20, "brake_at_rest": True},
        "load_cases": [
            {"name": "full", "share": 0.7},
            {"name": "empty", "payload": {"mass": 0.0}, "share": 0.3},
            {"name": "stretched", "kind": "worst pose"},
            {"name": "stop", "kind": "emergency stop", "time": 0.25},
        ],
    }
    return ps.sizing.load_cases_of(resolve_task(make_task(text)))


def random_catalogue(rng: np.random.Generator, n_motors: int, n_gears: int) -> ps.Catalogue:
    """Parts about the size that the arm needs, each cell unknown with a probability of 15 %."""

    def values(**typical: float) -> dict[str, float]:
        return {
            name: np.nan if rng.random() < UNKNOWN else float(value * 10 ** rng.uniform(-0.7, 0.7))
            for name, value in typical.items()
        }

    return ps.Catalogue(
        motors=[random_motor(rng, f"M{k}", values) for k in range(n_motors)],
        gearboxes=[random_gearbox(rng, f"G{k}", values) for k in range(n_gears)],
        drives=[ps.Drive(**values(bus_voltage=40.0)) for _ in range(n_motors)],
    )


def random_motor(rng: np.random.Generator, name: str, values: Any) -> ps.Motor:
    given = values(
        rotor_inertia=1e-4, viscous_friction=1e-4, coulomb_friction=0.01, torque_constant=0.1, resistance=1.0,
        peak_torque=1.2, continuous_torque=0.5, max_speed=300.0, peak_power=200.0, max_winding_celsius=150.0, mass=1.0,
        cost=100.0,
    )  # fmt: skip
    curves = {}
    if rng.random() < 0.4:
        peak, speed = 1.5 * 10 ** rng.uniform(-0.5, 0.5), 400 * 10 ** rng.uniform(-0.4, 0.4)
        curves = {"peak_curve": [[0.0, peak], [0.6 * speed, peak], [speed, 0.3 * peak]]}
        if np.isnan(given["continuous_torque"]):
            curves["continuous_curve"] = [[0.0, 0.5 * peak], [speed, 0.2 * peak]]
    nodes = int(rng.integers(0, 3))
    thermal = {"thermal_resistances": [1.0, 2.0][:nodes], "thermal_time_constants": [20.0, 600.0][:nodes]}
    return ps.Motor(name=name, **given, **curves, **thermal)


def random_gearbox(rng: np.random.Generator, name: str, values: Any) -> ps.Gearbox:
    shares = {
        key: np.nan if rng.random() < UNKNOWN else float(rng.uniform(least, 1.0))
        for key, least in (("efficiency", 0.5), ("backward_efficiency", 0.0))
    }
    return ps.Gearbox(
        name=name,
        ratio=float(rng.choice([-1.0, 1.0]) * rng.uniform(30.0, 160.0)),
        **shares,
        **values(
            inertia=2e-5, no_load_torque=0.01, rated_torque=40.0, rated_speed=200.0, rated_life_hours=7000.0,
            max_average_torque=60.0, max_repeated_torque=100.0, max_momentary_torque=200.0,
            max_average_input_speed=150.0, max_input_speed=300.0, mass=1.0, cost=100.0,
        ),
    )  # fmt: skip


def conditions(rng: np.random.Generator) -> ps.sizing.Conditions:
    """Supply, life and the ratio of inertias in half the cases each."""
    typical = {
        "ambient_celsius": 35.0, "bus_voltage": 60.0, "peak_current": 30.0, "continuous_current": 10.0,
        "peak_power": 900.0, "continuous_power": 200.0, "peak_regenerated_power": 300.0, "required_life_hours": 3000.0,
        "max_inertia_ratio": 30.0, "momentary_torque": 80.0,
    }  # fmt: skip
    asked = {name: value for name, value in typical.items() if rng.random() < 0.5}
    return ps.sizing.Conditions(**asked, margins=MARGINS)


def compared(seed: int, n_motors: int, n_gears: int, joints: range, keep: int | None) -> tuple[int, int, int]:
    """Verdicts, those too close to a limit to be told by samples, and differences."""
    rng = np.random.default_rng(seed)
    cases, catalogue, asked = load_cases(), random_catalogue(rng, n_motors, n_gears), conditions(rng)
    rank = RANKS[seed % len(RANKS)]
    selection = ps.size(cases, catalogue=catalogue, conditions=asked, keep=keep, rank=rank)
    total = close = different = 0
    for j in joints:
        one = selection.joints[j]
        place = (one.places or ())[j]
        stress = stresses(cases, j, catalogue, place, MARGINS)
        near = np.abs(stress - 1) < TOO_CLOSE
        passes = stress <= 1
        wrong = ~near & (
            (one.is_feasible != (passes & ~lacks(catalogue))) | (one.is_undecided != (passes & lacks(catalogue)))
        )
        total, close, different = total + len(near), close + int(near.sum()), different + int(wrong.sum())
        if keep is None:
            assert_ranked(one.kept, catalogue, stress, rank)
    return total, close, different


def assert_ranked(
    kept: tuple[ps.sizing.Candidate, ...], catalogue: ps.Catalogue, stress: np.ndarray, rank: str
) -> None:
    """By mass or cost, unknown ones last, then by use; and the use is that of the samples."""
    number = {
        (catalogue.motors[i].name, catalogue.gearboxes[g].name): k
        for k, (i, g) in enumerate(zip(catalogue.motor_index, catalogue.gearbox_index, strict=True))
    }
    rows = [number[c.motor, c.gearbox] for c in kept]
    values = {"mass": catalogue.masses(), "cost": catalogue.costs(), "margin": np.zeros(catalogue.n_pairs)}[rank]
    keys = [(np.nan_to_num(values[k], nan=np.inf), stress[k]) for k in rows]
    for (first, use), (second, more) in pairwise(keys):
        assert first < second or (first == second and use <= more * (1 + TOO_CLOSE))
    for candidate, k in zip(kept, rows, strict=True):
        assert candidate.stress == pytest.approx(stress[k], rel=TOO_CLOSE)


@pytest.mark.slow
def test_a_small_catalogue_is_judged_as_by_samples() -> None:
    total, close, different = compared(1, 8, 6, range(0, 6, 2), None)
    assert (total, different) == (144, 0)
    assert close < 0.05 * total


@pytest.mark.study
@pytest.mark.parametrize("seed", range(10))
def test_ten_thousand_verdicts(seed: int) -> None:
    """14,016 verdicts of one cycle without margins were compared once, without a difference; these have all that."""
    total, close, different = compared(100 + seed, 14, 12, range(6), None if seed < 2 else 1)
    assert (total, different) == (14 * 12 * 6, 0)
    assert close < 0.05 * total
