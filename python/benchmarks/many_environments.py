"""What ten thousand environments at once take: time to make, reset and step them, and memory.

    python python/benchmarks/many_environments.py [--count 10000] [--engine NAME ...] [--json FILE]

Of the default configuration with policy steps of 20 ms, on two threads. Times are CPU time; memory is what the process
gained. Each engine has a process of its own. Fails where an environment takes more than docs/limits.md says.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
import time
from pathlib import Path

import numpy as np
import psutil

import crossgait
from crossgait.envs import AdaptiveGaitVectorEnv

MOST = {"mujoco": 100.0, "bullet": 600.0, "dart": 700.0}  #: kB of an environment, by the engine's name up to @ and :


def measure(engine: str, count: int) -> dict[str, float]:
    """Figures of one engine, of an environment: ms, kB."""
    process = psutil.Process()
    before, begin = process.memory_info().rss, time.process_time()
    envs = AdaptiveGaitVectorEnv(count, engine=engine, policy_dt=0.02, workers=2)
    figures = {"make_ms": time.process_time() - begin}
    begin = time.process_time()
    envs.reset(seed=1)
    figures["reset_ms"] = time.process_time() - begin
    actions = np.zeros(envs.action_space.shape)
    begin = time.process_time()
    envs.step(actions)
    figures["step_ms"] = time.process_time() - begin
    kilobytes = (process.memory_info().rss - before) / count / 1000
    return {name: 1000 * seconds / count for name, seconds in figures.items()} | {"kB": kilobytes}


def main() -> int:
    """Measure each engine, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--engine", action="append", help="all in this process that there are, if none is given")
    parser.add_argument("--json", metavar="FILE")
    options = parser.parse_args()
    found = {}
    print(f"{'engine':16} {'make, ms':>9} {'reset, ms':>9} {'step, ms':>9} {'kB':>6}   of each of {options.count}")
    for engine in options.engine or crossgait.available_engines():
        with multiprocessing.get_context("spawn").Pool(1) as alone:
            of = found[engine] = alone.apply(measure, (engine, options.count))
        numbers = f"{of['make_ms']:9.2f} {of['reset_ms']:9.2f} {of['step_ms']:9.3f} {of['kB']:6.0f}"
        print(f"{engine:16} {numbers}", flush=True)
    if options.json:
        Path(options.json).write_text(json.dumps(found, indent=1) + "\n")
    large = [e for e, of in found.items() if of["kB"] > MOST.get(e.split("@")[0].split(":")[0], np.inf)]
    if large:
        print(f"FAILED: more memory than docs/limits.md says: {', '.join(large)}")
    return 1 if large else 0


if __name__ == "__main__":
    sys.exit(main())
