"""A vector environment of the core with terms that Python computes for all environments at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait import _core
from crossgait.errors import ConfigError
from crossgait.terms.declarations import Terms
from crossgait.terms.running import RunningTerms

FloatArray = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Step = tuple[FloatArray, FloatArray, Flags, Flags, FloatArray | None]


class TermedVectorEnvironment:
    """What `_core.VectorEnvironment` is to those that step it, of a configuration with terms.

    The core steps all and resets none; after its step terms are asked in the order terminations, rewards, curriculum
    (where episodes ended), events, observations. Without terms the numbers are those of the core alone, bit for bit.
    """

    def __init__(
        self, config: _core.EnvironmentConfig, environments: int, *, workers: int = 1, auto_reset: str = "next_step"
    ) -> None:
        """As `_core.VectorEnvironment`, whose engine is the configuration's. Raises ConfigError."""
        terms: Terms = config.terms
        self._config = config
        self._core = _core.VectorEnvironment(
            config._without_terms(), environments, workers=workers, auto_reset="disabled"
        )
        self._auto_reset = auto_reset
        self._batch = self._core.batch()
        self._terms = RunningTerms(terms, self._batch)
        self._layouts = config._layouts()
        self._ended = np.zeros(environments, np.bool_)  # in the last step, and not begun anew
        self._final: list[dict[str, Any] | None] = [None] * environments
        self._final_infos: dict[str, Any] | None = None
        self._going = False  # whether `reset` cuts episodes off
        self._kept: dict[str, Any] | None = None
        self._own = np.zeros((environments, len(self._core.observation_layout)))

    @property
    def size(self) -> int:
        """How many environments."""
        return self._core.size

    @property
    def workers(self) -> int:
        """Threads."""
        return self._core.workers

    @property
    def config(self) -> _core.EnvironmentConfig:
        """With its terms."""
        return self._config

    @property
    def terms(self) -> Terms:
        """Terms at work: objects that remember are copies of those of the configuration."""
        return self._terms.terms

    @property
    def engine(self) -> str:
        """Name of the engine."""
        return self._core.engine

    @property
    def observation_layout(self) -> list[tuple[str, str, float, float, float, float]]:
        """The core's, and the numbers of the terms behind it."""
        return list(self._layouts[0])

    @property
    def action_layout(self) -> list[tuple[str, str, float, float, float, float]]:
        """The core's."""
        return self._core.action_layout

    @property
    def layout_hash(self) -> str:
        """What a policy is trained for."""
        return str(self._layouts[2])

    @property
    def diverged(self) -> int:
        """Episodes that ended because the engine diverged."""
        return self._core.diverged

    @property
    def episodes(self) -> int:
        """Episodes begun so far."""
        return self._core.episodes

    def batch(self) -> _core.Batch:
        """What terms see: the same one in every call."""
        return self._batch

    def environment(self, index: int) -> _core.EnvironmentView:
        """One of them, to look at."""
        return self._core.environment(index)

    def reset(self, seed: int | Sequence[int]) -> FloatArray:
        """Begin an episode everywhere, as `_core.VectorEnvironment.reset`."""
        self.cut_off()
        self._own = self._core.reset(seed)
        if self._kept is not None:
            self._terms.keep(self._kept)
            self._kept = None
            self._own = self._core.reset(seed)  # in worlds of those parameters
        self._terms.seed(seed)
        self._begin(np.ones(self.size, np.bool_))
        self._going = True
        self._ended[:] = False
        self._final, self._final_infos = [None] * self.size, None
        return self._seen()

    def reset_some(self, which: Flags, observations: FloatArray, seed: int | Sequence[int] | None = None) -> None:
        """Begin episodes of those, as `_core.VectorEnvironment.reset_some`.

        A seed, or seeds, begin the random numbers of all environments' terms anew: they come from one stream.
        """
        if (made := np.flatnonzero(which & (self._batch.time > 0))).size:
            self._terms.end(made)
        self._core.reset_some(which, self._own, seed)
        if seed is not None:
            self._terms.seed(seed)
        self._begin(which)
        self._ended &= ~which
        for value in self._terms.reward_values.values():
            value[which] = 0
        observations[which] = self._seen()[which]

    def cut_off(self) -> None:
        """Tell curricula that all episodes are over which have made a step; those of `reset` follow."""
        if self._going and (made := np.flatnonzero(self._batch.time > 0)).size:
            self._terms.end(made)
        self._going = False

    def kept(self) -> dict[str, Any]:
        """What terms keep beyond `reset`, in plain values and arrays: see `keep`. Raises ConfigError."""
        return self._terms.kept()

    def keep(self, kept: dict[str, Any]) -> None:
        """Let the next `reset` go on from what another one of the same size has `kept`; it may raise ConfigError."""
        if len(kept["parameters"]) != self.size:
            raise ConfigError("terms", "restore", f"{self.size} environments", str(len(kept["parameters"])))
        self._kept = kept

    def _begin(self, which: Flags) -> None:
        if self._terms.begin(np.flatnonzero(which)):
            self._core.observe_start(which, self._own)

    def _begin_next(self, which: Flags) -> None:
        self._terms.end(np.flatnonzero(which))
        self._core.reset_some(which, self._own)
        self._begin(which)

    def _seen(self) -> FloatArray:
        return np.concatenate([self._own, self._terms.observe("policy")], axis=1)

    def group(self, name: str) -> FloatArray:
        """What the terms of an observation group show now, (n, width): "critic"."""
        return self._terms.shown(name)

    def step(self, actions: npt.NDArray[Any]) -> Step:
        """One policy step everywhere, as `_core.VectorEnvironment.step`."""
        self._own, rewards, terminated, truncated, _ = self._core.step(actions)
        pending = self._ended
        if pending.any():  # of next_step: it stood still
            self._begin_next(pending)
            terminated &= ~pending
            truncated &= ~pending
        going = ~(terminated | truncated | pending)
        by_terms, by_time = self._terms.terminations()
        by_terms &= going
        by_time &= going & ~by_terms
        if by_terms.any() or by_time.any():
            self._batch._end_in_step(by_terms, by_time, rewards)
            terminated |= by_terms
            truncated |= by_time
        own = self._terms.rewards()
        if pending.any():
            own[pending] = 0
            for value in self._terms.reward_values.values():
                value[pending] = 0
        rewards += own
        ended = terminated | truncated
        self._terms.change(~(ended | pending))
        seen = self._seen()
        if self._auto_reset != "same_step":
            self._ended = ended & (self._auto_reset == "next_step")
            return seen, rewards, terminated, truncated, None
        final = seen
        self._final, self._final_infos = [None] * self.size, None
        if ended.any():
            for i in map(int, np.flatnonzero(ended)):
                self._final[i] = self.info(i)
            self._final_infos = of_those(ended, self.infos())
            self._begin_next(ended)
            for name, value in self._terms.reward_values.items():
                self._terms.reward_values[name] = np.where(ended, 0.0, value)
            seen = np.where(ended[:, None], self._seen(), final)
        return seen, rewards, terminated, truncated, final

    def info(self, index: int) -> dict[str, Any]:
        """What is known of one environment's last step."""
        info = self._core.info(index)
        info["reward_terms"] |= {name: float(value[index]) for name, value in self._terms.reward_values.items()}
        return info

    def infos(self) -> dict[str, Any]:
        """The same of all, as Gymnasium's vector environments have it."""
        infos = self._core.infos()
        rewards, mask = infos["reward_terms"], infos["_reward_terms"]
        for name, value in self._terms.reward_values.items():
            rewards |= {name: value, f"_{name}": mask}
        return infos

    @property
    def reward_means(self) -> dict[str, float]:
        """Means over environments of the terms' rewards in the last step, weighted."""
        return {name: float(value.mean()) for name, value in self._terms.reward_values.items()}

    def final_info(self, index: int) -> dict[str, Any] | None:
        """With same_step, of one environment's episode if the last step ended it."""
        return self._final[index]

    def final_infos(self) -> dict[str, Any]:
        """With same_step, of the episodes that the last step ended."""
        return self._final_infos or of_those(np.zeros(self.size, np.bool_), self.infos())


def of_those(which: Flags, infos: dict[str, Any]) -> dict[str, Any]:
    """Infos of some environments alone: zero or None elsewhere."""
    masked: dict[str, Any] = {}
    for key, value in infos.items():
        if isinstance(value, dict):
            masked[key] = of_those(which, value)
        elif key.startswith("_"):
            masked[key] = which
        else:
            masked[key] = np.where(which, value, None if value.dtype == object else value.dtype.type(0))
    return masked
