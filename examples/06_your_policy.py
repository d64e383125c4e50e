"""Runs a policy of your own, a function, in whole episodes beside the gait alone, and in every engine."""

import numpy as np

import crossgait

environment = crossgait.EnvironmentConfig(policy_dt=0.02, episode_seconds=2, adapt=["step_length"])
actions = len(crossgait.policies.PolicyInterface(environment).action_layout)

# A function that makes a function: each episode has a policy with a memory of its own.
lower = crossgait.FunctionPolicy(lambda: lambda observation: np.full(actions, -0.05), name="lower")
print(crossgait.rollout([lower, "zero"], environment, episodes=2))
print(crossgait.transfer(lower, environment, terrains=["flat"], episodes=1))
