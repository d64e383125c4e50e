"""The native vector environment for rl_games: tensors, states for a central value, time-outs.

>>> register("mine", "Crossgait/JointControl-v0", terms=mine)    # then in the runner's file: env_name: mine
>>> runner.load(yaml.safe_load(open("ppo.yaml")))
>>> runner.run({"train": True})
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from crossgait.extras import needed_for

with needed_for("environments of rl_games", "rl-games"):
    import gymnasium
    import torch
    from rl_games.common import env_configurations, vecenv
    from rl_games.common.ivecenv import IVecEnv

from crossgait.envs.not_copyable import NotCopyable
from crossgait.envs.quadruped_vector_env import same_step_vector

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from crossgait.envs.keywords import VectorKeywords

Seen = torch.Tensor | dict[str, torch.Tensor]


class VecEnv(NotCopyable, IVecEnv):  # type: ignore[misc]  # untyped
    """`num_envs` environments stepped on threads of the core; episodes begin anew in the step that ends them.

    Where terms observe for `critic`, observations are {"obs", "states"}: states, for a central value, are observations
    with what is seen for the critic behind them.

    Attributes:
        vector: the vector environment of Gymnasium that it steps.

    """

    def __init__(
        self,
        env_id: str = "Crossgait/JointControl-v0",
        num_envs: int = 64,
        *,
        device: str = "cpu",
        seed: int | None = None,
        **settings: Unpack[VectorKeywords],
    ) -> None:
        """Build the environments; the first `reset` begins their episodes.

        Args:
            env_id: Crossgait/AdaptiveGait-v0 or Crossgait/JointControl-v0.
            num_envs: how many.
            device: of the tensors.
            seed: of all that is random in the environments; random itself by default.
            settings: what `crossgait.envs.QuadrupedVectorEnv` takes: config, engine, terrain, terms, workers, keys, ...

        Raises:
            ConfigError: for what is wrong, naming the key.

        """
        self.vector = same_step_vector(env_id, num_envs, **settings)
        self._device, self._seed = device, seed

    def get_env_info(self) -> dict[str, Any]:
        """Spaces of one environment."""
        info: dict[str, Any] = {
            "observation_space": self.vector.single_observation_space,
            "action_space": self.vector.single_action_space,
            "agents": 1,
            "value_size": 1,
        }
        if (states := self.vector.state_space) is not None:
            info["state_space"] = gymnasium.spaces.Box(states.low, states.high, dtype=np.float32)
        return info

    def seed(self, seed: int) -> None:
        """Take the seed of the next `reset`."""
        self._seed = seed

    def reset(self) -> Seen:
        """Begin an episode everywhere."""
        observations, _ = self.vector.reset(seed=self._seed)
        self._seed = None
        return self._seen(observations)

    def step(self, actions: torch.Tensor) -> tuple[Seen, torch.Tensor, torch.Tensor, dict[str, Any]]:
        """One policy step everywhere: observations, rewards, dones, infos (`time_outs`)."""
        self.vector.check_open()
        numbers = np.ascontiguousarray(actions.detach().cpu().numpy())
        observations, rewards, terminated, truncated, _ = self.vector.core.step(numbers)
        infos = {"time_outs": self._tensor(truncated)}
        return self._seen(observations), self._tensor(rewards), self._tensor(terminated | truncated), infos

    def close(self) -> None:
        """Close the renderer; `step` raises ClosedEnvironmentError afterwards."""
        self.vector.close()

    def _seen(self, observations: npt.NDArray[Any]) -> Seen:
        seen = self._tensor(observations)
        return seen if self.vector.state_space is None else {"obs": seen, "states": self._tensor(self.vector.state())}

    def _tensor(self, array: npt.NDArray[Any]) -> torch.Tensor:
        kept = array if array.dtype == np.bool_ else array.astype(np.float32)
        return torch.as_tensor(kept, device=self._device)


def register(
    name: str = "crossgait",
    env_id: str = "Crossgait/JointControl-v0",
    *,
    device: str = "cpu",
    **settings: Unpack[VectorKeywords],
) -> None:
    """Name environments, so that `env_name` of rl_games' configurations means them; `num_actors` says how many.

    `env_config` there has keywords of `VecEnv`, which come on top of those that are given here.
    """

    def make(_: str, num_actors: int, **keywords: Any) -> VecEnv:
        return VecEnv(env_id, num_actors, **{"device": device, **settings, **keywords})

    vecenv.register(name, make)
    creator = {"vecenv_type": name, "env_creator": lambda **keywords: make(name, 1, **keywords)}
    env_configurations.register(name, creator)
