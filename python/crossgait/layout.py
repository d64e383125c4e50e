"""What the numbers of observations and actions mean, by name, and what they stay within."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Entries = Sequence[tuple[str, str, float, float, float, float]]  #: name, unit, min, max, low, high of each number


class HasLayouts(Protocol):
    """What environments of the core say of their numbers."""

    @property
    def observation_layout(self) -> Entries:
        """Of an observation."""

    @property
    def action_layout(self) -> Entries:
        """Of an action."""

    @property
    def layout_hash(self) -> str:
        """Of both."""


@dataclass(frozen=True)
class Layout:
    """The numbers of one vector, in order. Bounds are read-only.

    Attributes:
        low, high: infinite where nothing bounds a number.
        box: finite, as tools of reinforcement learning expect: the same, wider by rounding, or far beyond what a robot
            that walks or falls reaches.

    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    low: FloatArray = field(compare=False)
    high: FloatArray = field(compare=False)
    box: tuple[FloatArray, FloatArray] = field(compare=False)

    @classmethod
    def of(cls, entries: Entries) -> Layout:
        """Of (name, unit, min, max, low, high), as the core has them."""
        bounds = np.array([entry[2:] for entry in entries], np.float64).reshape(-1, 4).T.copy()
        bounds.flags.writeable = False
        low, high, *box = bounds
        return cls(tuple(e[0] for e in entries), tuple(e[1] for e in entries), low, high, (box[0], box[1]))

    def __len__(self) -> int:
        return len(self.names)

    def index(self, name: str) -> int:
        """Where `name` stands. Raises KeyError with the names that are like it."""
        try:
            return self.names.index(name)
        except ValueError:
            close = difflib.get_close_matches(name, self.names) or self.names
            raise KeyError(f"no number is named {name!r}; there are {', '.join(close)}") from None


@dataclass(frozen=True)
class EnvironmentLayout:
    """Both vectors of an environment. A policy trained for one `hash` runs wherever it is the same."""

    observation: Layout
    action: Layout
    hash: str

    @classmethod
    def of(cls, environment: HasLayouts) -> EnvironmentLayout:
        """Of an environment of the core, `_core.Environment` or `_core.EnvironmentView`."""
        return cls(
            Layout.of(environment.observation_layout),
            Layout.of(environment.action_layout),
            environment.layout_hash,
        )
