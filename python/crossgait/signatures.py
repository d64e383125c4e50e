"""Signatures of the core's classes and functions, for `help`, notebooks and whoever else asks `inspect.signature`.

Type checkers read the stub; at run time nanobind has the same text, but not where Python looks for it. By the same
text a call whose arguments do not fit says which of them, and what was expected (`misfit`).
"""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NoReturn

from crossgait.errors import meant

_DEFAULT = "default_"  #: begins what stands for a default of nanobind's list


class _OfConstructor:
    """Attribute `__signature__` of one class, read when it is asked for."""

    def __init__(self, owner: type) -> None:
        self._owner = owner

    def __get__(self, _: object, owner: type) -> inspect.Signature:
        if owner is not self._owner:  # a class of Python's below it has its own
            raise AttributeError("__signature__")
        bound = _without_self(_signature_of_function(owner.__init__))  # type: ignore[misc]
        return bound.replace(return_annotation=inspect.Signature.empty)


class _OfFunction:
    """Attribute `__signature__` of all functions of one of nanobind's types, read when it is asked for."""

    def __init__(self, is_bound: bool) -> None:
        self._is_bound = is_bound

    def __get__(self, function: Any, _: type) -> inspect.Signature:
        if function is None or not hasattr(function, "__nb_signature__"):
            raise AttributeError("__signature__")
        whole = _signature_of_function(function)
        return _without_self(whole) if self._is_bound else whole


def _signature_of_function(function: Any) -> inspect.Signature:
    """The longest of its signatures, where it has several."""
    overloads = function.__nb_signature__  # nanobind's
    return signature_of(*max(((text, defaults) for text, _, defaults in overloads), key=lambda one: len(one[0])))


def _without_self(whole: inspect.Signature) -> inspect.Signature:
    return whole.replace(parameters=list(whole.parameters.values())[1:])


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
    raise TypeError(_unknown_keyword(name, next(iter(unknown)), known))


def _unknown_keyword(name: str, key: str, known: Iterable[str]) -> str:
    names = list(known)
    return f"{name}() has no keyword '{key}': " + meant(key, names, f"it has {', '.join(names) or 'none'}")


def misfit(function: Any, positional: list[Any], keywords: dict[str, Any]) -> str:
    """Say which argument of a call of the core's does not fit its signature. `positional` has no unmade `self`."""
    owner, _, name = (function.__qualname__ or "").rpartition(".")
    name = owner if name in ("__init__", "__new__") else name.lstrip("_")
    said = []
    overloads = function.__nb_signature__
    if function.__name__ == "__new__" and len(overloads) > 1:
        overloads = overloads[1:]  # the first is nanobind's own
    for text, _, defaults in overloads:
        text = text.replace("def (", "def value(", 1)  # what is set to a property has no name
        parameters = list(signature_of(text, defaults).parameters.values())
        if parameters and parameters[0].name in ("self", "cls"):
            parameters, given = parameters[1:], positional[function.__name__ not in ("__init__", "__new__") :]
        else:
            given = positional
        said.append(_Call(name, parameters).misfit(given, keywords))
    return max(said)[1]  # of the overload that most of it fits


def check_types(name: str, given: Mapping[str, Any], parameters: Mapping[str, inspect.Parameter]) -> None:
    """Raise TypeError for the first argument that is none of its annotation, where that is of Python's own types."""
    for key, value in given.items():
        annotation = parameters[key].annotation
        if isinstance(annotation, str) and not _fits(value, ast.parse(annotation, mode="eval").body):
            raise TypeError(f"{name}(): {key}: expected {_plain(annotation)}, found {_shown(value)}")


