from __future__ import annotations

import copy
import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor, VecNormalize

from crossgait import ConfigError, _core
from crossgait.sb3 import CrossgaitVecEnv

GAIT, JOINTS = "Crossgait/AdaptiveGait-v0", "Crossgait/JointControl-v0"
SHORT = {"episode_seconds": 0.2, "settle_seconds": 0.02, "randomisation": {"start_yaw": [-1, 1]}}


@pytest.fixture(autouse=True)
def _one_thread() -> None:
    torch.set_num_threads(1)


def make(num_envs: int = 3, env_id: str = JOINTS, **settings: Any) -> CrossgaitVecEnv:
    return CrossgaitVecEnv(env_id, num_envs, **settings)


def random_actions(envs: CrossgaitVecEnv, count: int) -> np.ndarray:
    shape = (count, envs.num_envs, *envs.action_space.shape)
    return np.random.default_rng(0).uniform(-1, 1, shape).astype(np.float32)


def test_steps_are_those_of_stable_baselines_own_over_single_environments(engine: str) -> None:
    """Against DummyVecEnv, whose environments are given the same seeds, over several episodes."""
    envs = make(engine=engine, **SHORT)
    envs.seed(3)
    seen = envs.reset()
    singles = DummyVecEnv([lambda: gymnasium.make(JOINTS, engine=engine, dtype=np.float32, **SHORT) for _ in range(3)])

    def seeded() -> np.ndarray:
        return np.array(
            [env.reset(seed=seed)[0] for env, seed in zip(singles.envs, envs.get_attr("episode_seed"), strict=True)]
        )

    singles.reset()
    np.testing.assert_array_equal(seen, seeded())
    ended = 0
    for actions in random_actions(envs, 25):
        seen, rewards, dones, infos = envs.step(actions)
        expected = singles.step(actions)
        assert (seen.dtype, rewards.dtype, dones.dtype) == (np.float32, np.float32, np.bool_)
        np.testing.assert_array_equal(rewards, expected[1])
        np.testing.assert_array_equal(dones, expected[2])
        for mine, theirs in zip(infos, expected[3], strict=True):
            last, other_last = mine.pop("terminal_observation", None), theirs.pop("terminal_observation", None)
            np.testing.assert_array_equal(last, other_last)
            assert mine == theirs
        if dones.any():
            ended += 1
            assert dones.all()  # all are of the same length, and none falls
            assert [info["TimeLimit.truncated"] for info in infos] == [True] * 3
            assert [info["time"] for info in envs.reset_infos] == [0] * 3
            np.testing.assert_array_equal(seen, seeded())
        else:
            np.testing.assert_array_equal(seen, expected[0])
    assert ended == 2


def test_a_fall_is_no_truncation() -> None:
    envs = make(2, GAIT, policy_dt=0.02, tilt_limit_deg=2, settle_seconds=0.02)
    envs.reset()
    for actions in random_actions(envs, 200):
        _, _, dones, infos = envs.step(actions)
        if dones.any():
            break
    info = infos[int(np.argmax(dones))]
    assert info["outcome"] == "fell"
    assert info["TimeLimit.truncated"] is False
    assert info["terminal_observation"].shape == envs.observation_space.shape


def test_seeds() -> None:
    one, other = make(**SHORT), make(**SHORT)
    assert one.seed(5) == [5, 6, 7]
    other.seed(5)
    first = one.reset()
    np.testing.assert_array_equal(first, other.reset())
    assert one.get_attr("episode_seed") == [_core.derived_seed(_core.derived_seed(5, i), 0) for i in range(3)]
    second = one.reset()  # a seed is used once; what follows follows from it
    assert not np.array_equal(first, second)
    np.testing.assert_array_equal(second, other.reset())
    one.seed(6)
    assert not np.array_equal(one.reset(), first)
    one.set_options({"height": 1})
    with pytest.raises(ConfigError, match="options"):
        one.reset()


