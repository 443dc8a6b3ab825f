"""Do the tests find what is wrong? Seeded mutants of the core rooms, by cosmic-ray: ``python -m campaign.mutants``.

Of each room some mutants are drawn, and each is tested by the quick tests that belong to its room. What survives is
written down with its difference, to be killed by a new test or told equivalent. Needs the package cosmic-ray.
"""

from __future__ import annotations

import argparse
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Final

from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import TestOutcome

from puma_septic.views.tables import text_table

ROOMS: Final = {
    "piecewise": ("piecewise", "tests/piecewise tests/test_trajectory.py"),
    "profiles": ("profiles", "tests/profiles"),
    "trajectory": ("trajectory.py", "tests/test_trajectory.py tests/profiles"),
    "friction": ("friction.py", "tests/test_friction.py tests/test_dynamics.py"),
    "dynamics": ("dynamics.py", "tests/test_dynamics.py tests/robot tests/simulation/test_simulate.py"),
    "motion": ("motion.py", "tests/test_motion.py tests/test_truth.py tests/assessment"),
    "limit_check": ("limit_check.py", "tests/test_limit_check.py tests/assessment"),
    "assessment": ("assessment", "tests/assessment tests/cycle tests/test_truth.py"),
    "robot": ("robot", "tests/robot"),
    "drives": ("drives", "tests/drives tests/sizing"),
    "sizing": ("sizing", "tests/sizing"),
}
# Annotations such as ``A | None`` are never evaluated; without decorators that make values nothing imports.
_LEFT_OUT: Final = ("BinaryOperator_BitOr", "RemoveDecorator")
_LONGEST: Final = 300.0  # s, for a mutant that makes a loop endless


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
        for room in given.rooms or ROOMS:
            killed, left = _room(clone, room, given.each, random.Random(f"{given.seed} {room}"))
            rows.append([room, str(killed + len(left)), str(killed), f"{100 * killed / (killed + len(left)):.0f} %"])
            print(*rows[-1], flush=True)
            survived.writelines(left)
            survived.flush()
    print(text_table(["room", "mutants", "killed", "share"], rows))
    return 0


def _room(clone: Path, room: str, count: int, draw: random.Random) -> tuple[int, list[str]]:
    """How many mutants of a room its tests kill, and the differences of those that survive."""
    module, tests = ROOMS[room]
    config, session = clone / f"{room}.toml", clone / f"{room}.sqlite"
    pytest = f"{sys.executable} -m pytest -x -q -n0 -p no:cacheprovider {tests}"
    config.write_text(
        f'[cosmic-ray]\nmodule-path = "puma_septic/{module}"\ntimeout = {_LONGEST}\nexcluded-modules = []\n'
        f'test-command = "{pytest}"\n[cosmic-ray.distributor]\nname = "local"\n'
    )
    environment = {**os.environ, "PYTHONPATH": str(clone), "PYTHONDONTWRITEBYTECODE": "1"}

    def cosmic_ray(command: str) -> None:
        subprocess.run(["cosmic-ray", command, config, session], cwd=clone, env=environment, check=True)

    subprocess.run(pytest.split(), cwd=clone, env=environment, check=True, stdout=subprocess.DEVNULL)
    cosmic_ray("init")
    with use_db(session, WorkDB.Mode.open) as database:
        every = [
            item
            for item in database.work_items
            if not any(part in item.mutations[0].operator_name for part in _LEFT_OUT)
        ]
        database.clear()
        database.add_work_items(draw.sample(every, min(count, len(every))))
    cosmic_ray("exec")
    with use_db(session, WorkDB.Mode.open) as database:
        results = [result for _, result in database.results]
    left = [f"{result.diff}\n" for result in results if result.test_outcome is TestOutcome.SURVIVED]
    return len(results) - len(left), left


if __name__ == "__main__":
    raise SystemExit(main())
