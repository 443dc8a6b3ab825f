"""The steps of a cycle: what each is, what it takes, and whether two of them join."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from puma_septic.document import card, one_line
from puma_septic.dynamics import check_inertia, inverse_dynamics, joint_wrenches, mass_matrix
from puma_septic.errors import InputError
from puma_septic.kinematics import jacobian
from puma_septic.motion import Motion, Rest, compute_motion
from puma_septic.piecewise import Piecewise
from puma_septic.robot import Actuator, Payload, Robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array, checked_flag, checked_kind, checked_number

__all__ = [
    "Dwell",
    "Stretch",
    "check_join",
    "check_steps",
    "gaps",
    "gravity",
    "inertia",
    "mass_matrices",
    "moved",
    "stretch",
    "tool_travel",
    "wrenches",
]

# Steps join where position and velocity differ by less than this part of their largest values (at least 1 rad and
# 1 rad/s): some thousand roundings of a polynomial's end value.
_JOINED: Final = 1e-9


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Dwell:
    """Rest at the point where the step before ends (of a first step: where the next begins).

    Parameters
    ----------
    duration : float
        s.
    holding_brake : bool
        A brake at the motor holds the joints: the motors take no torque, the gears still carry the load.
    payload : Payload, optional
        What is held meanwhile; None: what the motion before carries (of a first step: the one after). An empty hand is
        ``Payload(mass=0.0)``.
    """

    duration: float = field(kw_only=False)
    holding_brake: bool = False
    payload: Payload | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "duration", checked_number("dwell duration", self.duration, unit="s", above=0.0))
        object.__setattr__(self, "holding_brake", checked_flag("holding_brake", self.holding_brake))
        if self.payload is not None:
            checked_kind("payload", self.payload, Payload)

    def __repr__(self) -> str:
        return one_line("Dwell", self._facts())

    def _repr_html_(self) -> str:
        return card("Dwell", self._facts())

    def _facts(self) -> dict[str, object]:
        held = {} if self.payload is None else {"payload": f"{self.payload.mass:g} kg"}
        return {"duration": f"{self.duration:g} s", "brake": "on" if self.holding_brake else "off", **held}


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Stretch:
    """One step of a cycle, from time 0: the arm, and what it does.

    `load` is the torque without drives, `direction` the way of each joint on each interval of its breaks, 0 at rest;
    `resolution` is the travel of each joint that does not count as motion.
    """

    robot: Robot
    position: Piecewise
    torque: Piecewise
    load: Piecewise
    direction: Array
    resolution: Array
    braked: bool
    label: str


def check_steps(steps: tuple[Motion | Dwell, ...]) -> None:
    """Raise an InputError unless these are steps of one arm, at least one of them a motion.

    Raises a ModelError where the torque of a joint is not known: a cycle is made to hold drives against it.
    """
    for k, step in enumerate(steps):
        if not isinstance(step, (Motion, Dwell)):
            raise InputError(f"steps[{k}]: expected a Motion or a Dwell, got {type(step).__name__}")
    motions = [(k, step) for k, step in enumerate(steps) if isinstance(step, Motion)]
    if not motions:
        raise InputError("a cycle needs at least one motion")
    first, robot = motions[0][0], motions[0][1].robot
    check_inertia(robot)
    for k, motion in motions[1:]:
        if motion.robot.joint_names != robot.joint_names:
            raise InputError(
                f"steps[{k}] moves joints {', '.join(motion.robot.joint_names)},"
                f" but steps[{first}] moves {', '.join(robot.joint_names)}"
            )
        if not _same_drives(robot, motion.robot):
            raise InputError(f"steps[{k}] has other drives (rotors, friction) than steps[{first}]: one arm per cycle")


def _same_drives(one: Robot, other: Robot) -> bool:
    arrays = all(np.array_equal(getattr(one, name), getattr(other, name)) for name in ("armature", "transmission"))
    return arrays and all(a.known.is_same(b.known) for a, b in zip(one.friction, other.friction, strict=True))


def stretch(steps: tuple[Motion | Dwell, ...], k: int) -> Stretch:
    """Step k from time 0 on; its load is that of the same arm without drives."""
    step = steps[k]
    if isinstance(step, Motion):
        trajectory = step.trajectory
        bare = compute_motion(_without_drives(step.robot), trajectory)
        return Stretch(
            robot=step.robot,
            position=trajectory.position.from_zero(),
            torque=step.torque.from_zero(),
            load=bare.torque.from_zero(),
            direction=bare.direction.coefficients[0],
            resolution=np.asarray(trajectory.resolution),
            braked=False,
            label=f"steps[{k}] ({trajectory.profile}, {trajectory.duration:g} s)",
        )
    return _dwell_stretch(steps, k, step)


def _dwell_stretch(steps: tuple[Motion | Dwell, ...], k: int, dwell: Dwell) -> Stretch:
    """Held where the motion before ends, or the one after begins."""
    rest = _rest(steps, k, dwell)
    return Stretch(
        robot=rest.robot,
        position=rest.position,
        torque=rest.torque,
        load=rest.load,
        direction=np.zeros((1, rest.robot.n_joints)),
        resolution=np.zeros(rest.robot.n_joints),
        braked=dwell.holding_brake,
        label=f"steps[{k}] (dwell, {dwell.duration:g} s)",
    )


def _rest(steps: tuple[Motion | Dwell, ...], k: int, dwell: Dwell) -> Rest:
    before = [step for step in steps[:k] if isinstance(step, Motion)]
    motion = before[-1] if before else next(step for step in steps if isinstance(step, Motion))
    robot = motion.robot if dwell.payload is None else motion.robot.with_payload(dwell.payload)
    q = motion.trajectory(motion.trajectory.breaks[-1 if before else 0])
    return Rest(robot=robot, q=q, duration=dwell.duration, is_braked=dwell.holding_brake)


def moved(steps: tuple[Motion | Dwell, ...], k: int) -> Motion:
    """Step k as a motion from time 0 on, a rest too."""
    step = steps[k]
    if isinstance(step, Motion):
        return step
    rest = _rest(steps, k, step)
    ends = np.array([0.0, step.duration])
    held = Trajectory(position=rest.position, points=np.stack([rest.q, rest.q]), times=ends, profile="dwell")
    motion = compute_motion(rest.robot, held)
    return replace(motion, torque=motion.torque * 0.0) if rest.is_braked else motion


def _without_drives(robot: Robot) -> Robot:
    return robot.with_actuators((Actuator(),) * robot.n_joints)


def inertia(stretch: Stretch) -> Piecewise:
    """``M_jj(q)`` without rotors along a step."""
    bare = _without_drives(stretch.robot)

    def diagonal(q: Array) -> Array:
        return np.asarray(np.diagonal(mass_matrix(bare, q), axis1=1, axis2=2))

    return stretch.position.mapped(diagonal)


def wrenches(stretch: Stretch) -> Piecewise:
    """Force and moment that each joint passes on along a step, see `joint_wrenches`: 6 components per joint."""
    n = stretch.robot.n_joints

    def passed_on(state: Array) -> Array:
        q, v, a = (state[:, k * n : (k + 1) * n] for k in range(3))
        return joint_wrenches(stretch.robot, q, v, a).reshape(len(state), 6 * n)

    return stretch.position.with_derivatives(2).mapped(passed_on)


def mass_matrices(stretch: Stretch) -> Piecewise:
    """``M(q)`` without rotors along a step, row by row."""
    bare = _without_drives(stretch.robot)
    return stretch.position.mapped(lambda q: mass_matrix(bare, q).reshape(len(q), -1))


def tool_travel(stretch: Stretch) -> Piecewise:
    """The linear part of the tool's Jacobian along a step, in world axes: 3 components per joint."""

    def linear(q: Array) -> Array:
        return np.asarray(jacobian(stretch.robot, q)[:, :3]).transpose(0, 2, 1).reshape(len(q), -1)

    return stretch.position.mapped(linear)


