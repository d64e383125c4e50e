"""Policies: made of names and files, and of what other frameworks train."""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from crossgait import _core
from crossgait._core import EnvironmentConfig, MlpNetwork, PolicyBundle, PolicyInterface
from crossgait.errors import ConfigError
from crossgait.files import check_outputs
from crossgait.inputs import InterfaceLike, as_environment, environment_for
from crossgait.layout import EnvironmentLayout, Layout
from crossgait.policies import agreement, expression

if TYPE_CHECKING:
    import torch

FloatArray = npt.NDArray[np.float64]
#: (mean, std) of observations, and the limit of what they become, +-; for models that are given normalised ones.
Normalisation = tuple[npt.ArrayLike, npt.ArrayLike]

_BUNDLE = ".safetensors"


def interface_of(environment: InterfaceLike) -> PolicyInterface:
    """What a policy runs on.

    Args:
        environment: a PolicyInterface, or whatever `crossgait.inputs.as_environment` takes: an EnvironmentConfig, its
            YAML file, a mapping of its keys, a Walk, or an environment

    Raises:
        ConfigError: for anything else, or a configuration that makes no environment

    """
    return _home_of(environment)[0]


def _home_of(environment: InterfaceLike) -> tuple[PolicyInterface, EnvironmentConfig | None]:
    """The interface, and the configuration that it is of, where that is known."""
    if isinstance(environment, PolicyInterface):
        return environment, None
    config = as_environment(environment, "policy")
    return PolicyInterface(config), config


