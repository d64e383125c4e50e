"""What a sweep adds to a loop over the same runs, and what bounds it.

    python python/benchmarks/sweep_overhead.py [--rounds 5] [--runs 8] [--seconds 1] [--workers 2] [--ray auto|local]
    python python/benchmarks/sweep_overhead.py --walk 8 --workers 1

Runs are waited for instead of computed, so that the machine's other work does not count as the sweep's; everything
else is real: hand-out, rows of the usual size, the file with its lock and fsync. With --walk they are walks of so many
seconds. Loop and sweep take turns; figures are medians and quartiles over rounds. Workers are started before, as they
are once in a sweep of hours.
"""

from __future__ import annotations

import argparse
import functools
import json
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from crossgait import available_engines
from crossgait.sweep import Executor, ProcessPool, RayCluster, RowFile, Run, Study, row_of, sweep
from crossgait.sweep.executors import Make

STUDY = "engines: [{engine}]\nstarts: {count}\nwalks: [{{seconds: {seconds}}}]\n"
EMPTY = 1000  #: runs that take no time


def waited_for(seconds: float, row: str, run: Run) -> str:
    """A row of the usual size after this time."""
    time.sleep(seconds)
    return row.replace("HASH", run.hash)


class Started:
    """Workers that outlive a sweep."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor

    def __getattr__(self, name: str) -> Any:
        return getattr(self._executor, name)

    def close(self) -> None:
        """Stay."""


@contextmanager
def started(make: Callable[[], Executor], run: Run) -> Iterator[Callable[[], Started]]:
    """Workers that have all made a run."""
    executor = make()
    expected = executor.workers
    for _ in range(expected):
        executor.submit(run)
    while expected:
        expected -= len(executor.wait(1))
    try:
        yield lambda: Started(executor)
    finally:
        executor.close()


def loop(runs: list[Run], make: Callable[[Run], str], file: Path) -> float:
    """Wall time of the loop that a sweep stands for, s."""
    begin = time.monotonic()
    with file.open("w") as rows:
        for run in runs:
            rows.write(make(run) + "\n")
            rows.flush()
    return time.monotonic() - begin


def swept(runs: list[Run], executor: Callable[[], Any], file: Path) -> tuple[float, float]:
    """Wall time of a sweep, and CPU time of the process that sweeps, s."""
    file.unlink(missing_ok=True)
    wall, cpu = time.monotonic(), time.process_time()
    assert sweep(runs, file, executor).missing == 0
    return time.monotonic() - wall, time.process_time() - cpu


def quartiles(values: list[float]) -> list[float]:
    """Median, lower and upper quartile."""
    return [float(value) for value in np.percentile(values, (50, 25, 75))]


def writing(row: str, file: Path, count: int = 2000) -> float:
    """Wall time of appending a row, s."""
    with RowFile(file) as rows:
        begin = time.monotonic()
        for i in range(count):
            rows.add(row.replace("HASH", f"{i:016x}"))
        rows.sync()
        return (time.monotonic() - begin) / count


def executors(options: argparse.Namespace) -> dict[str, Callable[[Make], Executor]]:
    """By name, each of a function that makes rows."""
    kinds: dict[str, Callable[[Make], Executor]] = {"pool": functools.partial(ProcessPool, options.workers)}
    if options.ray:
        connect(options.ray, options.workers)
        kinds["ray"] = functools.partial(RayCluster, options.ray, None)
    return kinds


def measure(options: argparse.Namespace, folder: Path) -> dict[str, Any]:
    """All figures by name."""
    file, study = folder / "rows.jsonl", folder / "study.yaml"
    count = options.runs * options.workers
    study.write_text(STUDY.format(engine=available_engines()[0], count=count, seconds=options.walk or 0.1))
    runs = Study.load(study).runs()
    first = row_of(runs[0])
    row = first.replace(runs[0].hash, "HASH")
    figures: dict[str, Any] = {"workers": options.workers, "row_bytes": len(first) + 1}
    figures["write_row_us"] = quartiles([1e6 * writing(row, folder / f"{i}.jsonl") for i in range(options.rounds)])
    at_once = functools.partial(waited_for, 0, row)
    make = row_of if options.walk else functools.partial(waited_for, options.seconds, row)
    many = [replace(runs[0], hash=f"{i:016x}") for i in range(EMPTY)]
    for name, executor in executors(options).items():
        with started(functools.partial(executor, at_once), runs[0]) as workers:
            times = [swept(many, workers, file) for _ in range(options.rounds)]
        figures[f"{name}_empty_run_us"] = quartiles([1e6 * wall / EMPTY for wall, _ in times])
        figures[f"{name}_empty_run_cpu_us"] = quartiles([1e6 * cpu / EMPTY for _, cpu in times])
        with started(functools.partial(executor, make), runs[0]) as workers:
            alone, together = [], []
            for _ in range(options.rounds):
                alone.append(loop(runs[: options.runs], make, file))
                together.append(swept(runs, workers, file)[0])
        figures[f"{name}_run_s"] = quartiles([seconds / options.runs for seconds in alone])
        shares = [100 * (swept_seconds / seconds - 1) for swept_seconds, seconds in zip(together, alone, strict=True)]
        figures[f"{name}_overhead_percent"] = quartiles(shares)
    return figures


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--runs", type=int, default=8, help="of a round, for each worker")
    parser.add_argument("--seconds", type=float, default=1.0, help="of a run")
    parser.add_argument("--walk", type=float, metavar="SECONDS", help="walks of so many seconds for runs")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--ray", metavar="ADDRESS", help="also on this cluster; local starts one of so many workers")
    parser.add_argument("--json", metavar="FILE", help="write the figures there")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        text = json.dumps(measure(options, Path(folder)), indent=2)
    print(text)
    if options.json:
        Path(options.json).write_text(text + "\n")


def connect(address: str, workers: int) -> None:
    """Start or join a cluster, and stay connected."""
    import ray

    if address == "local":
        ray.init(num_cpus=workers, include_dashboard=False, object_store_memory=80 * 2**20, log_to_driver=False)
    else:
        ray.init(address=address, log_to_driver=False)


if __name__ == "__main__":
    main()
