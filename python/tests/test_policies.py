"""Policies of the core: by name, as arrays, in bundles."""

from __future__ import annotations

import numpy as np
import pytest
from policy_models import ACTIONS, JOINTS, OBSERVATIONS, random_layers, random_network, random_normalisation

import crossgait
from crossgait.policies import MlpNetwork, Policy, PolicyBundle, PolicyInterface, interface_of

# Single precision, a few roundings of numbers around one.
SINGLE = 1e-6


def by_hand(network: MlpNetwork, observation: np.ndarray) -> np.ndarray:
    mean, std = network.normalisation
    x = np.clip((observation - mean) / std, -network.clip, network.clip)
    for k, (weight, bias) in enumerate(network.layers):
        x = weight @ x + bias
        if k + 1 < len(network.layers):
            x = {
                "tanh": np.tanh,
                "elu": lambda v: np.where(v > 0, v, np.expm1(np.minimum(v, 0))),
                "relu": lambda v: np.maximum(v, 0),
                "swish": lambda v: v / (1 + np.exp(-v)),
            }[network.activation](x)
    return np.clip(np.tanh(x) if network.output == "tanh" else x, -1, 1)


def test_zero_does_nothing_and_random_repeats_by_seed():
    observation = np.zeros(69)
    guide = crossgait.EnvironmentConfig(preset="guide")
    zero = Policy.load("zero", guide)
    assert zero.name == "zero"
    assert zero.network is None
    assert not zero.act(np.zeros(len(zero.layout.observation))).any()
    random, other = Policy.load("random", guide), Policy.load("random", guide)
    observation = np.zeros(len(random.layout.observation))
    random.reset(7)
    other.reset(7)
    first = [random.act(observation) for _ in range(3)]
    assert np.array_equal(first, [other.act(observation) for _ in range(3)])
    assert np.ptp(first) > 0
    assert np.abs(first).max() <= 1
    other.reset(8)
    assert not np.array_equal(first[0], other.act(observation))


@pytest.mark.parametrize("activation", ["tanh", "elu", "relu", "swish"])
@pytest.mark.parametrize("output", ["linear", "tanh"])
def test_a_network_given_as_arrays_acts_as_by_hand(activation, output):
    network = random_network(activation, output)
    policy = Policy.from_network(network, JOINTS)
    rng = np.random.default_rng(0)
    for _ in range(10):
        observation = rng.normal(0, 4, OBSERVATIONS)
        action = policy.act(observation)
        np.testing.assert_allclose(action, by_hand(network, observation), atol=SINGLE)
        single = observation.astype(np.float32)
        np.testing.assert_array_equal(policy.act(single), policy.act(single.astype(np.float64)))


def test_actions_are_new_arrays():
    policy = Policy.from_network(random_network(), JOINTS)
    first = policy.act(np.zeros(OBSERVATIONS))
    kept = first.copy()
    second = policy.act(np.ones(OBSERVATIONS))
    assert np.array_equal(first, kept)
    assert not np.shares_memory(first, second)
    assert first.dtype == np.float64


def test_an_observation_that_is_not_finite_gives_zeros():
    observation = np.zeros(OBSERVATIONS)
    observation[3] = np.nan
    assert not Policy.from_network(random_network(), JOINTS).act(observation).any()


@pytest.mark.parametrize("observation", [np.zeros(47), np.zeros(48, dtype=np.int64)])
def test_an_observation_of_another_size_or_type_is_an_error(observation):
    with pytest.raises(crossgait.ConfigError, match=r"float64 or float32 of shape \(48,\)"):
        Policy.load("zero", JOINTS).act(observation)


def test_what_is_saved_is_loaded_bit_for_bit(tmp_path):
    path = tmp_path / "p.safetensors"
    policy = Policy.from_network(random_network("swish", "tanh"), JOINTS)
    policy.save(path)
    loaded = Policy.load(path, JOINTS)
    assert loaded.name == "p.safetensors"
    a, b = policy.network, loaded.network
    for (weight, bias), (other_weight, other_bias) in zip(a.layers, b.layers, strict=True):
        assert np.array_equal(weight, other_weight)
        assert np.array_equal(bias, other_bias)
    assert np.array_equal(a.normalisation, b.normalisation)
    assert (a.activation, a.output, a.clip) == (b.activation, b.output, b.clip) == ("swish", "tanh", 5)
    assert np.array_equal(loaded.bundle.golden_action, policy.bundle.golden_action)
    observation = np.linspace(-1, 1, OBSERVATIONS)
    assert np.array_equal(policy.act(observation), loaded.act(observation))
    first = path.read_bytes()
    loaded.save(path)
    assert path.read_bytes() == first


def test_a_network_may_do_without_normalisation_and_clip(tmp_path):
    network = MlpNetwork(random_layers([OBSERVATIONS, ACTIONS]))
    policy = Policy.from_network(network, JOINTS)
    policy.save(tmp_path / "p.safetensors")
    loaded = Policy.load(tmp_path / "p.safetensors", JOINTS).network
    assert loaded.normalisation is None
    assert loaded.clip is None
    assert (loaded.activation, loaded.output) == ("tanh", "linear")


