"""TorchScript and checkpoints of rsl_rl as networks that run without PyTorch."""

from __future__ import annotations

import io
import warnings
import zipfile
from dataclasses import dataclass
from typing import Any

import numpy as np

from crossgait._core import MlpNetwork, PolicyInterface
from crossgait.errors import ConfigError
from crossgait.files import CHECKPOINT_BYTES, read_bytes
from crossgait.importing.onnx_network import OnnxNetwork
from crossgait.importing.stated import Stated
from crossgait.policies.place import Place
from crossgait.policies.torch_reader import holds_code, load_script

try:
    import torch
except ImportError as error:
    raise ImportError("TorchScript and checkpoints need torch: pip install crossgait[torch]") from error

#: Of actions, between PyTorch and the same network in ONNX Runtime: sums in another order, through steps of memory.
_TOLERANCE = 1e-4
_STEPS = 12


def is_script(file: str) -> bool:
    """Whether a zip of PyTorch's is TorchScript, which has code; a checkpoint has none."""
    saved = io.BytesIO(read_bytes(file, CHECKPOINT_BYTES))
    try:
        with zipfile.ZipFile(saved) as archive:
            return holds_code(archive)
    except Exception as error:  # of no common type
        raise ConfigError(file, "file", "a file of PyTorch's", str(error)) from error


def script_as_onnx(file: str, interface: PolicyInterface) -> OnnxNetwork:
    """A TorchScript module, with what it remembers as inputs and outputs.

    Raises:
        ConfigError: naming the operation that cannot be followed, or where the ONNX file computes something else

    """
    script: Any = load_script(file).eval()
    names = _memory_of(script, interface, file)
    module: torch.nn.Module = script
    memory = [_buffer(script, name) for name in names]
    if names:
        from crossgait.importing.script_memory import ScriptWithMemory

        module = ScriptWithMemory(script, names, file)
    return _checked(_exported(module, memory, interface, file), load_script(file).eval(), interface, file)


def _buffer(script: Any, name: str) -> torch.Tensor:
    return torch.zeros_like(dict(script.named_buffers())[name])


def _memory_of(script: Any, interface: PolicyInterface, file: str) -> list[str]:
    """The buffers that a forward pass changes."""
    before = {name: buffer.clone() for name, buffer in script.named_buffers()}
    for _ in range(2):
        _act(script, np.ones(len(interface.observation_layout)), file)
    changed = [name for name, buffer in script.named_buffers() if not torch.equal(buffer, before[name])]
    begun = [name for name in changed if before[name].abs().max() > 0]
    if begun:
        raise ConfigError(file, begun[0], "memory that is zero before the first step", "another")
    for name, buffer in script.named_buffers():
        with torch.no_grad():
            buffer.copy_(before[name])
    return changed


def _act(module: Any, observation: np.ndarray[Any, Any], file: str) -> np.ndarray[Any, Any]:
    try:
        with torch.no_grad():
            action = module(torch.from_numpy(observation[None].astype(np.float32)))
    except RuntimeError as error:
        size = len(observation)
        found = str(error).strip().splitlines()[-1]
        raise ConfigError(file, "forward", f"a pass from [1, {size}], the environment's observation", found) from error
    action = action[0] if isinstance(action, tuple) else action
    return np.asarray(action.detach().reshape(-1).double().numpy())


def _exported(
    module: torch.nn.Module, memory: list[torch.Tensor], interface: PolicyInterface, file: str
) -> OnnxNetwork:
    inputs = ["observation", *(f"memory_{i}_in" for i in range(len(memory)))]
    outputs = ["action", *(f"memory_{i}_out" for i in range(len(memory)))]
    written = io.BytesIO()
    example = (torch.zeros(1, len(interface.observation_layout)), *memory)
    try:
        with warnings.catch_warnings(), torch.no_grad():
            warnings.simplefilter("ignore")  # of traces as such: the result is compared with the module
            if memory:
                module = torch.jit.trace(module, example, check_trace=False)  # type: ignore[no-untyped-call]
            export: Any = torch.onnx.export  # its types know no buffers, which it takes
            export(module, example, written, input_names=inputs, output_names=outputs, dynamo=False, opset_version=17)
    except ConfigError:
        raise
    except Exception as error:  # of no common type
        found = str(error).strip().splitlines()[0] if str(error).strip() else type(error).__name__
        raise ConfigError(file, "network", "operations that ONNX has", found) from error
    ports = dict(zip(inputs[1:], outputs[1:], strict=True))
    return OnnxNetwork(written.getvalue(), "observation", "action", ports)


