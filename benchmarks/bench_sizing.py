"""Selection: 100,000 pairs of motor and gearbox at six joints, against assessing each pair anew.

Assessing all 600,000 in full would take hours; a random sample is timed and its mean time multiplied. Then the same
pairs in five load cases, and the memory of 1.2 million pairs, in a process of its own.
"""

from __future__ import annotations

import resource
import subprocess
import sys
from time import perf_counter

import numpy as np

import puma_septic as ps
from puma_septic.limit_check import LimitCheck
from puma_septic.paper import PAPER
from puma_septic.sizing._checks import assess_joint

MOTORS, GEARBOXES, KEEP = 500, 200, 3
# Pairs per joint that are assessed in full for comparison.
SAMPLE = 25
# Table 1 and times of Raji, Asaolu, Akano, rad and s.
POINTS, TIMES = PAPER.table_1, PAPER.times


def run() -> list[tuple[str, ...]]:
    """Time the selection, then the sample, whose verdicts must be the same."""
    cycle, catalogue = paper_cycle(), made_up_catalogue()
    loads = [ps.sizing.joint_load(cycle, j) for j in range(6)]  # both need them
    start = perf_counter()
    selection = ps.size(cycle, catalogue=catalogue, keep=KEEP)
    chosen = perf_counter() - start
    rng = np.random.default_rng(4)
    agree, start = 0, perf_counter()
    for j, load in enumerate(loads):
        for k in rng.choice(catalogue.n_pairs, SAMPLE, replace=False).tolist():
            agree += in_full(load, catalogue.drivetrain(k, j)) == selection.joints[j].is_feasible[k]
    each = (perf_counter() - start) / (6 * SAMPLE)
    total = 6 * catalogue.n_pairs
    strong = sum(int(one.is_feasible.sum()) for one in selection.joints)
    polished = sum(one.n_assessed for one in selection.joints)
    return [
        (f"{total:,} pairs ({catalogue.n_pairs:,} at 6 joints)", "time", "per pair", "times slower", "verdicts"),
        ("selection", f"{chosen:.1f} s", f"{chosen / total * 1e6:.1f} us", "1", f"{strong:,} fit, {polished} in full"),
        (
            f"each pair in full, from {6 * SAMPLE}", f"{each * total:.0f} s", f"{each * 1e6:.0f} us",
            f"{each * total / chosen:.0f}", f"{agree} of {6 * SAMPLE} equal",
        ),
        *run_cases(catalogue, chosen),
        run_memory(),
    ]  # fmt: skip


def run_cases(catalogue: ps.Catalogue, one: float) -> list[tuple[str, ...]]:
    """The same pairs in five load cases; goal: three times as long as one."""
    cases = load_cases()
    start = perf_counter()
    selection = ps.size(cases, catalogue=catalogue, keep=KEEP)
    took = perf_counter() - start
    strong = sum(int(joint.is_feasible.sum()) for joint in selection.joints)
    total = 6 * catalogue.n_pairs
    return [
        (
            f"{len(cases)} load cases", f"{took:.1f} s", f"{took / total * 1e6:.1f} us", f"{took / one:.2f}",
            f"{strong:,} fit",
        )
    ]  # fmt: skip


def load_cases() -> list[ps.sizing.LoadCase]:
    """Three payloads, a faster cycle, and one that waits."""
    robot = ps.load_robot()

    def case(mass: float, stretch: float, dwell: float) -> ps.sizing.LoadCase:
        there = ps.compute_motion(
            robot.with_payload(ps.Payload(mass=mass)), ps.septic(POINTS, np.multiply(TIMES, stretch))
        )
        cycle = ps.cycle.with_return(there, dwell=dwell, robot_back=robot)
        return ps.sizing.LoadCase(name=f"{mass} kg, {stretch} times, {dwell} s", cycle=cycle)

    return [
        case(*given) for given in ((2.5, 1.0, 1.0), (0.0, 1.0, 1.0), (1.25, 1.0, 0.5), (2.5, 0.8, 1.0), (2.5, 1.0, 5.0))
    ]


