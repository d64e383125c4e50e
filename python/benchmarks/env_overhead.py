"""What Python adds to a step of an environment: CPU time, in turns, medians (quartiles) over rounds.

    python python/benchmarks/env_overhead.py [--engine mujoco] [--rounds 15] [--steps 2000] [--json FILE]

One environment: the C++ core alone (`crossgait rollout` of a long episode less one of a short one, the same policy
and seed), the core called from Python (`_core.Environment.step`), Gymnasium's environment without and with the wrappers
that `gymnasium.make` puts around it. Many environments on one thread: the core's vector environment, Gymnasium's and
Stable-Baselines3's on top of it.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable

import gymnasium
import numpy as np

import crossgait.envs
from crossgait import EnvironmentConfig, _core, available_engines
from crossgait.sb3 import CrossgaitVecEnv

ID = "Crossgait/AdaptiveGait-v0"
SEED = 1


def cpu_seconds(work: Callable[[], object]) -> float:
    """CPU time of the process that `work` takes, s."""
    start = time.process_time()
    work()
    return time.process_time() - start


def rollout_seconds(config: EnvironmentConfig, steps: int) -> float:
    """CPU time of one episode of that many steps and its beginning, all of it in C++, s."""
    episode = config.updated(episode_seconds=steps * config.policy_dt)
    return cpu_seconds(lambda: crossgait.rollout("zero", environment=episode, episodes=1, workers=1, seed=0))


def repeat(step: Callable[[np.ndarray], object], action: np.ndarray, times: int) -> float:
    """CPU time of a step, s."""

    def work() -> None:
        for _ in range(times):
            step(action)

    return cpu_seconds(work) / times


def single(config: EnvironmentConfig, rounds: int, steps: int) -> dict[str, list[float]]:
    """CPU times of a step by who makes it, s, round by round."""
    core = _core.Environment(config)
    env = gymnasium.make(ID, config=config)
    bare = env.unwrapped
    assert isinstance(bare, crossgait.envs.QuadrupedEnv)
    action = np.zeros(env.action_space.shape, np.float32)
    seed = _core.derived_seed(0, 0)  # of the rollout's episode
    times: dict[str, list[float]] = {name: [] for name in ("C++", "_core", "env", "gymnasium.make")}
    for _ in range(rounds):
        short = rollout_seconds(config, 1)
        times["C++"].append((rollout_seconds(config, steps + 1) - short) / steps)
        core.reset(seed)
        times["_core"].append(repeat(core.step, action, steps))
        bare.reset(seed=seed)
        times["env"].append(repeat(bare.step, action, steps))
        env.reset(seed=seed)
        times["gymnasium.make"].append(repeat(env.step, action, steps))
    return times


def many(config: EnvironmentConfig, count: int, rounds: int, steps: int) -> dict[str, list[float]]:
    """The same of a step of `count` environments on one thread."""
    core = _core.VectorEnvironment(config, count)
    envs = gymnasium.make_vec(ID, num_envs=count, config=config, workers=1)
    sb3 = CrossgaitVecEnv(ID, count, config=config, workers=1)
    actions = np.zeros(envs.action_space.shape, np.float32)
    times: dict[str, list[float]] = {name: [] for name in ("_core", "gymnasium", "stable_baselines3")}
    for _ in range(rounds):
        core.reset(SEED)
        times["_core"].append(repeat(core.step, actions, steps))
        envs.reset(seed=SEED)
        times["gymnasium"].append(repeat(envs.step, actions, steps))
        sb3.seed(SEED)
        sb3.reset()
        times["stable_baselines3"].append(repeat(sb3.step, actions, steps))
    return times


def report(title: str, times: dict[str, list[float]]) -> dict[str, dict[str, list[float]]]:
    """Print and return, in us: quartiles of the times, and of what each adds to the first in its own round."""
    print(f"\n{title}, us per step: median (quartiles)")
    first = np.array(next(iter(times.values())))
    rows = {}
    for name, seconds in times.items():
        rows[name] = {
            "step_us": np.percentile(1e6 * np.array(seconds), (25, 50, 75)).tolist(),
            "added_us": np.percentile(1e6 * (np.array(seconds) - first), (25, 50, 75)).tolist(),
        }
        (a, b, c), (d, e, f) = rows[name]["step_us"], rows[name]["added_us"]
        print(f"  {name:18} {b:9.2f} ({a:.2f} to {c:.2f})   added {e:7.2f} ({d:.2f} to {f:.2f})")
    return rows


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--engine", default=available_engines()[0], choices=available_engines())
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--steps", type=int, default=2000, help="of one environment in a round")
    parser.add_argument("--json", metavar="FILE", help="write the figures there")
    options = parser.parse_args()
    config = EnvironmentConfig(engine=options.engine, episode_seconds=1000)
    print(f"{options.engine}, policy steps of {1e3 * config.policy_dt:g} ms, {options.rounds} rounds")
    figures = {"1": report("One environment", single(config, options.rounds, options.steps))}
    for count in (4, 64):
        # Short turns: what is measured is a small part of them, and the machine's pace changes.
        steps = max(10, options.steps // (2 * count))
        times = many(config, count, 4 * options.rounds, steps)
        figures[str(count)] = report(f"{count} environments on one thread", times)
    if options.json:
        with open(options.json, "w") as file:
            json.dump({"engine": options.engine, "rounds": options.rounds, "environments": figures}, file, indent=1)


if __name__ == "__main__":
    main()