def _checked(network: OnnxNetwork, module: Any, interface: PolicyInterface, file: str) -> OnnxNetwork:
    """Raise ConfigError unless module and ONNX file act the same through some steps."""
    from crossgait.policies.onnx_session import session

    opened = session(network.model, file)
    sizes = {i.name: i.shape for i in opened.get_inputs()}
    memory = {name: np.zeros(sizes[name], np.float32) for name in network.memory}
    random = np.random.default_rng(0)
    for step in range(_STEPS):
        observation = random.normal(size=len(interface.observation_layout))
        given = {network.observation: observation[None].astype(np.float32), **memory}
        action, *after = opened.run([network.action, *network.memory.values()], given)
        memory = dict(zip(network.memory, after, strict=True))
        theirs = _act(module, observation, file)
        if theirs.size != len(interface.action_layout):
            raise ConfigError(file, "action", f"{len(interface.action_layout)} numbers", f"{theirs.size}")
        apart = float(np.abs(action.reshape(-1) - theirs).max())
        if not apart <= _TOLERANCE * max(1.0, float(np.abs(theirs).max())):
            raise ConfigError(file, f"step {step}", f"the module's action within {_TOLERANCE:g}", f"{apart:.3g} apart")
    return network


@dataclass(frozen=True)
class Actor:
    """What a checkpoint holds: plain layers, or a recurrent part in front of them."""

    network: MlpNetwork | None
    layers: MlpNetwork
    recurrent: torch.nn.LSTM | torch.nn.GRU | None


_NETWORKS = ("actor", "mlp")
_NORMALISERS = ("actor_obs_normalizer", "obs_normalizer")
_ACTIVATIONS = {"elu": "elu", "relu": "relu", "tanh": "tanh", "swish": "swish", "silu": "swish"}


def read_checkpoint(file: str, agent: Stated | None) -> Actor:
    """The actor of a checkpoint of rsl_rl. Nothing in it is executed (`weights_only`).

    Raises:
        ConfigError: where it is none, without agent.yaml, or for an activation or class that Crossgait has not

    """
    if agent is None:
        expected = "agent.yaml of its run (--from agent.yaml), which says what is between the layers"
        raise ConfigError(file, "architecture", expected, "none: a checkpoint holds weights alone")
    weights = _Weights.load(file)
    activation = _activation(agent)
    layers = _layers(weights)
    normaliser = _normaliser(weights)
    recurrent = _recurrent(weights, agent)
    if recurrent is not None and normaliser is not None:
        layers_alone = MlpNetwork(layers, activation=activation)
        return Actor(None, layers_alone, _folded(recurrent, *normaliser, file))
    if recurrent is not None:
        return Actor(None, MlpNetwork(layers, activation=activation), recurrent)
    network = MlpNetwork(layers, activation=activation, normalisation=normaliser)
    return Actor(network, network, None)


def _is_plain(tensor: torch.Tensor) -> bool:
    return tensor.layout == torch.strided and tensor.device.type == "cpu"


class _Weights:
    """The tensors of a checkpoint, each looked at before it is used: a file may hold anything under any name."""

    def __init__(self, file: str, state: dict[Any, Any]) -> None:
        self.file = file
        self.names = [name for name in state if isinstance(name, str)]
        self._state = state

    @classmethod
    def load(cls, file: str) -> _Weights:
        """Of a file, tensors alone. Raises ConfigError."""
        content = io.BytesIO(read_bytes(file, CHECKPOINT_BYTES))
        try:
            saved = torch.load(content, map_location="cpu", weights_only=True)
        except Exception as error:  # of no common type
            found = str(error).strip().splitlines()[:1] or [type(error).__name__]
            raise ConfigError(file, "file", "a checkpoint of tensors alone", found[0]) from error
        state = saved.get("actor_state_dict", saved.get("model_state_dict")) if isinstance(saved, dict) else None
        if not isinstance(state, dict):
            raise ConfigError(file, "file", "model_state_dict or actor_state_dict, as rsl_rl writes it", "neither")
        norm = saved.get("obs_norm_state_dict")
        beside = {f"obs_normalizer.{key}": value for key, value in norm.items()} if isinstance(norm, dict) else {}
        return cls(file, dict(state) | beside)

    def __contains__(self, name: str) -> bool:
        return name in self._state

    def at(self, name: str, dimensions: int | None = None) -> torch.Tensor:
        """A tensor of numbers, of so many dimensions. Raises ConfigError."""
        value = self._state.get(name)
        expected = "a tensor of numbers" if dimensions is None else f"a tensor of numbers with {dimensions} dimensions"
        if not isinstance(value, torch.Tensor) or not value.dtype.is_floating_point or not _is_plain(value):
            found = "none" if value is None else str(getattr(value, "dtype", type(value).__name__))
            raise ConfigError(self.file, name, expected, found)
        if dimensions is not None and value.dim() != dimensions:
            raise ConfigError(self.file, name, expected, f"{value.dim()} dimensions")
        if not bool(torch.isfinite(value).all()):
            raise ConfigError(self.file, name, "finite numbers", "others among them")
        return value

    def numbers(self, name: str, dimensions: int | None = None) -> np.ndarray[Any, Any]:
        """The same as an array."""
        return np.asarray(self.at(name, dimensions).detach().resolve_neg().double().numpy())


def _policy(agent: Stated) -> Stated:
    found = agent.find("actor") or agent.find("policy")
    if found is None:
        agent.fail("policy: or actor:, as agent.yaml of rsl_rl has")
    return found


def _activation(agent: Stated) -> str:
    value = _policy(agent).at("activation")
    name = value.text().lower()
    if name not in _ACTIVATIONS:
        value.fail(f"one of {', '.join(_ACTIVATIONS)}")
    return _ACTIVATIONS[name]


