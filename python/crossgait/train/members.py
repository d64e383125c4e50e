"""The members of a hierarchical policy in training: what each sees and does of an environment (docs/policies.md)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper
from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

from crossgait._core import PolicyBundle, PolicyInterface

Array = npt.NDArray[Any]
Indices = npt.NDArray[np.intp]


@dataclass(frozen=True)
class Member:
    """A planner or a residual policy, and where its numbers are among those of the whole."""

    interface: PolicyInterface  #: what its bundle is for
    sees: tuple[str, ...]  #: as a description's `observation` says it; nothing: everything
    observation: Indices
    action: Indices

    @staticmethod
    def of(whole: PolicyInterface, part: str, sees: Sequence[str], policy_dt: float) -> Member:
        """Of `part` of the action. Raises ConfigError."""
        interface = whole.member(part, observation=list(sees), policy_dt=policy_dt)
        observation = _places(interface.observation_layout, whole.observation_layout)
        return Member(interface, tuple(sees), observation, _places(interface.action_layout, whole.action_layout))


def _places(part: Sequence[tuple[Any, ...]], whole: Sequence[tuple[Any, ...]]) -> Indices:
    names = [entry[0] for entry in whole]
    return np.array([names.index(entry[0]) for entry in part], dtype=np.intp)


class Pace:
    """Which environments are due for a plan: in the first step of an episode, and every `period` steps from there."""

    def __init__(self, count: int, period: int) -> None:
        self.period = period
        self._steps = np.zeros(count, dtype=np.int64)  # of each episode

    @property
    def due(self) -> npt.NDArray[np.bool_]:
        """Of each environment, before its next step."""
        due: npt.NDArray[np.bool_] = self._steps % self.period == 0
        return due

    def begin(self) -> None:
        """New episodes everywhere."""
        self._steps[:] = 0

    def advance(self, dones: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
        """A step everywhere; returns what would be due in episodes that `dones` ended, had they gone on."""
        self._steps += 1
        due = self.due
        self._steps[dones] = 0
        return due


class MemberEnvs(VecEnvWrapper):
    """Environments as one member sees them. The other's part of the action is zero, or a frozen planner's.

    As in a rollout of the whole policy, a plan acts in one step, and deltas are zero until the next.
    """

    def __init__(
        self, envs: VecEnv, member: Member, frozen: tuple[Member, PolicyBundle] | None = None, period: int = 1
    ) -> None:
        """Wrap `envs`; `frozen` plans every `period` steps."""
        self._member, self._frozen = member, frozen
        self._pace = Pace(envs.num_envs, period)
        self._observations: Array = np.empty(0)
        super().__init__(
            envs,
            _part(envs.observation_space, member.observation),
            _part(envs.action_space, member.action),
        )

    def reset(self) -> Array:
        """Begin an episode everywhere."""
        self._pace.begin()
        observations = self.venv.reset()
        assert isinstance(observations, np.ndarray)
        self._observations = observations
        return observations[:, self._member.observation]

    def step_async(self, actions: Array) -> None:
        """Take the member's actions."""
        whole = np.zeros((self.num_envs, *self.venv.action_space.shape), np.float32)  # type: ignore[misc]
        due = np.flatnonzero(self._pace.due)
        if self._frozen is not None and len(due):
            planner, bundle = self._frozen
            plans = bundle.network.evaluate(self._observations[np.ix_(due, planner.observation)].astype(np.float64))
            whole[np.ix_(due, planner.action)] = np.clip(plans, -1, 1)
        whole[:, self._member.action] = actions
        self.venv.step_async(whole)

    def step_wait(self) -> VecEnvStepReturn:
        """One policy step everywhere."""
        observations, rewards, dones, infos = self.venv.step_wait()
        assert isinstance(observations, np.ndarray)
        self._pace.advance(dones)
        self._observations = observations
        for i in np.flatnonzero(dones):
            infos[i]["terminal_observation"] = infos[i]["terminal_observation"][self._member.observation]
        return observations[:, self._member.observation], rewards, dones, infos


class TwoPaceEnvs(VecEnvWrapper):
    """Environments as both members see them: the last number of an observation says whether a plan is due.

    Where none is due, what the planner says does nothing.
    """

    def __init__(self, envs: VecEnv, planner: Member, period: int) -> None:
        """Wrap `envs`, with a plan due every `period` steps."""
        self._planner = planner
        self._pace = Pace(envs.num_envs, period)
        seen = envs.observation_space
        assert isinstance(seen, gymnasium.spaces.Box)
        low, high = (np.append(bounds, end).astype(np.float32) for bounds, end in ((seen.low, 0), (seen.high, 1)))
        super().__init__(envs, gymnasium.spaces.Box(low, high, dtype=np.float32), envs.action_space)

    def _seen(self, observations: Any, due: npt.NDArray[np.bool_]) -> Array:
        return np.concatenate([observations, due[:, None]], axis=1, dtype=np.float32)

    def reset(self) -> Array:
        """Begin an episode everywhere."""
        self._pace.begin()
        return self._seen(self.venv.reset(), self._pace.due)

    def step_async(self, actions: Array) -> None:
        """Take whole actions."""
        whole = actions.copy()
        whole[np.ix_(~self._pace.due, self._planner.action)] = 0
        self.venv.step_async(whole)

    def step_wait(self) -> VecEnvStepReturn:
        """One policy step everywhere."""
        observations, rewards, dones, infos = self.venv.step_wait()
        due = self._pace.advance(dones)
        for i in np.flatnonzero(dones):
            last = infos[i]["terminal_observation"]
            infos[i]["terminal_observation"] = np.append(last, due[i]).astype(np.float32)
        return self._seen(observations, self._pace.due), rewards, dones, infos


def _part(space: gymnasium.Space[Any], at: Indices) -> gymnasium.spaces.Box:
    assert isinstance(space, gymnasium.spaces.Box)
    return gymnasium.spaces.Box(space.low[at], space.high[at], dtype=np.float32)
