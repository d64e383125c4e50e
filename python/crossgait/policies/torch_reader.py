"""The network of a PyTorch module: any nn.Module whose forward pass is a multilayer perceptron, and TorchScript."""

from __future__ import annotations

import copy
import io
import warnings
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from crossgait._core import MlpNetwork
from crossgait.consent import require_consent
from crossgait.errors import ConfigError
from crossgait.files import CHECKPOINT_BYTES, read_bytes
from crossgait.layout import Layout
from crossgait.policies import expression
from crossgait.policies.expression import Affine, FloatArray
from crossgait.policies.network import to_network
from crossgait.policies.place import Place
from crossgait.policies.torch_operations import Call, apply, numbers_of, refusal

try:
    import torch
except ImportError as error:
    raise ImportError("PyTorch modules need torch: pip install crossgait[torch]") from error


@dataclass(frozen=True)
class TorchNetwork:
    """What a module holds, and the module itself to compare with."""

    network: MlpNetwork
    half: bool
    run: Callable[[FloatArray], FloatArray]


def holds_code(archive: zipfile.ZipFile) -> bool:
    """Whether a zip of PyTorch's is TorchScript; a checkpoint has none."""
    return any("/code/" in name or name.endswith("constants.pkl") for name in archive.namelist())


def _is_checkpoint(file: io.BytesIO) -> bool:
    if not zipfile.is_zipfile(file):
        return False
    with zipfile.ZipFile(file) as archive:
        found = any(name.endswith("data.pkl") for name in archive.namelist()) and not holds_code(archive)
    file.seek(0)
    return found


def load_script(file: str | io.BytesIO) -> torch.nn.Module:
    """A TorchScript file. Raises ConfigError, also without consent to what it runs."""
    source = str(file)
    if isinstance(file, str):
        require_consent(file, "PyTorch's interpreter runs TorchScript")
        file = io.BytesIO(read_bytes(file, CHECKPOINT_BYTES))
        if _is_checkpoint(file):
            expected = "TorchScript, as torch.jit.save writes it; checkpoints are read by crossgait.import_policy"
            raise ConfigError(source, "file", expected, "weights alone, as torch.save writes them")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of TorchScript as such
            module: torch.nn.Module = torch.jit.load(file, map_location="cpu")  # type: ignore[no-untyped-call]
            return module
    except Exception as error:  # of no common type
        Place(source, "file").fail("TorchScript, as torch.jit.save writes it", _first_line(error))


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
    if not isinstance(module, torch.nn.Module):
        raise ConfigError(source, "module", "an nn.Module, or the file of a TorchScript module", source)
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
        values[name] = observation if spec.target is None else numbers_of(tensors[spec.target])

    def resolved(argument: Any) -> Any:
        return torch.fx.node.map_arg(argument, lambda node: values[node.name])

    for node in program.graph.nodes:
        if node.op == "output":
            return resolved(node.args[0])
        if node.op == "get_attr":
            values[node.name] = numbers_of(getattr(program.graph_module, node.target))
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
        values[node.name] = apply(call)
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
            return [numbers_of(value) if isinstance(value, torch.Tensor) else value]
        if name in ("ListConstruct", "TupleConstruct"):
            return [inputs]
        if refused := refusal(inputs):
            return [refused] * count
        if name in ("ListUnpack", "TupleUnpack"):
            return inputs[0]
        return [
            ConfigError(source, place.element, "straight TorchScript", f"{node.kind()}, decided while it runs")
        ] * count
    schema = torch._C.parse_schema(node.schema())
    result = apply(Call(name, _bound(schema, inputs, {}), place))
    return [result] * count if isinstance(result, ConfigError) else [result]


def _source_line(node: Any) -> str:
    lines = [line.strip() for line in node.sourceRange().splitlines()]
    marked = [lines[i - 1] for i, line in enumerate(lines) if i and line.startswith("~")]
    return repr(marked[0].removesuffix(" <--- HERE")) if marked else "forward"


def _first_line(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__