def _layers(weights: _Weights) -> list[tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]]:
    for prefix in _NETWORKS:
        parts = [name.split(".") for name in weights.names if name.startswith(f"{prefix}.")]
        numbers = sorted(
            int(part[1]) for part in parts if len(part) == 3 and part[1].isdecimal() and part[2] == "weight"
        )
        if numbers:
            return [
                (weights.numbers(f"{prefix}.{i}.weight", 2), weights.numbers(f"{prefix}.{i}.bias", 1)) for i in numbers
            ]
    found = ", ".join(sorted(weights.names)[:5])
    raise ConfigError(weights.file, "model_state_dict", "actor.N.weight or mlp.N.weight", found)


def _normaliser(weights: _Weights) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]] | None:
    for prefix in _NORMALISERS:
        if f"{prefix}._mean" in weights:
            std = weights.numbers(f"{prefix}._std").reshape(-1)
            # (x - mean) / (std + 1e-2), as rsl_rl's EmpiricalNormalization has it.
            return weights.numbers(f"{prefix}._mean").reshape(-1), std + 1e-2
    return None


_RECURRENT = {"lstm": torch.nn.LSTM, "gru": torch.nn.GRU}


def _recurrent(weights: _Weights, agent: Stated) -> torch.nn.LSTM | torch.nn.GRU | None:
    prefix = next((p for p in ("memory_a.rnn.", "rnn.rnn.", "rnn.") if f"{p}weight_ih_l0" in weights), None)
    if prefix is None:
        return None
    kind = _policy(agent).at("rnn_type")
    if kind.text().lower() not in _RECURRENT:
        kind.fail("lstm or gru")
    own = {name.removeprefix(prefix): weights.at(name) for name in weights.names if name.startswith(prefix)}
    hidden = weights.at(f"{prefix}weight_hh_l0", 2).shape[1]
    count = len([name for name in own if name.startswith("weight_ih_l")])
    sees = weights.at(f"{prefix}weight_ih_l0", 2).shape[1]
    try:
        module: torch.nn.LSTM | torch.nn.GRU = _RECURRENT[kind.text().lower()](sees, hidden, count)
        module.load_state_dict(own)
    except (RuntimeError, ValueError) as error:
        expected = f"weights of {count} layers of {kind.text()}, {hidden} wide"
        found = " ".join(str(error).split())
        raise ConfigError(weights.file, f"{prefix}*", expected, found) from error
    module.eval()
    return module


def _folded(recurrent: Any, mean: np.ndarray[Any, Any], std: np.ndarray[Any, Any], file: str) -> Any:
    """With the normaliser of its input in its first layer."""
    if not mean.size == std.size == recurrent.input_size:
        found = f"{mean.size} means and {std.size} deviations"
        raise ConfigError(file, "normaliser", f"{recurrent.input_size} of each", found)
    with torch.no_grad():
        weight = recurrent.weight_ih_l0.double() / torch.from_numpy(std)
        recurrent.bias_ih_l0 -= (weight @ torch.from_numpy(mean)).float()
        recurrent.weight_ih_l0.copy_(weight.float())
    return recurrent


class _Recurrent(torch.nn.Module):
    """A recurrent layer and plain ones behind it; memory goes in and comes out."""

    def __init__(self, actor: Actor) -> None:
        super().__init__()
        assert actor.recurrent is not None
        self.recurrent = actor.recurrent
        activations = {"elu": torch.nn.ELU, "relu": torch.nn.ReLU, "tanh": torch.nn.Tanh, "swish": torch.nn.SiLU}
        parts: list[torch.nn.Module] = []
        for weight, bias in actor.layers.layers:
            layer = torch.nn.Linear(weight.shape[1], weight.shape[0])
            with torch.no_grad():
                layer.weight.copy_(torch.from_numpy(weight))
                layer.bias.copy_(torch.from_numpy(bias))
            parts += [layer, activations[actor.layers.activation]()]
        self.layers = torch.nn.Sequential(*parts[:-1])

    def forward(self, observation: torch.Tensor, *memory: torch.Tensor) -> tuple[torch.Tensor, ...]:
        given = memory if len(memory) > 1 else memory[0]
        seen, after = self.recurrent(observation[None], given)
        return (self.layers(seen[0]), *(after if isinstance(after, tuple) else (after,)))


def recurrent_as_onnx(actor: Actor, interface: PolicyInterface, file: str) -> OnnxNetwork:
    """A checkpoint's recurrent actor. Raises ConfigError."""
    recurrent = actor.recurrent
    assert recurrent is not None
    if recurrent.input_size != len(interface.observation_layout):
        Place(file, "observation").fail(f"{len(interface.observation_layout)} numbers", f"{recurrent.input_size}")
    states = 2 if isinstance(recurrent, torch.nn.LSTM) else 1
    memory = [torch.zeros(recurrent.num_layers, 1, recurrent.hidden_size) for _ in range(states)]
    return _exported(_Recurrent(actor).eval(), memory, interface, file)
