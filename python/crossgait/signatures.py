"""Signatures of the core's classes, for `help`, notebooks and whoever else asks `inspect.signature`.

Type checkers read the stub; at run time nanobind has the same text, but not where Python looks for it.
"""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterable
from typing import Any, NoReturn

from crossgait.errors import nearest

_DEFAULT = "default_"  #: begins what stands for a default of nanobind's list


class _OfConstructor:
    """Attribute `__signature__` of one class, read when it is asked for."""

    def __init__(self, owner: type) -> None:
        self._owner = owner

    def __get__(self, _: object, owner: type) -> inspect.Signature:
        if owner is not self._owner:  # a class of Python's below it has its own
            raise AttributeError("__signature__")
        overloads = owner.__init__.__nb_signature__  # type: ignore[misc]  # nanobind's
        whole = signature_of(*max(((text, defaults) for text, _, defaults in overloads), key=lambda one: len(one[0])))
        return whole.replace(parameters=list(whole.parameters.values())[1:], return_annotation=inspect.Signature.empty)


def signature_of(text: str, defaults: tuple[Any, ...] | None = None) -> inspect.Signature:
    """Read `def name(...) -> type`, where defaults are literals, `...`, or a backslash and an index of `defaults`."""
    text = re.sub(r"\bndarray\[[^][]*\]", "ndarray", text)  # whose shapes are no Python
    function = ast.parse(re.sub(r"\\(\d+)", rf"{_DEFAULT}\1", text) + ": ...").body[0]
    assert isinstance(function, ast.FunctionDef)
    given = function.args

    def default_of(node: ast.expr | None) -> Any:
        if node is None:
            return inspect.Parameter.empty
        if isinstance(node, ast.Name) and node.id.startswith(_DEFAULT) and defaults is not None:
            return defaults[int(node.id.removeprefix(_DEFAULT))]
        return ast.literal_eval(node)

    def made(argument: ast.arg, kind: Any, node: ast.expr | None = None) -> inspect.Parameter:
        annotation = ast.unparse(argument.annotation) if argument.annotation else inspect.Parameter.empty
        return inspect.Parameter(argument.arg, kind, default=default_of(node), annotation=annotation)

    positional = [*given.posonlyargs, *given.args]
    nodes: list[ast.expr | None] = [*[None] * (len(positional) - len(given.defaults)), *given.defaults]
    kinds: list[Any] = [inspect.Parameter.POSITIONAL_ONLY] * len(given.posonlyargs)
    kinds += [inspect.Parameter.POSITIONAL_OR_KEYWORD] * len(given.args)
    parameters = [made(*one) for one in zip(positional, kinds, nodes, strict=True)]
    for argument, node in zip(given.kwonlyargs, given.kw_defaults, strict=True):
        parameters.append(made(argument, inspect.Parameter.KEYWORD_ONLY, node))
    returned = ast.unparse(function.returns) if function.returns else inspect.Signature.empty
    return inspect.Signature(parameters, return_annotation=returned)


def refuse(name: str, unknown: Iterable[str], known: Iterable[str]) -> NoReturn:
    """Raise TypeError for the first keyword that is none, naming the nearest that is, or all where none is near."""
    key, names = next(iter(unknown)), list(known)
    meant = nearest(key, names)
    hint = f": did you mean '{meant}'?" if meant else f": it has {', '.join(names)}"
    raise TypeError(f"{name}() has no keyword '{key}'{hint}")


def tell_signatures(module: Any) -> None:
    """Give the classes of a nanobind module that can be constructed their `__signature__`."""
    for member in list(vars(module).values()):
        if isinstance(member, type) and hasattr(vars(member).get("__init__"), "__nb_signature__"):
            member.__signature__ = _OfConstructor(member)  # type: ignore[attr-defined]
