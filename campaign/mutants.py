"""Do the tests find what is wrong? Seeded mutants of the core rooms, by cosmic-ray: ``python -m campaign.mutants``.

Of each room some mutants are drawn. Each is put before the tests that ran the function it stands in, what these let
live before all quick tests of its room, and what these let live before its slow ones. What then survives, or runs out
of time, is written down with its difference, to be killed by a new test or told equivalent. Needs the package
cosmic-ray.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Final

from cosmic_ray.commands import init
from cosmic_ray.mutating import mutate_and_test, mutate_code
from cosmic_ray.plugins import get_operator
from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import MutationSpec, TestOutcome
from coverage import CoverageData

from puma_septic.views.tables import text_table

ROOMS: Final = {
    "piecewise": ("piecewise", "tests/piecewise tests/test_trajectory.py tests/test_reprs.py"),
    "profiles": ("profiles", "tests/profiles tests/documentation/test_api.py"),
    "trajectory": (
        "trajectory.py",
        "tests/test_trajectory.py tests/profiles/test_profiles_basic.py tests/profiles/test_profiles_vias.py"
        " tests/test_reprs.py",
    ),
    "friction": ("friction.py", "tests/test_dynamics.py tests/test_friction.py tests/test_reprs.py"),
    "dynamics": (
        "dynamics.py",
        "tests/test_dynamics.py tests/robot/test_mimic.py tests/sizing/test_bearing.py tests/limits/test_payload.py"
        " tests/simulation/test_simulate.py tests/documentation/test_api.py",
    ),
    "motion": (
        "motion.py",
        "tests/test_friction.py tests/test_motion.py tests/test_truth.py tests/assessment tests/test_reprs.py",
    ),
    "limit_check": ("limit_check.py", "tests/test_limit_check.py tests/test_quantities.py tests/assessment"),
    "assessment": ("assessment", "tests/assessment tests/cycle tests/test_truth.py"),
    "robot": ("robot", "tests/drives/test_drives.py tests/test_reprs.py tests/robot"),
    "drives": ("drives", "tests/drives tests/sizing"),
    "sizing": ("sizing", "tests/sizing"),
}
# Without them a value has another form of storage, a cache another size: slower or larger, never other numbers.
_EQUIVALENT: Final = ("slots", "maxsize")
_TRIVIAL: Final = "RemoveDecorator"  # without the decorators that make values nothing imports
_SHORTEST: Final = 120.0  # s; on a busy machine a mutant that is only slow must not look like an endless loop
_FACTOR: Final = 5.0  # how many times as long as the undisturbed tests a mutant may take
_MOST_SLOW: Final = 3600.0  # s; of a room's slow tests
OUTCOMES: Final = ("killed", "timed out", "incompetent", "survived")


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m campaign.mutants", description=__doc__)
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=f"all by default: {', '.join(ROOMS)}")
    parser.add_argument("--seed", type=int, default=560)
    parser.add_argument("--each", type=int, default=20, metavar="N", help="mutants of each room (default: 20)")
    parser.add_argument("--survivors", type=Path, default=Path("mutants-survived.txt"), metavar="FILE")
    given = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder, given.survivors.open("w") as survived:
        clone = Path(folder, "clone")
        subprocess.run(["git", "clone", "--quiet", ".", clone], check=True)
        os.chdir(clone)
        os.environ["PYTHONPATH"] = str(clone)
        for room in given.rooms or ROOMS:
            counts: Counter[str] = Counter()
            for outcome, difference in _judged(room, given.each, random.Random(f"{given.seed} {room}")):
                counts[outcome] += 1
                if outcome != "killed":
                    print(f"{room}: {outcome}\n{difference}\n", file=survived, flush=True)
            drawn = counts.total()
            rows.append(
                [room, *map(str, [drawn, *map(counts.__getitem__, OUTCOMES)]), f"{counts['killed'] / drawn:.0%}"]
            )
            print(*rows[-1], flush=True)
    print(text_table(["room", "mutants", *OUTCOMES, "share killed"], rows))
    return 0


def _judged(room: str, count: int, draw: random.Random) -> Iterator[tuple[str, str]]:
    """The outcome and the difference of each mutant that is drawn; run in a checkout that may be written to."""
    module, tests = ROOMS[room]
    pytest = f"{sys.executable} -m pytest -x -q -n0 -p no:cacheprovider"
    began = time.monotonic()
    undisturbed = f"{pytest} --cov=puma_septic --cov-context=test --cov-report= --cov-fail-under=0 {tests}"
    subprocess.run(undisturbed.split(), check=True, stdout=subprocess.DEVNULL)
    patience = max(_SHORTEST, _FACTOR * (time.monotonic() - began))
    ran = CoverageData()
    ran.read()
    every = _mutants(Path("puma_septic", module))
    for mutant in islice(filter(_compiles, draw.sample(every, len(every))), count):
        first = _first_tests(mutant, ran.contexts_by_lineno(str(mutant.module_path)))
        Path("first.txt").write_text("\n".join(first))
        stages = [("@first.txt", patience), (tests, patience), (f"-m slow {tests}", _MOST_SLOW)]
        for chosen, seconds in stages if first else stages[1:]:
            result = mutate_and_test([mutant], f"{pytest} {chosen}", seconds)
            if result.test_outcome is not TestOutcome.SURVIVED:
                break
        outcome = str(result.test_outcome.value) if result.test_outcome else "incompetent"
        yield "timed out" if result.output == "timeout" else outcome, result.diff or ""


def _mutants(module: Path) -> list[MutationSpec]:
    """All mutants of a module or a folder but those that change nothing that is ever computed."""
    paths = sorted(module.rglob("*.py")) if module.is_dir() else [module]
    unused = {path: list(_spans_without_effect(ast.parse(path.read_text()))) for path in paths}
    with use_db("mutants.sqlite", WorkDB.Mode.create) as database:
        init(paths, database, {})
        # The database has no order of its own; the draw must depend on the seed alone.
        every = sorted((item.mutations[0] for item in database.work_items), key=repr)
    return [
        mutant
        for mutant in every
        if _TRIVIAL not in mutant.operator_name
        and not any(start <= mutant.start_pos and mutant.end_pos <= end for start, end in unused[mutant.module_path])
    ]


def _compiles(mutant: MutationSpec) -> bool:
    """Whether it is Python at all: a star before arguments counts as an operator, too."""
    operator = get_operator(mutant.operator_name)(**mutant.operator_args)
    try:
        ast.parse(mutate_code(mutant.module_path.read_text(), operator, mutant.occurrence) or "")
    except SyntaxError:
        return False
    return True


def _spans_without_effect(tree: ast.Module) -> Iterator[tuple[tuple[int, int], tuple[int, int]]]:
    """Where annotations stand, which are never evaluated, and the arguments that change no number."""
    for node in ast.walk(tree):
        parts = [getattr(node, "annotation", None), getattr(node, "returns", None)]
        if isinstance(node, ast.keyword) and node.arg in _EQUIVALENT:
            parts.append(node.value)
        for part in parts:
            if part is not None:
                yield (part.lineno, part.col_offset), (part.end_lineno, part.end_col_offset)


def _first_tests(mutant: MutationSpec, contexts: dict[int, list[str]]) -> list[str]:
    """The tests that ran the body of the innermost function around a mutant; none where it stands in no function."""
    line = mutant.start_pos[0]
    tree = ast.parse(mutant.module_path.read_text())
    functions = [
        n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef) and n.lineno <= line <= (n.end_lineno or 0)
    ]
    if not functions:
        return []
    body = range(functions[-1].body[0].lineno, (functions[-1].end_lineno or 0) + 1)
    return sorted({context.partition("|")[0] for at in body for context in contexts.get(at, ()) if context})


if __name__ == "__main__":
    raise SystemExit(main())
