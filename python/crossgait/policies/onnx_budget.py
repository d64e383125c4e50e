"""What an ONNX file may cost to read: bytes, nodes, and the constants that it computes."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait.extras import needed_for
from crossgait.files import read_bytes
from crossgait.policies.place import Place

with needed_for("ONNX files", "onnx"):
    import onnx
    import onnx.external_data_helper

MOST_BYTES = 64 << 20  #: of a file, and of the files of weights that it names: eight networks of three layers of 1,000
MOST_NODES = 10_000  #: functions of the model counted where they are called
MOST_NUMBERS = 1 << 22  #: of all constants that nodes compute, together


def load(source: str) -> onnx.ModelProto:
    """Read a model with the weights beside it. Raises ConfigError beyond the budget, and whatever onnx raises."""
    model = onnx.load_model_from_string(read_bytes(source, MOST_BYTES))
    beside = sum(_size(Path(source).parent / name) for name in _files_beside(model))
    if beside > MOST_BYTES:
        Place(source, "external data").fail(f"at most {MOST_BYTES} bytes in regular files", f"{beside:g}")
    onnx.external_data_helper.load_external_data_for_model(model, str(Path(source).parent))
    if (nodes := _count_nodes(model)) > MOST_NODES:
        Place(source, "file").fail(f"at most {MOST_NODES} nodes, with functions unfolded", f"{nodes}")
    return model


def _files_beside(model: onnx.ModelProto) -> set[str]:
    return {
        entry.value
        for tensor in model.graph.initializer
        for entry in tensor.external_data
        if onnx.external_data_helper.uses_external_data(tensor) and entry.key == "location"
    }


def _size(path: Path) -> float:
    return path.stat().st_size if path.is_file() else (math.inf if path.exists() else 0)


def _count_nodes(model: onnx.ModelProto) -> int:
    functions = {(f.domain, f.name): f for f in model.functions}
    counts: dict[tuple[str, str], int] = {}

    def count(nodes: Any) -> int:
        return sum(of_node(node) for node in nodes)

    def of_node(node: onnx.NodeProto) -> int:
        inside = sum(count(a.g.node) + sum(count(g.node) for g in a.graphs) for a in node.attribute)
        name = (node.domain, node.op_type)
        if name not in functions:
            return 1 + inside
        if name not in counts:
            counts[name] = MOST_NODES + 1  # of one that calls itself
            counts[name] = count(functions[name].node)
        return counts[name] + inside

    return count(model.graph.node)


class Constants:
    """Counts the numbers of constants before they are computed."""

    def __init__(self) -> None:
        self._left = MOST_NUMBERS

    def take(self, model: onnx.ModelProto, given: dict[str, npt.NDArray[Any]], place: Place) -> None:
        """Of a model of one node, whose inputs are these. Raises ConfigError if it would compute too much."""
        (node,) = model.graph.node
        if any(a.type in (onnx.AttributeProto.GRAPH, onnx.AttributeProto.GRAPHS) for a in node.attribute):
            place.fail("constants of operations without graphs of their own", node.op_type)
        known = onnx.ModelProto()
        known.CopyFrom(model)
        # Shapes may hang on small inputs; of others the shape is enough.
        del known.graph.input[:]
        for name, value in given.items():
            if value.size <= 64:
                known.graph.initializer.append(onnx.numpy_helper.from_array(np.asarray(value), name))
            else:
                kind = onnx.helper.np_dtype_to_tensor_dtype(value.dtype)
                known.graph.input.append(onnx.helper.make_tensor_value_info(name, kind, value.shape))
        for output in known.graph.output:
            output.ClearField("type")
        inferred = onnx.shape_inference.infer_shapes(known, data_prop=True)
        for output in inferred.graph.output:
            dimensions = output.type.tensor_type.shape.dim
            if not output.type.tensor_type.HasField("shape") or any(not d.HasField("dim_value") for d in dimensions):
                # What depends on the numbers themselves, such as NonZero, has no more places than they.
                self._left -= 8 * sum(value.size for value in given.values()) + 8
            else:
                self._left -= math.prod(d.dim_value for d in dimensions)
        if self._left < 0:
            place.fail(f"at most {MOST_NUMBERS} numbers in all constants that are computed", "more")
