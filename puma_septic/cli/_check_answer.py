"""What ``puma-septic check`` does: planned trajectories of files, whether they may go to the robot."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, final

import numpy as np

import puma_septic
from puma_septic._version import __version__
from puma_septic.cli._arguments import asked_robot
from puma_septic.cli._parser import Answer
from puma_septic.cli._task_text import wrapped
from puma_septic.document import SCHEMAS, records_csv, to_json
from puma_septic.errors import InputError, NoSolution, PumaSepticError
from puma_septic.files import sha256_of
from puma_septic.gate import (
    START_TOLERANCE,
    VERDICTS,
    Fixed,
    Reason,
    TrajectoryCheck,
    check_trajectory,
    checked_allowances,
    fixed,
)
from puma_septic.paths import ToolLimits
from puma_septic.quantities import QUANTITIES
from puma_septic.robot import Payload, Robot, load_robot, robot_files
from puma_septic.ros import (
    JointState,
    JointTrajectoryError,
    PlannedTrajectory,
    is_bag,
    read_joint_state,
    read_joint_state_log,
    read_joint_trajectories,
    recorded_topics,
    write_message,
)
from puma_septic.task import load_task
from puma_septic.validation import checked_number

__all__ = ["answer"]

EXIT_CODES: Final = {"ok": 0, "violated": 1, "invalid": 2, "undecided": 3}
_JOINT_STATE: Final = "sensor_msgs/msg/JointState"


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Checked:
    """One trajectory of one file, or a file that has none."""

    path: str
    origin: str
    sha256: str | None
    check: TrajectoryCheck
    planned: PlannedTrajectory | None = None


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Asked:
    """What every trajectory is held against beside the robot's limits, and what does not count."""

    start_tolerance: float
    allow: tuple[str, ...]
    floor: float | None
    tool_speed: float | None

    @property
    def rules(self) -> dict[str, Any]:
        """As arguments of `check_trajectory` and `fixed`."""
        limits = None if self.tool_speed is None else ToolLimits(speed=self.tool_speed, source="--tool-speed")
        return {"allow": self.allow, "floor": self.floor, "tool_limits": limits}


def answer(arguments: Namespace) -> Answer:
    """Check every trajectory of every file; the exit code is that of the worst."""
    asked = _asked(arguments)
    if arguments.effort and arguments.fix is None:
        raise InputError("--effort goes with --fix: the efforts are those of the trajectory that is written")
    inputs: list[dict[str, str]] = []
    fix: dict[str, Any] | None = None
    try:
        robot = _robot(arguments, inputs)
        start = _start(arguments.start, robot, inputs)
    except PumaSepticError as error:
        results = [_invalid(path, [_refusal("setup_invalid", error)]) for path in arguments.files]
    else:
        results = [one for path in arguments.files for one in _checked(path, robot, start, asked, arguments.topic)]
        if arguments.fix is not None:
            fix = _fix(arguments, robot, results, asked)
    verdict = max((one.check.verdict for one in results), key=VERDICTS.index)
    if arguments.format in ("json", "csv"):
        document = _document(arguments, results, inputs, asked, fix)
        text = to_json(document) if arguments.format == "json" else _csv(document)
    else:
        text = _text(results, inputs, verdict, fix)
    return Answer(text, EXIT_CODES[verdict])


def _asked(arguments: Namespace) -> _Asked:
    tolerance = START_TOLERANCE if arguments.start_tolerance is None else arguments.start_tolerance
    return _Asked(
        start_tolerance=checked_number("--start-tolerance", tolerance, unit="rad", at_least=0.0),
        allow=tuple(sorted(checked_allowances(arguments.allow, tuple(QUANTITIES)))),
        floor=arguments.floor,
        tool_speed=arguments.tool_speed,
    )


