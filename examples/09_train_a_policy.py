"""Trains a short PPO, makes it a file, and says what it is worth in every engine: 09_train_a_policy.py [STEPS].

The default is far too few to learn anything: it shows the way. Needs crossgait[sb3].
"""

import sys
from pathlib import Path

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecNormalize

import crossgait
from crossgait.sb3 import CrossgaitVecEnv

torch.set_num_threads(1)  # the other cores step environments
keys = {"terrain": "rough", "policy_dt": 0.02, "episode_seconds": 2}
envs = VecNormalize(CrossgaitVecEnv("Crossgait/AdaptiveGait-v0", num_envs=8, **keys))
model = PPO("MlpPolicy", envs, n_steps=64, batch_size=128, n_epochs=2, policy_kwargs={"net_arch": [64, 64]}, seed=0)
model.learn(int(sys.argv[1]) if len(sys.argv) > 1 else 1024)

environment = envs.get_attr("config")[0]
Path("env.yaml").write_text(environment.to_yaml())
crossgait.Policy.from_sb3(model, environment).save("policy.safetensors")  # with VecNormalize's statistics

print(crossgait.rollout(["policy.safetensors", "zero"], environment, episodes=2))
print(crossgait.transfer("policy.safetensors", environment, terrains=["flat", "rough"], episodes=1))
print(crossgait.verdict("policy.safetensors", environment=environment, starts=6))
print("the same from the shell: crossgait verdict --policy policy.safetensors --config env.yaml")
