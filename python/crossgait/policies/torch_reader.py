"""The network of a PyTorch module: any nn.Module whose forward pass is a multilayer perceptron, and TorchScript."""

from __future__ import annotations

import copy
import io
import itertools
import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait._core import MlpNetwork
from crossgait.errors import ConfigError
from crossgait.layout import Layout
from crossgait.policies import expression
from crossgait.policies.expression import Affine, FloatArray
from crossgait.policies.network import to_network
from crossgait.policies.place import Place

try:
    import torch
except ImportError as error:
    raise ImportError("PyTorch modules need torch: pip install crossgait[torch]") from error

_FLOATS = (torch.float16, torch.bfloat16, torch.float32, torch.float64)


@dataclass(frozen=True)
class TorchNetwork:
    """What a module holds, and the module itself to compare with."""

    network: MlpNetwork
    half: bool
    run: Callable[[FloatArray], FloatArray]


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


def load_script(file: str | io.BytesIO) -> torch.nn.Module:
    """A TorchScript file. Raises ConfigError."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of TorchScript as such
            module: torch.nn.Module = torch.jit.load(file, map_location="cpu")  # type: ignore[no-untyped-call]
            return module
    except Exception as error:  # of no common type
        Place(str(file), "file").fail("TorchScript, as torch.jit.save writes it", _first_line(error))


def read(
    module: torch.nn.Module, action: Layout, observation: Affine, source: str, output: int | None = None
) -> TorchNetwork:
    """The network of `module`, in evaluation mode.

    Args:
        module: takes [1, obs] and gives [1, act]; from torch.jit.load, too
        action: what it gives
        observation: what it takes, of raw observations: themselves, or normalised outside the module
        source: what stands for the module in messages
        output: which of several outputs is the action

    Raises:
        ConfigError: naming the layer that no bundle can express

    """
    module = _for_evaluation(module)
    dtypes = {p.dtype for p in [*module.parameters(), *module.buffers()] if p.dtype.is_floating_point}
    half = bool(dtypes & {torch.float16, torch.bfloat16})
    dtype = torch.float64 if dtypes == {torch.float64} else next(iter(dtypes)) if half else torch.float32
    example = torch.zeros(1, len(observation), dtype=dtype)
    follow = _follow_script if isinstance(module, torch.jit.ScriptModule) else _follow_export
    place = Place(source, "output")
    found = _chosen(follow(module, example, observation, source), output, place)
    if isinstance(found, ConfigError):
        raise _with_memory(found, module)
    if not isinstance(found, Affine):
        place.fail("a tensor that depends on the observation", "a constant" if found is not None else "nothing")
    base = observation.base
    assert isinstance(base, expression.Observation)

    def run(observations: FloatArray) -> FloatArray:
        given = np.clip((observations - base.mean) / base.std, -base.clip, base.clip)
        try:
            with torch.no_grad():
                rows = [_chosen(module(torch.from_numpy(row[None]).to(dtype)), output, place) for row in given]
        except RuntimeError as error:
            Place(source, "forward").fail(f"a pass from [1, {len(observation)}], {dtype}", _first_line(error))
        return np.array([row.reshape(-1).double().numpy() for row in rows])

    return TorchNetwork(to_network(found, action, place), half, run)


def _for_evaluation(module: torch.nn.Module) -> torch.nn.Module:
    """A copy on the CPU: what it is given stays in training mode, and where it is. What is frozen is in neither."""
    if isinstance(module, torch.jit.ScriptModule):
        written = io.BytesIO()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of TorchScript as such
            torch.jit.save(module, written)
        written.seek(0)
        module = load_script(written)
    else:
        module = copy.deepcopy(module).cpu()
    return module.eval() if hasattr(module, "training") else module


def _chosen(outputs: Any, output: int | None, place: Place) -> Any:
    if not isinstance(outputs, (tuple, list)):
        return outputs
    if output is None and len(outputs) != 1:
        place.fail("one, the action; `output` says which of several", f"{len(outputs)} of them")
    if output is not None and not -len(outputs) <= output < len(outputs):
        place.fail(f"an index of {len(outputs)} outputs", str(output))
    return outputs[output or 0]


def _with_memory(error: ConfigError, module: torch.nn.Module) -> ConfigError:
    """The same, and which layer remembers, if one does: exporters fail far from it."""
    for name, layer in module.named_modules():
        kind = getattr(layer, "original_name", type(layer).__name__)
        if kind.removesuffix("Cell") in ("LSTM", "GRU", "RNN"):
            found = f"{error.found}; bundles have no memory, and layer {name!r} ({kind}) has"
            return ConfigError(error.source, error.element, error.expected, found)
    return error


def _follow_export(module: torch.nn.Module, example: torch.Tensor, observation: Affine, source: str) -> Any:
    try:
        program = torch.export.export(module, (example,), strict=False)
    except Exception as error:  # whatever the forward pass raises
        expected = "a pass that torch.export follows, from [1, obs]"
        raise _with_memory(ConfigError(source, "forward", expected, _first_line(error)), module) from error
    values: dict[str, Any] = {}
    tensors = {**program.state_dict, **program.constants}
    for spec in program.graph_signature.input_specs:
        name = getattr(spec.arg, "name", "")
        values[name] = observation if spec.target is None else _numbers(tensors[spec.target])

    def resolved(argument: Any) -> Any:
        return torch.fx.node.map_arg(argument, lambda node: values[node.name])

    for node in program.graph.nodes:
        if node.op == "output":
            return resolved(node.args[0])
        if node.op == "get_attr":
            values[node.name] = _numbers(getattr(program.graph_module, node.target))
        if node.op != "call_function":
            continue
        if not hasattr(node.target, "_schema"):  # operator.getitem
            of, index = resolved(node.args)
            values[node.name] = of if isinstance(of, ConfigError) else of[index]
            continue
        schema = node.target._schema
        arguments = _bound(schema, resolved(node.args), resolved(node.kwargs))
        place = Place(source, _layer(node))
        call = Call(schema.name.partition("::")[2], arguments, place, _computation(node.target, arguments))
        values[node.name] = _apply(call)
        if call.works_in_place:
            values[node.args[0].name] = values[node.name]
    return None


def _layer(node: torch.fx.Node) -> str:
    """The innermost module that a node is of: "layer 'net.2' (LayerNorm)"."""
    stack = list(node.meta.get("nn_module_stack", {}).values())
    path, kind = stack[-1] if stack else ("", "module")
    kind = getattr(kind, "__name__", str(kind)).rpartition(".")[2]
    return f"layer {path!r} ({kind})" if path else f"forward of {kind}"


def _bound(schema: Any, args: Any, kwargs: Any) -> dict[str, Any]:
    given = dict(zip((a.name for a in schema.arguments), args, strict=False)) | dict(kwargs)
    return {a.name: given.get(a.name, a.default_value) for a in schema.arguments}


def _computation(target: Any, arguments: Mapping[str, Any]) -> Callable[[], Any]:
    def compute() -> Any:
        given = {k: torch.from_numpy(v) if isinstance(v, np.ndarray) else v for k, v in arguments.items()}
        return target(**given)

    return compute


def _follow_script(module: torch.nn.Module, example: torch.Tensor, observation: Affine, source: str) -> Any:
    del example  # the graph is there without running it
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of TorchScript as such
            frozen = torch.jit.freeze(module) if hasattr(module, "training") else module
            graph: Any = frozen.inlined_graph
    except Exception as error:  # of no common type
        Place(source, "forward").fail("TorchScript that can be frozen", _first_line(error))
    inputs = [i for i in graph.inputs() if i.type().kind() != "ClassType"]
    if len(inputs) != 1:
        names = ", ".join(i.debugName().partition(".")[0] for i in inputs)
        Place(source, "inputs").fail("one, the observation; bundles have no memory", f"{len(inputs)}: {names}")
    values: dict[str, Any] = {inputs[0].debugName(): observation}
    for node in graph.nodes():
        outputs = [o.debugName() for o in node.outputs()]
        results = _script_node(node, [values.get(i.debugName()) for i in node.inputs()], len(outputs), source)
        values.update(zip(outputs, results, strict=False))
        if node.kind().startswith("aten::") and node.kind().endswith("_"):  # in place
            values[next(iter(node.inputs())).debugName()] = values[outputs[0]]
    results = [values[o.debugName()] for o in graph.outputs()]
    return results[0] if len(results) == 1 else results


def _script_node(node: Any, inputs: list[Any], count: int, source: str) -> Any:
    kind, _, name = node.kind().partition("::")
    place = Place(source, f"{node.kind()} in {_source_line(node)}")
    if kind == "prim":
        if name == "Constant":
            value = next(iter(node.outputs())).toIValue()
            return [_numbers(value) if isinstance(value, torch.Tensor) else value]
        if name in ("ListConstruct", "TupleConstruct"):
            return [inputs]
        if refused := _refusal(inputs):
            return [refused] * count
        if name in ("ListUnpack", "TupleUnpack"):
            return inputs[0]
        return [
            ConfigError(source, place.element, "straight TorchScript", f"{node.kind()}, decided while it runs")
        ] * count
    schema = torch._C.parse_schema(node.schema())
    result = _apply(Call(name, _bound(schema, inputs, {}), place))
    return [result] * count if isinstance(result, ConfigError) else [result]


def _source_line(node: Any) -> str:
    lines = [line.strip() for line in node.sourceRange().splitlines()]
    marked = [lines[i - 1] for i, line in enumerate(lines) if i and line.startswith("~")]
    return repr(marked[0].removesuffix(" <--- HERE")) if marked else "forward"


def _numbers(tensor: torch.Tensor) -> npt.NDArray[Any]:
    array = tensor.detach().cpu()
    return array.double().numpy() if array.dtype == torch.bfloat16 else array.numpy()


def _first_line(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__


def _is_live(argument: Any) -> bool:
    if isinstance(argument, (list, tuple)):
        return any(_is_live(a) for a in argument)
    return isinstance(argument, Affine)


def _refusal(argument: Any) -> ConfigError | None:
    if isinstance(argument, (list, tuple)):
        return next(filter(None, map(_refusal, argument)), None)
    return argument if isinstance(argument, ConfigError) else None


def _apply(call: Call) -> Any:
    """What a call gives: a value, or the error that using it is, as the action may not depend on it."""
    arguments = list(call.arguments.values())
    if refused := _refusal(arguments):
        return refused
    operation = call.operation.removesuffix("_")
    if not _is_live(arguments) and call.computed and not operation.startswith("rand"):
        result = call.computed()
        return _numbers(result) if isinstance(result, torch.Tensor) else result
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
