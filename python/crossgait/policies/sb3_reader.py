"""The actor of a Stable-Baselines3 model: PPO, A2C, SAC, TD3 and DDPG with multilayer perceptrons."""

from __future__ import annotations

import io
import os
import pickle
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from crossgait._core import MlpNetwork, PolicyInterface
from crossgait.consent import require_consent
from crossgait.files import CHECKPOINT_BYTES, read_bytes
from crossgait.layout import Layout
from crossgait.policies import expression, torch_reader
from crossgait.policies.expression import Affine, FloatArray
from crossgait.policies.network import check_width
from crossgait.policies.place import Place

try:
    import gymnasium
    import torch
    from stable_baselines3.common.base_class import BaseAlgorithm
    from stable_baselines3.common.policies import ActorCriticPolicy, BasePolicy
    from stable_baselines3.common.save_util import load_from_zip_file
    from stable_baselines3.common.torch_layers import FlattenExtractor
    from stable_baselines3.common.vec_env import VecNormalize
    from stable_baselines3.sac.policies import SACPolicy
    from stable_baselines3.td3.policies import TD3Policy
except ImportError as error:
    raise ImportError("Stable-Baselines3 models need it: pip install crossgait[sb3]") from error

#: Bounds of spaces are single precision.
_ROUNDING = 1e-6


@dataclass(frozen=True)
class Sb3Network:
    """What a model holds, and its own `predict` to compare with."""

    network: MlpNetwork
    run: Callable[[FloatArray], FloatArray]
    source: str


def read(model: Any, interface: PolicyInterface, vecnormalize: Any = None) -> Sb3Network:
    """The network of `model`.

    Args:
        model: a model, its policy, or the zip of `model.save`; loading one runs what it has pickled
        interface: what it was trained for
        vecnormalize: the VecNormalize that it was trained with, or the file of its `save`; by default the model's own

    Raises:
        ConfigError: naming the layer or setting that no bundle can express

    """
    source = os.fspath(model) if isinstance(model, (str, os.PathLike)) else type(model).__name__
    if vecnormalize is None and isinstance(model, BaseAlgorithm):
        vecnormalize = model.get_vec_normalize_env()
    policy = _policy(model, source)
    policy.set_training_mode(False)
    _check_spaces(policy, interface, source)
    observation, normalised = _normalisation(vecnormalize, interface, source)
    actor = _actor(policy, source)
    network = torch_reader.read(actor, Layout.of(interface.action_layout), observation, source).network

    def run(observations: FloatArray) -> FloatArray:
        given = normalised(observations.astype(policy.observation_space.dtype))
        return np.asarray(policy.predict(given, deterministic=True)[0], dtype=np.float64)

    return Sb3Network(network, run, source)


def _policy(model: Any, source: str) -> BasePolicy:
    if isinstance(model, (str, os.PathLike)):
        return _from_zip(source)
    policy = model.policy if isinstance(model, BaseAlgorithm) else model
    if not isinstance(policy, BasePolicy):
        Place(source, "model").fail("a model of Stable-Baselines3, its policy or a zip", type(model).__name__)
    return policy


def _from_zip(path: str) -> BasePolicy:
    """The policy alone, of whichever algorithm: weights and how it was built."""
    require_consent(path, "Stable-Baselines3 unpickles it")
    saved = io.BytesIO(read_bytes(path, CHECKPOINT_BYTES))
    try:
        data, parameters, _ = load_from_zip_file(saved, device="cpu")
        assert data is not None
        options = dict(data["policy_kwargs"])
        if data.get("use_sde"):
            options["use_sde"] = True
        policy = data["policy_class"](data["observation_space"], data["action_space"], lambda _: 0.0, **options)
        policy.load_state_dict(parameters["policy"])
    except Exception as error:  # of zip files, pickles, classes that changed
        Place(path, "file").fail("a zip of Stable-Baselines3's `save`", f"{type(error).__name__}: {error}")
    assert isinstance(policy, BasePolicy)
    return policy


