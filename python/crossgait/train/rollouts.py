"""What a worker does for a run whose rollouts are collected elsewhere: those of one block of environments.

A block's rollout follows from the plan, the block, the seed and what is given (weights, normalisation, what the block's
terms kept of its last rollout) alone, to the bit: nothing of it is left in the process that made it, so any other makes
it again. Environments are normalised by what the learner knew when the rollout began.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt
import torch
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.utils import set_random_seed
from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper, VecNormalize
from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

from crossgait._core import derived_seed
from crossgait.errors import ConfigError
from crossgait.notes import Note
from crossgait.terms import Terms
from crossgait.train.environments import Kept, TrainingEnvs
from crossgait.train.learner import Learner
from crossgait.train.plan import Plan
from crossgait.train.tally import Tally

Array = npt.NDArray[Any]

#: Of the buffer of a rollout, (n_steps, environments, ...).
FIELDS = ("observations", "actions", "rewards", "episode_starts", "values", "log_probs", "advantages", "returns")
_ACTIONS_SEED = 2**33  #: index of the seed that actions are drawn by, beyond any environment's and that of commands


@dataclass(frozen=True)
class Block:
    """Environments that are stepped together, by whichever worker."""

    index: int  #: among those of its stage
    part: int  #: of `Plan.shared_out`
    count: int  #: of environments
    kept: Kept | None = None  #: what its terms kept of its last rollout; None: there was none


def blocks_of(plan: Plan, stage: int) -> list[Block]:
    """The environments of a stage, in blocks of as many as the plan's `block` says at most, in one order."""
    counts = [
        (part, min(plan["block"], count - first))
        for part, (_, _, count) in enumerate(plan.shared_out(plan.stages[stage]))
        for first in range(0, count, plan["block"])
    ]
    return [Block(index, part, count) for index, (part, count) in enumerate(counts)]


@dataclass(frozen=True)
class Given:
    """What all blocks of one rollout begin with."""

    plan: Plan  #: without terms, which no configuration takes to another process
    terms: Terms | None
    learner: Learner
    key: str  #: of both, which are the same in all rollouts of a run
    stage: int
    seed: int  #: of the rollout
    weights: Mapping[str, Array]  #: of the policy
    observation: tuple[Array, Array] | None  #: mean and variance; None: as they are
    reward_variance: float


@dataclass(frozen=True)
class Collected:
    """One block's rollout."""

    fields: Mapping[str, Array]  #: those of `FIELDS`
    observation: RunningMeanStd  #: moments of what was seen, before it was normalised
    returns: RunningMeanStd  #: moments of discounted sums of rewards
    last: Array  #: observations after the last step, as they are
    tally: Tally
    summaries: list[dict[str, Any]]  #: of the episodes that go on
    parameters: list[dict[str, float] | None]
    kept: Kept | None  #: what terms keep for the block's next rollout


def collect(block: Block, given: Given) -> Collected | ConfigError:
    """Collect a block's rollout. Returns what is wrong with the plan here, such as an engine that is missing."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Note)  # which the trainer tells
            # Terms may leave their mark on worlds, and those have no key: their environments are made anew.
            worker = _Worker(given, block) if given.terms else _kept(_Kind(given, block))
            return worker.collect(block, given)
    except ConfigError as error:
        return error


class _Kind:
    """What environments and model of a block are made of; equal ones make equal ones."""

    def __init__(self, given: Given, block: Block) -> None:
        self.given, self.block = given, block
        self._said = (given.key, given.stage, block.part, block.count)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Kind) and self._said == other._said

    def __hash__(self) -> int:
        return hash(self._said)


@lru_cache(maxsize=8)  # a rollout has few kinds of blocks
def _kept(kind: _Kind) -> _Worker:
    return _Worker(kind.given, kind.block)


class _Worker:
    """Environments of a block's kind, and a model of Stable-Baselines3 to collect rollouts with."""

    def __init__(self, given: Given, block: Block) -> None:
        plan = given.plan if given.terms is None else given.plan.with_terms(given.terms)
        algorithm = plan["algorithm"] | {"batch_size": plan["algorithm"]["n_steps"] * block.count}
        plan = replace(plan, document=plan.document | {"algorithm": algorithm})
        torch.set_num_threads(plan["threads"])
        self._stage = plan.stages[given.stage]
        self._envs = TrainingEnvs(plan, self._stage, [(*plan.shared_out(self._stage)[block.part][:2], block.count)])
        self._seen = _Moments(given.learner.environments(self._envs), plan["algorithm"]["gamma"])
        self._normalise = normalised(self._seen, plan)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a batch that is never learned from
            self._model = given.learner.model(plan, self._normalise)
        self._normalise.training = False

    def collect(self, block: Block, given: Given) -> Collected:
        weights = {name: torch.tensor(array) for name, array in given.weights.items()}
        self._model.policy.load_state_dict(weights)
        if given.observation is not None:
            assert isinstance(self._normalise.obs_rms, RunningMeanStd)
            self._normalise.obs_rms.mean, self._normalise.obs_rms.var = given.observation
        self._normalise.ret_rms.var = np.asarray(given.reward_variance)
        seed = derived_seed(given.seed, block.index)
        if block.kept is not None:
            self._envs.keep(block.kept)
        self._envs.begin(self._stage, seed)
        set_random_seed(derived_seed(seed, _ACTIONS_SEED) % 2**32)
        model = self._model
        model._last_obs = None  # so that new episodes begin
        _, callback = model._setup_learn(model.n_steps * block.count)
        model.collect_rollouts(self._normalise, callback, model.rollout_buffer, model.n_steps)
        summaries, parameters = self._envs.env_method("summary"), self._envs.get_attr("parameters")
        self._envs.end()
        return Collected(
            {name: getattr(model.rollout_buffer, name).copy() for name in FIELDS},
            self._seen.observations,
            self._seen.returns,
            np.asarray(self._normalise.get_original_obs()),
            self._envs.tally,
            summaries,
            parameters,
            self._envs.kept(),
        )


class _Moments(VecEnvWrapper):
    """Sums up what it lets through, from one `reset` to the next, as VecNormalize would.

    Attributes:
        observations: moments of observations.
        returns: moments of discounted sums of rewards.

    """

    def __init__(self, envs: VecEnv, gamma: float) -> None:
        super().__init__(envs)
        self._gamma = gamma

    def reset(self) -> Array:
        seen = self.venv.reset()
        assert isinstance(seen, np.ndarray)
        self.observations, self.returns = RunningMeanStd(0, seen.shape[1:]), RunningMeanStd(0)
        self._sums = np.zeros(self.num_envs)
        self.observations.update(seen)
        return seen

    def step_wait(self) -> VecEnvStepReturn:
        seen, rewards, dones, infos = self.venv.step_wait()
        assert isinstance(seen, np.ndarray)
        self.observations.update(seen)
        self._sums = self._sums * self._gamma + rewards
        self.returns.update(self._sums)
        self._sums[dones] = 0
        return seen, rewards, dones, infos


def normalised(envs: VecEnv, plan: Plan) -> VecNormalize:
    """Wrap environments as the plan's `normalise` says."""
    asked = plan["normalise"]
    return VecNormalize(
        envs,
        norm_obs=asked["observation"],
        norm_reward=asked["reward"],
        clip_obs=float(asked["clip_observation"]),
        clip_reward=float(asked["clip_reward"]),
        gamma=plan["algorithm"]["gamma"],
    )
