"""TorchScript that remembers, as a function of its memory: what its buffers hold goes in and comes out."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import torch

from crossgait.policies.place import Place

_TO_THE_END = 2**63 - 1


class ScriptWithMemory(torch.nn.Module):
    """The forward pass of a TorchScript module, operation by operation, on buffers that are given."""

    def __init__(self, script: torch.jit.ScriptModule, memory: list[str], source: str) -> None:
        super().__init__()
        self.script, self.memory, self.source = script, memory, source

    def forward(self, observation: torch.Tensor, *memory: torch.Tensor) -> tuple[torch.Tensor, ...]:
        """The action, and the memory after it."""
        run = _Run(self.script, dict(zip(self.memory, memory, strict=True)), self.source)
        graph = self.script.inlined_graph
        own, given, *more = graph.inputs()
        if more:
            Place(self.source, "forward").fail("one input, the observation", f"{len(more) + 1}")
        run.values[own.debugName()] = ()
        run.values[given.debugName()] = observation
        run.block(graph)
        action = run.values[next(iter(graph.outputs())).debugName()]
        return (action, *(run.buffers[name] for name in self.memory))


class _Run:
    """One pass. Attributes of modules are tuples of names, until they are tensors."""

    def __init__(self, script: torch.jit.ScriptModule, buffers: dict[str, torch.Tensor], source: str) -> None:
        self.script, self.buffers, self.source = script, buffers, source
        self.values: dict[str, Any] = {}
        self.whole: dict[str, str] = {}  # values that are the whole of a buffer

    def block(self, block: Any) -> None:
        for node in block.nodes():
            results = list(self.results(node))
            for output, result in zip(node.outputs(), results, strict=True):
                self.values[output.debugName()] = result

    def given(self, node: Any) -> list[Any]:
        return [self.values[value.debugName()] for value in node.inputs()]

    def results(self, node: Any) -> Iterator[Any]:
        kind = node.kind()
        if kind == "prim::Constant":
            yield node.output().toIValue()
        elif kind == "prim::GetAttr":
            yield self.attribute(node)
        elif kind == "prim::SetAttr":
            owner, value = self.given(node)
            self.set_buffer(".".join((*owner, node.s("name"))), value)
        elif kind == "prim::If":
            yield from self.branch(node)
        elif kind in ("prim::ListConstruct", "prim::TupleConstruct"):
            yield tuple(self.given(node)) if kind == "prim::TupleConstruct" else self.given(node)
        elif kind in ("prim::TupleUnpack", "prim::ListUnpack"):
            yield from self.given(node)[0]
        elif kind in ("aten::__is__", "aten::__isnot__"):
            a, b = self.given(node)
            yield (a is b) == (kind == "aten::__is__")
        elif kind.startswith("aten::"):
            yield from self.operation(node)
        elif kind == "prim::unchecked_cast":
            yield self.given(node)[0]
        elif kind == "prim::TupleIndex":
            parts, index = self.given(node)
            yield parts[index]
        elif kind in ("prim::dtype", "prim::device"):
            yield getattr(self.given(node)[0], kind.removeprefix("prim::"))
        elif kind == "prim::Uninitialized":
            yield None
        elif kind == "prim::NumToTensor":
            yield torch.tensor(self.given(node)[0])
        else:
            Place(self.source, kind).fail("an operation that can be followed", "one that cannot")

    def branch(self, node: Any) -> Iterator[Any]:
        taken, otherwise = node.blocks()
        block = taken if bool(self.given(node)[0]) else otherwise
        self.block(block)
        for value in block.outputs():
            yield self.values[value.debugName()]

    def attribute(self, node: Any) -> Any:
        name = ".".join((*self.given(node)[0], node.s("name")))
        if name in self.buffers:
            self.whole[node.output().debugName()] = name
            return self.buffers[name]
        value: Any = self.script
        for part in name.split("."):
            value = getattr(value, part)
        return tuple(name.split(".")) if isinstance(value, torch.nn.Module) else value

    def set_buffer(self, name: str, value: Any) -> None:
        if name not in self.buffers:
            Place(self.source, name).fail("a buffer", "another attribute that the forward pass changes")
        self.buffers[name] = value

    def operation(self, node: Any) -> Iterator[Any]:
        kind, given = node.kind(), self.given(node)
        changed = self.whole.get(next(iter(node.inputs())).debugName()) if list(node.inputs()) else None
        name = kind.removeprefix("aten::")
        if changed is not None and name == "slice" and list(given[2:]) in ([0, _TO_THE_END, 1], [None, None, 1]):
            self.whole[node.output().debugName()] = changed
        if changed is not None and name == "copy_":
            result = given[1].expand_as(given[0]) if given[1].shape != given[0].shape else given[1]
            self.set_buffer(changed, result)
            yield result
            return
        if name.endswith("_") and not name.endswith("__"):
            given[0] = given[0].clone()  # nobody else's; the whole of a buffer is set below
        called, _ = torch._C._jit_get_operation(kind)
        result = called(*given)
        if name.endswith("_") and not name.endswith("__") and changed is not None:
            self.set_buffer(changed, result)
        count = len(list(node.outputs()))
        if count == 1:
            yield result
        elif count > 1:
            yield from result
