"""``--csv FILE``: a motion that was recorded or planned elsewhere."""

from __future__ import annotations

from argparse import Namespace
from dataclasses import dataclass, replace
from typing import Any, Final, final

import numpy as np

from puma_septic._version import __version__
from puma_septic.assessment import Assessment, assess
from puma_septic.cli._arguments import asked_robot
from puma_septic.cli._output_arguments import asked_units, origin, with_report
from puma_septic.cli._parser import UNDECIDED, Answer
from puma_septic.cli._task_text import details, margin_text, wrapped
from puma_septic.document import SCHEMAS
from puma_septic.errors import InputError
from puma_septic.logs import JointLog, LogFit, fit_log, fit_residual, read_log
from puma_septic.measurement import MeasuredTorque, TorqueBand, compare_measured, limit_doubts, torque_band
from puma_septic.motion import Motion, compute_motion
from puma_septic.report import (
    named_metrics_csv,
    new_folder,
    profile_labels,
    reserve_document,
    samples_csv,
    to_json,
    unmet_document,
)
from puma_septic.robot import Payload, Robot, load_robot
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array
from puma_septic.views.tables import number

__all__ = ["Recorded", "recorded", "run_log", "told"]

# A step this many times the usual one is a gap, over which a spline would invent a motion.
_GAP: Final = 10
# A band of torque that is narrower than this part of the torque is not printed.
_KNOWN: Final = 1e-4


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Recorded:
    """A file's motion on the asked robot, and what its samples leave unknown."""

    path: str
    log: JointLog
    fit: LogFit
    motion: Motion
    band: TorqueBand
    smoothing: str | float | None

    @property
    def robot(self) -> Robot:
        """The arm."""
        return self.motion.robot


def recorded(arguments: Namespace) -> Recorded:
    """The motion of ``--csv``, in doubt where noise hides whether a limit is kept."""
    for name, value in (("TASK", arguments.task), ("--branch", arguments.branch)):
        if value is not None:
            raise InputError(f"{name} does not go with --csv: the file has the points, and a spline goes through them")
    section = asked_robot(arguments, {})
    robot = load_robot(section.pop("source", "puma560"), **section)
    if getattr(arguments, "payload", None) is not None:
        robot = robot.with_payload(Payload(mass=arguments.payload))
    columns = {name: column for part in arguments.columns or () for name, column in part.items()}
    log = read_log(
        arguments.csv,
        robot,
        columns=columns,
        units=arguments.units or (),
        repeated=arguments.repeated or "refuse",
        max_gap=arguments.max_gap,
    )
    _check_gaps(arguments, log)
    fit = fit_log(
        log,
        smoothing=arguments.smoothing,
        resolution=arguments.resolution,
        ends=arguments.ends or "auto",
        bounds=robot.limits.position,
    )
    motion = compute_motion(robot, fit.trajectory)
    band = torque_band(motion, fit)
    motion = replace(motion, trajectory=_judged(fit, limit_doubts(motion, fit, band)))
    return Recorded(path=str(arguments.csv), log=log, fit=fit, motion=motion, band=band, smoothing=arguments.smoothing)


def _judged(fit: LogFit, doubts: tuple[str, ...]) -> Trajectory:
    """The motion in doubt where a limit lies within what the samples leave unknown, not for the noise alone."""
    trajectory = fit.trajectory
    answered = (doubt for doubt in trajectory.doubts if doubt not in fit.questions)
    return replace(trajectory, doubts=(*doubts, *fit.questions), remarks=(*answered, *trajectory.remarks))


