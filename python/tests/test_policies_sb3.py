"""Policies from Stable-Baselines3 models."""

from __future__ import annotations

import subprocess
import sys
import warnings

import numpy as np
import pytest

import crossgait
from crossgait._core import Environment
from crossgait.policies import Policy

gymnasium = pytest.importorskip("gymnasium")
torch = pytest.importorskip("torch")
pytest.importorskip("stable_baselines3")

from policy_models import ACTIONS, JOINTS, OBSERVATIONS  # noqa: E402
from stable_baselines3 import A2C, DDPG, DQN, PPO, SAC, TD3  # noqa: E402
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor  # noqa: E402
from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize  # noqa: E402

# Single precision, summed in another order.
SINGLE = 2e-6


@pytest.fixture(autouse=True)
def one_thread():
    torch.set_num_threads(1)


class Spaces(gymnasium.Env):
    """The spaces of an environment, and observations at random."""

    def __init__(self, observations=OBSERVATIONS, actions=ACTIONS, low=-1.0, high=1.0):
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (observations,), dtype=np.float32)
        self.action_space = gymnasium.spaces.Box(low, high, (actions,), dtype=np.float32)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return self.seen(), {}

    def step(self, action):
        return self.seen(), -float(np.square(action).sum()), bool(self.np_random.random() < 0.05), False, {}

    def seen(self):
        return self.np_random.normal(1, 3, self.observation_space.shape).astype(np.float32)


class Walking(Spaces):
    """The environment itself, as far as training needs it."""

    def __init__(self):
        super().__init__()
        self.environment = Environment(JOINTS, crossgait.available_engines()[0])

    def reset(self, *, seed=None, options=None):
        return self.environment.reset(seed or 0).astype(np.float32), {}

    def step(self, action):
        observation, *rest = self.environment.step(action)
        return observation.astype(np.float32), *rest, {}


def built(kind, env=None, **options):
    off_policy = kind in (SAC, TD3, DDPG)
    sizes = {"buffer_size": 100} if off_policy else {}
    return kind("MlpPolicy", env or Spaces(), device="cpu", seed=2, **sizes, **options)


def agrees(policy, model, normalise=lambda x: x):
    rng = np.random.default_rng(3)
    for _ in range(20):
        observation = rng.normal(0, 2, OBSERVATIONS).astype(np.float32)
        theirs, _ = model.predict(normalise(observation), deterministic=True)
        np.testing.assert_allclose(policy.act(observation), theirs, atol=SINGLE)


@pytest.mark.parametrize(
    ("kind", "net_arch", "activation", "name", "output"),
    [
        (PPO, [16, 8], torch.nn.Tanh, "tanh", "linear"),
        (PPO, {"pi": [16], "vf": [8]}, torch.nn.ELU, "elu", "linear"),
        (A2C, [16], torch.nn.SiLU, "swish", "linear"),
        (SAC, [16, 8], torch.nn.ReLU, "relu", "tanh"),
        (TD3, [16], torch.nn.ReLU, "relu", "tanh"),
        (DDPG, [16], torch.nn.Tanh, "tanh", "tanh"),
    ],
)
def test_actors_of_models_and_of_their_zips(tmp_path, kind, net_arch, activation, name, output):
    model = built(kind, policy_kwargs={"net_arch": net_arch, "activation_fn": activation})
    policy = Policy.from_sb3(model, JOINTS)
    assert (policy.network.activation, policy.network.output) == (name, output)
    agrees(policy, model)
    model.save(tmp_path / "model.zip")
    read = Policy.from_sb3(tmp_path / "model.zip", JOINTS)
    observation = np.linspace(-1, 1, OBSERVATIONS)
    assert np.array_equal(read.act(observation), policy.act(observation))
    assert np.array_equal(Policy.from_sb3(model.policy, JOINTS).act(observation), policy.act(observation))


@pytest.mark.parametrize("squash", [False, True])
def test_state_dependent_exploration(tmp_path, squash):
    model = built(PPO, use_sde=True, policy_kwargs={"squash_output": squash, "net_arch": [8]})
    policy = Policy.from_sb3(model, JOINTS)
    assert policy.network.output == ("tanh" if squash else "linear")
    agrees(policy, model)
    model.save(tmp_path / "model.zip")
    observation = np.linspace(-1, 1, OBSERVATIONS)
    read = Policy.from_sb3(tmp_path / "model.zip", JOINTS)
    assert np.array_equal(read.act(observation), policy.act(observation))


def test_vecnormalize_is_part_of_the_policy(tmp_path):
    env = VecNormalize(DummyVecEnv([Spaces]), clip_obs=2.5)
    model = built(PPO, env, n_steps=64, batch_size=32, policy_kwargs={"net_arch": [16]})
    model.learn(128)
    env.save(tmp_path / "normalise.pkl")
    model.save(tmp_path / "model.zip")
    policy = Policy.from_sb3(model, JOINTS)  # which has it from its environment
    network = policy.network
    assert network.clip == 2.5
    assert np.array_equal(network.normalisation[0], env.obs_rms.mean)
    assert np.array_equal(network.normalisation[1], np.sqrt(env.obs_rms.var + env.epsilon))
    agrees(policy, model, env.normalize_obs)
    for given in (env, tmp_path / "normalise.pkl"):
        read = Policy.from_sb3(tmp_path / "model.zip", JOINTS, given)
        observation = np.linspace(-1, 1, OBSERVATIONS)
        assert np.array_equal(read.act(observation), policy.act(observation))
    env.norm_obs = False
    assert Policy.from_sb3(model, JOINTS).network.normalisation is None


