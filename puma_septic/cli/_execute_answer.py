"""What ``puma-septic execute`` answers."""

from __future__ import annotations

from argparse import Namespace

from puma_septic.cli._arguments import asked_task
from puma_septic.cli._output_arguments import asked_units, origin, with_report
from puma_septic.cli._parser import Answer
from puma_septic.document import to_json
from puma_septic.outputs import file_names
from puma_septic.report import new_folder, numbered
from puma_septic.simulation import Controller, ElasticJoints, Execution, execute
from puma_septic.task import ResolvedTask, resolve_task

__all__ = ["answer"]

# Of a controller's answer: no profile diverged, or one did.
_DONE, _DIVERGED = 0, 1


def answer(arguments: Namespace) -> Answer:
    """Simulate, write the folder where one is asked for, and tell."""
    resolved = resolve_task(asked_task(arguments, "paper-turned", profiles=arguments.profile))
    execution = _executed(resolved, arguments)
    code = _DIVERGED if execution.has_diverged else _DONE
    title = f"{resolved.task.name}, executed"
    if arguments.out is not None:
        _write_folder(arguments, execution, title)
    if arguments.format == "json":
        return Answer(to_json(execution.to_dict()), code)
    if arguments.format == "csv":
        return Answer(execution.to_csv(), code)
    text = f"Task {resolved.task.name!r}, robot {resolved.robot.name!r}\n\n{execution}"
    if arguments.verbose:
        text = "\n\n".join([text, *(str(one) for one in execution.simulations.values())])
    return Answer(with_report(text, arguments), code)


def _executed(resolved: ResolvedTask, arguments: Namespace) -> Execution:
    robot = resolved.robot
    controller = Controller(
        law=arguments.controller,
        bandwidth=arguments.bandwidth,
        rate=arguments.rate,
        delay=arguments.delay,
        encoder_resolution=arguments.encoder,
        model=robot.with_payload(None) if arguments.unknown_payload else None,
    )
    elastic = None
    if arguments.joint_frequency is not None:
        elastic = ElasticJoints.of_frequency(robot, resolved.points[0], arguments.joint_frequency)
    labels = numbered([one.profile for one in resolved.trajectories])
    moves = dict(zip(labels, resolved.trajectories, strict=True))
    return execute(robot, moves, controller=controller, elastic=elastic, settle=arguments.settle)


def _write_folder(arguments: Namespace, execution: Execution, title: str) -> None:
    """Report, document, table and samples."""
    from puma_septic.pictures.execution import execution_pictures
    from puma_septic.report.figures import write_png
    from puma_septic.report.page import report_html
    from puma_septic.report.simulated import simulation_csv
    from puma_septic.report.svg import write_svg

    with new_folder(arguments.out, overwrite=arguments.force) as folder:
        (folder / "execution.json").write_text(to_json(execution.to_dict()), encoding="utf-8")
        (folder / "execution.csv").write_text(execution.to_csv(), encoding="utf-8")
        page = report_html(execution, title=title, made=origin(arguments), units=asked_units(arguments))
        (folder / "report.html").write_text(page, encoding="utf-8")
        simulated = execution.simulations
        for name, simulation in zip(file_names(list(simulated)), simulated.values(), strict=True):
            (folder / f"samples-{name}.csv").write_text(simulation_csv(simulation), encoding="utf-8")
        pictures = execution_pictures(execution)
        write_svg(folder, pictures)
        if not arguments.no_png:
            write_png(folder, pictures)
