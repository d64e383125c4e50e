"""One environment as Gymnasium's."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import gymnasium
import numpy as np
import numpy.typing as npt

from crossgait import _core
from crossgait.envs.configuration import ConfigLike, make_config
from crossgait.envs.described import described
from crossgait.envs.not_copyable import NotCopyable
from crossgait.envs.render_mode import Drawn, frame_size, known_camera, known_render_mode
from crossgait.envs.seeds import episode_seed, refuse_options
from crossgait.envs.spaces import action_array, action_space, observation_dtype, observation_space
from crossgait.errors import ConfigError
from crossgait.inputs import EngineLike, TerrainLike
from crossgait.layout import EnvironmentLayout
from crossgait.notes import tell_notes
from crossgait.terms import Terms

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from crossgait.envs.keywords import EnvironmentKeys

Observation = npt.NDArray[np.float64] | npt.NDArray[np.float32]


class QuadrupedEnv(NotCopyable, Drawn, gymnasium.Env[Any, Any]):
    """A quadruped whose gait a policy adjusts, or whose joints it commands: docs/environment.md.

    `reset(seed=s)` begins the episode that the core begins with seed s, the same bits in every process; without a seed
    `np_random` draws one. Observations are new arrays in every step. Numbers beyond the observation space are as they
    are, and named in `info["out_of_bounds"]`.

    Attributes:
        core: the environment of the core, with `state`, `robot`, `terrain`, `foot_contacts`, `summary()`, `save()`,
            `restore()`.
        batch: its state as arrays of one row, and what changes it: `set_state`, `apply_wrench`, `set_parameters`.
        layout: names, units and bounds of observation and action.

    """

    metadata: dict[str, Any] = {"render_modes": ["human", "rgb_array", "depth_array"], "render_fps": 50}  # noqa: RUF012
    #: "gait" or "joints".
    action: ClassVar[str] = ""

    def __init__(
        self,
        config: ConfigLike = None,
        *,
        engine: EngineLike | None = None,
        terrain: TerrainLike | None = None,
        terms: Terms | None = None,
        dtype: npt.DTypeLike = np.float64,
        render_mode: str | None = None,
        width: int = 640,
        height: int = 480,
        camera: Mapping[str, Any] | None = None,
        **keys: Unpack[EnvironmentKeys],
    ) -> None:
        """Read the configuration and build the world; nothing moves before `reset`.

        Args:
            config: the path of a YAML file, a mapping of its keys, an `EnvironmentConfig`, a `Walk`, or None for the
                defaults.
            engine: in the place of the configuration's; see `crossgait.available_engines()`.
            terrain: the same; a `Terrain`, or what makes one.
            terms: rewards, observations, terminations, events and curricula of your own.
            dtype: of observations, float64 or float32.
            render_mode: "rgb_array", "depth_array" or "human" (a window).
            width: of frames, pixels.
            height: of frames, pixels.
            camera: `azimuth`, `elevation`, `distance` and `look_at`, as `crossgait.viewing.rendering.Renderer` takes
                them; {"azimuth": 90} films from the side.
            keys: any other key of the configuration, in the place of what it says.

        Raises:
            ConfigError: for a configuration that is wrong, naming the key.

        """
        made = make_config(self.action, config, {"engine": engine, "terrain": terrain} | keys, terms)
        self.core = _core.Environment(made)
        tell_notes(made)
        self.batch = self.core.batch()
        self.layout = EnvironmentLayout.of(self.core)
        self._dtype = observation_dtype(dtype)
        self._single = self._dtype == np.float32
        self.observation_space = observation_space(self.layout, self._dtype)
        self.action_space = action_space(self.layout)
        self.metadata = self.metadata | {"render_fps": max(1, round(1 / made.policy_dt))}
        self.render_mode = known_render_mode(render_mode, self.metadata["render_modes"])
        self._frame_size = frame_size(width, height)
        self._camera = known_camera(camera)
        self._episode_seed: int | None = None
        self._closed = False

    def __repr__(self) -> str:
        return described(self, self.config)

    __str__ = __repr__  # which wrappers show

    @property
    def config(self) -> _core.EnvironmentConfig:
        """What it is made of."""
        return self.core.config

    @property
    def terms(self) -> Terms | None:
        """Terms at work, of which objects that remember are this environment's own; None before the first reset.

        None without terms as well. `config.terms` are those that were given.
        """
        return None if self.core._terms is None else self.core._terms.running.terms

    def group(self, name: str) -> npt.NDArray[np.float64]:
        """What terms of an observation group show now, (width,): "critic". Raises ConfigError where there are none."""
        if self.core._terms is None:
            raise ConfigError("environment", "group", "terms, and a reset", "none")
        return np.asarray(self.core._terms.running.shown(name)[0])

    @property
    def episode_seed(self) -> int | None:
        """What `reset` takes to repeat the present episode; None before the first."""
        return self._episode_seed

    @property
    def parameters(self) -> dict[str, float] | None:
        """Of the gait as adapted so far; None where actions command joints."""
        return self.core.parameters

    def set_command(self, vx: float, vy: float = 0, yaw_rate: float = 0) -> None:
        """Ask for another velocity from the next step to the end of the episode, m/s and rad/s."""
        self.core.set_command(vx, vy, yaw_rate)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode. Raises ConfigError for any option: there are none."""
        self._check_open()
        super().reset(seed=seed)
        refuse_options(options)
        self._episode_seed = episode_seed(seed, self.np_random)
        observation = self.core.reset(self._episode_seed)
        if self.render_mode == "human":
            self.render()
        return self._seen(observation), self.core.info

    def step(self, action: npt.ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """One policy step. Entries of the action are clipped to their bounds; not finite counts as zero."""
        self._check_open()
        observation, reward, terminated, truncated = self.core.step(action_array(action))
        if self.render_mode == "human":
            self.render()
        return self._seen(observation), reward, terminated, truncated, self.core.info

    def _check_open(self) -> None:
        if self._closed:
            raise gymnasium.error.ClosedEnvironmentError("this environment was closed: make another")

    def _seen(self, observation: npt.NDArray[np.float64]) -> Observation:
        return observation.astype(np.float32) if self._single else observation

    def render(self) -> npt.NDArray[np.uint8] | npt.NDArray[np.float32] | None:
        """A frame (height x width x 3) with "rgb_array", distances (height x width, m) with "depth_array".

        With "human" into the window.
        """
        if self.render_mode is None:
            gymnasium.logger.warn('render() without a render_mode: make the environment with "rgb_array" or "human"')
            return None
        renderer = self._open_renderer()
        if self.render_mode == "human":
            renderer.show(self.core)
            return None
        return renderer.depth(self.core) if self.render_mode == "depth_array" else renderer.frame(self.core)

    def close(self) -> None:
        """Close window and renderer; `reset` and `step` raise ClosedEnvironmentError afterwards."""
        self._closed = True
        self._close_renderer()


class AdaptiveGaitEnv(QuadrupedEnv):
    """Actions adjust a gait: changes of its parameters, and residuals of the foot targets."""

    action = "gait"


class JointControlEnv(QuadrupedEnv):
    """Actions are targets of the joints about their home."""

    action = "joints"
