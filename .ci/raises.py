"""Fail where a line that raises was executed by no test: after all tiers, of the coverage that they gathered.

A branch that only another platform or process reaches says so: ``# pragma: no cover`` with its reason.
"""

import ast
import sys
from pathlib import Path

from coverage import Coverage

gathered = Coverage()
gathered.load()
count, never = 0, []
for path in sorted(Path("puma_septic").rglob("*.py")):
    _, _, _, missing, _ = gathered.analysis2(str(path))
    raises = [one for one in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(one, ast.Raise) and one.exc]
    count += len(raises)
    never += [f"{path}:{one.lineno}: {ast.unparse(one)}" for one in raises if one.lineno in missing]
sys.stdout.write(f"{count - len(never)} of {count} errors are raised by a test\n")
sys.exit("\n".join(never) or 0)