def _check_spaces(policy: BasePolicy, interface: PolicyInterface, source: str) -> None:
    spaces = (("observation", policy.observation_space), ("action", policy.action_space))
    layouts = (Layout.of(interface.observation_layout), Layout.of(interface.action_layout))
    for (what, space), layout in zip(spaces, layouts, strict=True):
        place = Place(source, f"{what} space")
        if not isinstance(space, gymnasium.spaces.Box) or len(space.shape) != 1:
            place.fail("a Box of one dimension", str(space))
        check_width(space.shape[0], layout, what, place)
    action, layout = policy.action_space, layouts[1]
    assert isinstance(action, gymnasium.spaces.Box)
    for i, name in enumerate(layout.names):
        found, expected = (action.low[i], action.high[i]), (layout.low[i], layout.high[i])
        if not np.allclose(found, expected, rtol=_ROUNDING, atol=0):
            bounds = "{:g} to {:g}".format
            Place(source, f"action space, {name}").fail(bounds(*expected), bounds(*found))


def _normalisation(
    vecnormalize: Any,
    interface: PolicyInterface,
    source: str,
) -> tuple[Affine, Callable[[FloatArray], FloatArray]]:
    """What the policy sees of raw observations, and the same as VecNormalize computes it."""
    size = len(interface.observation_layout)
    none = expression.observation(np.zeros(size), np.ones(size))
    if vecnormalize is None:
        return none, lambda observations: observations
    if isinstance(vecnormalize, (str, os.PathLike)):
        source = os.fspath(vecnormalize)
        require_consent(source, "Stable-Baselines3 unpickles it")
        saved = read_bytes(source, CHECKPOINT_BYTES)
        try:
            vecnormalize = pickle.loads(saved)
        except Exception as error:  # whatever unpickling raises
            Place(source, "file").fail("what VecNormalize.save writes", f"{type(error).__name__}: {error}")
    if not isinstance(vecnormalize, VecNormalize):
        Place(source, "vecnormalize").fail("a VecNormalize or its file", type(vecnormalize).__name__)
    if not vecnormalize.norm_obs:
        return none, lambda observations: observations
    statistics = vecnormalize.obs_rms
    if isinstance(statistics, dict):
        Place(source, "vecnormalize").fail("statistics of one vector", f"of {', '.join(statistics)}")
    check_width(
        statistics.mean.size, Layout.of(interface.observation_layout), "observation", Place(source, "vecnormalize")
    )
    std = np.sqrt(statistics.var + vecnormalize.epsilon)
    seen = expression.observation(statistics.mean.astype(np.float64), std, float(vecnormalize.clip_obs))
    return seen, lambda observations: vecnormalize.normalize_obs(observations)


def _actor(policy: BasePolicy, source: str) -> torch.nn.Module:
    """From what VecNormalize gives to the action of `predict(deterministic=True)`, before any clip.

    Of classes whose forward pass is known: a subclass may change it.
    """
    extractor = getattr(policy, "pi_features_extractor", None) or getattr(policy, "actor", policy).features_extractor
    if type(extractor) is not FlattenExtractor:
        Place(source, "features_extractor").fail("FlattenExtractor", type(extractor).__name__)
    if type(policy) is ActorCriticPolicy:
        layers = [policy.mlp_extractor.policy_net, policy.action_net]
        squashed = policy.squash_output
    elif type(policy) is SACPolicy:
        layers = [policy.actor.latent_pi, policy.actor.mu]
        squashed = True
    elif type(policy) is TD3Policy:
        layers = [policy.actor.mu]  # its last part squashes
        squashed = False
    else:
        Place(source, "policy").fail("MlpPolicy of PPO, A2C, SAC, TD3 or DDPG", type(policy).__name__)
    if squashed:
        layers.append(torch.nn.Tanh())
    if policy.squash_output:
        space = policy.action_space
        assert isinstance(space, gymnasium.spaces.Box)
        if (space.low != -1).any() or (space.high != 1).any():
            layers.append(_Unscaled(space.low, space.high))
    return torch.nn.Sequential(*layers)


class _Unscaled(torch.nn.Module):
    """From [-1, 1] to the action space, as BasePolicy.unscale_action."""

    def __init__(self, low: Any, high: Any) -> None:
        super().__init__()
        self.low: torch.Tensor
        self.width: torch.Tensor
        self.register_buffer("low", torch.as_tensor(low))
        self.register_buffer("width", torch.as_tensor(high - low))

    def forward(self, action: torch.Tensor) -> torch.Tensor:
        return self.low + 0.5 * (action + 1.0) * self.width
