"""From a task with a cycle to the motions and rests that it is made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal, final

import numpy as np

from puma_septic import paths, profiles
from puma_septic.cycle import Cycle, CycleAssessment, Dwell, assess_cycle, way_back
from puma_septic.document import card, one_line
from puma_septic.errors import InputError, NoSolution
from puma_septic.kinematics import forward_kinematics, inverse_kinematics
from puma_septic.motion import Motion, compute_motion
from puma_septic.robot import Payload, Robot
from puma_septic.task._branches import Branch, Posed, Waypoint, branches_through, ranked_branches
from puma_septic.task._legs import Leg, Place, places_of, set_back, visited
from puma_septic.task._scene import body, named, solve_points, tool_limits
from puma_septic.task._schema import Task
from puma_septic.task._steps import DwellStep, GripStep, Move
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array

__all__ = ["ResolvedCycle", "resolve_cycle"]

# Of a joint move that names none: at rest at both ends, through several points without a stop.
_PROFILE: Final = "quintic_spline"
_LAW: Final = "quintic_segments"
_TURN: Final = 2 * np.pi
_SLACK: Final = 1e-9
Constraint = Literal["pose", "position"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ResolvedCycle:
    """A task's cycle with its robot loaded, its poses solved and its motions made; see `resolve_cycle`.

    Attributes
    ----------
    task : Task
    robot : Robot
        With the task's tool, limits, wrench and the payload that it carries all the time.
    branch : Branch
        The way through the places, of which `places` are the names.
    places : tuple of str
    cycle : Cycle
    names : tuple of str
        Of the steps of the cycle: "home to pick", "rest at pick" ...
    stops : tuple of str
        Where the steps begin, and the last one ends.
    """

    task: Task
    robot: Robot
    branch: Branch
    places: tuple[str, ...]
    cycle: Cycle
    names: tuple[str, ...]
    stops: tuple[str, ...]

    @property
    def trajectory(self) -> Trajectory:
        """The whole cycle as one trajectory, which `write_joint_trajectory` takes."""
        return self.cycle.trajectory

    def __repr__(self) -> str:
        return one_line("ResolvedCycle", self._facts())

    def _repr_html_(self) -> str:
        return card("ResolvedCycle", self._facts())

    def _facts(self) -> dict[str, object]:
        return {
            "task": self.task.name,
            "robot": self.robot.name,
            "steps": ", ".join(self.names),
            "branch": self.branch.configuration,
            "duration": f"{self.cycle.duration:g} s",
        }

    def assess(self) -> CycleAssessment:
        """Each motion held against the limits with what it carries.

        Returns
        -------
        CycleAssessment
        """
        return assess_cycle(self.cycle, names=self.names, tool_limits=tool_limits(self.task), floor=self.task.floor)


def resolve_cycle(task: Task) -> ResolvedCycle:
    """Load the robot, solve the poses, choose the branch, and make the motions of a task's cycle.

    The branch is held at every pose and along every line; "auto" takes the one that a task of one motion would, or the
    next in which every line can be followed. A point that is visited again by a joint move is taken as it was before.

    Parameters
    ----------
    task : Task
        With a cycle.

    Returns
    -------
    ResolvedCycle

    Raises
    ------
    InputError
        Naming file and step: a profile that cannot be made, steps that do not join, a cycle that is repeated but does
        not end where it begins.
    NoSolution
        For a pose or a path out of reach, naming the step.
    ModelError
        For a robot description that cannot be used.

    Examples
    --------
    >>> import puma_septic as ps
    >>> resolved = ps.resolve_cycle(ps.load_task("paper-straight"))
    >>> resolved.names
    ('lift', 'unload', 'place', 'back: place', 'back: unload', 'back: lift')
    """
    if not isinstance(task, Task) or not task.cycle:
        raise InputError("resolve_cycle takes a task with a cycle; resolve_task takes one with times and profiles")
    robot, points = solve_points(task)
    legs = places_of(task)
    scene = _Scene.of(task, robot, points, visited(task, legs))
    branches = branches_through(robot, scene.waypoints)
    with named(task, "branch"):
        ranked = ranked_branches(branches, task.branch, task.floor)
    first: NoSolution | None = None
    for branch in ranked:
        try:
            return _resolved(scene, legs, branch)
        except NoSolution as error:
            first = first or error
    raise first or InputError("a task has at least one branch")


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Scene:
    """The robot and the places of a cycle: their poses, and what is known of the joints there."""

    task: Task
    robot: Robot
    places: tuple[Place, ...]
    poses: dict[str, Array]
    waypoints: tuple[Waypoint, ...]

    @classmethod
    def of(cls, task: Task, robot: Robot, points: Sequence[Waypoint], places: tuple[Place, ...]) -> _Scene:
        names = [str(point.name) for point in task.points]
        known = dict(zip(names, points, strict=True))
        poses = {
            name: point.T_world_tool if isinstance(point, Posed) else forward_kinematics(robot, point)
            for name, point in known.items()
        }
        waypoints: list[Waypoint] = []
        for place in places:
            if place.before:
                pose = set_back(poses[place.point], place)
                constrain = next(point.constrain for point in task.points if point.name == place.point)
                constrain = constrain if isinstance(known[place.point], Posed) else "pose"
                with named(task, str(place)):
                    solutions = inverse_kinematics(robot, pose, constrain=constrain)
                waypoints.append(Posed(T_world_tool=pose, solutions=solutions, constrain=constrain))
            else:
                waypoints.append(known[place.point])
        return cls(task=task, robot=robot, places=places, poses=poses, waypoints=tuple(waypoints))

    def is_free(self, place: Place) -> bool:
        """Whether its point leaves the tool's orientation open, as those of arms with fewer than six axes do."""
        point = next(point for point in self.task.points if point.name == place.point)
        return point.is_posed and point.constrain != "pose"

    def pose(self, place: Place) -> Array:
        """The tool's pose there."""
        return set_back(self.poses[place.point], place)


