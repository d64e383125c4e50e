"""Environments that workers step: a learner's view of rollouts that are collected elsewhere."""

from __future__ import annotations

import hashlib
import pickle
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.vec_env import VecEnv, VecNormalize
from stable_baselines3.common.vec_env.base_vec_env import VecEnvIndices, VecEnvStepReturn

from crossgait import _core
from crossgait.envs.not_copyable import NotCopyable
from crossgait.envs.spaces import action_space, observation_space
from crossgait.errors import ConfigError
from crossgait.layout import EnvironmentLayout
from crossgait.sweep.executors import Executor, Outcome
from crossgait.train.environments import Kept, check_kept
from crossgait.train.learner import Learner, WholePolicy
from crossgait.train.plan import Plan, Stage
from crossgait.train.ppo import TimedPPO
from crossgait.train.rollouts import FIELDS, Block, Collected, Given, blocks_of, collect
from crossgait.train.tally import Tally

#: Makes workers, given what they do: `partial(ProcessPool, 8)`, `lambda make: RayCluster("auto", make=make)`.
Workers = Callable[[Callable[..., Any]], Executor[Block, Any]]

CRASHES = 3  #: of the processes that collect one block, after which it is given up
_LOOK_SECONDS = 0.2  #: how often Ctrl-C is looked at


