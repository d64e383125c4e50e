"""Networks of actuators: from the TorchScript that training read to a file that Crossgait runs."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait.errors import ConfigError
from crossgait.files import written_whole

FloatArray = npt.NDArray[np.float64]

ACTUATOR_FILE = "actuator.safetensors"
_FORMAT = "crossgait-actuator-1"
#: Of torques, between PyTorch and the same network here, in units of the largest.
_TOLERANCE = 1e-4
_GOLDEN_STEPS = 24
_ACTIVATIONS = {
    "softsign": lambda x: x / (1 + np.abs(x)),
    "elu": lambda x: np.where(x > 0, x, np.expm1(np.minimum(x, 0))),
    "relu": lambda x: np.maximum(x, 0),
    "tanh": np.tanh,
    "swish": lambda x: x / (1 + np.exp(-x)),
}


@dataclass(frozen=True)
class Actuator:
    """What a file says of a network of actuators.

    Attributes:
        file: TorchScript.
        place: where it was said.
        remembers: an LSTM, which takes (error, velocity) and its memory; else a perceptron on `instants`.
        physics_dt: s.
        instants: physics steps ago of its inputs.
        velocity_first: its inputs are velocities, then errors.

    """

    file: str
    place: str
    remembers: bool
    physics_dt: float
    instants: tuple[int, ...] = (0,)
    velocity_first: bool = False
    error_scale: float = 1.0
    velocity_scale: float = 1.0
    torque_scale: float = 1.0


def find_file(text: str, folders: tuple[str, ...], place: str) -> str:
    """A network's file by what a configuration calls it: there, or of that name beside the files that were given.

    Raises:
        ConfigError: where there is none

    """
    for file in [text, *(os.path.join(folder, os.path.basename(text)) for folder in folders)]:
        if os.path.isfile(file):
            return file
    raise ConfigError(place, "file", f"a file there, or {os.path.basename(text)} beside the file that says so", text)


def write_actuator(actuator: Actuator, folder: Path) -> str:
    """Write the network beside the environment, compared with the module; the file's name.

    Raises:
        ConfigError: for a module that is neither a perceptron nor an LSTM with layers behind it

    """
    import safetensors.numpy
    import torch

    from crossgait.policies.torch_reader import load_script

    module = load_script(actuator.file).eval()
    tensors = _tensors(module, actuator)
    rng = np.random.default_rng(1)
    error, velocity = rng.uniform(-0.3, 0.3, _GOLDEN_STEPS), rng.uniform(-6, 6, _GOLDEN_STEPS)
    try:
        with torch.no_grad():
            torque = _run(module, actuator, tensors, error, velocity, torch)
    except RuntimeError as problem:
        first = str(problem).strip().splitlines()[-1]
        kind = "an LSTM's (error, velocity) with its memory" if actuator.remembers else "a row of inputs"
        raise ConfigError(actuator.place, "network", f"a module that takes {kind}", first) from problem
    largest = max(1.0, float(np.abs(torque).max()))
    for name, function in _ACTIVATIONS.items():
        if np.abs(_computed(tensors, function, actuator, error, velocity) - torque).max() < _TOLERANCE * largest:
            activation = name
            break
    else:
        expected = f"layers, behind an LSTM or not, with one of {', '.join(_ACTIVATIONS)} between them"
        raise ConfigError(actuator.place, "network", expected, f"{actuator.file}, which computes otherwise")
    golden = {"golden.error": error, "golden.velocity": velocity, "golden.torque": torque}
    metadata = {
        "format": _FORMAT,
        "activation": activation,
        "input_order": "velocity_first" if actuator.velocity_first else "error_first",
        "instants": json.dumps(list(actuator.instants)),
        "physics_dt": repr(actuator.physics_dt),
        "error_scale": repr(actuator.error_scale),
        "velocity_scale": repr(actuator.velocity_scale),
        "torque_scale": repr(actuator.torque_scale),
    }
    contents = {k: np.ascontiguousarray(v, dtype=np.float64) for k, v in (tensors | golden).items()}
    with written_whole(folder / ACTUATOR_FILE) as beside:
        safetensors.numpy.save_file(contents, beside, metadata)
    return ACTUATOR_FILE


def _tensors(module: Any, actuator: Actuator) -> dict[str, FloatArray]:
    """Layers in their order, by the names of Crossgait's file."""
    state = {key: value.detach().double().numpy() for key, value in module.state_dict().items()}
    tensors: dict[str, FloatArray] = {}
    layers = 0
    for key, value in state.items():
        prefix, _, part = key.rpartition(".")
        if "_l" in part and part.startswith(("weight_", "bias_")):
            kind, _, layer = part.rpartition("_l")
            tensors[f"lstm.{layer}.{kind}"] = value
        elif part == "weight" and value.ndim == 2:
            tensors[f"layer.{layers}.weight"] = value
            bias = state.get(f"{prefix}.bias" if prefix else "bias")
            tensors[f"layer.{layers}.bias"] = np.zeros(len(value)) if bias is None else bias
            layers += 1
    if not layers or ("lstm.0.weight_ih" in tensors) != actuator.remembers:
        expected = "an LSTM and layers behind it" if actuator.remembers else "layers alone"
        raise ConfigError(actuator.place, "network", expected, ", ".join(state) or "no weights")
    return tensors


