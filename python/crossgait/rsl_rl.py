"""The native vector environment for rsl-rl-lib 5: TensorDicts of observation groups, time-outs.

>>> envs = VecEnv("Crossgait/JointControl-v0", num_envs=64, terms=mine)
>>> OnPolicyRunner(envs, configuration, "runs/mine").learn(100)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np
import numpy.typing as npt

from crossgait.extras import needed_for

with needed_for("environments of rsl_rl", "rsl-rl"):
    from rsl_rl.env import VecEnv as RslVecEnv
with needed_for("environments of rsl_rl", "rsl-rl"):
    import torch
    from tensordict import TensorDict

from crossgait._core import Batch
from crossgait.envs.described import described
from crossgait.envs.not_copyable import NotCopyable
from crossgait.envs.quadruped_vector_env import same_step_vector
from crossgait.envs.termed_vector import TermedVectorEnvironment
from crossgait.inputs import as_environment
from crossgait.terms import TerminationTerm, Terms

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from crossgait.envs.keywords import VectorKeywords

_TIME_OUT = "episode_length"  #: name of the term that ends episodes


class VecEnv(NotCopyable, RslVecEnv):  # type: ignore[misc]  # untyped
    """`num_envs` environments stepped on threads of the core; episodes begin anew in the step that ends them.

    Observations are groups of float32: `policy`, and `critic` where terms observe for it. `obs_groups` of the runner's
    configuration says who sees which: {"actor": ["policy"], "critic": ["policy", "critic"]}.

    Attributes:
        vector: the vector environment of Gymnasium that it steps.
        episode_length_buf: policy steps of each episode so far; a runner may set it, so that first episodes end at
            different times.

    """

    def __init__(
        self,
        env_id: str = "Crossgait/JointControl-v0",
        num_envs: int = 64,
        *,
        seed: int = 0,
        device: str = "cpu",
        **settings: Unpack[VectorKeywords],
    ) -> None:
        """Build the environments and begin an episode in each.

        Args:
            env_id: Crossgait/AdaptiveGait-v0 or Crossgait/JointControl-v0.
            num_envs: how many.
            seed: of all that is random; `torch.manual_seed` is the algorithm's.
            device: of the tensors.
            settings: what `crossgait.envs.QuadrupedVectorEnv` takes: config, engine, terrain, terms, workers, keys, ...

        Raises:
            ConfigError: for what is wrong, naming the key.

        """
        # Episodes end by a term too: lengths are the runner's to set.
        mine = settings.get("terms") or _terms_of(settings.get("config")) or Terms()
        timed = TerminationTerm(self._is_over, time_out=True)
        terminations = {**mine.terminations, _TIME_OUT: timed}
        settings["terms"] = Terms(mine.rewards, mine.observations, terminations, mine.events, mine.curriculum)
        self.vector = vector = same_step_vector(env_id, num_envs, **settings)
        self._core = cast(TermedVectorEnvironment, vector.core)
        config = vector.config
        self.num_envs = num_envs
        self.num_actions = len(vector.layout.action)
        self.max_episode_length = round(config.episode_seconds / config.policy_dt)
        self.episode_length_buf = torch.zeros(num_envs, dtype=torch.long, device=device)
        self.device = device
        self.cfg: dict[str, Any] = {key: value for key, value in config.to_dict().items() if key != "terms"}
        self._has_critic = bool(mine.observations.get("critic"))
        self._observations = self._groups(vector.reset(seed=seed)[0])

    def __repr__(self) -> str:
        return described(self, self.vector.config, self.num_envs)

    def _is_over(self, env: Batch) -> npt.NDArray[np.bool_]:
        # Asked within a step, before it is counted.
        lengths: npt.NDArray[np.int64] = self.episode_length_buf.cpu().numpy()
        return lengths + 1 >= self.max_episode_length

    def _groups(self, seen: npt.NDArray[Any]) -> TensorDict:
        groups = {"policy": self._tensor(seen)}
        if self._has_critic:
            groups["critic"] = self._tensor(self._core.group("critic"))
        return TensorDict(groups, batch_size=[self.num_envs], device=self.device)

    def _tensor(self, array: npt.NDArray[Any]) -> torch.Tensor:
        return torch.as_tensor(array.astype(np.float32), device=self.device)

    def get_observations(self) -> TensorDict:
        """What was seen last."""
        return self._observations

    def step(self, actions: torch.Tensor) -> tuple[TensorDict, torch.Tensor, torch.Tensor, dict[str, Any]]:
        """One policy step everywhere: observations, rewards, dones, extras (`time_outs`, and `log` of mean rewards)."""
        self.vector.check_open()
        numbers = actions.detach().cpu().numpy()
        seen, rewards, terminated, truncated, _ = self._core.step(np.ascontiguousarray(numbers))
        self.episode_length_buf += 1
        dones = torch.as_tensor(terminated | truncated, device=self.device)
        self.episode_length_buf[dones] = 0
        self._observations = self._groups(seen)
        means = self._core.reward_means
        extras = {
            "time_outs": torch.as_tensor(truncated, device=self.device),
            "log": {f"/reward/{name}": mean for name, mean in means.items()},
        }
        return self._observations, self._tensor(rewards), dones.long(), extras

    def close(self) -> None:
        """Close the renderer; `step` raises ClosedEnvironmentError afterwards."""
        self.vector.close()


def _terms_of(config: Any) -> Terms | None:
    found: Terms | None = None if config is None else as_environment(config).terms
    return found
