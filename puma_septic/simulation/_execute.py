"""Profiles side by side on the same controller."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, final

from puma_septic.document import SCHEMAS, one_line
from puma_septic.errors import InputError
from puma_septic.robot import Robot
from puma_septic.simulation._controller import Controller, controller_of
from puma_septic.simulation._elasticity import ElasticJoints
from puma_septic.simulation._simulate import REST_SPEED, simulate_all
from puma_septic.simulation._simulation import Simulation
from puma_septic.trajectory import Trajectory
from puma_septic.validation import FrozenMap, checked_choice, checked_kind
from puma_septic.views import execution as view

__all__ = ["Execution", "execute"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Execution:
    """Simulations of several trajectories under one controller; made by `execute`.

    Attributes
    ----------
    robot : Robot
    controller : Controller
    simulations : mapping of str to Simulation
        By the names of the trajectories.
    """

    robot: Robot
    controller: Controller
    simulations: Mapping[str, Simulation] = field(repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "simulations", FrozenMap(self.simulations))

    def __getitem__(self, name: str) -> Simulation:
        """The simulation of one trajectory."""
        return self.simulations[checked_choice("executed trajectory", name, self.simulations)]

    @property
    def has_diverged(self) -> bool:
        """Whether the arm left its plan for good on any of them."""
        return any(one.has_diverged for one in self.simulations.values())

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader must know: assumptions, and what the controller takes the arm for."""
        first = next(iter(self.simulations.values()))
        notes = []
        if first.elastic is not None:
            stiffness = ", ".join(f"{value:.3g}" for value in first.elastic.stiffness)
            notes.append(f"Stiffness of the joints, {first.elastic.source}: {stiffness} N m/rad (N/m).")
        if self.controller.model is not None:
            notes.append("The controller's model is another than the arm.")
        if self.robot.missing_inertia:
            notes.append(f"No inertia is known beyond {', '.join(self.robot.missing_inertia)}.")
        return tuple(notes)

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document without the samples.

        Returns
        -------
        dict
        """
        return {
            "schema": SCHEMAS["execution"],
            "robot": self.robot.name,
            "joint_names": list(self.robot.joint_names),
            "controller": self.controller.to_dict(),
            "runs": [one.run_document(name) for name, one in self.simulations.items()],
            "notes": list(self.notes),
        }

    def to_csv(self) -> str:
        """A line for the tool and one for each joint of each trajectory.

        Returns
        -------
        str
        """
        return view.csv(self.to_dict())

    def __str__(self) -> str:
        return view.text(self.to_dict())

    def __repr__(self) -> str:
        return one_line("Execution", {"robot": self.robot.name, "trajectories": ", ".join(self.simulations)})

    def _repr_html_(self) -> str:
        return view.html(self.to_dict())


def execute(
    robot: Robot,
    trajectories: Mapping[str, Trajectory],
    *,
    controller: Controller | str = "computed_torque",
    elastic: ElasticJoints | None = None,
    settle: float = 0.5,
    step: float | None = None,
    rest_speed: float = REST_SPEED,
) -> Execution:
    """Track trajectories with the simulated arm under the same controller, and set the results side by side.

    Parameters
    ----------
    robot : Robot
    trajectories : mapping of str to Trajectory
        Names and motions, such as those of a task's profiles.
    controller, elastic, settle, step, rest_speed
        As of `puma_septic.simulate`; the same for all.

    Returns
    -------
    Execution

    Raises
    ------
    InputError
        For no trajectory, and as `simulate`.
    ModelError
        As `simulate`.

    Examples
    --------
    >>> import puma_septic as ps
    >>> points, times = [[0.0] * 6, [0.2] * 6], [0.0, 0.4]
    >>> moves = {name: ps.profiles.make(name, points, times) for name in ("cycloidal", "quintic_segments")}
    >>> result = ps.execute(ps.load_robot(), moves, controller="pd_gravity", settle=0.05)
    >>> list(result.simulations), result.has_diverged
    (['cycloidal', 'quintic_segments'], False)
    """
    if not checked_kind("trajectories", trajectories, Mapping):
        raise InputError("an execution needs at least one trajectory")
    chosen = controller_of(controller)
    springs = None if elastic is None else [elastic] * len(trajectories)
    results = simulate_all(
        robot,
        list(trajectories.values()),
        controller=chosen,
        elastic=springs,
        settle=settle,
        step=step,
        rest_speed=rest_speed,
    )
    return Execution(robot=robot, controller=chosen, simulations=dict(zip(trajectories, results, strict=True)))
