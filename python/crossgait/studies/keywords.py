"""Errors of keywords that a study does not have, which say the one that may have been meant."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from crossgait.signatures import refuse

P = ParamSpec("P")
R = TypeVar("R")


def suggesting(study: Callable[P, R]) -> Callable[P, R]:
    """Return the function, whose TypeError for a keyword that it does not have names the nearest that it has."""
    known = inspect.signature(study).parameters

    @functools.wraps(study)
    def call(*arguments: P.args, **keywords: P.kwargs) -> R:
        for key in keywords:
            if key not in known:
                refuse(study.__name__, [key], known)
        return study(*arguments, **keywords)

    return call
