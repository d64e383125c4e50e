"""Your policy: a short PPO, made a bundle, and what it is worth in every engine.

Run it with: python your_policy.py [STEPS]. The default is far too few to learn anything: it shows the way.
"""

from __future__ import annotations

import sys
from pathlib import Path

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecNormalize

import crossgait
from crossgait.sb3 import CrossgaitVecEnv

SETTINGS = {"terrain": "rough", "policy_dt": 0.02, "episode_seconds": 2}


def main(steps: int) -> None:
    """Train in one engine; roll out, transfer and judge in all."""
    torch.set_num_threads(1)  # the other cores step environments
    envs = VecNormalize(CrossgaitVecEnv("Crossgait/AdaptiveGait-v0", num_envs=8, **SETTINGS))
    model = PPO("MlpPolicy", envs, n_steps=64, batch_size=128, n_epochs=2, policy_kwargs={"net_arch": [64, 64]}, seed=0)
    model.learn(steps)

    environment = envs.get_attr("config")[0]
    Path("env.yaml").write_text(environment.to_yaml())
    crossgait.Policy.from_sb3(model, environment).save("policy.safetensors")  # with VecNormalize's statistics

    print(crossgait.rollout(["policy.safetensors", "zero"], environment, episodes=2))
    print(crossgait.transfer("policy.safetensors", environment, terrains=["flat", "rough"], episodes=1))
    verdict = crossgait.verdict("policy.safetensors", environment=environment, starts=4)
    print(verdict.to_frame()[["score", "low", "high", "word"]].round(2))
    print("the same from the shell: crossgait verdict --policy policy.safetensors --config env.yaml")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1024)
