"""rl_games on the native vector environment."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_rsl_rl import CONFIG, EPISODE, MINE, PRIVILEGED, ROLLOUTS, learnable


def test_without_the_package_the_pip_line_is_named() -> None:
    code = "import sys; sys.modules['rl_games'] = None; import crossgait.rl_games"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "pip install 'crossgait[rl-games]'" in ended.stderr


@pytest.mark.filterwarnings("ignore")  # of rl_games and what it imports
def test_steps_are_those_of_the_vector_environment() -> None:
    pytest.importorskip("rl_games")
    import torch

    from crossgait.envs import JointControlVectorEnv
    from crossgait.rl_games import VecEnv

    envs = VecEnv(num_envs=3, seed=7, config=CONFIG, terms=MINE)
    plain = JointControlVectorEnv(3, CONFIG, terms=MINE, autoreset_mode="SameStep", dtype="float32")
    seen = envs.reset()
    assert np.array_equal(seen["obs"].numpy(), plain.reset(seed=7)[0])
    info = envs.get_env_info()
    assert info["state_space"].shape == seen["states"].shape[1:] == (seen["obs"].shape[1] + 12,)
    assert np.array_equal(seen["states"].numpy(), plain.state())
    rng = np.random.default_rng(0)
    timed_out = 0
    for _ in range(12):
        actions = rng.uniform(-1, 1, (3, 12)).astype(np.float32)
        expected, rewards, terminated, truncated, _ = plain.step(actions)
        seen, theirs, dones, infos = envs.step(torch.from_numpy(actions))
        assert np.array_equal(seen["obs"].numpy(), expected)
        assert np.array_equal(theirs.numpy(), rewards.astype(np.float32))
        assert np.array_equal(dones.numpy(), terminated | truncated)
        assert np.array_equal(infos["time_outs"].numpy(), truncated)
        timed_out += truncated.sum()
    assert timed_out > 0
    assert isinstance(VecEnv(num_envs=2, config=CONFIG).reset(), torch.Tensor)  # without states


def parameters(epochs: int) -> dict[str, Any]:
    """A runner's file, as its documentation has it."""
    continuous = {
        "mu_activation": "None",
        "sigma_activation": "None",
        "mu_init": {"name": "default"},
        "sigma_init": {"name": "const_initializer", "val": -1.0},
        "fixed_sigma": True,
    }
    mlp = {"units": [64, 64], "activation": "elu", "initializer": {"name": "default"}}
    return {
        "seed": 3,
        "algo": {"name": "a2c_continuous"},
        "model": {"name": "continuous_a2c_logstd"},
        "network": {"name": "actor_critic", "separate": False, "space": {"continuous": continuous}, "mlp": mlp},
        "config": {
            "name": "walk",
            "env_name": "mine",
            "device": "cpu",
            "num_actors": 32,
            "horizon_length": 24,
            "minibatch_size": 192,
            "mini_epochs": 4,
            "max_epochs": epochs,
            "learning_rate": 1e-3,
            "lr_schedule": "None",
            "gamma": 0.98,
            "tau": 0.95,
            "e_clip": 0.2,
            "entropy_coef": 0.0,
            "critic_coef": 2,
            "grad_norm": 1.0,
            "truncate_grads": True,
            "clip_value": True,
            "ppo": True,
            "normalize_input": True,
            "normalize_value": True,
            "normalize_advantage": True,
            "value_bootstrap": True,
            "bounds_loss_coef": 0.0,
            "reward_shaper": {"scale_value": 1.0},
            "print_stats": False,
            "save_frequency": 0,
            "save_best_after": 10**9,
        },
    }


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_a_runner_trains(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("rl_games")
    import torch
    from rl_games.torch_runner import Runner

    from crossgait.rl_games import VecEnv, register

    torch.set_num_threads(1)
    monkeypatch.chdir(tmp_path)  # it writes runs/
    config = learnable()
    register("mine", config=config, terms=PRIVILEGED)
    runner = Runner()
    runner.load({"params": parameters(ROLLOUTS)})
    agent = runner.algo_factory.create("a2c_continuous", base_name="run", params=runner.params)

    def mean_reward() -> float:
        envs = VecEnv(num_envs=32, seed=0, config=config, terms=PRIVILEGED)
        seen, rewards = envs.reset(), []
        agent.set_eval()
        for _ in range(EPISODE):
            with torch.inference_mode():
                mean = agent.get_action_values(agent.obs_to_tensors(seen))["mus"]
            seen, reward, _, _ = envs.step(mean.clamp(-1, 1))
            rewards.append(reward.mean())
        return float(torch.stack(rewards).mean())

    before = mean_reward()
    agent.train()
    assert agent.frame == ROLLOUTS * 24 * 32
    assert mean_reward() > before
