"""Adds a reward, an observation and a push of one's own to many environments: 10_your_reward.py [ENVIRONMENTS]."""

import sys

import gymnasium
import numpy as np

import crossgait.envs
from crossgait import terms


def bounce(env: crossgait.Batch) -> np.ndarray:
    """Vertical speed of every robot's base, m/s."""
    return np.abs(env.base_linear_velocity[:, 2])


mine = terms.Terms(
    rewards={
        "bounce": terms.RewardTerm(bounce, weight=-0.5),
        "feet_air_time": terms.RewardTerm(terms.feet_air_time, params={"threshold": 0.2}),
    },
    observations={"policy": {"height": terms.ObservationTerm(lambda env: env.base_height, scale=5.0)}},
    events={"push": terms.EventTerm(terms.push_by_setting_velocity, "interval", (0.2, 0.4), {"speed": 0.3})},
)
count = int(sys.argv[1]) if len(sys.argv) > 1 else 16
envs = gymnasium.make_vec("Crossgait/JointControl-v0", num_envs=count, terms=mine, config={"robot": "serial_quadruped"})
envs.reset(seed=0)
for _ in range(50):
    infos = envs.step(np.zeros(envs.action_space.shape, np.float32))[4]
for name, values in infos["reward_terms"].items():
    if not name.startswith("_"):
        print(f"{name:20} {values.mean():8.4f}")
print(f"bases are {envs.unwrapped.batch.base_height.mean():.3f} m over the ground")
