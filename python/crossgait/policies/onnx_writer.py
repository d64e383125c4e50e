"""A bundle's network as an ONNX file, for robots and programs that run those."""

from __future__ import annotations

import json
import os
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait._core import LAYOUT_VERSION, PolicyBundle
from crossgait.errors import ConfigError
from crossgait.files import written_whole
from crossgait.layout import Layout
from crossgait.policies import onnx_session

try:
    import onnx
    import onnx.helper as make
    import onnx.numpy_helper
except ImportError as error:
    raise ImportError("ONNX files need onnx and onnxruntime: pip install crossgait[onnx]") from error

#: Old enough for the runtimes of robots, and the first with limits of Clip as inputs of every type is 12.
OPSET = 13
_IR_VERSION = 8  # of that opset's time, which older runtimes read


def to_model(bundle: PolicyBundle, action: Layout) -> onnx.ModelProto:
    """`observation` [batch, obs] -> `action` [batch, act], single precision, clipped to the action's bounds.

    The observation is normalised in double precision, as everywhere in Crossgait.
    """
    graph = _Graph()
    network = bundle.network
    x = "observation"
    if network.normalisation or network.clip:
        x = graph.node("Cast", [x], to=onnx.TensorProto.DOUBLE)
        if network.normalisation:
            mean, std = network.normalisation
            x = graph.node("Sub", [x, graph.constant("observation.mean", mean)])
            x = graph.node("Div", [x, graph.constant("observation.std", std)])
        if network.clip:
            limits = [
                graph.constant(f"observation.{n}", np.array(s * network.clip)) for n, s in (("low", -1), ("high", 1))
            ]
            x = graph.node("Clip", [x, *limits])
        x = graph.node("Cast", [x], to=onnx.TensorProto.FLOAT)
    for k, (weight, bias) in enumerate(network.layers):
        parameters = [
            graph.constant(f"layer.{k}.weight", weight.astype(np.float32)),
            graph.constant(f"layer.{k}.bias", bias.astype(np.float32)),
        ]
        x = graph.node("Gemm", [x, *parameters], transB=1)
        if k + 1 < len(network.layers):
            x = graph.activation(network.activation, x)
    if network.output == "tanh":
        x = graph.node("Tanh", [x])
    graph.limited(x, action)
    tensors = [
        make.make_tensor_value_info(name, onnx.TensorProto.FLOAT, ["batch", size])
        for name, size in (("observation", len(bundle.observation_names)), ("action", len(bundle.action_names)))
    ]
    made = make.make_graph(graph.nodes, "policy", tensors[:1], tensors[1:], graph.constants)
    model = make.make_model(
        made, producer_name="crossgait", opset_imports=[make.make_opsetid("", OPSET)], ir_version=_IR_VERSION
    )
    make.set_model_props(model, _metadata(bundle))
    onnx.checker.check_model(model)
    return model


def run(model: onnx.ModelProto, observations: npt.NDArray[np.float32], source: str) -> npt.NDArray[np.float64]:
    """What onnxruntime makes of [n, obs]. Raises ConfigError."""
    session = onnx_session.session(model.SerializeToString(), source)
    return np.asarray(session.run(["action"], {"observation": observations})[0], dtype=np.float64)


def write(model: onnx.ModelProto, path: str | os.PathLike[str]) -> None:
    """Write the whole file or nothing. Raises ConfigError."""
    try:
        with written_whole(path) as file:
            file.write_bytes(model.SerializeToString())
    except OSError as error:
        raise ConfigError(
            os.fspath(path), "file", "a place that can be written", error.strerror or str(error)
        ) from error


def _metadata(bundle: PolicyBundle) -> dict[str, str]:
    metadata = {
        "crossgait.observation_names": json.dumps(bundle.observation_names),
        "crossgait.action_names": json.dumps(bundle.action_names),
        "crossgait.layout_version": str(LAYOUT_VERSION),
        "crossgait.layout_hash": bundle.layout_hash,
    }
    if bundle.policy_dt is not None:
        metadata["crossgait.policy_dt"] = repr(bundle.policy_dt)
    return metadata


class _Graph:
    def __init__(self) -> None:
        self.nodes: list[onnx.NodeProto] = []
        self.constants: list[onnx.TensorProto] = []

    def constant(self, name: str, numbers: npt.NDArray[Any]) -> str:
        self.constants.append(onnx.numpy_helper.from_array(np.ascontiguousarray(numbers), name))
        return name

    def node(self, op: str, inputs: list[str], output: str | None = None, **attributes: Any) -> str:
        output = output or f"{op.lower()}_{len(self.nodes)}"
        self.nodes.append(make.make_node(op, inputs, [output], name=f"/{output}", **attributes))
        return output

    def activation(self, function: str, x: str) -> str:
        if function == "swish":  # an operation of its own since opset 24
            return self.node("Mul", [x, self.node("Sigmoid", [x])])
        return self.node({"tanh": "Tanh", "elu": "Elu", "relu": "Relu"}[function], [x])

    def limited(self, x: str, action: Layout) -> None:
        """The action, within its bounds."""
        low, high = (bound.astype(np.float32) for bound in (action.low, action.high))
        if (low == low[0]).all() and (high == high[0]).all():
            limits = [self.constant("action.low", low[0]), self.constant("action.high", high[0])]
            self.node("Clip", [x, *limits], "action")
            return
        x = self.node("Max", [x, self.constant("action.low", low)])
        self.node("Min", [x, self.constant("action.high", high)], "action")