class Policy:
    """An observation in, an action within its bounds out.

    One instance serves one environment at a time, from one thread: it may remember what happened since `reset`.
    """

    def __init__(
        self,
        core: _core.Policy,
        bundle: PolicyBundle | None = None,
        *,
        text: str | None = None,
        environment: EnvironmentConfig | None = None,
    ) -> None:
        if not isinstance(core, _core.Policy):
            raise TypeError(
                "a Policy is what Policy.load makes of a name or a file, and from_onnx, from_torch, from_sb3"
            )
        self._core = core
        self._bundle = bundle
        self._text = text
        self.environment = environment  #: that it was made for; None if only its interface was named

    @classmethod
    def load(cls, policy: str | os.PathLike[str], environment: InterfaceLike | None = None) -> Policy:
        """A policy by name or file.

        Args:
            policy: "zero", "random", one of `crossgait.policy_names()`, a bundle (FILE.safetensors) or a description
                (FILE.yaml; docs/policies.md)
            environment: what it runs on, as `interface_of` takes it; by default its own, which a name has, and a file
                with an environment.yaml beside it

        Raises:
            ConfigError: for an unknown name, a bad file, or one for another layout, saying what differs

        """
        interface, config = _home_of(environment_for(None, policy) if environment is None else environment)
        text = os.fspath(policy)
        file = _core.find_policy_file(text)
        if not file.endswith(_BUNDLE):
            return cls(_core.Policy(file, interface), text=text, environment=config)
        bundle = PolicyBundle.read(file)
        core = _core.Policy.of_bundle(bundle, file, interface)
        return cls(core, bundle, text=text, environment=config)

    @classmethod
    def from_network(
        cls,
        network: MlpNetwork,
        environment: InterfaceLike,
        *,
        name: str = "network",
    ) -> Policy:
        """Of a network given as arrays. Raises ConfigError unless it fits the environment and is finite."""
        interface, config = _home_of(environment)
        return cls._of_bundle(PolicyBundle(network, interface, name), name, interface, config)

    @classmethod
    def from_sb3(
        cls,
        model: Any,
        environment: InterfaceLike,
        vecnormalize: Any = None,
        *,
        observations: npt.ArrayLike | None = None,
    ) -> Policy:
        """The deterministic actor of a Stable-Baselines3 model: PPO, A2C, SAC, TD3, DDPG with MlpPolicy.

        Args:
            model: the model, its policy, or the zip of `model.save` (which is unpickled: load only what you trust)
            environment: what it was trained on
            vecnormalize: the VecNormalize that it was trained with, or the file of its `save`; the model's own if None
                and the model still has its environment
            observations: raw ones [n, obs] of a run, for golden pairs; chosen if None

        Raises:
            ConfigError: naming the layer or setting that bundles do not express, or the largest difference from
                `predict(deterministic=True)` if it is above 1e-5

        """
        from crossgait.policies import sb3_reader

        interface, config = _home_of(environment)
        read = sb3_reader.read(model, interface, vecnormalize)
        bundle = agreement.agreed_bundle(
            read.network, interface, read.run, read.source, "predict()", observations=observations
        )
        return cls._of_bundle(bundle, read.source, interface, config)

    @classmethod
    def from_torch(
        cls,
        module: torch.nn.Module | str | os.PathLike[str],
        environment: InterfaceLike,
        *,
        normalisation: Normalisation | None = None,
        clip: float | None = None,
        output: int | None = None,
        observations: npt.ArrayLike | None = None,
    ) -> Policy:
        """A PyTorch module that is a multilayer perceptron, in evaluation mode.

        Args:
            module: any nn.Module that `torch.export` follows, a TorchScript module, or the file of one
            environment: what it was trained on
            normalisation: (mean, std) of the observation, if the module is given normalised ones
            clip: limit of the normalised observation, +-, likewise
            output: which of several outputs is the action
            observations: raw ones [n, obs] of a run, for golden pairs; chosen if None

        Raises:
            ConfigError: naming the layer that bundles do not express, or the largest difference from the module if it
                is above 1e-5 (1e-2 for modules in half precision)

        """
        from crossgait.policies import torch_reader

        interface, config = _home_of(environment)
        source = type(module).__name__
        if isinstance(module, (str, os.PathLike)):
            source, module = os.fspath(module), torch_reader.load_script(os.fspath(module))
        seen = _seen(interface, normalisation, clip)
        read = torch_reader.read(module, Layout.of(interface.action_layout), seen, source, output)
        bundle = agreement.agreed_bundle(
            read.network, interface, read.run, source, "the module", half=read.half, observations=observations
        )
        return cls._of_bundle(bundle, source, interface, config)

    @classmethod
    def from_onnx(
        cls,
        file: str | os.PathLike[str],
        environment: InterfaceLike,
        *,
        normalisation: Normalisation | None = None,
        clip: float | None = None,
        output: str | None = None,
        observations: npt.ArrayLike | None = None,
    ) -> Policy:
        """An ONNX file that is a multilayer perceptron.

        Args:
            file: as exporters write it; docs/python-policies.md lists what is understood
            environment: what it was trained on
            normalisation: (mean, std) of the observation, if the file is given normalised ones
            clip: limit of the normalised observation, +-, likewise
            output: which of several outputs is the action
            observations: raw ones [n, obs] of a run, for golden pairs; chosen if None

        Raises:
            ConfigError: naming the node that bundles do not express, or the largest difference from onnxruntime if it
                is above 1e-5 (1e-2 for files in half precision)

        """
        from crossgait.policies import onnx_reader

        (interface, config), source = _home_of(environment), os.fspath(file)
        read = onnx_reader.read(source, interface, _seen(interface, normalisation, clip), output)
        bundle = agreement.agreed_bundle(
            read.network, interface, read.run, source, "onnxruntime", half=read.half, observations=observations
        )
        return cls._of_bundle(bundle, source, interface, config)

    @classmethod
    def _of_bundle(
        cls, bundle: PolicyBundle, source: str, interface: PolicyInterface, environment: EnvironmentConfig | None
    ) -> Policy:
        return cls(_core.Policy.of_bundle(bundle, source, interface), bundle, environment=environment)

    @property
    def for_studies(self) -> str | _core._BundlePolicy:
        """What studies make their own instances of: the text that it was loaded by, or its network."""
        if self._text is not None:
            return self._text
        return _core._BundlePolicy(self._needed_bundle("study"), self.name)

    @property
    def name(self) -> str:
        """For tables: "zero", "random", the file's name."""
        return self._core.name

    @property
    def interface(self) -> PolicyInterface:
        """What it runs on."""
        return self._core.interface

    @property
    def layout(self) -> EnvironmentLayout:
        """What observation and action mean, number by number."""
        return EnvironmentLayout.of(self._core.interface)

    @property
    def network(self) -> MlpNetwork | None:
        """As arrays; None for policies that are no network."""
        return self._bundle.network if self._bundle else None

    @property
    def bundle(self) -> PolicyBundle | None:
        """The network with its layout and golden pairs; None for policies that are no network."""
        return self._bundle

    def made_for(self, environment: InterfaceLike) -> Policy:
        """The same for an environment, as `interface_of` takes it: an instance of its own. Raises ConfigError."""
        if self._text is not None:
            return Policy.load(self._text, environment)
        bundle = self._needed_bundle("environment")
        interface, config = _home_of(environment)
        return Policy._of_bundle(bundle, self.name, interface, config)

    def reset(self, seed: int = 0) -> None:
        """Begin an episode; `seed` is of whatever the policy draws."""
        self._core.reset(seed)

    def act(self, observation: npt.NDArray[Any]) -> FloatArray:
        """The action [act] for a raw observation [obs], float64 or float32, in a new array.

        It is finite and within its bounds, whatever the observation holds. Raises ConfigError for one of another size.
        """
        return self._core.act(np.ascontiguousarray(observation))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a bundle, whole or not at all, which `crossgait rollout --policy` runs. Raises ConfigError."""
        text, bundle = os.fspath(path), self._needed_bundle("bundle")
        if not text.endswith(_BUNDLE):
            raise ConfigError(text, "file", f"a name that ends in {_BUNDLE}", "another")
        bundle.write(text)

    def to_onnx(self, file: str | os.PathLike[str]) -> None:
        """Write the network as ONNX, whole or not at all: `observation` [batch, obs] -> `action` [batch, act].

        Actions are clipped as `act` clips them. What is written has been run by onnxruntime on the golden pairs.

        Raises:
            ConfigError: if this is no network, if the place cannot be written, or with the largest difference from
                onnxruntime if it is above 1e-5

        """
        from crossgait.policies import onnx_writer

        bundle = self._needed_bundle("ONNX file")
        check_outputs([("file", file)], [("the policy", self._text or self.name)])
        model = onnx_writer.to_model(bundle, self.layout.action)
        given = bundle.golden_observation.astype(np.float32)
        theirs = onnx_writer.run(model, given, os.fspath(file))
        ours = np.array([self.act(row) for row in given])
        agreement.check_agreement(ours, theirs, self.layout.action, os.fspath(file), "onnxruntime")
        onnx_writer.write(model, file)

    def _needed_bundle(self, what: str) -> PolicyBundle:
        if self._bundle is None:
            raise ConfigError(self.name, what, "a policy that is a network", "one that is not")
        return self._bundle

    def __reduce__(self) -> tuple[Any, ...]:
        """Networks travel whole, other policies by the text that they were loaded by."""
        if self._bundle is None:
            return Policy.load, (self._text, self.environment)
        if self.environment is None:
            raise TypeError(f"policy {self.name} cannot be pickled: it was made for an interface, not an environment")
        return _unpickled, (bytes_of(self._bundle), self.name, self.environment)

    def __repr__(self) -> str:
        return f"<Policy {self.name}: {len(self.layout.observation)} -> {len(self.layout.action)}>"


def bytes_of(bundle: PolicyBundle) -> bytes:
    """Return what the bundle's file would hold."""
    with TemporaryDirectory(prefix="crossgait-") as folder:
        file = Path(folder) / f"policy{_BUNDLE}"
        bundle.write(file)
        return file.read_bytes()


