"""Steps sixty-four robots on threads of the core, under noise: 08_many_environments.py [ENVIRONMENTS]."""

import sys
import time

import gymnasium
import numpy as np

import crossgait.envs  # noqa: F401  registers the environments

count = int(sys.argv[1]) if len(sys.argv) > 1 else 64
keys = {"terrain": "rough", "policy_dt": 0.02, "episode_seconds": 1, "randomisation": {"friction": [0.4, 0.8]}}
envs = gymnasium.make_vec("Crossgait/AdaptiveGait-v0", num_envs=count, autoreset_mode="SameStep", **keys)
envs.reset(seed=1)
rng, distances, begin = np.random.default_rng(0), [], time.perf_counter()
for _ in range(100):
    actions = rng.normal(0, 0.1, envs.action_space.shape).astype(np.float32)
    _, _, terminated, truncated, infos = envs.step(actions)
    if np.any(terminated | truncated):
        distances += infos["final_info"]["distance"][terminated | truncated].tolist()
print(f"{len(distances)} episodes: {np.mean(distances):.3f} m on average, {np.std(distances):.3f} m apart")
print(f"{count * 100 * 0.02 / (time.perf_counter() - begin):.0f} simulated seconds per second")
envs.close()
