"""The network of an ONNX file, as exporters of PyTorch, TensorFlow, JAX and others write multilayer perceptrons."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait._core import MlpNetwork, PolicyInterface, check_interface
from crossgait.errors import ConfigError
from crossgait.layout import Layout
from crossgait.policies import expression, onnx_budget, onnx_session
from crossgait.policies.expression import Affine, FloatArray
from crossgait.policies.network import check_width, to_network
from crossgait.policies.onnx_operations import FLOATS, OPERATIONS, Live, Node, Value, type_name
from crossgait.policies.place import Place

try:
    import onnx
    import onnx.inliner
    import onnx.numpy_helper
    import onnx.reference
except ImportError as error:
    raise ImportError("ONNX files need onnx and onnxruntime: pip install crossgait[onnx]") from error


_HALVES = (onnx.TensorProto.FLOAT16, onnx.TensorProto.BFLOAT16)


#: What gives other numbers every time, also where nothing comes in.
_RANDOM = ("RandomNormal", "RandomUniform", "RandomNormalLike", "RandomUniformLike", "Bernoulli", "Multinomial")


@dataclass(frozen=True)
class OnnxNetwork:
    """What a file holds, and the file itself to compare with."""

    network: MlpNetwork
    half: bool
    run: Callable[[FloatArray], FloatArray]


def read(
    path: str | os.PathLike[str],
    interface: PolicyInterface,
    observation: Affine,
    output: str | None = None,
) -> OnnxNetwork:
    """The network of `path`.

    Args:
        path: an ONNX file
        interface: what it was trained for
        observation: what the file takes, of raw observations: themselves, or normalised outside the file
        output: which of several outputs is the action

    Raises:
        ConfigError: naming the node that no bundle can express

    """
    source = os.fspath(path)
    try:
        model = onnx_budget.load(source)
        onnx.checker.check_model(model)
        if model.functions:
            model = onnx.inliner.inline_local_functions(model)
    except ConfigError:
        raise
    except Exception as error:  # onnx raises many kinds, among them those of protobuf
        first_line = str(error).strip().splitlines()[:1]
        Place(source, "file").fail("an ONNX model", first_line[0] if first_line else type(error).__name__)
    _check_metadata(model, interface, source)
    reader = _Reader(model, source, interface, observation, output)
    network = to_network(
        reader.action(), Layout.of(interface.action_layout), Place(source, f"output {reader.output!r}")
    )
    return OnnxNetwork(network, reader.half, _Session(source, reader, observation))


def _check_metadata(model: onnx.ModelProto, interface: PolicyInterface, source: str) -> None:
    """What Crossgait wrote into a file of its own has to fit."""
    stated = {p.key.removeprefix("crossgait."): p.value for p in model.metadata_props if p.key.startswith("crossgait.")}
    if not stated:
        return
    try:
        observation_names, action_names = (json.loads(stated[f"{v}_names"]) for v in ("observation", "action"))
        layout_hash, policy_dt = stated["layout_hash"], stated.get("policy_dt")
        check_interface(
            interface,
            observation_names=observation_names,
            action_names=action_names,
            layout_hash=layout_hash,
            policy_dt=None if policy_dt is None else float(policy_dt),
            source=source,
        )
    except ConfigError:
        raise
    except (KeyError, TypeError, ValueError) as error:
        Place(source, "metadata crossgait.*").fail("as Policy.to_onnx writes it", f"{type(error).__name__}: {error}")


class _Session:
    """The file in onnxruntime."""

    def __init__(self, source: str, reader: _Reader, observation: Affine) -> None:
        self.session = onnx_session.session(source, source)
        self.reader = reader
        self.observation = observation

    def __call__(self, observations: FloatArray) -> FloatArray:
        base = self.observation.base
        assert isinstance(base, expression.Observation)
        given = np.clip((observations - base.mean) / base.std, -base.clip, base.clip)
        return np.array([self._row(row) for row in given], dtype=np.float64)

    def _row(self, given: FloatArray) -> npt.NDArray[Any]:
        reader = self.reader
        try:
            action = self.session.run([reader.output], {reader.input: reader.fed(given)})[0]
        except Exception as error:  # of no common type
            Place(reader.source, "file").fail("a model that onnxruntime runs", str(error).strip().splitlines()[0])
        return np.asarray(action).reshape(-1)


class _Reader:
    """Follows a graph from its input to its action."""

    def __init__(
        self, model: onnx.ModelProto, source: str, interface: PolicyInterface, observation: Affine, output: str | None
    ) -> None:
        self.graph = model.graph
        self.source = source
        self.opset = max((o.version for o in model.opset_import if o.domain in ("", "ai.onnx")), default=1)
        self.half = False
        self.values: dict[str, Value] = {}
        self.constants = onnx_budget.Constants()
        for initialiser in self.graph.initializer:
            try:
                self.values[initialiser.name] = onnx.numpy_helper.to_array(initialiser)
            except (KeyError, TypeError, ValueError) as error:
                Place(source, f"initialiser {initialiser.name!r}").fail("numbers", f"{type(error).__name__}: {error}")
        if self.graph.sparse_initializer:
            Place(source, f"initialiser {self.graph.sparse_initializer[0].values.name!r}").fail(
                "a dense one", "a sparse one"
            )
        self.output = self._output(output)
        self.input, rank = self._input(interface)
        self.values[self.input] = Live(observation, rank)

    def _output(self, output: str | None) -> str:
        names = [o.name for o in self.graph.output]
        if output is None and len(names) != 1:
            Place(self.source, "outputs").fail(
                "one, the action; `output` says which of several", ", ".join(names) or "none"
            )
        if output is not None and output not in names:
            Place(self.source, "outputs").fail(f"one named {output!r}", ", ".join(names))
        return output or names[0]

    def _input(self, interface: PolicyInterface) -> tuple[str, int]:
        inputs = [i for i in self.graph.input if i.name not in self.values]
        if len(inputs) != 1:
            names = ", ".join(i.name for i in inputs)
            Place(self.source, "inputs").fail("one, the observation; bundles have no memory", f"{len(inputs)}: {names}")
        tensor = inputs[0].type.tensor_type
        place = Place(self.source, f"input {inputs[0].name!r}")
        if tensor.elem_type not in FLOATS:
            place.fail("floating-point numbers", type_name(tensor.elem_type))
        self.dtype = FLOATS[tensor.elem_type]
        self.half = tensor.elem_type in _HALVES
        # Of a dimension that is not given, 0.
        self.shape = [d.dim_value for d in tensor.shape.dim]
        if not 1 <= len(self.shape) <= 3 or any(d > 1 for d in self.shape[:-1]):
            place.fail("[obs] or [batch, obs], with a batch of 1 or any size", f"{self.shape}")
        layout = Layout.of(interface.observation_layout)
        if self.shape[-1] != 0:
            check_width(self.shape[-1], layout, "observation", place)
        self.shape = [1] * (len(self.shape) - 1) + [len(layout)]
        return inputs[0].name, len(self.shape)

    def fed(self, row: FloatArray) -> npt.NDArray[Any]:
        """One observation as the file takes it."""
        return row.astype(self.dtype).reshape(self.shape)

    def action(self) -> Affine:
        """What the output is."""
        for node in self._needed():
            self._follow(node)
        value = self.values.get(self.output)
        if not isinstance(value, Live):
            Place(self.source, f"output {self.output!r}").fail("what depends on the observation", "a constant")
        return value.value

    def _needed(self) -> list[onnx.NodeProto]:
        """The nodes that the output depends on, in order."""
        wanted, nodes = {self.output}, []
        for node in reversed(self.graph.node):
            if wanted.intersection(node.output):
                nodes.append(node)
                wanted.update(node.input)
        return nodes[::-1]

    def _follow(self, proto: onnx.NodeProto) -> None:
        inputs = [self.values[name] if name else None for name in proto.input]
        node = Node(proto, inputs, self.opset, self.source)
        if proto.domain not in ("", "ai.onnx"):
            node.place.fail("an operation of ONNX itself", f"one of {proto.domain}")
        if not any(isinstance(i, Live) for i in inputs) and proto.op_type not in _RANDOM:
            results: Sequence[Value] = self._computed(node)
        else:
            self.half |= any(isinstance(i, np.ndarray) and i.dtype == np.float16 for i in inputs)
            if proto.op_type not in OPERATIONS:
                node.place.fail(
                    f"an operation of a multilayer perceptron: {', '.join(sorted(OPERATIONS))}", proto.op_type
                )
            result = OPERATIONS[proto.op_type](node)
            results = result if isinstance(result, list) else [result]
        self.half |= proto.op_type == "Cast" and node.attributes["to"] in _HALVES
        self.values.update(zip(proto.output, results, strict=False))

    def _computed(self, node: Node) -> list[npt.NDArray[Any]]:
        """A node of constants alone."""
        proto = node.proto
        names = [name for name in proto.input if name]
        try:
            graph = onnx.helper.make_graph(
                [proto],
                "constants",
                [onnx.helper.make_value_info(name, onnx.TypeProto()) for name in names],
                [onnx.helper.make_value_info(name, onnx.TypeProto()) for name in proto.output if name],
            )
            model = onnx.helper.make_model(graph, opset_imports=[onnx.helper.make_opsetid("", self.opset)])
            given = {name: value for name in names if isinstance(value := self.values[name], np.ndarray)}
            self.constants.take(model, given, node.place)
            outputs = onnx.reference.ReferenceEvaluator(model).run(None, given)
        except ConfigError:
            raise
        except Exception as error:  # whatever an operation raises
            node.place.fail(
                "constants that can be computed", str(error).strip().splitlines()[0] or type(error).__name__
            )
        results = iter(outputs)
        return [np.asarray(next(results)) if name else np.zeros(0) for name in proto.output]