def run_log(arguments: Namespace) -> Answer:
    """Assess the motion of a CSV file on the asked robot, telling what its fit leaves over."""
    if arguments.profile is not None:
        raise InputError("--profile does not go with --csv: the file has the points, and a spline goes through them")
    what = recorded(arguments)
    assessment = assess(what.motion, dwell=arguments.dwell or 0.0)
    measured = _measured(what)
    document = (
        to_json(_document(what, assessment, measured, arguments.margin))
        if arguments.format == "json" or arguments.out
        else ""
    )
    if arguments.format == "json":
        text = document
    elif arguments.format == "csv":
        text = named_metrics_csv([(what.path, [assessment])])
    else:
        margin = [margin_text([assessment], arguments.margin)] if arguments.margin else []
        more = [wrapped(str(one)) for one in measured]
        text = "\n\n".join([told(what), *margin, *more, *details([assessment], arguments.verbose, arguments.margin)])
    if arguments.out is not None:
        notes = [*_lines(what)[:-1], *(line for one in measured for line in str(one).splitlines())]
        _write_folder(arguments, assessment, document, notes)
    text = with_report(text, arguments)
    if assessment.undecided:
        return Answer(text, UNDECIDED)
    return Answer(text, 1 if assessment.keeps(arguments.margin) else 0)


def told(what: Recorded) -> str:
    """How the file was read and fitted, and what its noise leaves unknown, for the terminal."""
    return "\n".join(wrapped(line) for line in _lines(what))


def _lines(what: Recorded) -> list[str]:
    fit, robot, log = what.fit, what.robot, what.log
    joints = robot.joint_names
    residual = fit_residual(fit.trajectory)
    j = int(np.argmax(residual.max))
    return [
        f"File {what.path}: {len(log.t)} rows from {log.t[0]:.9g} s to {log.t[-1]:.9g} s"
        + (f" after the stamp {log.origin}" if log.t[0] == 0 and float(log.origin) else "")
        + f", {_way(fit)}",
        *(f"Read: {note}" for note in log.notes),
        f"Ends: {_ends(fit)}",
        f"Largest residual: {number(float(residual.max[j]))} rad ({joints[j]}); RMS at most"
        f" {number(float(residual.rms.max()))} rad",
        *_noise_lines(what),
        f"Robot: {robot.name}, tool {robot.tool!r}",
    ]


def _way(fit: LogFit) -> str:
    intervals = len(fit.trajectory.breaks) - 1
    if fit.spread.is_regularised:
        return f"smoothed by the quintic spline of greatest restricted likelihood, {intervals} intervals"
    if fit.spread.parts:
        return f"smoothed by the least-squares quintic spline, {intervals} intervals"
    return "interpolated by a quintic spline"


def _ends(fit: LogFit) -> str:
    before, after = fit.trajectory.rest_before, fit.trajectory.rest_after
    if before and after:
        return "at rest at both"
    moving = "both" if not (before or after) else "the start" if after else "the end"
    return f"moving at {moving}: an excerpt, of which nothing is assumed beyond"


def _noise_lines(what: Recorded) -> list[str]:
    """Noise, jitter, encoder steps, dead band and band, as far as there are any."""
    fit, joints = what.fit, what.robot.joint_names
    lines = []
    if fit.encoder_step.any():
        lines.append(f"Positions step by {_each(joints, fit.encoder_step)} rad")
    if fit.noise.any():
        jitter = f"; stamps are off by {number(fit.jitter)} s RMS" if fit.jitter else ""
        lines.append(f"Noise of a sample: {_each(joints, fit.noise)} rad{jitter}")
    resolution = np.asarray(fit.trajectory.resolution)
    if resolution.any():
        lines.append(f"Taken for rest: travel within {_each(joints, resolution)} rad over 0.1 s or longer")
    if fit.wraps.any():
        turns = (f"{joints[j]} {fit.wraps[j]}" for j in np.flatnonzero(fit.wraps))
        lines.append(f"Jumps by a turn that were taken out: {', '.join(turns)}")
    if fit.noise.any() or what.band.relative_width > _KNOWN:
        for name, (least, greatest) in (("Peak", what.band.peak), ("RMS", what.band.rms)):
            spans = (
                f"{joint} {low:.4g} to {high:.4g}" for joint, low, high in zip(joints, least, greatest, strict=True)
            )
            lines.append(f"{name} torque within (95 %): {', '.join(spans)} N m")
    return lines


