"""Stable-Baselines3 on the native vector environment.

>>> envs = CrossgaitVecEnv("Crossgait/JointControl-v0", num_envs=16, engine="bullet", terrain="rough")
>>> PPO("MlpPolicy", envs).learn(1_000_000)
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

try:
    import gymnasium
    from stable_baselines3.common.vec_env import VecEnv
    from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices, VecEnvStepReturn
except ImportError as error:
    raise ImportError("crossgait.sb3 needs Stable-Baselines3: pip install crossgait[sb3]") from error

import crossgait.envs
from crossgait import _core
from crossgait._core import EnvironmentConfig
from crossgait.envs.described import described
from crossgait.envs.not_copyable import NotCopyable
from crossgait.envs.quadruped_vector_env import same_step_vector
from crossgait.layout import EnvironmentLayout

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from crossgait.envs.keywords import VectorKeywords


class SubEnvironment:
    """One of the environments, as `get_attr`, `set_attr` and `env_method` reach it.

    It has what `_core.EnvironmentView` has (`state`, `parameters`, `summary`, `set_command`, `episode_seed`, ...), and
    whatever `set_attr` gave it.
    """

    def __init__(self, vector: crossgait.envs.QuadrupedVectorEnv, index: int) -> None:
        self.core: _core.EnvironmentView = vector.core.environment(index)
        self.layout: EnvironmentLayout = vector.layout
        self.observation_space = vector.single_observation_space
        self.action_space = vector.single_action_space
        self.render_mode = vector.render_mode
        self.spec = vector.spec

    def __getattr__(self, name: str) -> Any:
        return getattr(self.core, name)


class CrossgaitVecEnv(NotCopyable, VecEnv):
    """`num_envs` environments stepped on threads of the core, for the algorithms of Stable-Baselines3.

    Observations and rewards are float32. An environment whose episode ends begins the next in the same step; its infos
    then hold those of the step that ended, `terminal_observation` and `TimeLimit.truncated`, and `reset_infos` those of
    the beginning. The environments' seeds all follow from the first that `seed` returns, as
    `crossgait.envs.QuadrupedVectorEnv` says.

    Attributes:
        vector: the vector environment of Gymnasium that it steps.
        core_seconds: wall time that `reset` and `step_wait` have spent in the core so far, s.

    """

    def __init__(
        self, env_id: str = "Crossgait/AdaptiveGait-v0", num_envs: int = 1, **settings: Unpack[VectorKeywords]
    ) -> None:
        """Build the environments.

        Args:
            env_id: Crossgait/AdaptiveGait-v0 or Crossgait/JointControl-v0.
            num_envs: how many.
            settings: what `crossgait.envs.QuadrupedVectorEnv` takes: config, engine, terrain, workers, keys, ...

        Raises:
            ConfigError: for what is wrong, naming the key.

        """
        self.vector = vector = same_step_vector(env_id, num_envs, **settings)
        self._environments = [SubEnvironment(vector, i) for i in range(num_envs)]
        self._actions: npt.NDArray[Any] | None = None
        self.core_seconds = 0.0
        super().__init__(num_envs, vector.single_observation_space, vector.single_action_space)
        self.metadata = self.metadata | {"render_fps": vector.metadata["render_fps"]}

    def __repr__(self) -> str:
        return described(self, self.vector.config, self.num_envs)

    def reset(self) -> npt.NDArray[np.float32]:
        """Begin an episode everywhere, by the seed of the last `seed`, if none has used it."""
        if any(self._options):
            self.vector.reset(options=self._options[0])  # which refuses them
        begin = time.perf_counter()
        observations, _ = self.vector.reset(seed=self._seeds[0])
        self.core_seconds += time.perf_counter() - begin
        self._reset_seeds()
        self._reset_options()
        self.reset_infos = [self.vector.core.info(i) for i in range(self.num_envs)]
        return observations  # type: ignore[return-value]

    def step_async(self, actions: npt.NDArray[Any]) -> None:
        """Take what `step_wait` does."""
        self._actions = actions

    def step_wait(self) -> VecEnvStepReturn:
        """One policy step everywhere: observations, rewards, dones, infos."""
        self.vector.check_open()
        core = self.vector.core
        begin = time.perf_counter()
        observations, rewards, terminated, truncated, final = core.step(np.asarray(self._actions))
        self.core_seconds += time.perf_counter() - begin
        dones = terminated | truncated
        infos: list[dict[str, Any]] = [core.final_info(i) or core.info(i) for i in range(self.num_envs)]
        for i, info in enumerate(infos):
            info["TimeLimit.truncated"] = bool(truncated[i])
        for i in map(int, np.flatnonzero(dones)):
            assert final is not None  # of same_step
            infos[i]["terminal_observation"] = final[i].astype(np.float32)
            self.reset_infos[i] = core.info(i)
        return observations.astype(np.float32), rewards.astype(np.float32), dones, infos

    def close(self) -> None:
        """Close the renderer; `step` raises ClosedEnvironmentError afterwards."""
        self.vector.close()

    def get_images(self) -> Sequence[npt.NDArray[np.uint8] | None]:
        """A frame of every environment; None without render_mode="rgb_array"."""
        return self.vector.render() or [None] * self.num_envs

    @property
    def config(self) -> EnvironmentConfig:
        """That of all environments."""
        return self.vector.config

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Of each environment: see `SubEnvironment`."""
        return [getattr(self._environments[i], attr_name) for i in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Give environments an attribute. Raises AttributeError for what they themselves have."""
        for i in self._get_indices(indices):
            if hasattr(self._environments[i].core, attr_name):
                raise AttributeError(f"{attr_name} of an environment is not to be set")
            if attr_name in self.config.to_dict():
                more = "set_parameters of its batch sets what can change between steps"
                raise AttributeError(f"{attr_name} is of the configuration, which an environment keeps: {more}")
            setattr(self._environments[i], attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: VecEnvIndices = None, **method_kwargs: Any
    ) -> list[Any]:
        """Call a method of each environment: `env_method("set_command", 0.3, indices=[0])`."""
        return [method(*method_args, **method_kwargs) for method in self.get_attr(method_name, indices)]

    def env_is_wrapped(
        self, wrapper_class: type[gymnasium.Wrapper[Any, Any, Any, Any]], indices: VecEnvIndices = None
    ) -> list[bool]:
        """None is wrapped."""
        return [False for _ in self._get_indices(indices)]