def bundle_of(content: bytes) -> PolicyBundle:
    """Return the bundle of a file's bytes. Raises ConfigError for those of another file."""
    with TemporaryDirectory(prefix="crossgait-") as folder:
        file = Path(folder) / f"policy{_BUNDLE}"
        file.write_bytes(content)
        return PolicyBundle.read(file)


def _unpickled(bundle: bytes, name: str, environment: EnvironmentConfig) -> Policy:
    """A network in memory, of the bytes of its bundle."""
    read = bundle_of(bundle)
    return Policy(_core.Policy.of_bundle(read, name, PolicyInterface(environment)), read, environment=environment)


def _seen(interface: PolicyInterface, normalisation: Normalisation | None, clip: float | None) -> expression.Affine:
    """What a model is given of raw observations."""
    layout = Layout.of(interface.observation_layout)
    mean, std = (np.zeros(len(layout)), np.ones(len(layout))) if normalisation is None else map(_vector, normalisation)
    for name, array in (("mean", mean), ("std", std)):
        if array.shape != (len(layout),) or not np.isfinite(array).all():
            expected = f"{len(layout)} finite numbers"
            raise ConfigError("normalisation", name, expected, f"shape {list(array.shape)} or others")
    if not (std > 0).all():
        at = int(np.argmin(std))
        raise ConfigError("normalisation", f"std of {layout.names[at]}", "a number above zero", f"{std[at]:g}")
    limit = np.inf if clip is None else float(clip)
    if not limit > 0:
        raise ConfigError("normalisation", "clip", "a number above zero", f"{limit:g}")
    return expression.observation(mean, std, limit)


def _vector(numbers: npt.ArrayLike) -> FloatArray:
    return np.asarray(numbers, dtype=np.float64)