def _inputs(actuator: Actuator, error: FloatArray, velocity: FloatArray) -> FloatArray:
    """Of every step a row; what was before the first is zero."""
    oldest = max(actuator.instants)
    before = np.zeros(oldest)
    parts = [
        [
            np.concatenate([before, values * scale])[oldest - ago : oldest - ago + len(values)]
            for ago in actuator.instants
        ]
        for values, scale in ((error, actuator.error_scale), (velocity, actuator.velocity_scale))
    ]
    return np.stack(parts[1] + parts[0] if actuator.velocity_first else parts[0] + parts[1], axis=1)


def _run(
    module: Any, actuator: Actuator, tensors: dict[str, FloatArray], error: FloatArray, velocity: FloatArray, torch: Any
) -> FloatArray:
    """What the module itself makes of them, N m."""
    inputs = torch.from_numpy(_inputs(actuator, error, velocity)).float()
    if not actuator.remembers:
        return np.asarray(module(inputs).double().reshape(-1)) * actuator.torque_scale
    layers, units = len([k for k in tensors if k.endswith("weight_hh")]), tensors["lstm.0.weight_hh"].shape[1]
    memory = (torch.zeros(layers, 1, units), torch.zeros(layers, 1, units))
    torques = []
    for row in inputs:
        torque, memory = module(row.reshape(1, 1, 2), memory)
        torques.append(float(torque.reshape(-1)[0]))
    return np.asarray(torques) * actuator.torque_scale


def _computed(
    tensors: dict[str, FloatArray], activation: Any, actuator: Actuator, error: FloatArray, velocity: FloatArray
) -> FloatArray:
    """The same here, N m."""
    x = _inputs(actuator, error, velocity)
    for layer in range(len([k for k in tensors if k.endswith("weight_hh")])):
        x = _lstm({k: tensors[f"lstm.{layer}.{k}"] for k in ("weight_ih", "weight_hh", "bias_ih", "bias_hh")}, x)
    count = len([k for k in tensors if k.startswith("layer.") and k.endswith("weight")])
    for layer in range(count):
        x = x @ tensors[f"layer.{layer}.weight"].T + tensors[f"layer.{layer}.bias"]
        if layer + 1 < count:
            x = activation(x)
    return np.asarray(x[:, 0] * actuator.torque_scale)


def _lstm(weights: dict[str, FloatArray], inputs: FloatArray) -> FloatArray:
    units = weights["weight_hh"].shape[1]
    h, c = np.zeros(units), np.zeros(units)
    out = []
    for x in inputs:
        i, f, g, o = np.split(
            weights["weight_ih"] @ x + weights["bias_ih"] + weights["weight_hh"] @ h + weights["bias_hh"], 4
        )
        i, f, o = (1 / (1 + np.exp(-gate)) for gate in (i, f, o))
        c = f * c + i * np.tanh(g)
        h = o * np.tanh(c)
        out.append(h)
    return np.stack(out)
