"""What `crossgait.rsl_rl` costs and reaches: so much CPU time of PPO of rsl-rl-lib on a bundled robot.

    python python/benchmarks/rsl_rl_minute.py [--seconds 60] [--seed 1 --seed 2 --seed 3] [--json FILE]

Joints of `serial_quadruped` on flat ground, 64 environments, the environment and reward of the preset `joints` with a
command of 0.4 m/s. Before and after: means per step of the reward and of the speed forward, without exploration, over
two episodes everywhere. Time is CPU time of the process, on one thread of PyTorch and one of the core, so that other
work on the machine takes nothing of it. Fails where training did not raise the reward. Needs `crossgait[rsl-rl]`.
"""

from __future__ import annotations

import argparse
import io
import json
import sys
import tempfile
import time
import warnings
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
import torch
from rsl_rl.runners import OnPolicyRunner

from crossgait.rsl_rl import VecEnv
from crossgait.train import Plan

COUNT, LENGTH = 64, 24  #: environments, steps of a rollout
CONFIGURATION: dict[str, Any] = {
    "num_steps_per_env": LENGTH,
    "save_interval": 10**6,
    "obs_groups": {"actor": ["policy"], "critic": ["policy"]},
    "actor": {
        "class_name": "rsl_rl.models.MLPModel",
        "hidden_dims": [128, 128],
        "activation": "elu",
        "obs_normalization": True,
        "distribution_cfg": {"class_name": "rsl_rl.modules.GaussianDistribution", "init_std": 0.3},
    },
    "critic": {
        "class_name": "rsl_rl.models.MLPModel",
        "hidden_dims": [128, 128],
        "activation": "elu",
        "obs_normalization": True,
    },
    "algorithm": {"class_name": "rsl_rl.algorithms.PPO", "learning_rate": 1e-3, "num_mini_batches": 4},
}


def judged(runner: OnPolicyRunner, envs: VecEnv) -> dict[str, float]:
    """Means per step without exploration, over two episodes."""
    policy = runner.get_inference_policy()
    rewards, speeds = list[float](), list[float]()
    with torch.inference_mode():
        for _ in range(2 * envs.max_episode_length):
            rewards.append(float(envs.step(policy(envs.get_observations()))[1].mean()))
            speeds.append(float(envs.vector.batch.base_linear_velocity_b[:, 0].mean()))
    return {"reward": float(np.mean(rewards)), "speed_mps": float(np.mean(speeds))}


def added(envs: VecEnv, steps: int = 400) -> list[float]:
    """What VecEnv adds to a step of all environments and their terms, us: quartiles."""
    actions, core = torch.zeros(COUNT, envs.num_actions), envs.vector.core
    step, within = core.step, 0.0

    def timed(numbers: Any) -> Any:
        nonlocal within
        begin = time.process_time()
        result = step(numbers)
        within = time.process_time() - begin
        return result

    core.step = timed  # type: ignore[method-assign]
    found = []
    for _ in range(steps):
        begin = time.process_time()
        envs.step(actions)
        found.append(1e6 * (time.process_time() - begin - within))
    return [float(value) for value in np.percentile(found, (25, 50, 75))]


def train(seconds: float, seed: int) -> dict[str, Any]:
    """One run."""
    torch.manual_seed(seed)
    keys = Plan.preset("joints").stages[0].environment.updated(command={"vx": 0.4}, episode_seconds=4, engine="mujoco")
    envs = VecEnv("Crossgait/JointControl-v0", COUNT, seed=seed, config=keys, workers=1)
    stepping = 0.0
    step = envs.step

    def timed(actions: torch.Tensor) -> Any:
        nonlocal stepping
        begin = time.process_time()
        result = step(actions)
        stepping += time.process_time() - begin
        return result

    with tempfile.TemporaryDirectory() as folder:
        with redirect_stdout(io.StringIO()):
            runner = OnPolicyRunner(envs, CONFIGURATION, folder)
        before = judged(runner, envs)
        envs.step = timed  # type: ignore[method-assign]
        begin, iterations = time.process_time(), 0
        while time.process_time() - begin < seconds:
            with redirect_stdout(io.StringIO()):
                runner.learn(10, init_at_random_ep_len=iterations == 0)
            iterations += 10
        took = time.process_time() - begin
        envs.step = step  # type: ignore[method-assign]
        after = judged(runner, envs)
    steps = iterations * LENGTH * COUNT
    said = {"seed": seed, "before": before, "after": after, "steps": steps, "steps_per_second": steps / took}
    return said | {"share_of_environments": stepping / took, "added_us": added(envs)}


def main() -> int:
    """Train, and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60, help="of CPU time, of each run")
    parser.add_argument("--seed", type=int, action="append", help="1, 2 and 3 if none is given")
    parser.add_argument("--json", metavar="FILE", help="write the figures there")
    options = parser.parse_args()
    warnings.simplefilter("ignore")  # of rsl_rl and what it imports
    torch.set_num_threads(1)
    runs = [train(options.seconds, seed) for seed in options.seed or (1, 2, 3)]
    for run in runs:
        a, b, (low, middle, high) = run["before"], run["after"], run["added_us"]
        print(
            f"seed {run['seed']}: reward {a['reward']:.3f} to {b['reward']:.3f}, speed {a['speed_mps']:.3f} to "
            f"{b['speed_mps']:.3f} m/s, {run['steps']} steps, {run['steps_per_second']:.0f} steps/s, "
            f"{100 * run['share_of_environments']:.0f} % in environments; "
            f"added to a step of {COUNT} {middle:.0f} us ({low:.0f} to {high:.0f})"
        )
    if options.json:
        Path(options.json).write_text(json.dumps(runs, indent=1) + "\n")
    return 0 if all(run["after"]["reward"] > run["before"]["reward"] for run in runs) else 1


if __name__ == "__main__":
    sys.exit(main())