@final
@dataclass(eq=False, kw_only=True)
class _Arm:
    """Where the arm is while its motions are made, and what it has done; local to `_resolved`."""

    scene: _Scene
    rows: dict[Place, Array]
    q: Array
    robot: Robot
    postures: dict[Place, Array] = field(default_factory=dict)
    steps: list[Motion | Dwell] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    stops: list[str] = field(default_factory=list)
    turns: Array = field(default_factory=lambda: np.zeros(0))
    returned: int = 0

    def go(self, leg: Leg) -> None:
        """Add the motion of a leg."""
        trajectory = self._joint(leg) if leg.kind == "joint" else self._straight(leg)
        self.q, end = trajectory(trajectory.breaks[-1]), leg.places[-1]
        self.postures.setdefault(end, self.q)
        if leg.kind != "joint":
            self.turns = np.where(self.robot.is_prismatic, 0.0, _TURN * np.rint((self.q - self.rows[end]) / _TURN))
        self._add(leg.name, compute_motion(self.robot, trajectory), str(end))

    def rest(self, step: DwellStep, name: str) -> None:
        """Add a rest."""
        payload = self.robot.payload or Payload(mass=0.0)
        self._add(name, Dwell(duration=step.dwell, holding_brake=step.brake, payload=payload), self.stops[-1])

    def back(self) -> None:
        """Add all motions since the start, or the last way back, in reversed order and time."""
        there = list(zip(self.names, self.steps, self.stops, strict=False))[self.returned :]
        for name, step, stop in reversed(there):
            if isinstance(step, Motion):
                self._add(f"back: {name}", way_back(step, self.robot), stop)
                self.q = step.trajectory(step.trajectory.breaks[0])
        self.returned = len(self.steps)

    def _add(self, name: str, step: Motion | Dwell, stop: str) -> None:
        self.steps.append(step)
        self.names.append(name)
        self.stops.append(stop)

    def _joint(self, leg: Leg) -> Trajectory:
        move = leg.move
        points = np.stack([self.q, *(self._posture(place) for place in leg.places[1:])])
        # A profile that finds its own time takes none; what it is given then does not count.
        durations = move.durations or (move.duration or 1.0,) * (len(points) - 1)
        choice = move.profile
        return profiles.make(
            _PROFILE if choice is None else choice.name,
            points,
            np.concatenate([[0.0], np.cumsum(durations)]),
            options=None if choice is None else choice.options,
            joint_names=self.robot.joint_names,
        )

    def _posture(self, place: Place) -> Array:
        """As it was there before; else the branch's, with the turns that lines have led to, within the limits."""
        if place in self.postures:
            return self.postures[place]
        row = self.rows[place]
        if not isinstance(self.scene.waypoints[self.scene.places.index(place)], Posed):
            return row
        low, high = self.robot.limits.position.T
        turned = row + self.turns
        outside = (turned < low - _SLACK) | (turned > high + _SLACK)
        return np.where(outside, row, turned)

    def _straight(self, leg: Leg) -> Trajectory:
        move, poses, orientation = leg.move, [self.scene.pose(place) for place in leg.places], leg.move.orientation
        constrain: Constraint = "pose"
        if any(self.scene.is_free(place) for place in leg.places):  # then no orientation of them means anything
            constrain, orientation = "position", "held"
            poses = [np.block([[poses[0][:3, :3], pose[:3, 3:]], [pose[3:]]]) for pose in poses]
        if leg.kind == "arc":
            path = paths.arc(*poses, orientation=orientation or "geodesic")
        elif len(poses) > 2:
            path = paths.polyline(poses, zone=float(move.zone or 0.0))
        else:
            path = paths.line(*poses, turn_axis=move.turn_axis)
        law = self._law(path, leg)
        made = paths.tool_move(self.robot, path, law, start=self.q, constrain=constrain)
        return replace(made, profile=leg.kind, joint_names=self.robot.joint_names)

    def _law(self, path: paths.Path, leg: Leg) -> Trajectory:
        move = leg.move
        timed = move.duration is not None and leg.kind == move.move
        if timed:
            choice = move.profile
            name, options = (_LAW, None) if choice is None else (choice.name, choice.options)
            return paths.in_time(path, float(move.duration or 0.0), name, options=options)
        return paths.at_speed(
            path, speed=float(move.speed or 0.0), acceleration=float(move.acceleration or 0.0), jerk=move.jerk
        )


