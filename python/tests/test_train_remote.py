"""Rollouts that workers collect: the same bits whoever made them, in whatever order, and after losses."""

from __future__ import annotations

import pickle
import random
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
import training
from test_train_hierarchy import plan as hierarchical

import crossgait
from crossgait import ConfigError, _core, terms
from crossgait.sweep import Outcome

pytest.importorskip("stable_baselines3")

from crossgait.sb3 import CrossgaitVecEnv
from crossgait.train import Plan
from crossgait.train.learner import WholePolicy
from crossgait.train.remote_envs import RemoteEnvs
from crossgait.train.rollouts import FIELDS, Block, blocks_of, normalised
from crossgait.train.trainer import Trainer

TINY = {
    "environments": 6,
    "block": 2,
    "algorithm": {"n_steps": 8, "batch_size": 12, "n_epochs": 1},
    "network": {"hidden": [8]},
    "environment": training.SMALL["environment"] | {"terrain": "flat", "episode_seconds": 0.1},
    "randomisation": {},
}


def plan(**changes: Any) -> Plan:
    return Plan.parse(training.small(**TINY) | changes, "tiny")


@contextmanager
def kept_random_numbers() -> Iterator[None]:
    states = random.getstate(), np.random.get_state(), torch.get_rng_state()  # noqa: NPY002
    yield
    random.setstate(states[0])
    np.random.set_state(states[1])  # noqa: NPY002
    torch.set_rng_state(states[2])


class Here:
    """Workers that are this process: tasks travel as bytes, and come back last first, as often as they are let."""

    workers = 1

    def __init__(self, make: Callable[..., Any], losses: dict[int, list[str]] | None = None, reverse: bool = False):
        self._make, self._losses, self._reverse = make, losses or {}, reverse
        self._tasks: list[Block] = []

    def share(self, value: Any) -> None:
        self._shared = pickle.dumps(value)

    def has_room(self) -> bool:
        return len(self._tasks) < 3

    def submit(self, task: Block) -> None:
        self._tasks.append(pickle.loads(pickle.dumps(task)))

    def wait(self, _: float) -> list[Outcome[Block, Any]]:
        task = self._tasks.pop(-1 if self._reverse else 0)
        if self._losses.get(task.index):
            return [Outcome(task, self._losses[task.index].pop(), detail="signal SIGKILL")]  # type: ignore[arg-type]
        with kept_random_numbers():  # of the learner, who is in another process otherwise
            made = self._make(task, pickle.loads(self._shared))
        return [Outcome(task, "made", pickle.loads(pickle.dumps(made)))]

    def close(self) -> None:
        self._tasks = []


def rollouts(
    made: Plan, count: int = 2, workers: Callable[..., Any] | None = None, **how: Any
) -> tuple[list[np.ndarray], RemoteEnvs]:
    """All that `count` rollouts leave with the learner, which learns from each."""
    learner = WholePolicy(made)
    envs = RemoteEnvs(made, learner, workers or partial(Here, **how))
    normalise = normalised(learner.environments(envs), made)
    model = learner.model(made, normalise)
    model.lr_schedule = lambda _: 1e-3
    kept: list[np.ndarray] = []
    for index in range(count):
        envs.begin(made.stages[0], index + 7)
        envs.collect(model, normalise)
        kept += [getattr(model.rollout_buffer, name).copy() for name in FIELDS]
        kept += [normalise.obs_rms.mean, normalise.obs_rms.var, np.asarray(normalise.ret_rms.var)]
        model.train()
    kept += [tensor.numpy().copy() for tensor in model.policy.state_dict().values()]
    assert model.num_timesteps == count * 8 * 6 == count * envs.tally.steps
    return kept, envs


def same(a: list[np.ndarray], b: list[np.ndarray]) -> bool:
    return all(np.array_equal(x, y) for x, y in zip(a, b, strict=True))


def test_a_rollout_does_not_depend_on_who_made_it_when() -> None:
    kept, envs = rollouts(plan())
    assert all(np.isfinite(array).all() for array in kept)
    assert envs.lost == 0
    losses = {0: ["lost", "lost", "crashed"], 2: ["crashed", "lost"]}
    again, lost = rollouts(plan(), losses=losses, reverse=True)
    assert same(again, kept)
    assert lost.lost == 5
    assert lost.tally.numbers() == envs.tally.numbers()
    assert lost.env_method("summary") == envs.env_method("summary")
    other, _ = rollouts(plan(seed=1))
    assert not same(other, kept)


