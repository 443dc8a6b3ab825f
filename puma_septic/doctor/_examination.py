"""A robot's data examined, and what each kind of answer may be trusted with."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, final

from puma_septic.doctor._bodies import body_findings, mesh_findings
from puma_septic.doctor._finding import ANSWERS, Finding
from puma_septic.doctor._limits import limit_findings
from puma_septic.document import SCHEMAS
from puma_septic.robot import Robot
from puma_septic.validation import checked_kind
from puma_septic.views import doctor as view

__all__ = ["Examination", "doubts", "examine"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Examination:
    """What is odd in a robot's data; made by `examine`.

    Attributes
    ----------
    robot : Robot
    findings : tuple of Finding
        The worst first: what is impossible, doubtful, missing.
    """

    robot: Robot
    findings: tuple[Finding, ...]

    @property
    def is_sound(self) -> bool:
        """Whether nothing is impossible or doubtful; what is missing is no fault."""
        return all(finding.severity == "missing" for finding in self.findings)

    @property
    def verdicts(self) -> dict[str, str]:
        """By kind of answer (`ANSWERS`): "yes", "doubtful" or "incomplete"."""
        worst = {"impossible": "doubtful", "doubtful": "doubtful", "missing": "incomplete"}
        found: dict[str, str] = {}
        for finding in self.findings:
            found.setdefault(finding.answer, worst[finding.severity])
        return {answer: found.get(answer, "yes") for answer in ANSWERS}

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document.

        Returns
        -------
        dict
        """
        return {
            "schema": SCHEMAS["doctor"],
            "robot": self.robot.name,
            "is_sound": self.is_sound,
            "verdicts": self.verdicts,
            "findings": [
                {
                    "code": finding.code,
                    "severity": finding.severity,
                    "answer": finding.answer,
                    "parts": list(finding.parts),
                    "message": finding.message,
                }
                for finding in self.findings
            ],
            "notes": list(self.robot.notes),
        }

    def __str__(self) -> str:
        return view.text(self.to_dict())


def examine(robot: Robot) -> Examination:
    """Examine a robot's data: what no arm has, what hardly any has, and what is missing.

    Numbers are kept as they are; this says which answers should not be trusted. The tensor of a link that nothing
    moving carries counts only about its axis. Meshes that are there are read.

    Parameters
    ----------
    robot : Robot

    Returns
    -------
    Examination

    Examples
    --------
    >>> import puma_septic as ps
    >>> robot = ps.load_robot()
    >>> ps.doctor.examine(robot.with_limits(effort=1000.0)).verdicts["effort limits"]
    'doubtful'
    """
    checked_kind("robot", robot, Robot)
    found = (*_quick(robot), *mesh_findings(robot), *_drive_findings(robot))
    order = ("impossible", "doubtful", "missing")
    return Examination(robot=robot, findings=tuple(sorted(found, key=lambda finding: order.index(finding.severity))))


def doubts(robot: Robot) -> tuple[str, ...]:
    """What an assessment must tell beside its verdict: messages of what is doubtful, found without reading meshes.

    What the robot's notes tell already, moments that no body has, is left to them.

    Returns
    -------
    tuple of str
    """
    told = ("inertia_impossible",)
    return tuple(
        f"doubtful {finding.answer}: {finding.message}"
        for finding in _quick(checked_kind("robot", robot, Robot))
        if finding.severity != "missing" and finding.code not in told
    )


@lru_cache(maxsize=16)
def _quick(robot: Robot) -> tuple[Finding, ...]:
    """All that needs no files; kept, as a robot never changes."""
    return (*body_findings(robot), *limit_findings(robot))


def _drive_findings(robot: Robot) -> tuple[Finding, ...]:
    unknown = tuple(
        name
        for name, train, law in zip(robot.joint_names, robot.drivetrains, robot.friction, strict=True)
        if not (train.reflected_inertia >= 0 and law.is_known)
    )
    if not unknown:
        return ()
    message = f"rotor inertia or friction not known, not in the torques: {', '.join(unknown)}"
    return (Finding(code="no_drive", severity="missing", parts=unknown, message=message),)
