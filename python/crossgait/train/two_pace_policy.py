"""A planner and a residual policy as one policy of PPO, so that both are trained together."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
import torch
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.type_aliases import Schedule
from torch import Tensor

from crossgait._core import MlpNetwork
from crossgait.train.members import Indices, Member

_LOG_TWO_PI = math.log(2 * math.pi)
ACTIVATIONS = {"tanh": torch.nn.Tanh, "elu": torch.nn.ELU, "relu": torch.nn.ReLU}


class Normalised(torch.nn.Module):
    """Layers over clip((x - mean) / std) of some of the numbers that it is given; the normalisation stays as it is."""

    def __init__(
        self, layers: torch.nn.Sequential, at: Indices, mean: Tensor, std: Tensor, clip: float | None = None
    ) -> None:
        """Of numbers `at` among those given."""
        super().__init__()
        self.layers = layers
        self.clip = clip
        self.at: Tensor
        self.mean: Tensor
        self.std: Tensor
        for name, value in (("at", torch.as_tensor(at)), ("mean", mean.float()), ("std", std.float())):
            self.register_buffer(name, value)

    def forward(self, given: Tensor) -> Tensor:
        """What the layers make of it."""
        seen = (given[:, self.at] - self.mean) / self.std
        made: Tensor = self.layers(seen if self.clip is None else seen.clamp(-self.clip, self.clip))
        return made

    @staticmethod
    def of(network: MlpNetwork, at: Indices) -> Normalised:
        """A bundle's network."""
        mean, std = network.normalisation or (np.zeros(len(at)), np.ones(len(at)))
        layers = linear_layers(
            [(torch.as_tensor(w), torch.as_tensor(b)) for w, b in network.layers], network.activation
        )
        return Normalised(layers, at, torch.as_tensor(mean), torch.as_tensor(std), network.clip)


def linear_layers(weights: Sequence[tuple[Tensor, Tensor]], activation: str) -> torch.nn.Sequential:
    """Linear layers (weight [out, in], bias [out]) with the activation after all but the last."""
    parts: list[torch.nn.Module] = []
    for weight, bias in weights:
        layer = torch.nn.Linear(weight.shape[1], weight.shape[0])
        with torch.no_grad():
            layer.weight.copy_(weight)
            layer.bias.copy_(bias)
        parts += [layer, ACTIVATIONS[activation]()]
    return torch.nn.Sequential(*parts[:-1])


@dataclass(frozen=True)
class Start:
    """What both members and the critic are at the beginning."""

    planner: Normalised
    residual: Normalised
    critic: Normalised
    log_std: Tensor  #: of the whole action


class TwoPacePolicy(ActorCriticPolicy):
    """Two networks whose Gaussian actions are parts of one.

    The last number of an observation says whether a plan is due (`crossgait.train.members.TwoPaceEnvs`). Where none is,
    the planner's action does nothing, and its probability and entropy count for nothing: that makes the gradient of a
    step the one of the members that acted in it.
    """

    def __init__(
        self,
        observation_space: gymnasium.Space[Any],
        action_space: gymnasium.spaces.Box,
        lr_schedule: Schedule,
        *,
        members: tuple[Member, Member],
        start: Start,
        use_sde: bool = False,
    ) -> None:
        """Of (planner, residual policy)."""
        super().__init__(observation_space, action_space, lr_schedule, net_arch=[], use_sde=use_sde)
        del self.mlp_extractor, self.action_net, self.value_net  # the networks of a single policy
        self.planner, self.residual, self.critic = start.planner, start.residual, start.critic
        self.log_std = torch.nn.Parameter(start.log_std.clone())
        planner, residual = members
        counted = torch.zeros(len(start.log_std))
        counted[torch.as_tensor(residual.action)] = 1
        self.always: Tensor  # one for actions that always do something
        self.register_buffer("always", counted)
        self.order: Tensor  # of the whole action in the planner's followed by the residual policy's
        self.register_buffer("order", torch.as_tensor(np.argsort(np.append(planner.action, residual.action))))
        # With the epsilon of Stable-Baselines3's own policies.
        self.optimizer = torch.optim.Adam(self.parameters(), lr=lr_schedule(1), eps=1e-5)

    def _mean(self, observations: Tensor) -> Tensor:
        members = torch.cat([self.planner(observations), self.residual(observations)], dim=1)
        return members[:, self.order]

    def _sampled(self, mean: Tensor) -> Tensor:
        return mean + self.log_std.exp() * torch.randn_like(mean)

    def _log_prob(self, observations: Tensor, mean: Tensor, actions: Tensor) -> Tensor:
        """Of what does something, under independent Gaussians."""
        each = -0.5 * ((actions - mean) / self.log_std.exp()) ** 2 - self.log_std - 0.5 * _LOG_TWO_PI
        return (each * self._counted(observations)).sum(1)

    def _counted(self, observations: Tensor) -> Tensor:
        """One for every action that does something, zero for the others."""
        return torch.maximum(self.always, observations[:, -1:])

    def forward(self, obs: Tensor, deterministic: bool = False) -> tuple[Tensor, Tensor, Tensor]:
        """Actions, values and log probabilities."""
        mean = self._mean(obs)
        actions = mean if deterministic else self._sampled(mean)
        return actions, self.critic(obs), self._log_prob(obs, mean, actions)

    def evaluate_actions(self, obs: Any, actions: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Values, log probabilities and entropies."""
        entropy = ((0.5 + 0.5 * _LOG_TWO_PI + self.log_std) * self._counted(obs)).sum(1)
        return self.critic(obs), self._log_prob(obs, self._mean(obs), actions), entropy

    def predict_values(self, obs: Any) -> Tensor:
        """What the critic says."""
        values: Tensor = self.critic(obs)
        return values

    def _predict(self, observation: Any, deterministic: bool = False) -> Tensor:
        mean = self._mean(observation)
        return mean if deterministic else self._sampled(mean)