def test_the_rollout_buffer_holds_what_happened() -> None:
    """What PPO keeps equals what other environments of the same seed do under the actions that it kept."""
    envs, steps = make(3, **SHORT), 24
    model = PPO("MlpPolicy", envs, n_steps=steps, batch_size=24, n_epochs=1, gamma=0.9, gae_lambda=0.8, seed=1)
    model._setup_learn(total_timesteps=3 * steps)
    assert model.collect_rollouts(envs, _Silent(), model.rollout_buffer, n_rollout_steps=steps)
    buffer = model.rollout_buffer

    again = make(3, **SHORT)
    again.seed(1)
    seen, starts = again.reset(), np.ones(3)
    rewards = np.zeros((steps, 3))
    for k in range(steps):
        np.testing.assert_array_equal(buffer.observations[k], seen)
        np.testing.assert_array_equal(buffer.episode_starts[k], starts)
        seen, reward, dones, infos = again.step(np.clip(buffer.actions[k], -1, 1))
        for i, info in enumerate(infos):
            if info["TimeLimit.truncated"]:  # what might have followed counts by its value
                reward[i] += 0.9 * value_of(model, info["terminal_observation"][None])[0]
        rewards[k], starts = reward, dones.astype(float)
    assert 0 < buffer.episode_starts[1:].sum() < 3 * steps
    # Values are computed in batches of another size here, in float32.
    np.testing.assert_allclose(buffer.rewards, rewards, rtol=1e-5, atol=1e-6)

    advantage, following = np.zeros(3), value_of(model, seen)
    for k in reversed(range(steps)):
        alive = 1 - starts
        delta = rewards[k] + 0.9 * alive * following - buffer.values[k]
        advantage = delta + 0.9 * 0.8 * alive * advantage
        np.testing.assert_allclose(buffer.advantages[k], advantage, rtol=1e-4, atol=1e-5)
        following, starts = buffer.values[k], buffer.episode_starts[k]


def value_of(model: PPO, observations: np.ndarray) -> np.ndarray:
    with torch.no_grad():
        return model.policy.predict_values(torch.as_tensor(observations)).numpy().ravel()


class _Silent:
    """A callback that lets all go on."""

    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: True


def test_ppo_learns_for_2000_steps() -> None:
    envs = VecNormalize(VecMonitor(make(4, terrain="rough", episode_seconds=1, settle_seconds=0.02)))
    model = PPO("MlpPolicy", envs, n_steps=125, batch_size=125, n_epochs=2, seed=0)
    before = [parameter.clone() for parameter in model.policy.parameters()]
    model.learn(2000)
    assert model.num_timesteps == 2000
    assert len(model.ep_info_buffer) == 2000 // 50
    # All its second, but where it fell on the way to knowing better.
    assert max(info["l"] for info in model.ep_info_buffer) == 50
    assert any(not torch.equal(a, b) for a, b in zip(before, model.policy.parameters(), strict=True))
    action, _ = model.predict(envs.reset(), deterministic=True)
    assert np.isfinite(action).all()


def test_attributes_and_methods_of_environments() -> None:
    envs = make(3, observation=["command"])
    envs.reset()
    assert envs.get_attr("config") == [envs.vector.config] * 3
    assert envs.get_attr("layout", indices=1)[0].observation.names[0] == "command.vx"
    assert envs.has_attr("state")
    assert not envs.has_attr("wings")
    assert envs.env_method("set_command", 0.1, yaw_rate=0.5, indices=[0, 2]) == [None, None]
    seen, *_ = envs.step(np.zeros((3, 12), np.float32))
    np.testing.assert_allclose(seen[[0, 2]], [[0.1, 0, 0.5]] * 2, rtol=1e-6)  # float32
    assert seen[1].tolist() != seen[0].tolist()
    assert [s["outcome"] for s in envs.env_method("summary")] == ["walked"] * 3
    envs.set_attr("stage", 2, indices=[1])
    assert envs.get_attr("stage", indices=[1]) == [2]
    with pytest.raises(AttributeError):
        envs.get_attr("stage", indices=[0])
    with pytest.raises(AttributeError, match="not to be set"):
        envs.set_attr("state", 0)
    assert envs.env_is_wrapped(Monitor) == [False] * 3
    assert envs.env_is_wrapped(Monitor, indices=[0]) == [False]
    envs.close()


def test_what_was_returned_stays_as_it_was() -> None:
    envs = make(2, **SHORT)
    envs.reset()
    kept, copies = [], []
    for actions in random_actions(envs, 15):
        kept.append(envs.step(actions))
        copies.append(copy.deepcopy(kept[-1]))
    for mine, theirs in zip(kept, copies, strict=True):
        for a, b in zip(mine[:3], theirs[:3], strict=True):
            np.testing.assert_array_equal(a, b)


def test_copies_are_refused() -> None:
    with pytest.raises(TypeError, match="CrossgaitVecEnv cannot be copied or pickled"):
        pickle.dumps(make())