def test_a_trained_model_runs_in_the_program(tmp_path):
    env = VecNormalize(DummyVecEnv([Walking]))
    model = built(PPO, env, n_steps=100, batch_size=50, policy_kwargs={"net_arch": [32, 32]})
    model.learn(300)
    Policy.from_sb3(model, JOINTS).save(tmp_path / "p.safetensors")
    (tmp_path / "env.yaml").write_text(JOINTS.to_yaml(), encoding="utf-8")
    engine = crossgait.available_engines()[0]
    options = ["--episodes", "1", "--episode-seconds", "1", "--engine", engine]
    done = subprocess.run(
        [sys.executable, "-m", "crossgait", "rollout", "--policy", "p.safetensors", "--config", "env.yaml", *options],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "p.safetensors" in done.stdout


def test_actions_of_other_bounds():
    """A squashed output is scaled to them after the tanh: a further layer, where the activation is tanh as well."""
    yaml = JOINTS.to_yaml().replace("limit: 1", "limit: 2")
    wide = crossgait.EnvironmentConfig.parse(yaml)
    env = Spaces(low=-2.0, high=2.0)
    model = built(SAC, env, policy_kwargs={"net_arch": [16], "activation_fn": torch.nn.Tanh})
    policy = Policy.from_sb3(model, wide)
    assert len(policy.network.layers) == 3
    agrees(policy, model)
    relu = built(SAC, env, policy_kwargs={"net_arch": [16]})
    with pytest.raises(crossgait.ConfigError, match="the same activation everywhere, found relu and tanh"):
        Policy.from_sb3(relu, wide)
    agrees(Policy.from_sb3(built(PPO, env), wide), built(PPO, env))
    for other in (relu, built(PPO, env)):
        with pytest.raises(
            crossgait.ConfigError, match=r"action space, target\.FL_tilt: expected -1 to 1, found -2 to 2"
        ):
            Policy.from_sb3(other, JOINTS)


class Halves(BaseFeaturesExtractor):
    def __init__(self, space):
        super().__init__(space, OBSERVATIONS)

    def forward(self, observations):
        return observations / 2


class OwnPolicy(type(built(PPO).policy)):
    def _predict(self, observation, deterministic=False):
        return 2 * super()._predict(observation, deterministic)


class Choices(Spaces):
    def __init__(self):
        super().__init__()
        self.action_space = gymnasium.spaces.Discrete(3)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: built(PPO, policy_kwargs={"features_extractor_class": Halves}), "FlattenExtractor, found Halves"),
        (lambda: PPO(OwnPolicy, Spaces(), device="cpu"), "MlpPolicy of PPO, A2C, SAC, TD3 or DDPG, found OwnPolicy"),
        (lambda: DQN("MlpPolicy", Choices(), buffer_size=10, device="cpu"), "a Box of one dimension, found Discrete"),
        (lambda: built(PPO, Spaces(observations=40)), "observation space: expected 48 observations, found 40"),
        (lambda: built(PPO, Spaces(actions=13)), "expected 12 actions, found 13, the last 1 after target"),
        (lambda: built(PPO, policy_kwargs={"activation_fn": torch.nn.GELU}), "GELU"),
        (lambda: built(SAC, use_sde=True), "Hardtanh"),
        (lambda: "absent.zip", "a readable file"),
        (lambda: torch.nn.Linear(2, 2), "a model of Stable-Baselines3, its policy or a zip, found Linear"),
    ],
)
def test_what_no_bundle_can_say_is_refused(make, words):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of models that are unusual
        model = make()
    with pytest.raises(crossgait.ConfigError, match=words):
        Policy.from_sb3(model, JOINTS)


def test_a_file_that_is_no_zip_is_refused(tmp_path):
    (tmp_path / "model.zip").write_text("no zip")
    with pytest.raises(crossgait.ConfigError, match="a zip of Stable-Baselines3's `save`"):
        Policy.from_sb3(tmp_path / "model.zip", JOINTS)


def test_what_is_no_vecnormalize(tmp_path):
    (tmp_path / "bad.pkl").write_bytes(b"nothing of the kind")
    model = built(PPO)
    for given, words in ((tmp_path / "bad.pkl", "VecNormalize.save"), (3, "a VecNormalize or its file, found int")):
        with pytest.raises(crossgait.ConfigError, match=words):
            Policy.from_sb3(model, JOINTS, given)


def test_a_model_that_was_trained_with_other_statistics_is_refused(monkeypatch):
    """The guard behind the reader: here the clip is forgotten."""
    env = VecNormalize(DummyVecEnv([Spaces]), clip_obs=0.5)
    model = built(PPO, env)
    from crossgait.policies import expression

    right = expression.observation
    monkeypatch.setattr(expression, "observation", lambda mean, std, clip=np.inf: right(mean, std))
    with pytest.raises(crossgait.ConfigError, match=r"what predict\(\) computes, .* the largest difference"):
        Policy.from_sb3(model, JOINTS)


def test_pickles_take_consent(tmp_path, monkeypatch):
    """What would run is not run: the file need not even be one."""
    monkeypatch.delenv("CROSSGAIT_TRUST")
    (tmp_path / "model.zip").write_bytes(b"")
    (tmp_path / "normalise.pkl").write_bytes(b"")
    with pytest.raises(crossgait.ConfigError, match="unpickles"):
        Policy.from_sb3(tmp_path / "model.zip", JOINTS)
    with pytest.raises(crossgait.ConfigError, match=r"normalise\.pkl.*unpickles"):
        Policy.from_sb3(built(PPO), JOINTS, vecnormalize=tmp_path / "normalise.pkl")
