"""Many environments as one of Gymnasium's vector environments, stepped on threads of the core."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from crossgait import _core
from crossgait.envs.configuration import ConfigLike, make_config
from crossgait.envs.described import described
from crossgait.envs.not_copyable import NotCopyable
from crossgait.envs.quadruped_env import Observation
from crossgait.envs.render_mode import Drawn, frame_size, known_camera, known_render_mode
from crossgait.envs.seeds import episode_seed, episode_seeds, reset_mask
from crossgait.envs.spaces import action_array, action_space, observation_dtype, observation_space
from crossgait.envs.termed_vector import TermedVectorEnvironment, of_those
from crossgait.errors import ConfigError
from crossgait.inputs import EngineLike, TerrainLike, whole_number
from crossgait.layout import EnvironmentLayout
from crossgait.notes import tell_notes
from crossgait.terms import Terms
from crossgait.terms.configuration import group_width

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from crossgait.envs.keywords import EnvironmentKeys, VectorKeywords

Flags = npt.NDArray[np.bool_]

_AUTO_RESET = {
    AutoresetMode.NEXT_STEP: "next_step",
    AutoresetMode.SAME_STEP: "same_step",
    AutoresetMode.DISABLED: "disabled",
}


def _known_autoreset_mode(mode: AutoresetMode | str) -> AutoresetMode:
    known = [m for m in _AUTO_RESET if mode in (m, m.value)]
    if not known:
        raise ConfigError("vector environment", "autoreset_mode", "NextStep, SameStep or Disabled", str(mode))
    return known[0]


class QuadrupedVectorEnv(NotCopyable, Drawn, VectorEnv[Any, Any, npt.NDArray[Any]]):
    """`num_envs` environments of one configuration.

    Results are the same, bit for bit, for any number of `workers`, and those of single environments: `reset(seed=s)`
    gives environment i the seed `derived_seed(s, i)`, and its k-th episode `derived_seed` of that and k, which a single
    environment's `reset(seed=...)` takes (`episode_seeds` has them). All arrays are new in every step.

    Attributes:
        core: the vector environment of the core; `core.environment(i)` looks at one of them.
        batch: the state of all as arrays, and what changes it: `set_state`, `apply_wrench`, `set_parameters`.
        layout: names, units and bounds of one observation and action.

    """

    metadata: dict[str, Any] = {  # noqa: RUF012
        "render_modes": ["rgb_array", "depth_array"],
        "render_fps": 50,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }
    #: "gait" or "joints".
    action: ClassVar[str] = ""

    def __init__(
        self,
        num_envs: int = 1,
        config: ConfigLike = None,
        *,
        engine: EngineLike | None = None,
        terrain: TerrainLike | None = None,
        terms: Terms | None = None,
        workers: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        max_episode_steps: int | None = None,
        dtype: npt.DTypeLike = np.float64,
        render_mode: str | None = None,
        width: int = 640,
        height: int = 480,
        camera: Mapping[str, Any] | None = None,
        **keys: Unpack[EnvironmentKeys],
    ) -> None:
        """Build `num_envs` worlds; nothing moves before `reset`.

        Args:
            num_envs: how many.
            config: as of `QuadrupedEnv`; so are engine, terrain, dtype, width, height, camera and keys.
            engine: the engine of all.
            terrain: the ground of all.
            terms: as of `QuadrupedEnv`; they see all environments at once.
            workers: threads; as many as the process may use cores, but no more than environments, unless given.
            autoreset_mode: what happens at the end of an episode, NEXT_STEP, SAME_STEP or DISABLED: then `reset` with
                `options={"reset_mask": ended}` begins the next ones, and nothing is stepped before.
            max_episode_steps: ends episodes earlier than the configuration does.
            dtype: of observations.
            render_mode: "rgb_array" or "depth_array".
            width: of frames, pixels.
            height: of frames, pixels.
            camera: of every environment.
            keys: keys of the configuration.

        Raises:
            ConfigError: for what is wrong, naming the key.

        """
        made = make_config(self.action, config, {"engine": engine, "terrain": terrain} | keys, terms)
        if max_episode_steps is not None:
            steps = whole_number(max_episode_steps, "vector environment", "max_episode_steps")
            seconds = min(made.episode_seconds, steps * made.policy_dt)
            made = make_config(self.action, made, {"episode_seconds": seconds})
        mode = _known_autoreset_mode(autoreset_mode)
        num_envs = whole_number(num_envs, "vector environment", "num_envs")
        if workers is None:
            workers = min(num_envs, len(os.sched_getaffinity(0)))
        tell_notes(made)
        self.core: _core.VectorEnvironment | TermedVectorEnvironment
        if made.terms is None:
            self.core = _core.VectorEnvironment(made, num_envs, workers=workers, auto_reset=_AUTO_RESET[mode])
            self.layout = EnvironmentLayout.of(self.core.environment(0))
        else:
            self.core = TermedVectorEnvironment(made, num_envs, workers=workers, auto_reset=_AUTO_RESET[mode])
            self.layout = EnvironmentLayout.of(self.core)
        self.batch = self.core.batch()
        self.num_envs = num_envs
        self._dtype = observation_dtype(dtype)
        self.single_observation_space = observation_space(self.layout, self._dtype)
        self.single_action_space = action_space(self.layout)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.metadata = self.metadata | {
            "autoreset_mode": mode,
            "render_fps": max(1, round(1 / made.policy_dt)),
        }
        self.render_mode = known_render_mode(render_mode, self.metadata["render_modes"])
        self._frame_size = frame_size(width, height)
        self._camera = known_camera(camera)
        self._critic_width = group_width(made, "critic")
        self._last: npt.NDArray[np.float64] | None = None
        self._over = np.zeros(num_envs, np.bool_)  # with DISABLED: ended, and not begun anew

    def __repr__(self) -> str:
        return described(self, self.config, self.num_envs)

    @property
    def config(self) -> _core.EnvironmentConfig:
        """What all are made of."""
        return self.core.config

    @property
    def terms(self) -> Terms | None:
        """Terms at work, of which objects that remember are these environments' own; None without.

        `config.terms` are those that were given.
        """
        return self.core.terms if isinstance(self.core, TermedVectorEnvironment) else None

    def group(self, name: str) -> npt.NDArray[np.float64]:
        """What terms of an observation group show now, (num_envs, width): "critic".

        Raises ConfigError where there are none, and before the first reset.
        """
        if not isinstance(self.core, TermedVectorEnvironment) or self._last is None:
            raise ConfigError("vector environment", "group", "terms, and a reset", "none")
        return self.core.group(name)

    @property
    def episode_seeds(self) -> npt.NDArray[np.uint64]:
        """What a single environment's `reset` takes to repeat the episode that each is in."""
        seeds = (self.core.environment(i).episode_seed for i in range(self.num_envs))
        return np.fromiter(seeds, np.uint64, self.num_envs)

    def set_command(self, vx: npt.ArrayLike, vy: npt.ArrayLike = 0, yaw_rate: npt.ArrayLike = 0) -> None:
        """Ask for other velocities to the end of each episode, m/s and rad/s: one for all or one each."""
        try:
            columns = [np.broadcast_to(np.asarray(v, np.float64), (self.num_envs,)) for v in (vx, vy, yaw_rate)]
        except (TypeError, ValueError):
            expected = f"vx, vy and yaw_rate, each a number or {self.num_envs} of them"
            raise ConfigError("environment", "command", expected, repr((vx, vy, yaw_rate))) from None
        for i, command in enumerate(zip(*columns, strict=True)):
            self.core.environment(i).set_command(*map(float, command))

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode everywhere, or of those of a mask.

        Args:
            seed: one from which every environment's follows; or one each, with which a single environment begins the
                same episode (None draws it). With a mask and without a seed it is the next episode of each.
            options: `reset_mask`, a bool of each environment; infos are then of those alone, and rows of observations
                of the others as they were.

        Raises:
            ConfigError: for other seeds or options, and for a mask before the first reset of all.

        """
        self.check_open()
        if isinstance(seed, np.ndarray):
            seed = seed.tolist()
        each = isinstance(seed, Sequence)
        super().reset(seed=None if each else seed)  # type: ignore[arg-type]
        which = reset_mask(options, self.num_envs)
        begin = self._seeds(seed, masked=which is not None)
        if which is None:
            assert begin is not None
            self._last, infos = self.core.reset(begin), self.core.infos()
            self._over[:] = False
            return self._seen(self._last), infos
        if self._last is None:
            raise ConfigError("reset", "reset_mask", "a reset of all before it", "none")
        self.core.reset_some(which, self._last, begin)
        self._over &= ~which
        return self._seen(self._last), of_those(which, self.core.infos())

    def _seeds(self, seed: int | Sequence[int | None] | None, *, masked: bool) -> int | list[int] | None:
        if isinstance(seed, Sequence):
            return episode_seeds(seed, self.num_envs, self.np_random)
        return None if seed is None and masked else episode_seed(seed, self.np_random)

    def step(self, actions: npt.ArrayLike) -> tuple[Observation, npt.NDArray[np.float64], Flags, Flags, dict[str, Any]]:
        """One policy step everywhere. With SAME_STEP, `final_obs` and `final_info` are those of ended episodes.

        Raises ClosedEnvironmentError after `close`, and with DISABLED ConfigError where an episode has ended.
        """
        self.check_open()
        if self._over.any():
            expected = "reset(options={'reset_mask': ended}) of those whose episode has ended"
            raise ConfigError("step", "episode", expected, f"{np.count_nonzero(self._over)} that have")
        observations, rewards, terminated, truncated, final = self.core.step(action_array(actions))
        self._last = observations
        if self.metadata["autoreset_mode"] == AutoresetMode.DISABLED:
            self._over = terminated | truncated
        infos = self.core.infos()
        if final is not None:
            ended = terminated | truncated
            if ended.any():
                infos |= self._final(ended, self._seen(final))
        return self._seen(observations), rewards, terminated, truncated, infos

    def check_open(self) -> None:
        """Raise ClosedEnvironmentError after `close`."""
        if self.closed:
            raise gymnasium.error.ClosedEnvironmentError("this environment was closed: make another")

    def _final(self, ended: Flags, observations: Observation) -> dict[str, Any]:
        final = np.full(self.num_envs, None, dtype=object)
        for i in np.flatnonzero(ended):
            final[i] = observations[i].copy()
        return {
            "final_obs": final,
            "_final_obs": ended,
            "final_info": self.core.final_infos(),
            "_final_info": ended.copy(),
        }

    def _seen(self, observations: npt.NDArray[np.float64]) -> Observation:
        return observations.astype(self._dtype)

    def render(self) -> tuple[npt.NDArray[Any], ...] | None:
        """A frame, or distances, of every environment, as `QuadrupedEnv`; None without a render_mode."""
        if self.render_mode is None:
            return None
        renderer = self._open_renderer()
        draw = renderer.depth if self.render_mode == "depth_array" else renderer.frame
        return tuple(draw(self.core.environment(i)) for i in range(self.num_envs))

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Call a method of each environment (`render`, or one of `core.environment(i)`), or read an attribute of each.

        As Gymnasium's own vector environments do, for libraries that render by it.
        """
        if name == "render":
            return self.render() or (None,) * self.num_envs
        members = [getattr(self.core.environment(i), name) for i in range(self.num_envs)]
        return tuple(member(*args, **kwargs) if callable(member) else member for member in members)

    @property
    def state_space(self) -> gymnasium.spaces.Box | None:
        """Of `state` of one environment; None where no term observes for `critic`. skrl looks for both."""
        if self._critic_width == 0:
            return None
        shape = (len(self.layout.observation) + self._critic_width,)
        return gymnasium.spaces.Box(-np.inf, np.inf, shape, np.float32)

    def state(self) -> npt.NDArray[np.float32]:
        """What critics may see, (num_envs, n): the last observations, and those for `critic` behind them.

        Raises ConfigError where no term observes for it, and before the first reset.
        """
        if self._critic_width == 0 or self._last is None:
            raise ConfigError("vector environment", "state", "terms that observe for critic, and a reset", "none")
        assert isinstance(self.core, TermedVectorEnvironment)
        return np.concatenate([self._last, self.core.group("critic")], axis=1, dtype=np.float32)

    def close_extras(self, **kwargs: Any) -> None:
        """Close the renderer."""
        self._close_renderer()


# VectorEnv is named again for libraries that look at the bases of a class alone, as skrl does.
class AdaptiveGaitVectorEnv(QuadrupedVectorEnv, VectorEnv[Any, Any, npt.NDArray[Any]]):
    """Of `AdaptiveGaitEnv`."""

    action = "gait"


class JointControlVectorEnv(QuadrupedVectorEnv, VectorEnv[Any, Any, npt.NDArray[Any]]):
    """Of `JointControlEnv`."""

    action = "joints"


def same_step_vector(env_id: str, num_envs: int, **settings: Unpack[VectorKeywords]) -> QuadrupedVectorEnv:
    """Make what the wrappers for learners step: observations of float32, episodes begun in the step that ends them.

    Raises ConfigError for what is wrong, naming the key.
    """
    vector = gymnasium.make_vec(
        env_id,
        num_envs=num_envs,
        vectorization_mode="vector_entry_point",
        dtype=np.float32,
        autoreset_mode=AutoresetMode.SAME_STEP,
        **settings,
    )
    assert isinstance(vector, QuadrupedVectorEnv)
    return vector
