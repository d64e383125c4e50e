"""Errors of arguments that a function does not take: keywords that it has not, values of another type."""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Mapping
from typing import Any, ParamSpec, TypeVar

from crossgait import _core
from crossgait.errors import ConfigError
from crossgait.files import noting_reads
from crossgait.signatures import check_types, has_bytes, refuse

#: The least and the most of numbers that say how much is to be done, as the commands have them (docs/limits.md).
BOUNDS = {
    "episodes": (1, 1_000_000),
    "starts": (2, 10_000),
    "iterations": (1, 10_000),
    "population": (4, 100_000),
    "terrains": (1, 1_000),
    "unseen": (0, 1_000),
}

P = ParamSpec("P")
R = TypeVar("R")


#: Those that may name files, whose names need be no text.
_NAMES = ("subject", "robot", "terrain", "policies", "policy")


def _check_values(name: str, given: Mapping[str, Any]) -> None:
    for key, value in given.items():
        if isinstance(value, str) and key not in _NAMES and not has_bytes(value):
            raise ConfigError(name, key, "text that UTF-8 has bytes for", repr(value))
        if isinstance(value, float) and math.isnan(value):
            raise ConfigError(name, key, "a number", "nan")
        if key in BOUNDS and isinstance(value, int):
            least, most = BOUNDS[key]
            if not least <= value <= most:
                found = str(value) if abs(value) < 1e18 else f"a number of {value.bit_length()} bits"
                raise ConfigError(name, key, f"{least} to {most}", found)


def _of_python(value: Any, levels: int = 2) -> Any:
    """NumPy's numbers as Python's, those of fewer digits as they were written: 0.7 of float32 is 0.7."""
    if levels > 0 and type(value) is dict:
        return {key: _of_python(one, levels - 1) for key, one in value.items()}
    if levels > 0 and type(value) in (list, tuple):
        return type(value)(_of_python(one, levels - 1) for one in value)
    kind = getattr(getattr(value, "dtype", None), "kind", "")
    if getattr(value, "ndim", 1) != 0 or kind not in ("f", "i", "u", "b"):
        return value
    return _core._as_written(value).item()


def checking_arguments(study: Callable[P, R]) -> Callable[P, R]:
    """Return the function, whose TypeErrors name the nearest keyword that it has, or what an argument should be.

    What it returns is told which files were read for it, which nothing of it may replace.
    """
    signature = inspect.signature(study)
    known = signature.parameters
    name = study.__qualname__.removesuffix(".__init__")

    @functools.wraps(study)
    def call(*arguments: P.args, **keywords: P.kwargs) -> R:
        for key in keywords:
            if key not in known:
                refuse(name, [key], [each for each in known if each != "self"])
        try:
            bound = signature.bind(*arguments, **keywords)
        except TypeError as error:  # which says what there is too much or too little of, but not where
            raise TypeError(f"{name}(): {error}") from None
        for key, value in bound.arguments.items():
            bound.arguments[key] = _of_python(value)
        given = bound.arguments
        check_types(name, given, known)
        _check_values(name, given)
        with noting_reads() as read:
            result = study(*bound.args, **bound.kwargs)
        if hasattr(result, "note_inputs"):
            result.note_inputs(read)
        return result

    return call
