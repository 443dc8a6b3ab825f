"""What the paper announces and does not show: both profiles executed on the arm's model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from puma_septic.paper._durations import stretched
from puma_septic.robot import Robot
from puma_septic.simulation import Controller, Simulation, simulate_all
from puma_septic.trajectory import Trajectory
from puma_septic.validation import Array
from puma_septic.vibration import residual_vibration

__all__ = ["FREQUENCIES", "SHARES", "Executed", "execute_profiles"]

SHARES: Final = (1.0, 0.5)
"""Durations that are simulated, of the paper's."""

FREQUENCIES: Final = np.linspace(5.0, 25.0, 81)
"""Structures of industrial arms swing at 5 to 25 Hz (Craig, "Introduction to Robotics", 3rd ed., 2005, chapter 9)."""

# Of the durations that the spectrum is taken at, of the paper's.
_SPECTRUM: Final = np.linspace(1 / 3, 1.0, 9)
# Controllers and a step that show the profiles' difference and cost little: rates below the usual 1 kHz.
_LAWS: Final = ("pd_gravity", "feedforward")
_RATE, _STEP, _REST_SPEED, _SETTLE = 250.0, 4e-3, 0.04, 0.1


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Executed:
    """Tracking and vibration of the profiles.

    Attributes
    ----------
    durations : ndarray, shape (k,)
        Simulated ones, s.
    tool_rms : mapping of str to ndarray, shape (k, n_profiles)
        Root mean square distance of the tool from its plan by control law, m; infinite where the arm diverged.
    residual : ndarray, shape (n_durations, n_frequencies, n_profiles)
        Amplitude left in an undamped spring-mass on the joint that it is largest of, rad.
    """

    durations: Array
    tool_rms: dict[str, Array]
    residual: Array


def execute_profiles(robot: Robot, profiles: tuple[Trajectory, ...]) -> Executed:
    """Simulate all profiles at each duration under each law, and take the spectra of what they leave behind."""
    total = profiles[0].duration
    moves = [_lasting(one, share * total) for share in SHARES for one in profiles]
    # The nearest rate that divides each motion, whatever the inputs are.
    shortest = total * min(SHARES)
    rate = round(_RATE * shortest) / shortest
    tool_rms = {}
    for law in _LAWS:
        controller = Controller(law=law, rate=rate)
        made = simulate_all(robot, moves, controller=controller, settle=_SETTLE, step=_STEP, rest_speed=_REST_SPEED)
        tool_rms[law] = np.array([_rms(one) for one in made]).reshape(len(SHARES), -1)
    spectra = [
        [residual_vibration(_lasting(one, share * total), FREQUENCIES).max(axis=1) for one in profiles]
        for share in _SPECTRUM
    ]
    return Executed(
        durations=np.array([share * total for share in SHARES]),
        tool_rms=tool_rms,
        residual=np.moveaxis(np.array(spectra), 1, 2),
    )


def _lasting(trajectory: Trajectory, duration: float) -> Trajectory:
    return stretched(trajectory, duration / trajectory.duration)


def _rms(simulation: Simulation) -> float:
    return np.inf if simulation.has_diverged else simulation.metrics.tool_rms_error
