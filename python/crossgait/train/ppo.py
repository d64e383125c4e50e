"""PPO of Stable-Baselines3, as a plan asks for it."""

from __future__ import annotations

import time
from typing import Any

from stable_baselines3 import PPO
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.vec_env import VecNormalize

from crossgait.train.plan import Plan
from crossgait.train.two_pace_policy import ACTIVATIONS


class TimedPPO(PPO):
    """PPO that knows how long its epochs took."""

    seconds = 0.0  #: wall time of `train` so far, s

    def train(self) -> None:
        """As PPO's."""
        begin = time.perf_counter()
        super().train()
        self.seconds += time.perf_counter() - begin


def make(plan: Plan, envs: VecNormalize, policy: type[ActorCriticPolicy], **settings: Any) -> TimedPPO:
    """With a policy of this class, made with `settings`."""
    asked = dict(plan["algorithm"])
    del asked["learning_rate"]  # the trainer's
    model = TimedPPO(policy, envs, policy_kwargs=settings, device="cpu", seed=plan["seed"] % 2**32, **asked)
    model.set_logger(Logger(folder=None, output_formats=[]))
    return model


def make_single(plan: Plan, envs: VecNormalize) -> TimedPPO:
    """With the plan's multilayer perceptrons."""
    network = plan["network"]
    return make(
        plan,
        envs,
        ActorCriticPolicy,
        net_arch=network["hidden"],
        activation_fn=ACTIVATIONS[network["activation"]],
        log_std_init=float(network["log_std_init"]),
    )