def _robot(arguments: Namespace, inputs: list[dict[str, str]]) -> Robot:
    section = asked_robot(arguments, {})
    source = section.pop("source")
    for role, path in robot_files(source, actuators=section.get("actuators")).items():
        if path.is_file():  # what is missing is told by load_robot
            inputs.append({"role": role, "path": str(path), "sha256": sha256_of(path)})
    robot = load_robot(source, **section)
    return robot if arguments.payload is None else robot.with_payload(Payload(mass=arguments.payload))


def _start(text: str | None, robot: Robot, inputs: list[dict[str, str]]) -> JointState | None:
    """A file's joint state, or numbers in the robot's order."""
    if text is None:
        return None
    try:
        position = np.array([float(part) for part in text.split(",")])
    except ValueError:
        state = read_joint_state(text)
        inputs.append({"role": "start", "path": text, "sha256": sha256_of(Path(text))})
        return state
    if len(position) != robot.n_joints or not np.isfinite(position).all():
        raise InputError(
            f"--start: {len(position)} positions for {robot.n_joints} joints, {', '.join(robot.joint_names)}; a finite"
            " number for each is needed, or a file with a JointState"
        )
    return JointState(joint_names=robot.joint_names, position=position, velocity=np.zeros(robot.n_joints))


def _checked(path: str, robot: Robot, start: JointState | None, asked: _Asked, topic: str | None) -> Iterator[_Checked]:
    """The trajectories of one file; what cannot be read is a result too."""
    try:
        if _is_log(Path(path), topic):
            yield _checked_log(path, robot, asked, topic)
            return
        for planned in read_joint_trajectories(path, robot, start=start, topic=topic):
            yield _held(path, robot, planned, asked)
    except JointTrajectoryError as error:
        if _is_task(path):
            how_else = f"puma-septic assess {path} assesses it, with --write it makes a JointTrajectory of it"
            yield _invalid(path, [Reason(code="no_trajectory", message=f"a task file, no JointTrajectory: {how_else}")])
            return
        faults = [
            Reason(
                code=fault.code,
                message=fault.message,
                joint=fault.joint,
                time=np.nan if fault.time is None else fault.time,
            )
            for fault in error.faults
        ]
        yield _invalid(path, faults)
    except PumaSepticError as error:
        yield _invalid(path, [_refusal("unreadable", error)])


def _is_task(path: str) -> bool:
    try:
        load_task(Path(path))
    except PumaSepticError:
        return False
    return True


def _held(path: str, robot: Robot, planned: PlannedTrajectory, asked: _Asked) -> _Checked:
    start = None if planned.start is None else planned.start.position
    try:
        check = check_trajectory(
            robot, planned.trajectory, start=start, start_tolerance=asked.start_tolerance, **asked.rules
        )
    except InputError as error:
        check = TrajectoryCheck(assessment=None, margins=(), reasons=(_refusal("unresolvable", error),))
    notes = [*planned.notes, *check.notes]
    if planned.message.has("effort").any():
        notes.append("effort fields are filled; a controller without an effort interface rejects the trajectory")
    check = replace(check, notes=tuple(notes))
    return _Checked(path=path, origin=planned.origin, sha256=planned.sha256, check=check, planned=planned)


def _is_log(path: Path, topic: str | None) -> bool:
    """Whether joint states are asked for: by the topic, or because a recording has nothing else."""
    if not is_bag(path) or not path.exists():
        return False
    topics = recorded_topics(path)
    if topic is not None:
        return topics.get(topic) == _JOINT_STATE
    return _JOINT_STATE in topics.values() and not any(kind.endswith("Trajectory") for kind in topics.values())


def _checked_log(path: str, robot: Robot, asked: _Asked, topic: str | None) -> _Checked:
    log = read_joint_state_log(path, robot, topic=topic)
    # By its public name, which loads it here: SciPy takes longer to load than a trajectory to check.
    trajectory = puma_septic.fit_trajectory(log.t, log.q, joint_names=robot.joint_names, continuous=robot.is_continuous)
    check = check_trajectory(robot, trajectory, start_tolerance=asked.start_tolerance, **asked.rules)
    notes = (
        *log.notes,
        "joint states, interpolated by a quintic spline: their noise is in the accelerations",
        *check.notes,
    )
    return _Checked(path=path, origin=path, sha256=log.sha256, check=replace(check, notes=notes))


