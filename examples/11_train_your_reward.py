"""Trains a policy for a reward of one's own, and judges it in two engines: 11_train_your_reward.py [STEPS] [WEIGHT].

The default is far too few to learn anything: it shows the way. 7200 take half a minute. Needs crossgait[train].
"""

import sys
from pathlib import Path

import numpy as np

import crossgait
from crossgait import terms
from crossgait.train import Plan
from crossgait.train.folder import locked
from crossgait.train.trainer import Trainer


def glide(env: crossgait.Batch) -> np.ndarray:
    """How fast the feet that carry each robot slide over the ground, m/s."""
    speeds = np.linalg.norm(env.foot_velocities[:, :, :2], axis=2)
    return (env.foot_contacts * speeds).sum(axis=1)


steps = int(sys.argv[1]) if len(sys.argv) > 1 else 240
weight = float(sys.argv[2]) if len(sys.argv) > 2 else -1.5
plan = Plan.parse(
    f"""
environment:
  terrain: rough
  policy_dt: 0.1
  settle_seconds: 0.1
  episode_seconds: 4
  adapt: [step_length, cycle_time]
  residual_scale: 0.002
  observation: [base_linear_velocity_local, gravity, parameters]
  reward: {{forward_velocity: 1, termination: -5}}
randomisation: {{terrain_seed: [0, 99]}}
environments: 8
algorithm: {{n_steps: 30, batch_size: 120, n_epochs: 8, gamma: 0.95, learning_rate: 0.001}}
network: {{hidden: [32]}}
evaluation: {{engines: [mujoco], episodes: 2, final_episodes: 6}}
steps: {steps}
"""
)
plan = plan.with_terms(terms.Terms(rewards={"glide": terms.RewardTerm(glide, weight=weight)}))
folder = Path(f"glide{weight:g}")
with locked(folder):  # makes the folder, and keeps others out
    Trainer(plan, folder, resume=False, progress=False).run()

best, environment = folder / "best.safetensors", plan.evaluated
columns = ["total_reward", "reward_terms.forward_velocity", "reward_terms.glide", "mean_speed_mps", "slip_per_path"]
episodes = crossgait.rollout([best, "zero"], environment, episodes=6, seed=77).to_frame()
print(episodes[columns].groupby("policy").mean().round(3).to_string())
print(crossgait.verdict(best, environment=environment, engines=["mujoco", "bullet"], starts=6))
