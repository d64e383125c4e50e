"""A long sweep on a Ray cluster of two nodes on this machine, one of which is lost again and again.

    python python/benchmarks/sweep_nodes.py [--runs 100000] [--seconds 0.1] [--losses 10] [--json FILE]

Each loss ends the second node at once, with the run that it is making, and adds another. Fails unless every run has
one row, and rows of a sample are those of a loop.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from train_workers import NODE, two_nodes

from crossgait import available_engines
from crossgait.sweep import RayCluster, Study, Summary, row_of, sweep

STUDY = "engines: [{engine}]\nstarts: {count}\nwalks: [{{seconds: {seconds}}}]\n"
SAMPLE = 200  #: rows that are made again


def main() -> int:
    """Sweep, and compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=100_000)
    parser.add_argument("--seconds", type=float, default=0.1)
    parser.add_argument("--losses", type=int, default=10)
    parser.add_argument("--json")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, two_nodes() as cluster:
        found = measure(options, Path(folder), cluster)
    print(json.dumps(found, indent=1))
    if options.json:
        Path(options.json).write_text(json.dumps(found, indent=1) + "\n")
    wanted = {"rows": options.runs, "unlike": 0, "losses": options.losses}
    return 0 if found.items() >= wanted.items() else 1


def measure(options: argparse.Namespace, folder: Path, cluster: Any) -> dict[str, Any]:
    """What came of it: rows, unlike ones of a sample, losses, wall time."""
    file = folder / "study.yaml"
    file.write_text(STUDY.format(engine=available_engines()[0], count=options.runs, seconds=options.seconds))
    runs = Study.load(file).runs()
    rows = folder / "rows.jsonl"
    losses: list[int] = []

    def lose_a_node(summary: Summary) -> None:
        due = (len(losses) + 1) * options.runs // (options.losses + 1)
        if summary.made >= due and len(losses) < options.losses:
            losses.append(summary.made)
            for node in list(cluster.worker_nodes):
                cluster.remove_node(node, allow_graceful=False)
            cluster.add_node(**NODE)
            print(f"{summary.made} of {options.runs} made: a node is lost", file=sys.stderr, flush=True)

    begin = time.monotonic()
    summary = sweep(runs, rows, lambda: RayCluster(cluster.address), listener=lose_a_node)
    seconds = time.monotonic() - begin
    made = rows.read_text().splitlines()
    step = max(1, len(runs) // SAMPLE)
    again = [row_of(run).strip() for run in runs[::step]]
    known = set(made)
    return {
        "runs": options.runs,
        "rows": len(known) if len(known) == len(made) else -1,
        "made": summary.made,
        "failed": summary.failed,
        "crashes": summary.crashes,
        "unlike": sum(row not in known for row in again),
        "sample": len(again),
        "losses": len(losses),
        "wall_seconds": round(seconds, 1),
        "runs_per_second": round(options.runs / seconds, 1),
    }


if __name__ == "__main__":
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    sys.exit(main())