def gravity(stretch: Stretch) -> Piecewise:
    """Torque that holds the arm at rest along a step, with payload and wrench."""

    def held(q: Array) -> Array:
        return inverse_dynamics(stretch.robot, q, np.zeros_like(q), np.zeros_like(q), friction=False)

    return stretch.position.mapped(held)


def check_join(one: Stretch, other: Stretch) -> None:
    """Raise an InputError with both ends where the second step does not go on from where the first ends."""
    differences = gaps(one, other, np.zeros(one.robot.n_joints, dtype=bool))
    if differences:
        raise InputError(f"{one.label} and {other.label} do not join: {'; '.join(differences)}")


def gaps(one: Stretch, other: Stretch, turns: NDArray[np.bool_]) -> list[str]:
    """Per joint whose position or velocity differs between the end of one step and the start of the other, both.

    Where a joint turns without end, whole turns make no difference.
    """
    turned = _gap_lines(one, other, "position", turns)
    return turned + _gap_lines(one, other, "velocity", np.zeros_like(turns))


def _gap_lines(one: Stretch, other: Stretch, what: str, turns: NDArray[np.bool_]) -> list[str]:
    f, g = one.position, other.position
    if what == "velocity":
        f, g = f.derivative(), g.derivative()
    end, start = f.ends()[1][-1], g.ends()[0][0]
    gap = start - end
    gap = np.where(turns, np.remainder(gap + np.pi, 2 * np.pi) - np.pi, gap)
    reach = np.maximum(*(h.bounds().max(axis=0) for h in (f, g)))
    lines = []
    for j in np.flatnonzero(~(np.abs(gap) <= _JOINED * np.maximum(1.0, reach))):
        unit = ("m" if one.robot.is_prismatic[j] else "rad") + ("/s" if what == "velocity" else "")
        name = one.robot.joint_names[j]
        lines.append(f"joint {name!r} ends at {what} {end[j]:.9g} {unit}, then starts at {start[j]:.9g} {unit}")
    return lines
