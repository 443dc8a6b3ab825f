"""The paper reproduced: tables, profiles, computing times, and every claim with its verdict."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from puma_septic.document import SCHEMAS, card, one_line, plain
from puma_septic.paper import _claims_of_motion, _claims_of_profiles
from puma_septic.paper._claim import Claim
from puma_septic.paper._evidence import TIME_STEP, Evidence, gather
from puma_septic.paper._inputs import PAPER, POINTS, PaperInputs
from puma_septic.robot import Robot, load_robot
from puma_septic.validation import Array, checked_number
from puma_septic.views.tables import Cell, text_table

__all__ = ["PaperReport", "reproduce"]

# Whatever changes in the layout of the document changes this.
_ORDER: Final = ("holds", "holds in part", "does not hold", "not stated", "not tested")
_JUDGES: Final[tuple[Callable[[Evidence], Claim], ...]] = (
    _claims_of_profiles.claim_1,
    _claims_of_profiles.claim_2,
    _claims_of_profiles.claim_3,
    _claims_of_profiles.claim_4,
    _claims_of_profiles.claim_5,
    _claims_of_profiles.claim_6,
    _claims_of_profiles.claim_7,
    _claims_of_profiles.claim_8,
    _claims_of_motion.claim_9,
    _claims_of_motion.claim_10,
    _claims_of_motion.claim_11,
    _claims_of_motion.claim_12,
    _claims_of_motion.claim_13,
)


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PaperReport:
    """What `reproduce` finds.

    Attributes
    ----------
    evidence : Evidence
        Tables, assessments, durations and computing times, with the inputs that they came from.
    claims : tuple of Claim
        All thirteen, in order.
    """

    evidence: Evidence
    claims: tuple[Claim, ...]

    @property
    def table_1(self) -> Array:
        """Joint angles of the four points from the Cartesian points, rad, shape (4, 6)."""
        return self.evidence.table_1

    @property
    def table_2(self) -> Array:
        """Coefficients of the septic, ascending powers of t, shape (8, 6)."""
        return self.evidence.table_2

    def to_dict(self) -> dict[str, Any]:
        """A JSON-ready document; SI units, "unbounded" for infinity, null for what is not known."""
        e = self.evidence
        return {
            "schema": SCHEMAS["paper"],
            "robot": e.robot.name,
            "branch": e.branch,
            "table_1": e.table_1.tolist(),
            "table_1_largest_difference": float(np.abs(e.table_1 - e.inputs.table_1).max()),
            "table_2": e.table_2.tolist(),
            "table_2_largest_difference": float(np.abs(e.table_2 - e.inputs.table_2).max()),
            "computing_times": {
                "septic": e.computing.septic,
                "lspb": e.computing.lspb,
                "median_of_runs": e.computing.runs,
                "instants": e.computing.instants,
            },
            "least_durations": {name: plain(found.duration) for name, found in e.least_durations.items()},
            "assessments": [one.to_dict() for one in (e.septic, e.lspb, e.quintic)],
            "claims": [
                {
                    "number": claim.number,
                    "text": claim.text,
                    "source": claim.source,
                    "verdict": claim.verdict,
                    "explanation": claim.explanation,
                    "measured": plain(claim.measured),
                }
                for claim in self.claims
            ],
        }

    @property
    def verdict(self) -> str:
        """How many claims hold, hold in part, do not hold, are not stated or not tested, in one sentence."""
        counts = Counter(claim.verdict for claim in self.claims)
        said = (f"{counts[verdict]} {_plural(verdict, counts[verdict])}" for verdict in _ORDER if counts[verdict])
        return f"Of the paper's {len(self.claims)} claims {', '.join(said)}"

    @property
    def summary(self) -> str:
        """The verdict, and one line for each claim."""
        rows = [[claim.number, claim.text, claim.verdict] for claim in self.claims]
        more = "More: -v shows tables, computing times and the reason of each verdict."
        return f"{self.verdict}.\n\n{text_table(['', 'claim', 'verdict'], rows)}\n\n{more}"

    def __str__(self) -> str:
        e = self.evidence
        parts = [
            f"Table 1 from the Cartesian points, rad (branch {e.branch!r}; {_difference(e.table_1, e.inputs.table_1)})",
            _table(["point", *e.robot.joint_names], POINTS, e.table_1),
            f"Table 2: coefficients of t^0 to t^7 ({_difference(e.table_2, e.inputs.table_2)})",
            _table(["power", *e.robot.joint_names], [f"t^{k}" for k in range(len(e.table_2))], e.table_2),
            _peaks(e),
            _computing(e),
            "The paper's claims",
            "\n\n".join(map(str, self.claims)),
        ]
        return "\n\n".join(parts)

    def __repr__(self) -> str:
        return one_line("PaperReport", self._facts())

    def _repr_html_(self) -> str:
        return card("PaperReport", self._facts())

    def _facts(self) -> dict[str, object]:
        return {"verdict": self.verdict}


def reproduce(
    robot: Robot | None = None,
    *,
    inputs: PaperInputs = PAPER,
    runs: int = 201,
    clock: Callable[[], float] = time.perf_counter,
) -> PaperReport:
    """Compute the paper's tables and profiles, and judge its claims.

    Every verdict is a function of the inputs and the robot; change one and the verdicts follow.

    Parameters
    ----------
    robot : Robot, optional
        A PUMA 560; `load_robot()` by default. Its tool becomes the wrist centre.
    inputs : PaperInputs
        What the paper prints.
    runs : int
        How often each profile is computed to time it; the median counts.
    clock : callable
        Returns seconds. The computing times depend on it and on the machine; of the verdicts, only claim 9's.

    Returns
    -------
    PaperReport

    Raises
    ------
    InputError
        For inputs that no profile can be made from.
    NoSolution
        For a point out of reach.

    Examples
    --------
    >>> from puma_septic.paper import reproduce
    >>> report = reproduce(runs=5)
    >>> report.claims[5].verdict, report.claims[5].measured["septic_max_rad"]
    ('does not hold', 2.6193)
    """
    count = int(checked_number("runs", runs, at_least=1))
    evidence = gather(load_robot() if robot is None else robot, inputs, runs=count, clock=clock)
    return PaperReport(evidence=evidence, claims=tuple(judge(evidence) for judge in _JUDGES))


def _plural(verdict: str, count: int) -> str:
    """A verdict of one claim, as it reads of several."""
    if verdict.startswith("not"):
        return f"{'is' if count == 1 else 'are'} {verdict}"
    return verdict if count == 1 else verdict.replace("does", "do").replace("holds", "hold")


def _difference(computed: Array, printed: Array) -> str:
    return f"at most {np.abs(computed - printed).max():.1e} from the printed one"


def _table(headers: list[str], names: Any, values: Array) -> str:
    # Adding 0.0 turns -0.0000 into 0.0000.
    rows = [[name, *(f"{value:z.4f}" for value in row)] for name, row in zip(names, values, strict=True)]
    return text_table(headers, rows)


def _peaks(e: Evidence) -> str:
    """Peaks of all three profiles side by side, with what the paper leaves out."""
    quantities = (("velocity", "rad/s"), ("acceleration", "rad/s^2"), ("jerk", "rad/s^3"), ("torque", "N m"))
    rows: list[list[Cell]] = [
        [f"{quantity} [{unit}]", one.motion.trajectory.profile, *map(float, getattr(one, f"peak_{quantity}"))]
        for quantity, unit in quantities
        for one in (e.septic, e.lspb, e.quintic)
    ]
    head = f"Peaks of septic, LSPB (blend time {e.inputs.blend_time:g} s) and three-segment quintic"
    return head + "\n\n" + text_table(["peak", "profile", *e.robot.joint_names], rows)


def _computing(e: Evidence) -> str:
    """Figures 6 and 7."""
    return (
        f"Computing times, medians of {e.computing.runs} runs of making the coefficients and evaluating all joints"
        f" at {e.computing.instants} instants ({TIME_STEP:g} s apart), on this machine:\n"
        f"septic {1e6 * e.computing.septic:z.0f} us (the paper prints {e.inputs.septic_seconds:z.6f} s), LSPB"
        f" {1e6 * e.computing.lspb:z.0f} us (the paper prints {e.inputs.lspb_seconds:z.6f} s)"
    )
