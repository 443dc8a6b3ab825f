"""Run every benchmark and print one table each: ``python -m benchmarks``."""

from __future__ import annotations

import sys
from pathlib import Path

# The same modules whether this is run as a module or as a folder.
sys.path.insert(0, str(Path(__file__).parent))

import bench_assessment
import bench_execution
import bench_ik
import bench_limits
import bench_paths
import bench_processes
import bench_profiles
import bench_sizing

from puma_septic.views.tables import text_table

for benchmark in (
    bench_assessment,
    bench_processes,
    bench_ik,
    bench_paths,
    bench_profiles,
    bench_sizing,
    bench_limits,
    bench_execution,
):
    headers, *rows = benchmark.run()
    print(text_table(headers, rows), flush=True)
    print()
