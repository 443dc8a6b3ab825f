"""``puma-septic assess --csv FILE``: a motion that was logged or planned elsewhere."""

from __future__ import annotations

from argparse import Namespace
from importlib import import_module
from typing import Any, Final

import numpy as np

from puma_septic._version import __version__
from puma_septic.assessment import Assessment, assess
from puma_septic.cli.arguments import Answer
from puma_septic.cli.tasks import asked_robot
from puma_septic.cli.texts import margin_text, wrapped
from puma_septic.document import SCHEMAS
from puma_septic.errors import InputError
from puma_septic.profiles.logged import JointLog, fit_residual, fit_trajectory, read_csv_trajectory
from puma_septic.report import named_metrics_csv, new_folder, profile_labels, samples_csv, to_json
from puma_septic.robot import Payload, Robot, load_robot
from puma_septic.validation import Array
from puma_septic.views.tables import number

__all__ = ["run_log"]

# A step this many times the usual one is a gap, over which a spline would invent a motion.
_GAP: Final = 10


def run_log(arguments: Namespace) -> Answer:
    """Assess the motion of a CSV file on the asked robot, telling what its fit leaves over."""
    for name, value in (("TASK", arguments.task), ("--profile", arguments.profile), ("--branch", arguments.branch)):
        if value is not None:
            raise InputError(f"{name} does not go with --csv: the file has the points, and a spline goes through them")
    section = asked_robot(arguments, {})
    robot = load_robot(section.pop("source", "puma560"), **section)
    if arguments.payload is not None:
        robot = robot.with_payload(Payload(mass=arguments.payload))
    log = _read(arguments)
    trajectory = fit_trajectory(
        log.t, _columns(arguments.csv, log, robot), smoothing=arguments.smoothing, joint_names=robot.joint_names
    )
    assessment = assess(robot, trajectory, dwell=arguments.dwell or 0.0)
    document = _document(arguments, assessment)
    name = str(arguments.csv)
    if arguments.format == "json":
        text = to_json(document)
    elif arguments.format == "csv":
        text = named_metrics_csv([(name, [assessment])])
    else:
        text = _text(arguments, assessment)
    if arguments.out is not None:
        _write_folder(arguments, assessment, document)
    return Answer(text, 1 if assessment.keeps(arguments.margin) else 0)


def _read(arguments: Namespace) -> JointLog:
    log = read_csv_trajectory(arguments.csv, max_gap=arguments.max_gap)
    steps = np.diff(log.t)
    usual, k = float(np.median(steps)), int(np.argmax(steps))
    if arguments.max_gap is None and steps[k] > _GAP * usual:
        raise InputError(
            f"{arguments.csv}: nothing between t = {log.t[k]:g} s and {log.t[k + 1]:g} s, where rows are mostly"
            f" {usual:g} s apart; --max-gap {1.02 * steps[k]:.3g} takes it for sampling"
        )
    return log


def _columns(path: str, log: JointLog, robot: Robot) -> Array:
    """The log's positions in the robot's order; the file may have its columns in any."""
    joints = ", ".join(robot.joint_names)
    for name in log.joint_names:
        if name not in robot.joint_names:
            raise InputError(f"{path}, row 1: robot {robot.name!r} has no joint {name!r}; valid: {joints}")
    for name in robot.joint_names:
        if name not in log.joint_names:
            raise InputError(f"{path}, row 1: no column for joint {name!r} of robot {robot.name!r}; needed: {joints}")
    return log.q[:, [log.joint_names.index(name) for name in robot.joint_names]]


def _text(arguments: Namespace, assessment: Assessment) -> str:
    trajectory, robot = assessment.motion.trajectory, assessment.motion.robot
    residual = fit_residual(trajectory)
    j = int(np.argmax(residual.max))
    way = "interpolated by" if arguments.smoothing is None else f"smoothed to {arguments.smoothing:g} rad RMS by"
    lines = [
        f"File {arguments.csv}: {len(trajectory.times)} rows from {trajectory.times[0]:g} s to"
        f" {trajectory.times[-1]:g} s, {way} a quintic spline that is at rest at both ends",
        f"Largest residual: {number(float(residual.max[j]))} rad ({robot.joint_names[j]}); RMS at most"
        f" {number(float(residual.rms.max()))} rad",
        f"Robot: {robot.name}, tool {robot.tool!r}",
    ]
    head = "\n".join(wrapped(line) for line in lines)
    margin = [margin_text([assessment], arguments.margin)] if arguments.margin else []
    return "\n\n".join([head, *margin, wrapped(str(assessment))])


def _document(arguments: Namespace, assessment: Assessment) -> dict[str, Any]:
    trajectory = assessment.motion.trajectory
    residual = fit_residual(trajectory)
    return {
        "schema": SCHEMAS["assess-log"],
        "version": __version__,
        "is_feasible": assessment.is_feasible,
        "file": str(arguments.csv),
        "joint_names": list(assessment.motion.robot.joint_names),
        "rows": len(trajectory.times),
        "smoothing": arguments.smoothing,
        "residual": {"max": residual.max.tolist(), "rms": residual.rms.tolist()},
        "assessment": assessment.to_dict(),
    }


def _write_folder(arguments: Namespace, assessment: Assessment, document: dict[str, Any]) -> None:
    page = import_module("puma_septic.report.page")
    pictures = import_module("puma_septic.pictures").assessment_pictures([assessment], profile_labels([assessment]))
    with new_folder(arguments.out) as folder:
        (folder / "report.html").write_text(page.report_html(assessment, title=str(arguments.csv)), encoding="utf-8")
        (folder / "assessment.json").write_text(to_json(document), encoding="utf-8")
        (folder / "metrics.csv").write_text(named_metrics_csv([(str(arguments.csv), [assessment])]), encoding="utf-8")
        (folder / "samples.csv").write_text(samples_csv(assessment), encoding="utf-8")
        import_module("puma_septic.report.svg").write_svg(folder, pictures)
        if not arguments.no_png:
            import_module("puma_septic.report.figures").write_png(folder, pictures)
