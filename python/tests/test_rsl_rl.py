"""rsl-rl-lib on the native vector environment."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crossgait
from crossgait import EnvironmentConfig, terms

CONFIG = EnvironmentConfig(
    action="joints", robot="serial_quadruped", settle_seconds=0.1, episode_seconds=0.2, command={"vx": 0.4}
)
#: How long learners of other libraries train, of 24 steps in 32 environments: in the nightly set about a minute.
ROLLOUTS = 200 if os.environ.get("CROSSGAIT_LONG_TESTS") else 20
_FORCES = {"critic": {"forces": terms.ObservationTerm(lambda e: e.foot_forces.reshape(e.num_envs, -1))}}
PRIVILEGED = terms.Terms(observations=_FORCES)
MINE = terms.Terms(rewards={"air": terms.RewardTerm(terms.feet_air_time)}, observations=_FORCES)
EPISODE = 200  #: steps of an episode of `learnable`


def learnable() -> EnvironmentConfig:
    """An environment in which a minute makes a difference that is seen without exploration, too."""
    from crossgait.train import Plan

    return Plan.preset("joints").stages[0].environment.updated(command={"vx": 0.4}, episode_seconds=4)


def test_without_the_package_the_pip_line_is_named() -> None:
    code = "import sys; sys.modules['rsl_rl'] = None; import crossgait.rsl_rl"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "pip install 'crossgait[rsl-rl]'" in ended.stderr


def test_steps_are_those_of_the_vector_environment() -> None:
    pytest.importorskip("rsl_rl")
    import torch

    from crossgait.envs import JointControlVectorEnv
    from crossgait.rsl_rl import VecEnv

    envs = VecEnv(num_envs=3, seed=7, config=CONFIG, terms=MINE)
    plain = JointControlVectorEnv(3, CONFIG, terms=MINE, autoreset_mode="SameStep", dtype="float32")
    assert np.array_equal(envs.get_observations()["policy"].numpy(), plain.reset(seed=7)[0])
    assert envs.get_observations()["critic"].shape == (3, 12)
    assert envs.max_episode_length == 10
    rng = np.random.default_rng(0)
    for step in range(12):
        actions = rng.uniform(-1, 1, (3, 12)).astype(np.float32)
        seen, rewards, terminated, truncated, _ = plain.step(actions)
        observations, theirs, dones, extras = envs.step(torch.from_numpy(actions))
        assert np.array_equal(observations["policy"].numpy(), seen)
        assert np.array_equal(theirs.numpy(), rewards.astype(np.float32))
        assert np.array_equal(dones.numpy(), terminated | truncated)
        assert np.array_equal(extras["time_outs"].numpy(), truncated)
        assert (envs.episode_length_buf == (step + 1) % 10).all() or terminated.any()
    envs.episode_length_buf[:] = torch.tensor([8, 0, 0])  # as `init_at_random_ep_len` does
    ends = [envs.step(torch.zeros(3, 12))[3]["time_outs"].tolist() for _ in range(2)]
    assert [end[0] for end in ends] == [False, True]


def configuration(iterations: int) -> dict[str, Any]:
    network = {"class_name": "rsl_rl.models.MLPModel", "hidden_dims": [64, 64], "activation": "elu"}
    normal = {"class_name": "rsl_rl.modules.GaussianDistribution", "init_std": 0.3}
    return {
        "num_steps_per_env": 24,
        "save_interval": iterations,
        "obs_groups": {"actor": ["policy"], "critic": ["policy", "critic"]},
        "actor": network | {"distribution_cfg": normal, "obs_normalization": True},
        "critic": network | {"obs_normalization": True},
        "algorithm": {"class_name": "rsl_rl.algorithms.PPO", "learning_rate": 1e-3, "num_mini_batches": 4},
    }


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")  # of rsl_rl and what it imports
def test_a_runner_trains_and_its_export_is_read(tmp_path: Path) -> None:
    pytest.importorskip("rsl_rl")
    import torch
    from rsl_rl.runners import OnPolicyRunner

    from crossgait.rsl_rl import VecEnv

    torch.manual_seed(0)
    torch.set_num_threads(1)
    config = learnable()
    envs = VecEnv(num_envs=32, seed=0, config=config, terms=PRIVILEGED)
    runner = OnPolicyRunner(envs, configuration(20), str(tmp_path))

    def mean_reward() -> float:
        policy = runner.get_inference_policy()
        with torch.inference_mode():
            rewards = [envs.step(policy(envs.get_observations()))[1].mean() for _ in range(EPISODE)]
        return float(torch.stack(rewards).mean())

    before = mean_reward()
    runner.learn(ROLLOUTS, init_at_random_ep_len=True)
    assert mean_reward() > before
    runner.export_policy_to_jit(str(tmp_path), "policy.pt")
    policy = crossgait.Policy.from_torch(tmp_path / "policy.pt", config)
    assert policy.layout.hash == envs.vector.layout.hash