def test_environments_are_the_cores_and_normalisation_is_that_of_all_that_was_seen() -> None:
    made = plan(normalise={"clip_observation": 1e9})
    kept, remote = rollouts(made, 1)
    observations, starts = kept[FIELDS.index("observations")], kept[FIELDS.index("episode_starts")]
    for block in blocks_of(made, 0):
        envs = CrossgaitVecEnv(config=made.stages[0].mix[0].environment, num_envs=2, engine="mujoco")
        envs.seed(_core.derived_seed(_core.derived_seed(7, block.index), 0) % 2**63)
        rows = slice(2 * block.index, 2 * block.index + 2)
        # Nothing was known yet: mean 0, variance 1.
        np.testing.assert_allclose(observations[0, rows] * np.sqrt(1 + 1e-8), envs.reset(), rtol=1e-6)
    assert starts[0].all()
    assert starts[1:].any()  # episodes end within a rollout
    seen = np.concatenate([observations, np.concatenate([part.last for part in remote._last])[None]]).reshape(9 * 6, -1)
    mean, variance = kept[len(FIELDS)], kept[len(FIELDS) + 1]
    # One that was there before any counts 1e-4; observations are float32.
    np.testing.assert_allclose(mean, seen.mean(axis=0), rtol=1e-5, atol=1e-5)
    np.testing.assert_allclose(variance, seen.var(axis=0), rtol=1e-4, atol=1e-5)


def test_blocks_are_of_one_engine_and_share() -> None:
    engines = crossgait.available_engines()[:2]
    made = plan(engines=engines, environments=10, block=2)
    counts = [(block.index, block.part, block.count) for block in blocks_of(made, 0)]
    assert counts == [(0, 0, 2), (1, 0, 2), (2, 0, 1), (3, 1, 2), (4, 1, 2), (5, 1, 1)][: 3 * len(engines)]


def constant(env: Any) -> np.ndarray:
    return np.ones(env.num_envs)


MARK = terms.Terms(
    rewards={"constant": terms.RewardTerm(constant)},
    events={"start": terms.EventTerm(terms.set_parameters_uniform, mode="startup", params={"friction": (0.3, 0.9)})},
)


def test_terms_travel_with_the_plan_and_leave_no_mark() -> None:
    made = plan().with_terms(MARK)
    kept, envs = rollouts(made)
    again, _ = rollouts(made, reverse=True)
    assert same(again, kept)
    assert envs.tally.numbers()["reward.constant"] == pytest.approx(1)


def test_what_is_wrong_is_said(tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match=r"block 1 crashed, 3 times: signal SIGKILL"):
        rollouts(plan(), losses={1: ["crashed"] * 3})
    with pytest.raises(ConfigError, match=r"tiny: block: expected a number of environments"):
        Trainer(plan(block=None), tmp_path, resume=False, workers=Here)
    with pytest.raises(ConfigError, match=r"tiny: block: expected a whole number from 1 or null, found 0"):
        plan(block=0)

    def broken(block: Block, given: Any) -> Any:
        return ConfigError("engine", "name", "one that is here", "none")

    envs = RemoteEnvs(plan(), WholePolicy(plan()), lambda _: Here(broken))
    normalise = normalised(envs, plan())
    with pytest.raises(ConfigError, match="one that is here"):
        envs.collect(WholePolicy(plan()).model(plan(), normalise), normalise)
    with pytest.raises(RuntimeError, match="stepped elsewhere"):
        envs.reset()


def test_learners_of_a_hierarchical_policy_travel() -> None:
    from crossgait.train.hierarchy import Hierarchy, PlannerAlone, ResidualUnderPlanner

    hierarchy = Hierarchy.of(hierarchical())
    network = _core.MlpNetwork([(np.zeros((2, len(hierarchy.planner.observation))), np.zeros(2))])
    bundle = _core.PolicyBundle(network, hierarchy.planner.interface)
    for learner in (PlannerAlone(hierarchy), ResidualUnderPlanner(hierarchy, bundle)):
        again = pickle.loads(pickle.dumps(learner))
        assert type(again) is type(learner)
        assert again._hierarchy.period == hierarchy.period
        assert np.array_equal(again._hierarchy.residual.action, hierarchy.residual.action)
