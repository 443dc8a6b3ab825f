"""Joint trajectories of robot arms: the torque they need, held against what the motors can do.

The public names are loaded when they are first used, so that importing the package and
``puma-septic --help`` answer at once.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Final

__version__ = "0.1.0"

# A public name has one line here, for the interpreter, and one below, for the type checker.
_HOMES: Final = {
    "Actuator": "robot",
    "Assessment": "assessment",
    "InputError": "errors",
    "Limits": "robot",
    "ModelError": "errors",
    "Motion": "motion",
    "NoSolution": "errors",
    "Payload": "robot",
    "Piecewise": "piecewise",
    "PumaSepticError": "errors",
    "Robot": "robot",
    "Trajectory": "trajectory",
    "Wrench": "robot",
    "assess": "assessment",
    "compute_motion": "motion",
    "forward_kinematics": "kinematics",
    "inverse_dynamics": "dynamics",
    "inverse_kinematics": "kinematics",
    "inverse_kinematics_batch": "kinematics",
    "jacobian": "kinematics",
    "load_robot": "robot",
    "lspb": "profiles",
    "paper": "paper",
    "plots": "plots",
    "profiles": "profiles",
    "quintic_segments": "profiles",
    "septic": "profiles",
    "tool_motion": "kinematics",
    "torque_terms": "dynamics",
}

__all__ = ["__version__", *_HOMES]

if TYPE_CHECKING:
    from puma_septic import paper as paper
    from puma_septic import plots as plots
    from puma_septic import profiles as profiles
    from puma_septic.assessment import Assessment as Assessment
    from puma_septic.assessment import assess as assess
    from puma_septic.dynamics import inverse_dynamics as inverse_dynamics
    from puma_septic.dynamics import torque_terms as torque_terms
    from puma_septic.errors import InputError as InputError
    from puma_septic.errors import ModelError as ModelError
    from puma_septic.errors import NoSolution as NoSolution
    from puma_septic.errors import PumaSepticError as PumaSepticError
    from puma_septic.kinematics import forward_kinematics as forward_kinematics
    from puma_septic.kinematics import inverse_kinematics as inverse_kinematics
    from puma_septic.kinematics import inverse_kinematics_batch as inverse_kinematics_batch
    from puma_septic.kinematics import jacobian as jacobian
    from puma_septic.kinematics import tool_motion as tool_motion
    from puma_septic.motion import Motion as Motion
    from puma_septic.motion import compute_motion as compute_motion
    from puma_septic.piecewise import Piecewise as Piecewise
    from puma_septic.profiles import lspb as lspb
    from puma_septic.profiles import quintic_segments as quintic_segments
    from puma_septic.profiles import septic as septic
    from puma_septic.robot import Actuator as Actuator
    from puma_septic.robot import Limits as Limits
    from puma_septic.robot import Payload as Payload
    from puma_septic.robot import Robot as Robot
    from puma_septic.robot import Wrench as Wrench
    from puma_septic.robot import load_robot as load_robot
    from puma_septic.trajectory import Trajectory as Trajectory
else:  # hidden from the type checker, which would take every misspelt name for an attribute

    def __getattr__(name: str) -> object:
        """Load a public name from its home; a module that is public itself is its own home."""
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        home = _HOMES[name]
        module = import_module(f"{__name__}.{home}")
        globals()[name] = value = module if home == name else getattr(module, name)
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
