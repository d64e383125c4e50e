"""Steps a reinforcement-learning environment with a policy that does nothing: an episode of the gait alone."""

import gymnasium

import crossgait.envs  # noqa: F401  registers the environments

env = gymnasium.make("Crossgait/AdaptiveGait-v0", terrain="rough", policy_dt=0.02, episode_seconds=2)
env.reset(seed=7)
ended, total = False, 0.0
while not ended:
    observation, reward, terminated, truncated, info = env.step(0 * env.action_space.sample())
    total, ended = total + reward, terminated or truncated
print(f"{info['distance']:.3f} m, return {total:.3f}")