def test_golden_pairs_may_be_given_and_have_to_be_what_the_network_does(tmp_path):
    interface = PolicyInterface(JOINTS)
    bundle = PolicyBundle(random_network(), interface)
    observations = np.random.default_rng(1).normal(0, 1, (5, OBSERVATIONS))
    actions = bundle.network.evaluate(observations)
    bundle.with_golden_pairs(observations, actions).write(str(tmp_path / "p.safetensors"))
    read = PolicyBundle.read(tmp_path / "p.safetensors")
    assert np.array_equal(read.golden_observation, observations)
    assert np.array_equal(read.golden_action, actions)
    assert read.policy_dt == interface.policy_dt
    bundle.with_golden_pairs(observations, actions + 1e-3).write(str(tmp_path / "p.safetensors"))
    with pytest.raises(crossgait.ConfigError, match=r"golden\.action"):
        Policy.load(tmp_path / "p.safetensors", JOINTS)


@pytest.mark.parametrize(
    ("observations", "actions", "words"),
    [
        (np.zeros((0, 48)), np.zeros((0, 12)), "1 to 256"),
        (np.zeros((257, 48)), np.zeros((257, 12)), "1 to 256"),
        (np.zeros((2, 47)), np.zeros((2, 12)), r"\[2, 48\]"),
        (np.zeros((2, 48)), np.zeros((3, 12)), r"\[2, 12\]"),
        (np.zeros((2, 48)), np.full((2, 12), np.nan), "finite"),
    ],
)
def test_golden_pairs_that_do_not_fit_are_errors(observations, actions, words):
    bundle = PolicyBundle(random_network(), PolicyInterface(JOINTS))
    with pytest.raises(crossgait.ConfigError, match=words):
        bundle.with_golden_pairs(observations, actions)


def test_a_network_that_does_not_fit_is_an_error():
    narrow = MlpNetwork(random_layers([OBSERVATIONS, 11]))
    with pytest.raises(crossgait.ConfigError, match="outputs: expected 12, found 11"):
        Policy.from_network(narrow, JOINTS)
    layers = random_layers([OBSERVATIONS, ACTIONS])
    layers[0][0][2, 3] = np.nan
    with pytest.raises(crossgait.ConfigError, match="finite"):
        Policy.from_network(MlpNetwork(layers), JOINTS)
    mean, std = random_normalisation()
    with pytest.raises(crossgait.ConfigError, match="positive"):
        Policy.from_network(MlpNetwork(random_layers([OBSERVATIONS, ACTIONS]), normalisation=(mean, -std)), JOINTS)
    for options in ({"activation": "gelu"}, {"output": "softmax"}):
        with pytest.raises(crossgait.ConfigError, match=next(iter(options))):
            MlpNetwork(layers, **options)
    with pytest.raises(crossgait.ConfigError, match=r"\[n, 48\]"):
        random_network().evaluate(np.zeros((1, 3)))


def test_a_bundle_for_another_environment_is_an_error(tmp_path):
    Policy.from_network(random_network(), JOINTS).save(tmp_path / "p.safetensors")
    with pytest.raises(crossgait.ConfigError, match="has 48 entries where 69 were expected"):
        Policy.load(tmp_path / "p.safetensors", crossgait.EnvironmentConfig(preset="guide"))


@pytest.mark.parametrize(
    ("text", "words"), [("nothing", "zero, random"), ("absent.safetensors", "absent"), ("absent.yaml", "absent")]
)
def test_what_is_no_policy_is_an_error(text, words):
    with pytest.raises(crossgait.ConfigError, match=words):
        Policy.load(text, JOINTS)


def test_descriptions_run_and_are_no_networks(tmp_path):
    path = tmp_path / "steps.yaml"
    path.write_text(
        "kind: scripted\nlayout_version: 3\nsteps: [{time: 0, action: {residual.FL.z: 0.25}}]\n", encoding="utf-8"
    )
    policy = Policy.load(path, crossgait.EnvironmentConfig(preset="guide"))
    policy.reset()
    action = policy.act(np.zeros(len(policy.layout.observation)))
    assert action[policy.layout.action.index("residual.FL.z")] == 0.25
    with pytest.raises(crossgait.ConfigError, match="a policy that is a network"):
        policy.save(tmp_path / "p.safetensors")


def test_saving_elsewhere_is_an_error_and_leaves_nothing(tmp_path):
    policy = Policy.from_network(random_network(), JOINTS)
    with pytest.raises(crossgait.ConfigError, match=r"ends in \.safetensors"):
        policy.save(tmp_path / "p.bin")
    with pytest.raises(crossgait.ConfigError):
        policy.save(tmp_path / "absent" / "p.safetensors")
    assert not list(tmp_path.iterdir())


def test_environments_are_named_in_several_ways(tmp_path):
    (tmp_path / "env.yaml").write_text(JOINTS.to_yaml(), encoding="utf-8")
    expected = PolicyInterface(JOINTS)

    class Wrapped:
        config = JOINTS

    for environment in (JOINTS, expected, tmp_path / "env.yaml", Wrapped()):
        assert interface_of(environment).layout_hash == expected.layout_hash
    with pytest.raises(crossgait.ConfigError, match="found int"):
        interface_of(3)


def test_a_policy_walks_in_its_environment(engine):
    from crossgait._core import Environment

    environment = Environment(JOINTS, engine)
    policy = Policy.from_network(random_network("swish", "tanh"), environment)
    assert policy.layout.hash == environment.layout_hash
    observation = environment.reset(1)
    for _ in range(5):
        observation, reward, *_ = environment.step(policy.act(observation))
        assert np.isfinite(reward)