class RemoteEnvs(NotCopyable, VecEnv):
    """All environments of a run, none of them here; `collect` is what steps them, a rollout at a time.

    Attributes:
        tally: what happened in the last rollout.
        core_seconds: wall time spent waiting for workers so far, s.
        lost: blocks so far that were made again, since the worker that had them was gone.

    """

    def __init__(self, plan: Plan, learner: Learner, workers: Workers) -> None:
        """Start the workers. Raises ConfigError."""
        self._plan, self._terms = plan.without_terms()
        # With terms there is no hierarchy, and what a worker takes of a learner is its model.
        self._learner = learner if self._terms is None else WholePolicy(self._plan)
        self._stage, self._seed = plan.stages[0], 0
        self._key = hashlib.sha256(pickle.dumps((self._plan, self._learner))).hexdigest()
        self.tally, self.core_seconds, self.lost = Tally(0), 0.0, 0
        self._last: list[Collected] = []
        self._kept: Kept | None = None
        layout = EnvironmentLayout.of(_core.Environment(plan.stages[0].environment))
        spaces = (observation_space(layout, np.dtype(np.float32)), action_space(layout))
        super().__init__(sum(count for _, _, count in plan.shared_out(self._stage)), *spaces)
        self._workers = workers(collect)

    def begin(self, stage: Stage, seed: int) -> None:
        """Say what the next rollout is of."""
        self._stage, self._seed = stage, seed

    def collect(self, model: TimedPPO, normalise: VecNormalize) -> None:
        """Fill the model's buffer with new episodes of all environments, and count their steps.

        Raises ConfigError for a plan that a worker cannot make environments of, and RuntimeError for a block whose
        process crashes again and again.
        """
        begin = time.perf_counter()
        blocks = self._blocks()
        self._last = self._collected(blocks, self._given(model, normalise))
        self.core_seconds += time.perf_counter() - begin
        buffer = model.rollout_buffer
        buffer.reset()
        for name in FIELDS:
            parts = [collected.fields[name] for collected in self._last]
            getattr(buffer, name)[:] = np.concatenate(parts, axis=1)
        buffer.pos, buffer.full = buffer.buffer_size, True
        for collected in self._last:  # in the order of blocks, whichever came first
            if normalise.norm_obs:
                assert isinstance(normalise.obs_rms, RunningMeanStd)
                normalise.obs_rms.combine(collected.observation)
            normalise.ret_rms.combine(collected.returns)
        normalise.old_obs = np.concatenate([collected.last for collected in self._last])
        model._last_obs = normalise.normalize_obs(normalise.old_obs)
        model.num_timesteps += model.n_steps * self.num_envs
        self.tally = Tally.sum_of([collected.tally for collected in self._last])
        kept = [collected.kept for collected in self._last if collected.kept is not None]
        if kept:
            self._kept = {"stage": self._stage.index, "parts": [part for of in kept for part in of["parts"]]}

    def kept(self) -> Kept | None:
        """What each block's terms keep for its next rollout; None without terms."""
        return self._kept

    def keep(self, kept: Kept | None) -> None:
        """Go on from what others have `kept`, if it is of the same stage. Raises ConfigError for another number."""
        if kept is not None:
            parts = [len(blocks_of(self._plan, stage.index)) for stage in self._plan.stages]
            check_kept(kept, [] if self._terms is None else parts)
        self._kept = kept

    def _blocks(self) -> list[Block]:
        blocks = blocks_of(self._plan, self._stage.index)
        if self._kept is None or self._kept["stage"] != self._stage.index:
            return blocks
        parts = zip(blocks, self._kept["parts"], strict=True)
        return [replace(block, kept=self._kept | {"parts": [part]}) for block, part in parts]

    def _given(self, model: TimedPPO, normalise: VecNormalize) -> Given:
        observation = None
        if normalise.norm_obs:
            assert isinstance(normalise.obs_rms, RunningMeanStd)
            observation = (normalise.obs_rms.mean, normalise.obs_rms.var)
        weights = {name: tensor.numpy() for name, tensor in model.policy.state_dict().items()}
        variance = float(normalise.ret_rms.var)
        how = (self._learner, self._key, self._stage.index, self._seed)
        return Given(self._plan, self._terms, *how, weights, observation, variance)

    def _collected(self, blocks: Sequence[Block], given: Given) -> list[Collected]:
        """Of all blocks, in their order; what is lost is handed out again."""
        self._workers.share(given)
        todo, done, crashes = list(reversed(blocks)), dict[int, Collected](), Counter[int]()
        while len(done) < len(blocks):
            while todo and self._workers.has_room():
                self._workers.submit(todo.pop())
            for outcome in self._workers.wait(_LOOK_SECONDS):
                if (made := self._made(outcome, crashes)) is None:
                    todo.append(outcome.task)
                else:
                    done[outcome.task.index] = made
        return [done[block.index] for block in blocks]

    def _made(self, outcome: Outcome[Block, Any], crashes: Counter[int]) -> Collected | None:
        """What came back; None: to be made again."""
        if outcome.kind == "made":
            if isinstance(outcome.made, ConfigError):
                raise outcome.made
            assert isinstance(outcome.made, Collected)
            return outcome.made
        self.lost += 1
        if outcome.kind == "crashed":
            crashes[outcome.task.index] += 1
            if crashes[outcome.task.index] >= CRASHES:
                said = f"the process that collected block {outcome.task.index} crashed, {CRASHES} times"
                raise RuntimeError(f"{said}: {outcome.detail}")
        return None

    def close(self) -> None:
        """End the workers."""
        self._workers.close()

    def reset(self) -> npt.NDArray[np.float32]:
        """Not here: raises RuntimeError."""
        raise RuntimeError("these environments are stepped elsewhere: collect")

    def step_async(self, actions: npt.NDArray[Any]) -> None:
        """Not here: raises RuntimeError."""
        self.reset()

    def step_wait(self) -> VecEnvStepReturn:
        """Not here: raises RuntimeError."""
        raise RuntimeError("these environments are stepped elsewhere: collect")

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """`parameters` of each environment at the end of the last rollout, and its `render_mode`, which is none."""
        if attr_name == "render_mode":
            return [None] * self.num_envs
        if attr_name != "parameters":
            raise AttributeError(f"{attr_name} of an environment that is stepped elsewhere")
        every = [value for collected in self._last for value in collected.parameters]
        return [every[i] for i in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Nothing is to be set: raises AttributeError."""
        raise AttributeError(f"{attr_name} of a training environment is not to be set")

    def env_method(self, method_name: str, *args: Any, indices: VecEnvIndices = None, **kwargs: Any) -> list[Any]:
        """`summary` of each environment at the end of the last rollout."""
        if method_name != "summary":
            raise AttributeError(f"{method_name} of an environment that is stepped elsewhere")
        every = [value for collected in self._last for value in collected.summaries]
        return [every[i] for i in self._get_indices(indices)]

    def env_is_wrapped(
        self, wrapper_class: type[gymnasium.Wrapper[Any, Any, Any, Any]], indices: VecEnvIndices = None
    ) -> list[bool]:
        """None is wrapped."""
        return [False for _ in self._get_indices(indices)]
