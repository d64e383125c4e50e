"""The command `python -m crossgait.sweep`."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from crossgait import _core
from crossgait.commands import INTERRUPTED, exit_code, say
from crossgait.errors import ConfigError
from crossgait.files import Named, check_outputs, noting_reads, written_whole
from crossgait.sweep.cluster import RayCluster
from crossgait.sweep.executors import Executor
from crossgait.sweep.pool import ProcessPool, usable_cores
from crossgait.sweep.rows import write_sorted
from crossgait.sweep.runner import Summary, sweep
from crossgait.sweep.runs import Run
from crossgait.sweep.study import Study

SHOWN_RUNS = 10  #: of a dry run

DESCRIPTION = """\
Make a grid of runs on all cores or a Ray cluster. Rows are appended to a file of stored runs, each with the hash of
all that its result depends on: stop it, kill it or lose a machine, and the same command goes on where it was.

A study, in YAML; every value may be a list, which makes it an axis of the grid:

    starts: 12
    walks:
      - terrain: [flat, rough]
        gait: [trot, walk]
        parameters: {step_height: [0.02, 0.03]}
        seconds: 2

Defaults: see --print-config. All keys: docs/sweeps.md.
"""

EXAMPLES = """\
examples:
  python -m crossgait.sweep study.yaml --dry-run
  python -m crossgait.sweep study.yaml --workers 8
  python -m crossgait.sweep study.yaml --ray auto --json summary.json
  python -m crossgait.sweep study.yaml --sorted rows.jsonl
  crossgait verdict --gait trot --terrain rough --seconds 2 --runs study.jsonl
"""


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m crossgait.sweep",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("study", metavar="STUDY.yaml")
    parser.add_argument("--runs", metavar="FILE.jsonl", help="where rows are (default: STUDY.jsonl beside the study)")
    parser.add_argument("--workers", metavar="N", type=_count, help="processes, or CPUs of the cluster (default: all)")
    parser.add_argument("--ray", metavar="ADDRESS", help="run on this Ray cluster: HOST:PORT, or auto")
    parser.add_argument("--retry-failed", action="store_true", help="make runs again that failed")
    parser.add_argument("--sorted", metavar="FILE", help="at the end, write the study's rows in the grid's order")
    parser.add_argument("--json", metavar="FILE", help="write a summary; - is standard output")
    parser.add_argument("--print-config", action="store_true", help="print the study with every default, and end")
    parser.add_argument("--dry-run", action="store_true", help="say how many runs there are, show the first, and end")
    return parser


def _count(text: str) -> int:
    number = int(text) if text.isascii() and text.isdecimal() and len(text) < 9 else 0
    if not 1 <= number <= _core.MOST_WORKERS:
        raise argparse.ArgumentTypeError(f"expected 1 to {_core.MOST_WORKERS}, found {text!r}")
    return number


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


class _Line:
    """One line of a terminal that says how far it is."""

    def __init__(self) -> None:
        self._next = 0.0

    def __call__(self, summary: Summary) -> None:
        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + 0.5
        rate = summary.runs_per_second
        left = f", {_duration(summary.missing / rate)} left" if rate > 0 else ""
        failed = f", {summary.failed} failed" if summary.failed else ""
        workers = f"{summary.workers} worker{'s' if summary.workers != 1 else ''}"
        done = summary.runs - summary.missing
        sys.stderr.write(f"\r\x1b[K{done}/{summary.runs} runs, {rate:.3g} runs/s on {workers}{left}{failed}")
        sys.stderr.flush()

    def clear(self) -> None:
        sys.stderr.write("\r\x1b[K")
        sys.stderr.flush()


def _describe(summary: Summary, rows: Path) -> str:
    parts = [f"{summary.made} of {summary.runs} runs made"]
    if summary.there_before:
        parts.append(f"{summary.there_before} were there")
    if summary.failed:
        parts.append(f"{summary.failed} failed (their rows say why)")
    if summary.made:
        parts.append(f"{_duration(summary.seconds)}, {summary.runs_per_second:.3g} runs/s")
    return f"{', '.join(parts)}: {rows}"


def _dry_run(study: Study) -> None:
    runs = study.runs()
    print(f"{len(runs)} runs")
    for run in runs[:SHOWN_RUNS]:
        say(f"  {run}")
    if len(runs) > SHOWN_RUNS:
        print(f"  and {len(runs) - SHOWN_RUNS} more")


def _write_json(target: str, summary: Summary, rows: Path) -> None:
    text = json.dumps({"rows": str(rows), **summary.to_dict()}, indent=2) + "\n"
    if target == "-":
        sys.stdout.write(text)
    else:
        with written_whole(target) as beside:
            beside.write_text(text)


def _run(options: argparse.Namespace) -> int:
    study = Study.load(options.study)
    if options.print_config:
        print(study.to_yaml(), end="")
        return 0
    if options.dry_run:
        _dry_run(study)
        return 0
    if options.sorted == "-":
        raise ConfigError("command line", "--sorted", "the name of a file (./- is one)", '"-"')
    rows = Path(options.runs) if options.runs else Path(options.study).with_suffix(".jsonl")
    with noting_reads() as read:
        runs = study.runs()
    inputs: list[Named] = [("STUDY.yaml", options.study), *read]
    store: list[Named] = [("--runs", rows), ("--runs", f"{rows}.index")]
    check_outputs([("--json", options.json), ("--sorted", options.sorted)], [*inputs, *store])
    check_outputs(store, inputs)

    def executor() -> Executor[Run, str]:
        if options.ray is not None:
            return RayCluster(options.ray, options.workers)
        return ProcessPool(min(options.workers or usable_cores(), max(len(runs), 1)))

    line = _Line() if sys.stderr.isatty() else None
    try:
        summary = sweep(runs, rows, executor, retry_failed=options.retry_failed, listener=line)
    finally:
        if line is not None:
            line.clear()
    if options.json:
        _write_json(options.json, summary, rows)
    if summary.interrupted:
        kept = summary.runs - summary.missing
        there = f"{kept} of {summary.runs} runs are in {rows}"
        say(f"interrupted: {there}; the same command goes on from here", error=True)
        return INTERRUPTED
    if options.sorted:
        write_sorted(rows, (run.hash for run in runs), options.sorted)
    if options.json != "-":
        say(_describe(summary, rows))
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Do it; returns the exit code."""
    options = _parser().parse_args(arguments)
    return exit_code("crossgait.sweep", lambda: _run(options), "interrupted: before the first run")


if __name__ == "__main__":
    sys.exit(main())
