"""What the operations of PyTorch do to a multilayer perceptron."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait.errors import ConfigError
from crossgait.policies import expression
from crossgait.policies.expression import Affine
from crossgait.policies.place import Place

try:
    import torch
except ImportError as error:
    raise ImportError("PyTorch modules need torch: pip install crossgait[torch]") from error


_FLOATS = (torch.float16, torch.bfloat16, torch.float32, torch.float64)


@dataclass(frozen=True)
class Call:
    """One operation of the forward pass, its arguments by the name that PyTorch gives them."""

    operation: str
    arguments: Mapping[str, Any]
    place: Place
    #: What the arguments that are constants alone give; nothing if it cannot be computed.
    computed: Callable[[], Any] | None = None

    @property
    def works_in_place(self) -> bool:
        """Whether its first argument becomes its result."""
        return self.operation.endswith("_")


def numbers_of(tensor: torch.Tensor) -> npt.NDArray[Any]:
    """A tensor's numbers; NumPy has no bfloat16."""
    array = tensor.detach().cpu()
    return array.double().numpy() if array.dtype == torch.bfloat16 else array.numpy()


def is_live(argument: Any) -> bool:
    """Whether an argument, or any element of it, depends on the observation."""
    if isinstance(argument, (list, tuple)):
        return any(is_live(a) for a in argument)
    return isinstance(argument, Affine)


def refusal(argument: Any) -> ConfigError | None:
    """The first error among arguments."""
    if isinstance(argument, (list, tuple)):
        return next(filter(None, map(refusal, argument)), None)
    return argument if isinstance(argument, ConfigError) else None


def apply(call: Call) -> Any:
    """What a call gives: a value, or the error that using it is, as the action may not depend on it."""
    arguments = list(call.arguments.values())
    if refused := refusal(arguments):
        return refused
    operation = call.operation.removesuffix("_")
    if not is_live(arguments) and call.computed and not operation.startswith("rand"):
        result = call.computed()
        return numbers_of(result) if isinstance(result, torch.Tensor) else result
    try:
        if operation not in _OPERATIONS:
            known = "Linear with Tanh, ELU, ReLU or SiLU between"
            call.place.fail(f"an operation of a multilayer perceptron ({known})", f"aten::{call.operation}")
        return _OPERATIONS[operation](call)
    except ConfigError as error:
        return error


def _value(call: Call, name: str = "self") -> Affine:
    value = call.arguments[name]
    if not isinstance(value, Affine):
        call.place.fail(f"`{name}` of aten::{call.operation} to depend on the observation", "a constant")
    return value


def _constant(call: Call, name: str) -> npt.NDArray[Any]:
    value = call.arguments[name]
    if isinstance(value, Affine) or value is None:
        call.place.fail(f"constant `{name}` of aten::{call.operation}", "what depends on the observation")
    return np.asarray(value)


def _last(call: Call, dim: int, rank: int = 2) -> None:
    """Tensors are [1, n]."""
    if dim not in (-1, rank - 1):
        call.place.fail("dimension -1, along the numbers", f"dimension {dim}")


def _linear(call: Call) -> Affine:
    bias = None if call.arguments["bias"] is None else _constant(call, "bias")
    return expression.linear(_value(call, "input"), _constant(call, "weight"), bias, call.place)


def _addmm(call: Call) -> Affine:
    weight = _constant(call, "mat2").astype(np.float64) * call.arguments["alpha"]
    bias = _constant(call, "self").astype(np.float64) * call.arguments["beta"]
    return expression.linear(_value(call, "mat1"), weight.T, bias, call.place)


def _matmul(call: Call) -> Affine:
    weight = _constant(call, "mat2" if "mat2" in call.arguments else "other")
    return expression.linear(_value(call), weight.T, None, call.place)


def _sum(call: Call, sign: float) -> Affine:
    a, b, alpha = call.arguments["self"], call.arguments["other"], call.arguments.get("alpha", 1)
    if isinstance(a, Affine) and isinstance(b, Affine):
        return expression.combine(a, b, sign * alpha, call.place)
    if isinstance(a, Affine):
        return expression.add(a, sign * alpha * np.asarray(b, dtype=np.float64), call.place)
    scaled = expression.multiply(_value(call, "other"), sign * alpha, call.place)
    return expression.add(scaled, a, call.place)


def _rsub(call: Call) -> Affine:
    scaled = expression.multiply(_value(call), -float(call.arguments["alpha"]), call.place)
    return expression.add(scaled, _constant(call, "other"), call.place)


def _product(call: Call) -> Affine:
    a, b = call.arguments["self"], call.arguments["other"]
    if isinstance(a, Affine) and isinstance(b, Affine):
        return expression.product(a, b, call.place)
    return expression.multiply(a, b, call.place) if isinstance(a, Affine) else expression.multiply(b, a, call.place)


def _quotient(call: Call) -> Affine:
    if call.arguments.get("rounding_mode") is not None:
        call.place.fail("no rounding", str(call.arguments["rounding_mode"]))
    return expression.divide(_value(call), _constant(call, "other"), call.place)


def _elu(call: Call) -> Affine:
    for name in ("alpha", "scale", "input_scale"):
        if call.arguments[name] != 1:
            call.place.fail(f"{name} 1", f"{call.arguments[name]:g}")
    return expression.activate("elu", _value(call), call.place)


def _activation(function: str) -> Callable[[Call], Affine]:
    return lambda call: expression.activate(function, _value(call), call.place)


def _clamp(low: str, high: str) -> Callable[[Call], Affine]:
    def clamp(call: Call) -> Affine:
        limits = [call.arguments.get(name) for name in (low, high)]
        numbers = [
            bound if limit is None else np.asarray(limit)
            for limit, bound in zip(limits, (-math.inf, math.inf), strict=True)
        ]
        return expression.clip(_value(call), numbers[0], numbers[1], call.place)

    return clamp