def _each(joints: tuple[str, ...], values: Array) -> str:
    """The range over the joints that have one."""
    some = values[values > 0]
    low, high = float(some.min()), float(some.max())
    whose = "" if len(some) == len(joints) else f" ({', '.join(joints[j] for j in np.flatnonzero(values > 0))})"
    return (f"{low:.3g}" if high <= 1.005 * low else f"{low:.3g} to {high:.3g}") + whose


def _check_gaps(arguments: Namespace, log: JointLog) -> None:
    steps = np.diff(log.t)
    usual, k = float(np.median(steps)), int(np.argmax(steps))
    if arguments.max_gap is None and steps[k] > _GAP * usual:
        raise InputError(
            f"{arguments.csv}: nothing between t = {log.t[k]:g} s and {log.t[k + 1]:g} s, where rows are mostly"
            f" {usual:g} s apart; --max-gap {1.02 * steps[k]:.3g} takes it for sampling"
        )


def _measured(what: Recorded) -> list[MeasuredTorque]:
    """What the file has of torques and currents, against the computed ones."""
    if what.robot.missing_inertia:  # which the assessment tells
        return []
    times = what.fit.trajectory.times
    signals = {"effort": what.log.effort, "current": what.log.current}
    return [
        compare_measured(what.motion, times, **{name: values}) for name, values in signals.items() if values is not None
    ]


def _document(what: Recorded, assessment: Assessment, measured: list[MeasuredTorque], margin: float) -> dict[str, Any]:
    fit, trajectory = what.fit, what.fit.trajectory
    residual = fit_residual(trajectory)
    return {
        "schema": SCHEMAS["assess-log"],
        "version": __version__,
        "is_feasible": assessment.is_feasible,
        "undecided": list(assessment.undecided),
        **reserve_document([assessment], margin),
        **unmet_document(assessment, margin),
        "file": what.path,
        "joint_names": list(what.robot.joint_names),
        "rows": len(trajectory.times),
        "first_stamp": what.log.origin,
        "read": list(what.log.notes),
        "fit": _way(fit),
        "smoothing": what.smoothing,
        "rest_before": trajectory.rest_before,
        "rest_after": trajectory.rest_after,
        "noise": fit.noise.tolist(),
        "stamp_jitter": fit.jitter,
        "encoder_step": fit.encoder_step.tolist(),
        "resolution": np.asarray(trajectory.resolution).tolist(),
        "unwrapped": fit.wraps.tolist(),
        "residual": {"max": residual.max.tolist(), "rms": residual.rms.tolist()},
        "band": what.band.to_dict(),
        "measured": [one.to_dict() for one in measured],
        "assessment": assessment.to_dict(),
    }


def _write_folder(arguments: Namespace, assessment: Assessment, document: str, notes: list[str]) -> None:
    # Templates and the replay's libraries take longer to load than a motion to assess; matplotlib far longer.
    from puma_septic.pictures import assessment_pictures, in_units
    from puma_septic.report.page import report_html
    from puma_septic.report.svg import write_svg

    shown = assessment_pictures([assessment], profile_labels([assessment]))
    pictures = [in_units(one, asked_units(arguments)) for one in shown]
    with new_folder(arguments.out, overwrite=arguments.force) as folder:
        (folder / "report.html").write_text(
            report_html(
                assessment,
                title=str(arguments.csv),
                notes=notes,
                margin=arguments.margin,
                made=origin(arguments),
                units=asked_units(arguments),
            ),
            encoding="utf-8",
        )
        (folder / "assessment.json").write_text(document, encoding="utf-8")
        (folder / "metrics.csv").write_text(named_metrics_csv([(str(arguments.csv), [assessment])]), encoding="utf-8")
        (folder / "samples.csv").write_text(samples_csv(assessment), encoding="utf-8")
        write_svg(folder, pictures)
        if not arguments.no_png:
            from puma_septic.report.figures import write_png

            write_png(folder, pictures)