def _resolved(scene: _Scene, legs: Sequence[Sequence[Leg]], branch: Branch) -> ResolvedCycle:
    """The motions of the cycle on one branch."""
    task, start = scene.task, Place(str(scene.task.points[0].name))
    rows = dict(zip(scene.places, branch.q, strict=True))
    arm = _Arm(scene=scene, rows=rows, q=rows[start], robot=scene.robot, turns=np.zeros(scene.robot.n_joints))
    arm.postures[start] = arm.q
    arm.stops.append(str(start))
    here = start
    for k, (step, moves) in enumerate(zip(task.cycle, legs, strict=True)):
        for leg in moves:
            with named(task, f"cycle[{k}] ({leg.name})"):
                arm.go(leg)
        here = moves[-1].places[-1] if isinstance(step, Move) else start if step == "back" else here
        with named(task, f"cycle[{k}]"):
            _other_step(arm, step, here)
    with named(task, "cycle"):
        cycle = Cycle(steps=tuple(arm.steps))
        if task.repeat and not cycle.is_periodic:
            raise InputError(
                f"{cycle.why_not_periodic}; add the way back (a move to {start}, or - back), or repeat: false"
            )
    return ResolvedCycle(
        task=task,
        robot=scene.robot,
        branch=branch,
        places=tuple(map(str, scene.places)),
        cycle=cycle,
        names=tuple(arm.names),
        stops=tuple(arm.stops),
    )


def _other_step(arm: _Arm, step: object, here: Place) -> None:
    """A grip, a release, a rest or the way back."""
    if isinstance(step, GripStep):
        hand, load = arm.scene.robot.payload, body(step.grip)
        arm.robot = arm.scene.robot.with_payload(load if hand is None else together(hand, load))
    elif isinstance(step, DwellStep):
        arm.rest(step, f"rest at {here}")
    elif step == "release":
        arm.robot = arm.scene.robot
    elif step == "back":
        arm.back()


def together(one: Payload, other: Payload) -> Payload:
    """Two bodies held at once as one: Steiner's theorem about their common centre of mass."""
    mass = one.mass + other.mass
    com = one.com if mass == 0 else (one.mass * one.com + other.mass * other.com) / mass
    inertia = np.zeros((3, 3))
    for part in (one, other):
        arm = part.com - com
        inertia += part.inertia + part.mass * ((arm @ arm) * np.eye(3) - np.outer(arm, arm))
    return Payload(mass=mass, com=com, inertia=inertia)
