"""What one section of a report is made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, final

from markupsafe import Markup

from puma_septic.assessment import Assessment
from puma_septic.pictures import Picture
from puma_septic.task import ResolvedTask, Task
from puma_septic.views.checks import to_spare, unmet_html

__all__ = ["Case", "DriveUse", "boxed", "in_reserve", "titled"]


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DriveUse:
    """A joint's drive on the first screen: its parts where they were chosen, and the limit that it uses most."""

    joint: str
    parts: str
    limit: str
    use: str
    percent: float
    is_violated: bool


@final
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Case:
    """One section of a report.

    Attributes
    ----------
    title : str
    assessments : tuple of Assessment
        What is drawn and tabled, at least one.
    labels : list of str
        Their names.
    is_feasible : bool
    sentence, reason : str
        The verdict, and why it cannot be otherwise, if that is known.
    preface : Markup
        What stands between the verdict and the rest.
    pictures : tuple of Picture
        Of a comparison or sizing, after the preface.
    resolved : ResolvedTask or None
        The task, where there is one.
    inputs : mapping or None
        Of a sizing: what repeats it.
    is_undecided : bool
        Whether too little is known of the parts.
    task : Task or None
        Of a cycle.
    point_names : tuple of str
        Of the points that a cycle stops at.
    no_replay : str
        Why there is no replay here; "" where there is one.
    drives : tuple of DriveUse
        Of a sizing: what the first screen shows in place of the motion's own limits.
    heading : str
        What stands above the sentence instead of "feasible" or "infeasible".
    margin : float
        Share of each limit that has to be left, see `Assessment.keeps`.
    """

    title: str
    assessments: tuple[Assessment, ...]
    labels: list[str]
    is_feasible: bool
    sentence: str
    reason: str = ""
    preface: Markup = Markup("")  # noqa: RUF009 - a constant text
    pictures: tuple[Picture, ...] = ()
    resolved: ResolvedTask | None = None
    inputs: Mapping[str, Any] | None = None
    is_undecided: bool = False
    task: Task | None = None
    point_names: tuple[str, ...] = ()
    no_replay: str = ""
    heading: str = ""
    drives: tuple[DriveUse, ...] = ()
    margin: float = 0.0

    @property
    def keeps_margin(self) -> bool:
        """Whether every known limit is kept with the margin that was asked for, if one was."""
        return not self.margin or not any(one.keeps(self.margin) for one in self.assessments)

    @property
    def word(self) -> str:
        """The verdict in a word, and that it rests on doubtful data if it does, or what stands in its place."""
        if self.heading:
            return self.heading
        if self.is_undecided or any(one.undecided for one in self.assessments):
            return "undecided"
        word = "feasible" if self.is_feasible else "infeasible"
        if self.is_feasible:
            word = f"{word if self.keeps_margin else 'not kept'}{to_spare(self.margin)}"
        return f"{word}, on doubtful data" if self.doubts else word

    @property
    def doubts(self) -> tuple[str, ...]:
        """What the verdict rests on and should not be trusted."""
        return tuple(dict.fromkeys(doubt for one in self.assessments for doubt in one.doubts))

    @property
    def colour(self) -> str:
        """The style of the verdict: never the colour of what is good where the data are doubtful."""
        return "bad" if not (self.is_feasible and self.keeps_margin) else "doubtful" if self.doubts else "good"


def in_reserve(case: Case, margin: float) -> Case:
    """The section where so much of each limit has to be left, with what does not leave it in a table first."""
    named = zip(case.labels, case.assessments, strict=True)
    unmet = [(label, checks) for label, one in named if margin and (checks := one.keeps(margin))]
    tables = boxed("\n".join(unmet_html(label, checks, margin) for label, checks in unmet)) if unmet else Markup("")
    return replace(case, margin=margin, preface=tables + case.preface)


def boxed(html: str) -> Markup:
    """Each table that has no box yet scrolls in one of its own. What values show of themselves is escaped already."""
    if '<div class="scroll"' not in html:
        html = html.replace("<table>", '<div class="scroll"><table>').replace("</table>", "</table></div>")
    return Markup('<div class="preface">{}</div>').format(Markup(html))


def titled(group: Sequence[Assessment], title: str | None) -> str:
    return group[0].motion.robot.name if title is None else title
