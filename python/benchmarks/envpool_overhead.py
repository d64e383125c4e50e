"""What EnvPool's environments take beyond their physics: Ant-v5 beside bare `mj_step` of the same model and motion.

    python -m venv build/envpool && build/envpool/bin/pip install envpool==1.2.5 mujoco==3.6.0
    build/envpool/bin/python python/benchmarks/envpool_overhead.py [--rounds 30] [--json FILE]

EnvPool holds whole environments on a thread pool in C++, as Crossgait does, but none of a robot of one's own, so that
the two cannot be held against each other step for step; this is its overhead, as `against_all.py` has Crossgait's over
`mujoco.batch`. The package `mujoco` is of the version that EnvPool is linked with, or this fails: states have to be the
same to rounding. Prints physics steps per core-second, and the ratio in one round, medians (quartiles).
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import envpool
import mujoco
import numpy as np

COUNT, SKIP = 64, 5  #: environments, physics steps in a step
SEEN = 13  #: where velocities begin in an observation, behind the position without x and y


def model() -> mujoco.MjModel:
    """What EnvPool reads."""
    import envpool_assets

    return mujoco.MjModel.from_xml_path(str(Path(envpool_assets.__path__[0]) / "mujoco/assets_gym/ant.xml"))


def put(bare: list[mujoco.MjData], of: mujoco.MjModel, seen: np.ndarray, infos: dict[str, Any]) -> None:
    """Put all where EnvPool's are."""
    for i, data in enumerate(bare):
        mujoco.mj_resetData(of, data)
        data.qpos[:2] = infos["x_position"][i], infos["y_position"][i]
        data.qpos[2:], data.qvel[:] = seen[i, :SEEN], seen[i, SEEN : SEEN + of.nv]


def measure(rounds: int, steps: int) -> dict[str, list[float]]:
    """Physics steps per core-second of both, round by round. Raises RuntimeError where they do not move alike."""
    keys = {"num_threads": 1, "seed": 1, "terminate_when_unhealthy": False, "max_episode_steps": 10**9}
    pool = envpool.make_gymnasium("Ant-v5", num_envs=COUNT, **keys)
    of = model()
    bare = [mujoco.MjData(of) for _ in range(COUNT)]
    random = np.random.default_rng(1)
    seen, infos = pool.reset()
    made: dict[str, list[float]] = {"EnvPool": [], "mj_step": []}
    for i in range(rounds + 1):
        actions = random.uniform(-1, 1, (steps, COUNT, of.nu))
        put(bare, of, seen, infos)
        taken = {}
        for name in ("EnvPool", "mj_step") if i % 2 else ("mj_step", "EnvPool"):
            begin = time.process_time()
            for action in actions:
                if name == "EnvPool":
                    seen, _, _, _, infos = pool.step(action)
                else:
                    for data, ctrl in zip(bare, action, strict=True):
                        data.ctrl[:] = ctrl
                        mujoco.mj_step(of, data, nstep=SKIP)
            taken[name] = time.process_time() - begin
        apart = max(float(np.abs(data.qpos[2:] - row[:SEEN]).max()) for data, row in zip(bare, seen, strict=True))
        if apart > 1e-6:  # rounding, which contacts make more of within a turn
            raise RuntimeError(f"not the same motion: {apart:.1g} apart")
        if i > 0:  # the first warms up
            for name, seconds in taken.items():
                made[name].append(steps * COUNT * SKIP / seconds)
    return made


def main() -> int:
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=30)
    parser.add_argument("--steps", type=int, default=10, help="of all environments, in a turn")
    parser.add_argument("--json", metavar="FILE", help="write the figures there")
    options = parser.parse_args()
    made = measure(options.rounds, options.steps)
    ratios = np.array(made["EnvPool"]) / np.array(made["mj_step"])
    rows = {name: np.percentile(rates, (25, 50, 75)).tolist() for name, rates in (made | {"ratio": ratios}).items()}
    print(f"EnvPool {envpool.__version__}, mujoco {mujoco.__version__}, {COUNT} environments of Ant-v5, one thread")
    for name, (low, middle, high) in rows.items():
        print(f"  {name:8} {middle:.4g} ({low:.4g} to {high:.4g})")
    if options.json:
        Path(options.json).write_text(json.dumps(rows, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
