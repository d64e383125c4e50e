"""What terms keep from one rollout of a training to the next: plain values and arrays, which travel and are saved."""

from __future__ import annotations

import inspect
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np

from crossgait.errors import ConfigError
from crossgait.terms.declarations import Terms


def owner_of(function: Callable[..., Any]) -> Any:
    """The object that a term's function is, or is a method of: one to be called as well, or one with a state."""
    owner = getattr(function, "__self__", None)
    if not inspect.ismethod(function) or inspect.isclass(owner):
        return function
    return owner if callable(owner) or (has(owner, "state") and has(owner, "restore")) else function


def has(owner: Any, method: str) -> bool:
    """Whether it has such a method."""
    return callable(getattr(owner, method, None))


def remembers(owner: Any) -> bool:
    """Whether it has a memory of its own: a `reset`, or a `state`."""
    return not inspect.isclass(owner) and (has(owner, "reset") or has(owner, "state"))


class Keepers:
    """The objects of a batch's terms that have a state, by the place of a term that is one: a curriculum's, if any is.

    A curriculum that keeps something without a state is found out, since a rollout made elsewhere would forget it.
    """

    def __init__(self, terms: Terms) -> None:
        """Of terms that are the batch's own. Raises ConfigError for a `state` without a `restore`."""
        self._keepers: dict[str, Any] = {}
        self._silent: dict[str, tuple[Any, bytes | None]] = {}
        seen = set[int]()
        for place, term in reversed(terms.placed):  # curricula first
            owner = owner_of(term.function)
            if id(owner) in seen:
                continue
            seen.add(id(owner))
            if remembers(owner) and has(owner, "state"):
                if not has(owner, "restore"):
                    raise ConfigError("terms", place, "a restore(state) beside its state()", type(owner).__name__)
                self._keepers[place] = owner
            elif place.startswith("curriculum."):
                holder = getattr(owner, "__self__", owner)  # of a method
                self._silent[place] = (holder, _attributes(holder))

    def state(self) -> dict[str, Any]:
        """Copies of the states. Raises ConfigError for what is not plain, and for what has none and has changed."""
        for place, (owner, before) in self._silent.items():
            if before != _attributes(owner):
                expected = "state() and restore(state) of what it keeps from rollout to rollout"
                raise ConfigError("terms", place, expected, f"a {type(owner).__name__} that has changed without")
        return {place: plain(owner.state(), f"{place}.state()") for place, owner in self._keepers.items()}

    def restore(self, state: dict[str, Any]) -> None:
        """Give states back. Raises ConfigError for those of other terms."""
        if state.keys() != self._keepers.keys():
            expected, found = (", ".join(names) or "none" for names in (self._keepers, state))
            raise ConfigError("terms", "restore", f"states of {expected}", found)
        for place, owner in self._keepers.items():
            owner.restore(plain(state[place], f"{place}.state()"))


def _attributes(owner: Any) -> bytes | None:
    """To see whether they change; None of what cannot be told."""
    try:
        return pickle.dumps(vars(owner))
    except Exception:  # no attributes, or of any kind
        return None


def plain(value: Any, place: str) -> Any:
    """A copy of plain values and arrays of numbers, however nested. Raises ConfigError for anything else."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, np.generic) and value.dtype.kind in "biuf":
        return value.item()
    if isinstance(value, np.ndarray) and value.dtype.kind in "biuf":
        return value.copy()
    if isinstance(value, (list, tuple)):
        return type(value)(plain(item, place) for item in value)
    if type(value) is dict and all(isinstance(key, (str, int)) for key in value):
        return {key: plain(item, place) for key, item in value.items()}
    raise ConfigError("terms", place, "numbers, texts, lists, dicts and arrays of numbers", type(value).__name__)
