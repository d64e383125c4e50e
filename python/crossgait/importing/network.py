"""The network of a policy: a bundle where that can say it, else an ONNX file that ONNX Runtime computes."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from crossgait._core import LAYOUT_VERSION, PolicyInterface
from crossgait.errors import ConfigError
from crossgait.files import opened, read_bytes, written_whole
from crossgait.importing.onnx_network import OnnxNetwork
from crossgait.policies.policy import Policy
from crossgait.sweep.strict_yaml import write_yaml

#: The core's budget of networks.
MOST_BYTES = 64 << 20
_TOLERANCE = 1e-5


def write_network(file: str, interface: PolicyInterface, folder: Path, agent: Any = None) -> str:
    """Write the policy of `file` into a folder, as NAME.safetensors or as NAME.yaml and NAME.onnx.

    Args:
        file: ONNX, TorchScript, a checkpoint of rsl_rl (with `agent`), or a bundle
        interface: of its environment
        folder: whose name is the policy's
        agent: of a checkpoint, what its agent.yaml states

    Returns:
        The policy's file.

    Raises:
        ConfigError: for a file that is none of these, or of other sizes than the environment's

    """
    with opened(file) as reading:
        begins = reading.read(4)
    if file.endswith(".onnx"):
        return _write_onnx(file, interface, folder)
    if file.endswith(".safetensors"):
        target = str(folder / f"{folder.name}.safetensors")
        Policy.load(file, interface).save(target)
        return target
    if begins[:2] == b"PK":
        from crossgait.importing import torch_files

        if torch_files.is_script(file):
            return _write_script(file, interface, folder)
        return _write_checkpoint(file, interface, folder, agent)
    raise ConfigError(file, "file", "FILE.onnx, TorchScript, a checkpoint of rsl_rl or FILE.safetensors", "another")


def _write_onnx(file: str, interface: PolicyInterface, folder: Path) -> str:
    model = read_bytes(file, MOST_BYTES)
    network = find_ports(model, interface, file)
    if not network.memory:
        try:
            return _saved(Policy.from_onnx(file, interface, output=network.action), folder)
        except ConfigError:
            pass  # no plain layers
    return write_described(network, interface, folder)


def _write_script(file: str, interface: PolicyInterface, folder: Path) -> str:
    from crossgait.importing import torch_files

    try:
        return _saved(Policy.from_torch(file, interface), folder)
    except ConfigError:
        network = torch_files.script_as_onnx(file, interface)
        return write_described(network, interface, folder)


def _write_checkpoint(file: str, interface: PolicyInterface, folder: Path, agent: Any) -> str:
    from crossgait.importing import torch_files

    actor = torch_files.read_checkpoint(file, agent)
    if actor.network is not None:
        return _saved(Policy.from_network(actor.network, interface, name=file), folder)
    return write_described(torch_files.recurrent_as_onnx(actor, interface, file), interface, folder)


def _saved(policy: Policy, folder: Path) -> str:
    target = str(folder / f"{folder.name}.safetensors")
    policy.save(target)
    return target


def find_ports(model: bytes, interface: PolicyInterface, source: str) -> OnnxNetwork:
    """Which inputs and outputs are observation, action and memory, by their sizes and names.

    Raises:
        ConfigError: where that is not clear

    """
    from crossgait.policies.onnx_session import session

    opened = session(model, source)
    observations, actions = len(interface.observation_layout), len(interface.action_layout)
    inputs = {i.name: _size(i.shape) for i in opened.get_inputs()}
    outputs = {o.name: _size(o.shape) for o in opened.get_outputs()}
    observation = _the_one(inputs, observations, ("obs", "observation", "observations"), source, "observation")
    action = _the_one(outputs, actions, ("action", "actions"), source, "action")
    memory: dict[str, str] = {}
    for name in inputs:
        if name == observation:
            continue
        partner = name.removesuffix("_in") + "_out"
        if not name.endswith("_in") or outputs.get(partner) != inputs[name]:
            raise ConfigError(
                source,
                f"input {name}",
                "NAME_in with an output NAME_out of the same size: memory",
                f"outputs {', '.join(outputs)}",
            )
        memory[name] = partner
    return OnnxNetwork(model, observation, action, memory)


def _size(shape: list[Any]) -> int:
    return int(np.prod([dimension if isinstance(dimension, int) else 1 for dimension in shape]))


def _the_one(sizes: dict[str, int], size: int, names: tuple[str, ...], source: str, what: str) -> str:
    fitting = [name for name, own in sizes.items() if own == size]
    named = [name for name in fitting if name in names]
    if len(named) == 1 or len(fitting) == 1:
        return (named or fitting)[0]
    found = ", ".join(f"{name} of {own}" for name, own in sizes.items())
    raise ConfigError(source, what, f"one of {size} numbers, as the environment's {what} has", found)


def write_described(network: OnnxNetwork, interface: PolicyInterface, folder: Path) -> str:
    """Write NAME.onnx and NAME.yaml, which says how it is run; run it once. Returns the latter's path."""
    name = folder.name
    with written_whole(folder / f"{name}.onnx") as beside:
        beside.write_bytes(network.model)
    description: dict[str, Any] = {
        "kind": "onnx",
        "layout_version": LAYOUT_VERSION,
        "layout_hash": interface.layout_hash,
        "policy_dt": interface.policy_dt,
        "network": f"{name}.onnx",
        "observation": network.observation,
        "action": network.action,
    }
    if network.memory:
        description["memory"] = network.memory
    target = folder / f"{name}.yaml"
    with written_whole(target) as beside:
        beside.write_text(write_yaml(description))
    Policy.load(os.fspath(target), interface)
    return os.fspath(target)