class _Call:
    """A call of one signature: what of it does not fit, and how much does."""

    def __init__(self, name: str, parameters: list[inspect.Parameter]) -> None:
        self._name, self._parameters = name, parameters
        self._place = f"{name}(): " if name else ""  # a property's value has no name, and is the only one
        self._taken = {p.name: p for p in parameters}
        self._in_order = [p for p in parameters if p.kind is not inspect.Parameter.KEYWORD_ONLY]

    def _at(self, argument: str) -> str:
        return f"{self._place}{argument}: " if self._place else ""

    def misfit(self, positional: list[Any], keywords: dict[str, Any]) -> tuple[int, str]:
        names = [p.name for p in self._in_order]
        if len(positional) > len(names):
            most = f"at most {len(names)}" if names else "no"
            return 0, f"{self._place}expected {most} arguments without their names, found {len(positional)}"
        by_name = [p.name for p in self._parameters if p.kind is not inspect.Parameter.POSITIONAL_ONLY]
        for key in keywords:
            if key not in by_name:
                return 0, _unknown_keyword(self._name, key, by_name)
        given = dict(zip(names, positional, strict=False)) | keywords
        for parameter in self._parameters:
            if parameter.name not in given and parameter.default is inspect.Parameter.empty:
                return 0, f"{self._at(parameter.name)}expected {_plain(parameter.annotation)}, found nothing"
        for fitting, (key, value) in enumerate(given.items(), 1):
            annotation = self._taken[key].annotation
            if not _fits(value, ast.parse(annotation, mode="eval").body):
                return fitting, f"{self._at(key)}expected {_plain(annotation)}, found {_shown(value)}"
        return len(given) + 1, self._out_of_bounds(given)

    def _out_of_bounds(self, given: dict[str, Any]) -> str:
        """What to say where each argument is of its type: numbers that are negative, lists of another length."""
        for key, value in given.items():
            if isinstance(value, str) and not has_bytes(value):
                return f"{self._at(key)}expected text that UTF-8 has bytes for, found {_shown(value)}"
            if isinstance(value, int) and value.bit_length() > 64:
                return f"{self._at(key)}expected a number of at most 64 bits, found one of {value.bit_length()} bits"
            if isinstance(value, int) and value < 0:
                return f"{self._at(key)}expected a number that is not negative, found {_shown(value)}"
        for key, value in given.items():
            if isinstance(value, (list, tuple)) or hasattr(value, "shape"):
                expected = _plain(self._taken[key].annotation)
                if isinstance(value, (list, tuple)) and "ndarray" in expected.lower():
                    return f"{self._at(key)}expected {expected} (numpy.array makes one of it), found {_shown(value)}"
                return f"{self._at(key)}expected {expected} of another length or shape, found {_shown(value)}"
        expected = ", ".join(f"{p.name}: {_plain(p.annotation)}" for p in self._parameters)
        return f"{self._place}expected ({expected}), found {', '.join(map(_shown, given.values())) or 'nothing'}"


def has_bytes(text: str) -> bool:
    """Whether it is no half of a surrogate pair, as Python has it for bytes of names that are no UTF-8."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def _plain(annotation: str) -> str:
    """A type as people write it, without the modules that it is of."""
    return re.sub(r"\b(?:[a-z_]+\.)+(?=[A-Za-z_])", "", annotation)


def _shown(value: Any) -> str:
    """A value by its type, and by its text where that is short."""
    kind = type(value).__name__
    if not isinstance(value, (str, int, float, list, tuple, dict)):
        shape = getattr(value, "shape", None)
        return f"{kind} of shape {shape}" if isinstance(shape, tuple) else kind
    text = repr(value)
    return f"{kind} {text}" if len(text) <= 60 else kind


_KINDS: dict[str, Callable[[Any], bool]] = {
    "None": lambda value: value is None,
    "str": lambda value: isinstance(value, str),
    "bool": lambda value: isinstance(value, bool) or type(value).__name__ in ("bool_", "bool"),
    "int": lambda value: hasattr(type(value), "__index__"),
    "float": lambda value: hasattr(type(value), "__float__") or hasattr(type(value), "__index__"),
    "PathLike": lambda value: hasattr(value, "__fspath__"),
    "Callable": callable,
    "Mapping": lambda value: hasattr(value, "keys"),
    "dict": lambda value: isinstance(value, dict),
    "Sequence": lambda value: hasattr(value, "__len__") and not isinstance(value, (str, bytes)),
    "ndarray": lambda value: hasattr(value, "__array__") or (hasattr(value, "__len__") and not isinstance(value, str)),
    "list": lambda value: hasattr(value, "__len__") and not isinstance(value, (str, bytes)),
}


def _fits(value: Any, annotation: ast.expr) -> bool:
    """Whether a value is of the annotated type, as far as that can be said: what is not known is taken to fit."""
    if isinstance(annotation, ast.BinOp):
        return _fits(value, annotation.left) or _fits(value, annotation.right)
    if isinstance(annotation, ast.Subscript):
        if not _fits(value, annotation.value):
            return False
        kind, inner = ast.unparse(annotation.value).rpartition(".")[2], annotation.slice
        if kind in ("Sequence", "list") and isinstance(value, (list, tuple)):
            return all(_fits(one, inner) for one in value)
        return True
    kind = ast.unparse(annotation).rpartition(".")[2]
    if kind in _KINDS:
        return _KINDS[kind](value)
    from crossgait import _core

    known = getattr(_core, kind, None)
    return not isinstance(known, type) or isinstance(value, known)


def tell_signatures(module: Any) -> None:
    """Give the functions of a nanobind module, and its classes that can be constructed, their `__signature__`."""
    types: dict[type, bool] = {}  #: nanobind's own, of functions, and whether they are bound to an object
    for member in list(vars(module).values()):
        if hasattr(member, "__nb_signature__"):
            types[type(member)] = False
        constructor: Any = vars(member).get("__init__") if isinstance(member, type) else None
        if hasattr(constructor, "__nb_signature__"):
            member.__signature__ = _OfConstructor(member)
            types |= {type(constructor): False, type(constructor.__get__(object())): True}
    for kind, is_bound in types.items():
        module._set_attribute_of_type(kind, "__signature__", _OfFunction(is_bound))