def _parts(sizes: list[int], value: Affine, call: Call) -> list[Affine]:
    ends = np.cumsum([0, *sizes])
    if ends[-1] != len(value):
        call.place.fail(f"parts of {len(value)} numbers", f"{sizes}")
    return [expression.take(value, np.arange(a, b), call.place) for a, b in itertools.pairwise(ends)]


def _sizes(size: int, each: int) -> list[int]:
    return [min(each, size - start) for start in range(0, size, each)]


def _chunk(call: Call) -> list[Affine]:
    _last(call, call.arguments["dim"])
    value = _value(call)
    return _parts(_sizes(len(value), math.ceil(len(value) / call.arguments["chunks"])), value, call)


def _split(call: Call) -> list[Affine]:
    _last(call, call.arguments["dim"])
    value = _value(call)
    sizes = call.arguments["split_sizes"] if "split_sizes" in call.arguments else call.arguments["split_size"]
    return _parts(list(sizes) if isinstance(sizes, (list, tuple)) else _sizes(len(value), sizes), value, call)


def _slice(call: Call) -> Affine:
    start, end, step = (call.arguments[name] for name in ("start", "end", "step"))
    if call.arguments["dim"] in (0, -2) and not start and (end is None or end >= 1):
        return _value(call)
    _last(call, call.arguments["dim"])
    value = _value(call)
    return expression.take(value, np.arange(len(value))[slice(start, end, step)], call.place)


def _narrow(call: Call) -> Affine:
    _last(call, call.arguments["dim"])
    start = int(call.arguments["start"])
    return expression.take(_value(call), np.arange(start, start + call.arguments["length"]), call.place)


def _index_select(call: Call) -> Affine:
    _last(call, call.arguments["dim"])
    return expression.take(_value(call), _constant(call, "index"), call.place)


def _index(call: Call) -> Affine:
    indices = list(call.arguments["indices"])
    if len(indices) != 2 or indices[0] is not None or not isinstance(indices[1], np.ndarray):
        call.place.fail("indices along the numbers", "others")
    return expression.take(_value(call), indices[1], call.place)


def _cat(call: Call) -> Affine:
    _last(call, call.arguments["dim"])
    tensors = list(call.arguments["tensors"])
    if not all(isinstance(t, Affine) for t in tensors):
        call.place.fail("parts of one layer", "constants among them")
    return expression.concatenate(tensors, call.place)


def _shaped(call: Call) -> Affine:
    value, shape = _value(call), [int(s) for s in call.arguments.get("size", call.arguments.get("shape", ()))]
    if len(shape) > 2 or shape[-1] not in (-1, len(value)) or any(s not in (-1, 1) for s in shape[:-1]):
        call.place.fail(f"a shape that keeps [1, {len(value)}]", f"{shape}")
    return value


def _to(call: Call) -> Affine:
    dtype = call.arguments.get("dtype")
    if isinstance(dtype, torch.dtype) and dtype not in _FLOATS:
        call.place.fail("a floating-point type", str(dtype))
    return _value(call)


def _dropout(call: Call) -> Affine:
    if call.arguments["train"]:
        call.place.fail("evaluation mode", "training mode")
    return _value(call, "input")


def _batch_norm(call: Call) -> Affine:
    if call.arguments.get("training"):
        call.place.fail("evaluation mode", "training mode")
    mean, variance = (_constant(call, n).astype(np.float64) for n in ("running_mean", "running_var"))
    value = expression.add(_value(call, "input"), -mean, call.place)
    value = expression.divide(value, np.sqrt(variance + call.arguments["eps"]), call.place)
    if call.arguments["weight"] is not None:
        value = expression.multiply(value, _constant(call, "weight"), call.place)
        value = expression.add(value, _constant(call, "bias"), call.place)
    return value


#: By the name that PyTorch gives an operation, without the underscore of those that work in place.
_OPERATIONS: dict[str, Callable[[Call], Any]] = {
    **dict.fromkeys(("alias", "clone", "contiguous", "detach"), _value),
    "flatten": _value,  # of [1, n]
    **dict.fromkeys(("reshape", "view", "_unsafe_view"), _shaped),
    **dict.fromkeys(("to", "_to_copy", "float", "double"), _to),
    **dict.fromkeys(("dropout", "feature_dropout", "alpha_dropout"), _dropout),
    **dict.fromkeys(("clamp", "clip"), _clamp("min", "max")),
    **dict.fromkeys(("mm", "matmul"), _matmul),
    **dict.fromkeys(("split", "split_with_sizes"), _split),
    **dict.fromkeys(("div", "divide", "true_divide"), _quotient),
    **dict.fromkeys(("mul", "multiply"), _product),
    **dict.fromkeys(("sub", "subtract"), lambda call: _sum(call, -1)),
    "_assert_tensor_metadata": lambda call: None,
    "add": lambda call: _sum(call, 1),
    "addmm": _addmm,
    "batch_norm": _batch_norm,
    "cat": _cat,
    "chunk": _chunk,
    "clamp_max": _clamp("", "max"),
    "clamp_min": _clamp("min", ""),
    "elu": _elu,
    "hardtanh": _clamp("min_val", "max_val"),
    "index": _index,
    "index_select": _index_select,
    "linear": _linear,
    "narrow": _narrow,
    "neg": lambda call: expression.multiply(_value(call), -1.0, call.place),
    "relu": _activation("relu"),
    "rsub": _rsub,
    "sigmoid": _activation("sigmoid"),
    "silu": _activation("swish"),
    "slice": _slice,
    "tanh": _activation("tanh"),
}
