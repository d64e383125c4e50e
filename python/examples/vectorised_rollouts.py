"""Vectorised rollouts: sixty-four robots on threads of the core, under noise on the zero policy's actions.

Run it with: python vectorised_rollouts.py [ENVIRONMENTS]. Prints how far they came, and simulated seconds per second.
"""

from __future__ import annotations

import sys
import time

import gymnasium
import numpy as np

import crossgait.envs  # noqa: F401  registers the environments


def main(count: int) -> None:
    """Step all of them through two episodes of a second."""
    envs = gymnasium.make_vec(
        "Crossgait/AdaptiveGait-v0",
        num_envs=count,
        vectorization_mode="vector_entry_point",
        autoreset_mode="SameStep",
        terrain="rough",
        policy_dt=0.02,
        episode_seconds=1,
        randomisation={"friction": [0.4, 0.8], "terrain_seed": [0, 1000]},
    )
    rng = np.random.default_rng(0)
    envs.reset(seed=1)
    distances: list[float] = []
    begin = time.perf_counter()
    for _ in range(100):
        actions = rng.normal(0, 0.1, envs.action_space.shape).astype(np.float32)
        _, _, terminated, truncated, infos = envs.step(actions)
        if np.any(terminated | truncated):
            distances += infos["final_info"]["distance"][terminated | truncated].tolist()
    seconds = time.perf_counter() - begin
    print(f"{len(distances)} episodes: {np.mean(distances):.3f} m on average, {np.std(distances):.3f} m apart")
    print(f"{count * 100 * 0.02 / seconds:.0f} simulated seconds per second")
    envs.close()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 64)