def run_memory() -> tuple[str, ...]:
    """Largest memory of a process that selects from 1.2 million pairs at six joints; goal: 1 GiB."""
    done = subprocess.run([sys.executable, __file__, "memory"], capture_output=True, text=True, check=True)
    seconds, mebibytes = done.stdout.split()
    return ("1,200,000 pairs at 6 joints", f"{float(seconds):.0f} s", "", "", f"{float(mebibytes):.0f} MiB at most")


def memory() -> None:
    """Print how long 1.2 million pairs at six joints take, s, and the largest memory of this process, MiB."""
    start = perf_counter()
    ps.size(paper_cycle(), catalogue=made_up_catalogue(1200, 1000), keep=KEEP)
    print(perf_counter() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def paper_cycle() -> ps.Cycle:
    """The paper's move with 2.5 kg there and nothing back."""
    robot = ps.load_robot()
    there = ps.compute_motion(robot.with_payload(ps.Payload(mass=2.5)), ps.septic(POINTS, TIMES))
    return ps.cycle.with_return(there, dwell=1.0, robot_back=robot)


def made_up_catalogue(motors: int = MOTORS, gearboxes: int = GEARBOXES) -> ps.Catalogue:
    """Parts of random sizes, whose values grow with their size as those of real ones do; full data sheets."""
    rng = np.random.default_rng(560)
    return ps.Catalogue(
        motors=[_motor(f"M{k}", *rng.uniform(0.7, 1.4, 4), size) for k, size in enumerate(rng.uniform(-2, 1, motors))],
        gearboxes=[
            _gearbox(f"G{k}", *rng.uniform(0.7, 1.4, 3), size) for k, size in enumerate(rng.uniform(0, 2, gearboxes))
        ],
    )


def _motor(name: str, light: float, strong: float, fast: float, cool: float, size: float) -> ps.Motor:
    torque, speed = strong * 10**size, 500 * fast * 10 ** (-size / 8)
    return ps.Motor(
        name=name,
        rotor_inertia=1e-4 * light * 10 ** (1.4 * size),
        viscous_friction=1e-5 * torque,
        coulomb_friction=0.02 * torque,
        torque_constant=0.15 * 10 ** (size / 3),
        resistance=0.8 * 10 ** (-size / 2),
        peak_torque=3 * torque,
        peak_curve=[[0.0, 3 * torque], [0.6 * speed, 3 * torque], [speed, 1.2 * torque]],
        continuous_curve=[[0.0, torque], [speed, 0.6 * torque]],
        max_speed=speed,
        max_winding_celsius=130.0,
        thermal_resistances=[0.7 * cool * 10 ** (-0.7 * size)],
        thermal_time_constants=[300.0 * light],
        mass=1.5 * light * 10 ** (0.8 * size),
    )


def _gearbox(name: str, light: float, strong: float, slow: float, size: float) -> ps.Gearbox:
    torque = 5 * strong * 10**size
    return ps.Gearbox(
        name=name,
        ratio=90.0 * slow**1.5,
        efficiency=0.75,
        backward_efficiency=0.68,
        inertia=4e-6 * light * 10**size,
        no_load_torque=5e-4 * torque,
        rated_torque=torque,
        rated_speed=200.0,
        rated_life_hours=10_000.0,
        max_average_torque=1.3 * torque,
        max_repeated_torque=2.2 * torque,
        max_momentary_torque=4.5 * torque,
        max_average_input_speed=360.0,
        max_input_speed=700.0,
        mass=0.3 * light * 10 ** (0.6 * size),
    )


def in_full(load: ps.sizing.JointLoad, train: ps.Drivetrain) -> bool:
    """Whether a pair is strong enough, by the code that sizes any drive train."""
    demands = ps.sizing.Demands(load=load, train=train, motor=ps.sizing.motor_load(load, train))
    checks = [outcome for outcome in assess_joint(demands) if isinstance(outcome, LimitCheck)]
    return not any(check.is_violated for check in checks if check.kind != "rule of thumb")


if __name__ == "__main__":
    if sys.argv[1:] == ["memory"]:
        memory()
        sys.exit()
    for row in run():
        print("  ".join(f"{cell:36}" for cell in row))
