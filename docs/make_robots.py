"""Write the table of docs/robots.md: what can be answered about each robot that is known by name.

Run it from anywhere: ``python docs/make_robots.py``. A test holds the page against it.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from textwrap import shorten

import numpy as np

import puma_septic as ps
from puma_septic.robot import named_robots

PAGE = Path(__file__).parent / "robots.md"
START, END = "<!-- table -->\n", "<!-- end of table -->\n"
HEAD = (
    "| robot | joints | that follow others | tool | torque | position limits | velocity limits | effort limits |"
    " friction | shapes left out |\n|---|---|---|---|---|---|---|---|---|---|\n"
)


def row(name: str) -> str:
    """One robot: how many of its joints each answer is known for, or why it is refused."""
    try:
        robot = ps.load_robot(name)
    except ps.PumaSepticError as error:
        reason = str(error).partition(": ")[2]
        return f"| {name} | refused: {shorten(reason, 160)} | | | | | | | | |\n"
    limits = robot.limits
    ranges = ~np.isnan(limits.position).any(axis=1) | robot.is_continuous
    known = [
        robot.knows_torque,
        ranges,
        ~np.isnan(limits.velocity),
        ~np.isnan(limits.effort),
        [not np.isnan([law.viscous, *law.coulomb]).all() for law in robot.friction],
    ]
    cells = [robot.n_joints, len(robot.mimics), f"`{robot.tool}`", *map(_share, known), len(robot.missing_meshes)]
    return f"| {name} | {' | '.join(map(str, cells))} |\n"


def page(rows: Iterable[str]) -> str:
    """The page with these rows."""
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(START)
    after = rest.partition(END)[2]
    return f"{before}{START}{HEAD}{''.join(rows)}{END}{after}"


def _share(known: Iterable[bool]) -> str:
    each = list(map(bool, known))
    return "all" if all(each) else f"{sum(each)} of {len(each)}" if any(each) else "none"


if __name__ == "__main__":
    PAGE.write_text(page(map(row, named_robots())), encoding="utf-8")
