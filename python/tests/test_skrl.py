"""skrl on the native vector environment, which its `wrap_env` knows as Gymnasium's."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from test_rsl_rl import CONFIG, EPISODE, MINE, PRIVILEGED, ROLLOUTS, learnable

import crossgait.envs  # registers the environments

#: What skrl steps: float32, and episodes that begin in the step that ends them.
HOW: dict[str, Any] = {
    "vectorization_mode": "vector_entry_point",
    "autoreset_mode": "SameStep",
    "dtype": np.float32,
}


def test_states_are_what_critics_may_see() -> None:
    envs = gymnasium.make_vec("Crossgait/JointControl-v0", num_envs=3, config=CONFIG, terms=MINE, **HOW)
    with pytest.raises(crossgait.ConfigError, match="and a reset"):
        envs.unwrapped.state()
    seen, _ = envs.reset(seed=1)
    for _ in range(12):
        states = envs.unwrapped.state()
        assert states.shape[1:] == envs.unwrapped.state_space.shape
        forces = envs.unwrapped.batch.foot_forces.reshape(3, -1)
        assert np.array_equal(states, np.concatenate([seen, forces.astype(np.float32)], axis=1))
        seen, *_ = envs.step(np.zeros((3, 12), np.float32))
    plain = gymnasium.make_vec("Crossgait/JointControl-v0", num_envs=3, config=CONFIG, **HOW)
    assert plain.unwrapped.state_space is None
    with pytest.raises(crossgait.ConfigError, match="terms that observe for critic"):
        plain.unwrapped.state()


def test_each_environment_is_called() -> None:
    envs = gymnasium.make_vec("Crossgait/JointControl-v0", num_envs=3, config=CONFIG, **HOW).unwrapped
    envs.reset(seed=1)
    assert envs.call("render") == (None,) * 3
    assert envs.call("episode_seed") == tuple(map(int, envs.episode_seeds))
    envs.call("set_command", 0.3)
    assert [summary["outcome"] for summary in envs.call("summary")] == ["walked"] * 3


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")  # of skrl and what it imports
def test_an_agent_trains(tmp_path: Path) -> None:
    pytest.importorskip("skrl")
    import torch
    from skrl.agents.torch.ppo import PPO, PPO_CFG
    from skrl.envs.wrappers.torch import wrap_env
    from skrl.envs.wrappers.torch.gymnasium_envs import GymnasiumWrapper
    from skrl.memories.torch import RandomMemory
    from skrl.models.torch import DeterministicMixin, GaussianMixin, Model
    from skrl.resources.preprocessors.torch import RunningStandardScaler
    from skrl.trainers.torch import SequentialTrainer
    from skrl.utils import set_seed

    set_seed(3)
    torch.set_num_threads(1)

    def layers(inputs: int, outputs: int) -> torch.nn.Sequential:
        hidden = [torch.nn.Linear(inputs, 64), torch.nn.ELU(), torch.nn.Linear(64, 64), torch.nn.ELU()]
        return torch.nn.Sequential(*hidden, torch.nn.Linear(64, outputs))

    class Actor(GaussianMixin, Model):
        def __init__(self, **spaces: Any) -> None:
            Model.__init__(self, **spaces)
            GaussianMixin.__init__(self)
            self.net = layers(self.num_observations, self.num_actions)
            self.log_std = torch.nn.Parameter(torch.full((self.num_actions,), -1.0))

        def compute(self, inputs: dict[str, Any], role: str = "") -> Any:
            return self.net(inputs["observations"]), {"log_std": self.log_std}

    class Critic(DeterministicMixin, Model):
        def __init__(self, **spaces: Any) -> None:
            Model.__init__(self, **spaces)
            DeterministicMixin.__init__(self)
            self.net = layers(self.num_states, 1)

        def compute(self, inputs: dict[str, Any], role: str = "") -> Any:
            return self.net(inputs["states"]), {}

    def wrapped() -> GymnasiumWrapper:
        config = learnable()
        made = wrap_env(
            gymnasium.make_vec("Crossgait/JointControl-v0", num_envs=32, config=config, terms=PRIVILEGED, **HOW),
            verbose=False,
        )
        assert isinstance(made, GymnasiumWrapper)
        return made

    envs = wrapped()
    spaces = {
        "observation_space": envs.observation_space,
        "state_space": envs.state_space,
        "action_space": envs.action_space,
        "device": "cpu",
    }
    cfg = PPO_CFG(rollouts=24, learning_epochs=4, mini_batches=4, learning_rate=1e-3, discount_factor=0.98)
    cfg.observation_preprocessor = cfg.state_preprocessor = RunningStandardScaler
    cfg.observation_preprocessor_kwargs = {"size": envs.observation_space, "device": "cpu"}
    cfg.state_preprocessor_kwargs = {"size": envs.state_space, "device": "cpu"}
    cfg.experiment.directory, cfg.experiment.write_interval, cfg.experiment.checkpoint_interval = str(tmp_path), 0, 0
    models = {"policy": Actor(**spaces), "value": Critic(**spaces)}
    memory = RandomMemory(memory_size=24, num_envs=32, device="cpu")
    agent = PPO(models=models, memory=memory, cfg=cfg, **spaces)
    how = {"close_environment_at_exit": False, "timesteps": 24 * ROLLOUTS, "disable_progressbar": True}
    trainer = SequentialTrainer(env=envs, agents=agent, cfg=how)

    def mean_reward() -> float:
        fresh = wrapped()
        seen, _ = fresh.reset()
        rewards = []
        agent.enable_models_training_mode(False)
        for _ in range(EPISODE):
            with torch.inference_mode():
                _, outputs = agent.act(seen, fresh.state(), timestep=10**6, timesteps=10**6)
            seen, reward, *_ = fresh.step(outputs["mean_actions"].clamp(-1, 1))
            rewards.append(reward.mean())
        return float(torch.stack(rewards).mean())

    before = mean_reward()
    trainer.train()
    assert mean_reward() > before
