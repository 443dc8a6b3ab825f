"""A simulated second of the PUMA 560 under feed-forward and PD at 1 kHz, against plain loops in Python.

The arm has its rotors and viscous friction; dry friction, which each simulator makes smooth in a way of its own, is
left out, so that all three solve the same equations. All integrate by RK4 at 0.5 ms; the torque is held over 1 ms.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from time import perf_counter

import numpy as np
import pinocchio as pin

import puma_septic as ps
from puma_septic.simulation import Gains
from puma_septic.validation import Array

ROUNDS = 5
DURATION, SETTLE, RATE, PARTS = 1.0, 0.0, 1000.0, 2
POINTS = [[0.0] * 6, [0.8, -0.5, 0.6, 0.5, 0.5, 1.0]]


def run() -> list[tuple[str, ...]]:
    """Time all in turn, round by round, and hold the end of each to a run at an eighth of the step."""
    robot, move = arm(), ps.quintic_segments(POINTS, [0.0, DURATION])
    exact = ps.simulate(robot, move, controller=controller(robot), settle=SETTLE, step=1 / RATE / PARTS / 8).q[-1]
    contenders: dict[str, Callable[[], Array]] = {
        "puma_septic: simulate": lambda: simulated(robot, [move])[0],
        "pin.aba and RK4 in a Python loop": plain_loop(robot, move),
    }
    if find_spec("mujoco") is not None:
        contenders["MuJoCo: mj_step with RK4, controller in Python"] = mujoco_loop(robot, move)
    contenders["puma_septic: 64 at once, each"] = lambda: simulated(robot, [move] * 64)[0]
    seconds: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(ROUNDS):
        for name, contender in contenders.items():
            start = perf_counter()
            contender()
            share = 64 if "64" in name else 1
            seconds[name].append((perf_counter() - start) / share)
    first = next(iter(contenders))
    rows = [("one simulated second", "simulated seconds per second", "times slower", "off at the end")]
    for name, values in seconds.items():
        slower = np.median(np.array(values) / seconds[first])
        off = np.abs(contenders[name]() - exact).max()
        rows.append((name, f"{DURATION / min(values):.1f}", f"{slower:.2f}", f"{off:.1e} rad"))
    if find_spec("mujoco") is None:
        rows.append(("MuJoCo is not installed (extra: mujoco)", "", "", ""))
    return rows


def arm() -> ps.Robot:
    """The PUMA without dry friction and torque limits."""
    puma = ps.load_robot()
    drives = [
        ps.Actuator(
            gear_ratio=one.gear_ratio,
            rotor_inertia=one.rotor_inertia,
            viscous_friction=one.viscous_friction,
            coulomb_friction=[0.0, 0.0],
        )
        for one in puma.actuators
    ]
    return puma.with_actuators(drives).with_limits(effort=np.nan)


def controller(robot: ps.Robot) -> ps.Controller:
    """The usual gains, by number, so that all have the same."""
    usual = ps.Controller(law="feedforward").gains_for(robot, np.zeros(6))
    return ps.Controller(law="feedforward", rate=RATE, gains=Gains(*usual))


def simulated(robot: ps.Robot, moves: list[ps.Trajectory]) -> list[Array]:
    made = ps.simulation.simulate_all(robot, moves, controller=controller(robot), settle=SETTLE, step=1 / RATE / PARTS)
    return [one.q[-1] for one in made]


def planned(robot: ps.Robot, move: ps.Trajectory) -> tuple[Array, Array, Array]:
    """Position, velocity and torque at each control period."""
    t = np.arange(round(DURATION * RATE)) / RATE
    q, v, a = (move(t, order) for order in range(3))
    return q, v, ps.inverse_dynamics(robot, q, v, a)


def plain_loop(robot: ps.Robot, move: ps.Trajectory) -> Callable[[], Array]:
    """As one writes it with Pinocchio."""
    model, data = robot.model, robot.model.createData()
    kp, kd, _ = controller(robot).gains or Gains(*np.zeros((3, 6)))
    viscous, h = robot.viscous_friction, 1 / RATE / PARTS

    def slope(q: Array, v: Array, tau: Array) -> Array:
        return np.array(pin.aba(model, data, q, v, tau - viscous * v))

    def loop() -> Array:
        want_q, want_v, torque = planned(robot, move)
        q, v = want_q[0].copy(), want_v[0].copy()
        for k in range(len(torque)):
            tau = torque[k] + kp * (want_q[k] - q) + kd * (want_v[k] - v)
            for _ in range(PARTS):
                a1 = slope(q, v, tau)
                v2 = v + h / 2 * a1
                a2 = slope(q + h / 2 * v, v2, tau)
                v3 = v + h / 2 * a2
                a3 = slope(q + h / 2 * v2, v3, tau)
                v4 = v + h * a3
                a4 = slope(q + h * v3, v4, tau)
                q = q + h / 6 * (v + 2 * v2 + 2 * v3 + v4)
                v = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        return q

    return loop


def mujoco_loop(robot: ps.Robot, move: ps.Trajectory) -> Callable[[], Array]:
    """The same arm in MuJoCo, whose compiler asks link inertias for the triangle inequality: see `mujoco_model`."""
    import mujoco

    model = mujoco_model(robot)
    model.opt.timestep = 1 / RATE / PARTS
    kp, kd, _ = controller(robot).gains or Gains(*np.zeros((3, 6)))

    def loop() -> Array:
        data = mujoco.MjData(model)
        want_q, want_v, torque = planned(robot, move)
        data.qpos, data.qvel = want_q[0], want_v[0]
        for k in range(len(torque)):
            data.qfrc_applied[:] = torque[k] + kp * (want_q[k] - data.qpos) + kd * (want_v[k] - data.qvel)
            for _ in range(PARTS):
                mujoco.mj_step(model, data)
        return np.array(data.qpos)

    return loop


def mujoco_model(robot: ps.Robot):  # type: ignore[no-untyped-def]
    """An MJCF model of the arm's joints and inertias, compiled, then given the inertias that its compiler refuses.

    Two links of the PUMA's published data are no bodies: link 1 has an inertia about its axis and no mass, which goes
    into its rotor's, where it does the same; link 3 breaks the triangle inequality (0.0125 + 0.066 < 0.086 kg m^2). It
    is compiled as a ball, and its principal moments are written into the compiled model.
    """
    import mujoco

    parts, closing = [], 0
    gravity = " ".join(map(str, robot.model.gravity.linear))
    for j, name in enumerate(robot.joint_names):
        k = robot.model.getJointId(name)
        place, body = robot.model.jointPlacements[k], robot.model.inertias[k]
        x, y, z, w = pin.Quaternion(place.rotation).coeffs()
        moments = np.linalg.eigvalsh(body.inertia)
        is_bodiless = body.mass == 0
        armature = robot.armature[j] + (body.inertia[2, 2] if is_bodiless else 0.0)
        ball = " ".join([str(max(float(moments.max()), 1e-9))] * 3)
        parts.append(
            f'<body pos="{" ".join(map(str, place.translation))}" quat="{w} {x} {y} {z}">'
            f'<joint name="{name}" axis="0 0 1" armature="{armature}" damping="{robot.viscous_friction[j]}"/>'
            f'<inertial mass="{1e-9 if is_bodiless else body.mass}" pos="{" ".join(map(str, body.lever))}"'
            f' diaginertia="{"1e-12 1e-12 1e-12" if is_bodiless else ball}"/>'
        )
        closing += 1
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option gravity="{gravity}" integrator="RK4"><flag contact="disable"/></option>'
        f"<worldbody>{''.join(parts)}{'</body>' * closing}</worldbody></mujoco>"
    )
    for j, name in enumerate(robot.joint_names):
        body = robot.model.inertias[robot.model.getJointId(name)]
        if body.mass:
            moments, axes = np.linalg.eigh(body.inertia)
            axes[:, 2] *= np.sign(np.linalg.det(axes))
            x, y, z, w = pin.Quaternion(axes).coeffs()
            model.body_inertia[j + 1], model.body_iquat[j + 1] = moments, [w, x, y, z]
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model
