"""Networks and files that tests of policies share."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np

import crossgait
from crossgait.policies import MlpNetwork

JOINTS = crossgait.EnvironmentConfig(action="joints")
OBSERVATIONS, ACTIONS = 48, 12


def random_layers(sizes: list[int], seed: int = 3) -> list[tuple[np.ndarray, np.ndarray]]:
    """(weight [out, in], bias), representable in single precision; actions well inside their bounds."""
    rng = np.random.default_rng(seed)
    layers = []
    for inputs, outputs in itertools.pairwise(sizes):
        weight = rng.normal(0, 0.7 / np.sqrt(inputs), (outputs, inputs)).astype(np.float32).astype(np.float64)
        layers.append((weight, rng.normal(0, 0.1, outputs).astype(np.float32).astype(np.float64)))
    return layers


def random_normalisation(seed: int = 5) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    mean = rng.normal(0, 1, OBSERVATIONS).astype(np.float32).astype(np.float64)
    return mean, rng.uniform(0.3, 2, OBSERVATIONS).astype(np.float32).astype(np.float64)


def random_network(activation: str = "elu", output: str = "linear", clip: float | None = 5.0) -> MlpNetwork:
    return MlpNetwork(
        random_layers([OBSERVATIONS, 24, 16, ACTIONS]),
        activation=activation,
        output=output,
        normalisation=random_normalisation(),
        clip=clip,
    )


class OnnxFile:
    """An ONNX graph, node by node."""

    def __init__(self) -> None:
        import onnx

        self.onnx = onnx
        self.nodes: list[Any] = []
        self.initialisers: list[Any] = []

    def constant(self, name: str, numbers: Any) -> str:
        self.initialisers.append(self.onnx.numpy_helper.from_array(np.array(numbers, order="C"), name))
        return name

    def node(self, op: str, inputs: list[str], output: str | list[str], **attributes: Any) -> Any:
        outputs = [output] if isinstance(output, str) else output
        self.nodes.append(self.onnx.helper.make_node(op, inputs, outputs, name=f"{op}_{outputs[0]}", **attributes))
        return output

    def write(
        self,
        path: Path,
        *,
        opset: int = 17,
        batch: Any = 1,
        inputs: dict[str, int] | None = None,
        outputs: dict[str, int] | None = None,
        element: Any = None,
        rank: int = 2,
    ) -> Path:
        make, element = self.onnx.helper, element or self.onnx.TensorProto.FLOAT
        lead = [batch] * (rank - 1)
        tensors = [
            [make.make_tensor_value_info(name, element, [*lead, size]) for name, size in given.items()]
            for given in (inputs or {"obs": OBSERVATIONS}, outputs or {"action": ACTIONS})
        ]
        graph = make.make_graph(self.nodes, "graph", *tensors, self.initialisers)
        model = make.make_model(graph, opset_imports=[make.make_opsetid("", opset)], ir_version=8)
        self.onnx.save(model, path)
        return path