def _refusal(code: str, error: PumaSepticError) -> Reason:
    return Reason(code=code, message=" ".join(str(error).split()))


def _invalid(path: str, reasons: Sequence[Reason]) -> _Checked:
    source = Path(path)
    digest = sha256_of(source) if source.is_file() else None
    return _Checked(
        path=path,
        origin=path,
        sha256=digest,
        check=TrajectoryCheck(assessment=None, margins=(), reasons=tuple(reasons)),
    )


def _fix(arguments: Namespace, robot: Robot, results: Sequence[_Checked], asked: _Asked) -> dict[str, Any]:
    """Write the stretched trajectory, or say why there is none."""
    planned = [one.planned for one in results if one.planned is not None]
    if len(results) != 1 or len(planned) != 1:
        raise InputError(f"--fix goes with one trajectory that can be read; there are {len(planned)}")
    try:
        made = fixed(robot, planned[0], effort=arguments.effort, **asked.rules)
    except (NoSolution, InputError) as error:  # InputError: friction of a kind that a stretch does not know
        return {"path": None, "message": str(error)}
    path = write_message(arguments.fix, made.message)
    return {
        "path": str(path),
        "sha256": sha256_of(path),
        "factor": made.factor,
        "duration": float(made.message.times[-1] - made.message.times[0]),
        "message": _told(made),
        "check": made.check.to_dict(),
    }


def _told(made: Fixed) -> str:
    if made.governing is None:
        return "unchanged: no known limit is violated"
    return f"{made.factor:.9g} times as long, the least that holds; then {made.governing}"


def _document(
    arguments: Namespace,
    results: Sequence[_Checked],
    inputs: Sequence[dict[str, str]],
    asked: _Asked,
    fix: dict[str, Any] | None,
) -> dict[str, Any]:
    verdict = max((one.check.verdict for one in results), key=VERDICTS.index)
    return {
        "schema": SCHEMAS["check"],
        "version": __version__,
        "verdict": verdict,
        "exit_code": EXIT_CODES[verdict],
        "robot": arguments.robot,
        "start_tolerance": asked.start_tolerance,
        "allow": list(asked.allow),
        "floor": asked.floor,
        "tool_speed": asked.tool_speed,
        "inputs": list(inputs),
        "trajectories": [
            {"path": one.path, "origin": one.origin, "sha256": one.sha256, **one.check.to_dict()} for one in results
        ],
        "fix": fix,
    }


def _csv(document: dict[str, Any]) -> str:
    """One row for each trajectory and worst margin; one row of a trajectory without any."""
    rows: list[dict[str, Any]] = []
    for one in document["trajectories"]:
        head = {key: one[key] for key in ("path", "origin", "verdict")}
        rows += [{**head, **margin} for margin in (*one["margins"], *one["cell_margins"])] or [head]
    return records_csv(rows)


def _text(
    results: Sequence[_Checked], inputs: Sequence[dict[str, str]], verdict: str, fix: dict[str, Any] | None
) -> str:
    parts = [f"{verdict}: {len(results)} trajectories"] if len(results) > 1 else []
    for one in results:
        parts.append(wrapped(f"{one.origin}: {one.check}"))
    if fix is not None:
        written = f"fix: {fix['path']}, {fix['message']}" if fix["path"] else f"fix: none written; {fix['message']}"
        parts.append(wrapped(written))
    digests = [f"{one['sha256']}  {one['path']}" for one in inputs]
    digests += list(dict.fromkeys(f"{one.sha256}  {one.path}" for one in results if one.sha256))
    parts.append("\n".join(["SHA-256:", *digests]))
    return "\n\n".join(parts)
