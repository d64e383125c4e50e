"""What the operations of ONNX do to a multilayer perceptron."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait.policies import expression
from crossgait.policies.expression import Affine
from crossgait.policies.place import Place

try:
    import onnx
    import onnx.inliner
    import onnx.numpy_helper
    import onnx.reference
except ImportError as error:
    raise ImportError("ONNX files need onnx and onnxruntime: pip install crossgait[onnx]") from error


FLOATS = {
    onnx.TensorProto.FLOAT: np.float32,
    onnx.TensorProto.DOUBLE: np.float64,
    onnx.TensorProto.FLOAT16: np.float16,
}


def type_name(number: int) -> str:
    """What ONNX calls a type of elements, or that it has none of this number."""
    types = onnx.TensorProto.DataType
    return str(types.Name(number)) if number in types.values() else f"type {number}, which ONNX has not"


@dataclass(frozen=True)
class Live:
    """A tensor that depends on the observation: its last dimension is `value`, and `rank - 1` of size 1 precede it."""

    value: Affine
    rank: int


Value = Live | npt.NDArray[Any]


class Node:
    """One node with what comes in."""

    def __init__(self, proto: onnx.NodeProto, inputs: list[Value | None], opset: int, source: str) -> None:
        self.proto = proto
        self.op = proto.op_type
        self.inputs = inputs
        self.opset = opset
        self.attributes = {a.name: onnx.helper.get_attribute_value(a) for a in proto.attribute}
        name = proto.name or (proto.output[0] if proto.output else "")
        self.place = Place(source, f"node {name!r} ({proto.op_type})")

    def input(self, index: int) -> Value | None:
        """The input of this index; None where there is none."""
        return self.inputs[index] if index < len(self.inputs) else None

    def live(self, index: int = 0) -> Live:
        """The same, which has to depend on the observation. Raises ConfigError."""
        value = self.input(index)
        if not isinstance(value, Live):
            self.place.fail(f"the observation's part in input {index}", "a constant")
        return value

    def constant(self, index: int, what: str) -> npt.NDArray[Any]:
        """The same, which has to be a constant. Raises ConfigError naming `what`."""
        value = self.input(index)
        if not isinstance(value, np.ndarray):
            self.place.fail(f"constant {what}", "none" if value is None else "what depends on the observation")
        return value

    def setting(self, index: int, attribute: str, what: str) -> npt.NDArray[Any] | None:
        """An input, or the attribute that it was in earlier opsets; None if there is neither."""
        if self.input(index) is not None:
            return self.constant(index, what)
        if attribute in self.attributes:
            return np.asarray(self.attributes[attribute])
        return None

    def last_axis(self, axis: int, rank: int) -> None:
        """Refuses any axis but the last."""
        if axis not in (-1, rank - 1):
            self.place.fail(f"axis {rank - 1} or -1, along the numbers", f"axis {axis}")

    def expect(self, attribute: str, expected: float, default: float) -> None:
        """Refuses any other value of an attribute."""
        found = self.attributes.get(attribute, default)
        if found != expected:
            self.place.fail(f"{attribute} {expected:g}", f"{found:g}")


def _gemm(node: Node) -> Live:
    live, attributes = node.live(), node.attributes
    node.expect("transA", 0, 0)
    weight = node.constant(1, "weights").astype(np.float64) * attributes.get("alpha", 1.0)
    bias = (
        node.constant(2, "biases").astype(np.float64) * attributes.get("beta", 1.0)
        if node.input(2) is not None
        else None
    )
    matrix = weight if attributes.get("transB", 0) else weight.T
    return Live(expression.linear(live.value, matrix, bias, node.place), live.rank)


def _matmul(node: Node) -> Live:
    if isinstance(node.input(0), Live):
        live, weight = node.live(0), node.constant(1, "weights")
        if weight.size != math.prod(weight.shape[-2:]):
            node.place.fail("one matrix of weights", f"shape {list(weight.shape)}")
        matrix = weight.reshape(weight.shape[-2:]).T
        return Live(expression.linear(live.value, matrix, None, node.place), _rank_with(live, weight))
    live = node.live(1)
    if live.rank != 1:
        node.place.fail("weights after the observation", "weights before it")
    return Live(expression.linear(live.value, node.constant(0, "weights"), None, node.place), live.rank)


def _rank_with(live: Live, other: npt.NDArray[Any]) -> int:
    return max(live.rank, other.ndim)


def _add(node: Node) -> Live:
    a, b = node.input(0), node.input(1)
    if isinstance(a, Live) and isinstance(b, Live):
        return Live(expression.combine(a.value, b.value, 1, node.place), max(a.rank, b.rank))
    live, numbers = (
        (node.live(0), node.constant(1, "summand")) if isinstance(a, Live) else (node.live(1), node.constant(0, ""))
    )
    return Live(expression.add(live.value, numbers, node.place), _rank_with(live, numbers))


def _subtract(node: Node) -> Live:
    a, b = node.input(0), node.input(1)
    if isinstance(a, Live) and isinstance(b, Live):
        return Live(expression.combine(a.value, b.value, -1, node.place), max(a.rank, b.rank))
    if isinstance(a, Live):
        numbers = node.constant(1, "subtrahend")
        return Live(expression.add(a.value, -numbers.astype(np.float64), node.place), _rank_with(a, numbers))
    numbers, live = node.constant(0, "minuend"), node.live(1)
    negative = expression.multiply(live.value, -1.0, node.place)
    return Live(expression.add(negative, numbers, node.place), _rank_with(live, numbers))


def _multiply(node: Node) -> Live:
    a, b = node.input(0), node.input(1)
    if isinstance(a, Live) and isinstance(b, Live):
        return Live(expression.product(a.value, b.value, node.place), max(a.rank, b.rank))
    live, numbers = (
        (node.live(0), node.constant(1, "factor")) if isinstance(a, Live) else (node.live(1), node.constant(0, ""))
    )
    return Live(expression.multiply(live.value, numbers, node.place), _rank_with(live, numbers))


def _divide(node: Node) -> Live:
    live, numbers = node.live(0), node.constant(1, "divisor")
    return Live(expression.divide(live.value, numbers, node.place), _rank_with(live, numbers))


def _negate(node: Node) -> Live:
    live = node.live()
    return replace(live, value=expression.multiply(live.value, -1.0, node.place))


def _activation(function: str, **settings: float) -> Callable[[Node], Live]:
    def activate(node: Node) -> Live:
        for attribute, expected in settings.items():
            node.expect(attribute, expected, expected)
        live = node.live()
        return replace(live, value=expression.activate(function, live.value, node.place))

    return activate


def _limits(low: npt.ArrayLike | None, high: npt.ArrayLike | None, node: Node, live: Live) -> Live:
    bounds = (-math.inf if low is None else low, math.inf if high is None else high)
    return replace(live, value=expression.clip(live.value, *bounds, node.place))


def _clip(node: Node) -> Live:
    return _limits(node.setting(1, "min", "limits"), node.setting(2, "max", "limits"), node, node.live())


def _extreme(node: Node) -> Live:
    if len(node.inputs) != 2:
        node.place.fail("two inputs", str(len(node.inputs)))
    index = 0 if isinstance(node.input(0), Live) else 1
    limit = node.constant(1 - index, "limit")
    low, high = (limit, None) if node.op == "Max" else (None, limit)
    return _limits(low, high, node, node.live(index))


def _unchanged(node: Node) -> Live:
    return node.live()


def _cast(node: Node) -> Live:
    if node.attributes["to"] not in (*FLOATS, onnx.TensorProto.BFLOAT16):
        node.place.fail("a floating-point type", type_name(node.attributes["to"]))
    return node.live()


def _dropout(node: Node) -> list[Value]:
    training = node.input(2)
    if training is not None and bool(np.asarray(node.constant(2, "training mode")).any()):
        node.place.fail("inference", "training mode")
    return [node.live()]


def _flatten(node: Node) -> Live:
    live = node.live()
    axis = node.attributes.get("axis", 1) % (live.rank + 1)
    # The dimensions before the last are of size 1, so that any axis up to it gives [1, n].
    if axis == live.rank:
        node.place.fail(f"an axis before {live.rank}", str(axis))
    return Live(live.value, 2)


def _reshape(node: Node) -> Live:
    live, shape = node.live(), node.constant(1, "shape").astype(int).tolist()
    last = shape[-1] if shape else 0
    if last == 0 and not node.attributes.get("allowzero", 0) and len(shape) == live.rank:
        last = len(live.value)
    if last not in (-1, len(live.value)) or any(d not in (-1, 0, 1) for d in shape[:-1]):
        node.place.fail(f"a shape that keeps the {len(live.value)} numbers together", f"{shape}")
    return Live(live.value, len(shape))


def _squeeze(node: Node) -> Live:
    live, axes = node.live(), node.setting(1, "axes", "axes")
    count = live.rank - 1 if axes is None else axes.size
    if axes is not None and any(int(a) in (-1, live.rank - 1) for a in axes.reshape(-1)):
        node.place.fail("axes before the last", f"{axes.reshape(-1).tolist()}")
    return Live(live.value, live.rank - count)


def _unsqueeze(node: Node) -> Live:
    live, axes = node.live(), node.setting(1, "axes", "axes")
    added = [] if axes is None else axes.astype(int).reshape(-1).tolist()
    rank = live.rank + len(added)
    if any(a % rank == rank - 1 for a in added):
        node.place.fail("axes before the last", f"{added}")
    return Live(live.value, rank)


def _transpose(node: Node) -> Live:
    live = node.live()
    permutation = list(node.attributes.get("perm", range(live.rank)[::-1]))
    if permutation[-1] != live.rank - 1:
        node.place.fail("an order that keeps the last axis", f"{permutation}")
    return live


def _shape(node: Node) -> npt.NDArray[np.int64]:
    live = node.live()
    shape = np.array([1] * (live.rank - 1) + [len(live.value)], dtype=np.int64)
    return shape[slice(node.attributes.get("start", 0), node.attributes.get("end"))]


def _split(node: Node) -> list[Value]:
    live = node.live()
    node.last_axis(node.attributes.get("axis", 0), live.rank)
    size, count = len(live.value), len(node.proto.output)
    given = node.setting(1, "split", "sizes")
    each = math.ceil(size / count)
    sizes = [min(each, size - i * each) for i in range(count)] if given is None else given.astype(int).tolist()
    ends = np.cumsum([0, *sizes])
    if len(sizes) != count or ends[-1] != size or min(sizes) < 1:
        node.place.fail(f"parts of {size} numbers", f"{sizes}")
    parts = [np.arange(a, b) for a, b in itertools.pairwise(ends)]
    return [Live(expression.take(live.value, part, node.place), live.rank) for part in parts]


def _slice(node: Node) -> Live:
    live = node.live()
    starts, ends = node.setting(1, "starts", "starts"), node.setting(2, "ends", "ends")
    if starts is None or ends is None:
        node.place.fail("starts and ends", "none")
    axes, steps = node.setting(3, "axes", "axes"), node.setting(4, "steps", "steps")
    value = live.value
    for i, (start, end) in enumerate(zip(starts.astype(int).tolist(), ends.astype(int).tolist(), strict=True)):
        axis = i if axes is None else int(axes[i])
        step = 1 if steps is None else int(steps[i])
        if axis not in (-1, live.rank - 1):
            if (start, step) != (0, 1) or end < 1:
                node.last_axis(axis, live.rank)
            continue
        chosen = slice(start, None if step < 0 and end < -len(value) else end, step)
        value = expression.take(value, np.arange(len(value))[chosen], node.place)
    return Live(value, live.rank)


def _gather(node: Node) -> Live:
    live, indices = node.live(), node.constant(1, "indices")
    axis = node.attributes.get("axis", 0)
    if axis in (0, -live.rank) and live.rank > 1 and indices.size == 1 and not indices.any():
        return Live(live.value, live.rank - 1 + indices.ndim)  # the only one of the batch
    node.last_axis(axis, live.rank)
    if indices.ndim != 1:
        node.place.fail("a list of indices", f"indices of shape {list(indices.shape)}")
    return Live(expression.take(live.value, indices.astype(np.int64), node.place), live.rank)


def _concat(node: Node) -> Live:
    parts = [node.live(i) for i in range(len(node.inputs))]
    node.last_axis(node.attributes["axis"], parts[0].rank)
    return Live(expression.concatenate([p.value for p in parts], node.place), parts[0].rank)


def _batch_normalisation(node: Node) -> Live:
    node.expect("training_mode", 0, 0)
    scale, shift, mean, variance = (
        expression.constant(node.constant(i, "statistics"), node.place) for i in (1, 2, 3, 4)
    )
    live = node.live()
    value = expression.add(live.value, -mean, node.place)
    value = expression.divide(value, np.sqrt(variance + node.attributes.get("epsilon", 1e-5)), node.place)
    return replace(live, value=expression.add(expression.multiply(value, scale, node.place), shift, node.place))


OPERATIONS: dict[str, Callable[[Node], Value | list[Value]]] = {
    "Add": _add,
    "BatchNormalization": _batch_normalisation,
    "Cast": _cast,
    "Clip": _clip,
    "Concat": _concat,
    "Div": _divide,
    "Dropout": _dropout,
    "Elu": _activation("elu", alpha=1),
    "Flatten": _flatten,
    "Gather": _gather,
    "Gemm": _gemm,
    "Identity": _unchanged,
    "MatMul": _matmul,
    "Max": _extreme,
    "Min": _extreme,
    "Mul": _multiply,
    "Neg": _negate,
    "Relu": _activation("relu"),
    "Reshape": _reshape,
    "Shape": _shape,
    "Sigmoid": _activation("sigmoid"),
    "Slice": _slice,
    "Split": _split,
    "Squeeze": _squeeze,
    "Sub": _subtract,
    "Swish": _activation("swish", alpha=1),
    "Tanh": _activation("tanh"),
    "Transpose": _transpose,
    "Unsqueeze": _unsqueeze,
}
