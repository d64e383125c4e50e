"""The environments of a training run: native vector environments, one for each engine and ground, behind one VecEnv."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from stable_baselines3.common.vec_env import VecEnv
from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices, VecEnvStepReturn

from crossgait._core import derived_seed
from crossgait.envs.not_copyable import NotCopyable
from crossgait.envs.termed_vector import TermedVectorEnvironment
from crossgait.errors import ConfigError
from crossgait.sb3 import CrossgaitVecEnv
from crossgait.train.keys import COMMAND
from crossgait.train.plan import Plan, Share, Stage
from crossgait.train.tally import Tally

#: Engine, what environments meet, and how many there are.
Dealt = Sequence[tuple[str, Share, int]]

#: What terms keep from one rollout to the next: the `stage`, and by `parts` of its environments what each has kept.
Kept = dict[str, Any]

_IDS = {"gait": "Crossgait/AdaptiveGait-v0", "joints": "Crossgait/JointControl-v0"}
_COMMANDS_SEED = 2**32  #: index of the seed that commands are drawn by, beyond any engine's


class TrainingEnvs(NotCopyable, VecEnv):
    """All environments in all engines; a rollout begins with `begin`, and new episodes everywhere.

    Everything that happens in a rollout follows from its stage and seed alone: that is what makes a run that goes on
    from a checkpoint equal to one that was never stopped.

    Attributes:
        tally: what happened since `begin`.

    """

    def __init__(self, plan: Plan, stage: Stage | None = None, dealt: Dealt | None = None) -> None:
        """Build the worlds of `stage`, the first by default. Raises ConfigError.

        Args:
            plan: of the run.
            stage: whose worlds.
            dealt: of them those, and no others later; all by default.

        """
        self._plan, self._dealt = plan, dealt
        self._seed = 0
        self._kept: Kept | None = None  # to go on from
        self._core_seconds = 0.0  # of vector environments of former stages
        self._enter(stage or plan.stages[0])
        first = self._parts[0]
        count = sum(part.num_envs for part in self._parts)
        self.tally = Tally(count)
        super().__init__(count, first.observation_space, first.action_space)

    def _enter(self, stage: Stage) -> None:
        self._is_closed = False
        self._stage = stage
        name, workers = _IDS[stage.environment.action], self._plan["workers"]
        dealt = self._dealt or self._plan.shared_out(stage)
        self._parts = [
            CrossgaitVecEnv(name, count, config=share.environment, engine=engine, workers=workers)
            for engine, share, count in dealt
        ]
        ends = np.cumsum([0, *(part.num_envs for part in self._parts)])
        self._slices = [slice(int(a), int(b)) for a, b in pairwise(ends)]
        self._commands = [
            _Commands(share, part) if share.command else None
            for part, (_, share, _) in zip(self._parts, dealt, strict=True)
        ]

    @property
    def core_seconds(self) -> float:
        """Wall time spent in the core so far, s."""
        return self._core_seconds + sum(part.core_seconds for part in self._parts)

    def begin(self, stage: Stage, seed: int) -> None:
        """Say what the next `reset` begins: another stage builds other worlds, and so does one after `close`."""
        if self._is_closed or stage.index != self._stage.index:
            self._core_seconds = self.core_seconds
            self.close()
            self._enter(stage)
        if self._kept is not None and self._kept["stage"] == stage.index:
            for part, kept in zip(self._termed(), self._kept["parts"], strict=True):
                part.keep(kept)
        self._kept, self._seed = None, seed
        self.tally = Tally(self.num_envs)

    def end(self) -> None:
        """The rollout is over, and with it all episodes: curricula are told so."""
        for part in self._termed():
            part.cut_off()

    def kept(self) -> Kept | None:
        """What terms keep for the next rollout of this stage; None without terms. Raises ConfigError."""
        parts = [part.kept() for part in self._termed()]
        return {"stage": self._stage.index, "parts": parts} if parts else None

    def keep(self, kept: Kept | None) -> None:
        """Go on with the next `begin` from what others have `kept`, if it is of the same stage.

        Raises ConfigError for that of other terms.
        """
        if kept is not None:
            all_parts = [len(self._dealt or self._plan.shared_out(stage)) for stage in self._plan.stages]
            check_kept(kept, all_parts if self._termed() else [])
        self._kept = kept

    def _termed(self) -> list[TermedVectorEnvironment]:
        return [part.vector.core for part in self._parts if isinstance(part.vector.core, TermedVectorEnvironment)]

    def reset(self) -> npt.NDArray[np.float32]:
        """Begin an episode everywhere, by the seed of the last `begin`."""
        for i, part in enumerate(self._parts):
            part.seed(derived_seed(self._seed, i) % 2**63)
        observations = np.concatenate([part.reset() for part in self._parts])
        self._random = np.random.default_rng(derived_seed(self._seed, _COMMANDS_SEED))
        self._command(range(self.num_envs), observations)
        self.reset_infos = [info for part in self._parts for info in part.reset_infos]
        return observations

    def _command(self, which: Sequence[int], observations: npt.NDArray[np.float32]) -> None:
        """Draw commands of environments whose episode has just begun, and show them in their first observation."""
        for i in which:
            part = next(k for k, s in enumerate(self._slices) if i < s.stop)
            commands = self._commands[part]
            if commands is not None:
                command = commands.draw(self._random)
                self._parts[part].env_method("set_command", *command, indices=[i - self._slices[part].start])
                commands.show(command, observations[i])

    def step_async(self, actions: npt.NDArray[Any]) -> None:
        """Take what `step_wait` does."""
        for part, rows in zip(self._parts, self._slices, strict=True):
            part.step_async(actions[rows])

    def step_wait(self) -> VecEnvStepReturn:
        """One policy step everywhere."""
        results = [part.step_wait() for part in self._parts]
        observations, rewards, dones = (np.concatenate([r[k] for r in results]) for k in range(3))
        infos = [info for result in results for info in result[3]]
        if dones.any():
            self._command([int(i) for i in np.flatnonzero(dones)], observations)
        self.tally.add(rewards, dones, infos)
        return observations, rewards, dones, infos

    def close(self) -> None:
        """Close every part."""
        self._is_closed = True
        for part in self._parts:
            part.close()

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Of each environment: see `crossgait.sb3.SubEnvironment`."""
        every = [value for part in self._parts for value in part.get_attr(attr_name)]
        return [every[i] for i in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Nothing is to be set: raises AttributeError."""
        raise AttributeError(f"{attr_name} of a training environment is not to be set")

    def env_method(self, method_name: str, *args: Any, indices: VecEnvIndices = None, **kwargs: Any) -> list[Any]:
        """Call a method of each environment."""
        return [method(*args, **kwargs) for method in self.get_attr(method_name, indices)]

    def env_is_wrapped(
        self, wrapper_class: type[gymnasium.Wrapper[Any, Any, Any, Any]], indices: VecEnvIndices = None
    ) -> list[bool]:
        """None is wrapped."""
        return [False for _ in self._get_indices(indices)]


def check_kept(kept: Kept, parts: Sequence[int]) -> None:
    """Raise ConfigError where it is not of so many parts as each stage's environments with terms have."""
    stage, found = kept["stage"], len(kept["parts"])
    if stage >= len(parts) or found != parts[stage]:
        each = ", ".join(map(str, parts)) or "no"
        expected = f"what terms keep of {each} parts of the environments, by stages"
        raise ConfigError("terms", "restore", expected, f"of {found} in stage {stage}")


class _Commands:
    """Commands of episodes, drawn uniformly from a share's ranges; what it does not name is the configuration's."""

    def __init__(self, share: Share, part: CrossgaitVecEnv) -> None:
        nominal = share.environment.command or {}
        fixed = {key: nominal.get(key, 0.0) for key in COMMAND}
        self._ranges = [share.command.get(key, (fixed[key], fixed[key])) for key in COMMAND]
        # Where the first observation shows it. The core has written it with the configuration's command; entries of
        # other ages (a delay, a history) keep that one until the new one has come of age.
        names = part.vector.layout.observation.names
        self._at = [names.index(f"command.{key}") if f"command.{key}" in names else None for key in COMMAND]
        self._scale, self._clip = _seen(share.environment.observation)

    def draw(self, random: np.random.Generator) -> tuple[float, float, float]:
        vx, vy, yaw_rate = (float(random.uniform(low, high)) for low, high in self._ranges)
        return vx, vy, yaw_rate

    def show(self, command: tuple[float, float, float], observation: npt.NDArray[np.float32]) -> None:
        for at, value, scale in zip(self._at, command, self._scale, strict=True):
            if at is not None:
                observation[at] = np.clip(value * scale, -self._clip, self._clip)


def _seen(observation: list[Any]) -> tuple[list[float], float]:
    """Scale and clip of the first block `command` without a delay."""
    for term in observation:
        if isinstance(term, dict) and term["block"] == "command" and not term.get("delay"):
            scale = term.get("scale", 1)
            scales = scale if isinstance(scale, list) else [scale] * len(COMMAND)
            return [float(s) for s in scales], float(term.get("clip", np.inf))
    return [1.0] * len(COMMAND), float("inf")
