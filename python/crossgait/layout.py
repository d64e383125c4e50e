"""What the numbers of observations and actions mean, by name, and what they stay within."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

#: What numbers of a unit stay within, where the layout itself has no bound: far beyond what a robot that walks or falls
#: reaches, and finite, as tools of reinforcement learning expect. Scaled observations scale it. An engine counts as
#: diverged at 340 m/s, 1e4 rad/s and 1e6 m.
UNIT_BOUNDS: dict[str, float] = {
    "m": 1e3,  # of the way since the world's origin, and heights
    "m/s": 100.0,
    "rad": 100.0,  # joints without stops may turn over
    "rad/s": 1e3,
}
#: Of every other unit.
OTHER_BOUND = 1e6
#: The parts of unit vectors and normalised parameters may pass their bounds by rounding: a share of the bound.
ROUNDING = 1e-9

# "rad from 0.900 x 0.05": an angle from home, times a scale.
_UNIT = re.compile(r"(?P<unit>.*?)(?: from \S+)?(?: x (?P<scale>\S+))?")


def unit_bound(unit: str) -> float:
    """What a number of this unit stays within, as the layout writes units: "m", "rad from 0.900 x 0.05"."""
    match = _UNIT.fullmatch(unit)
    assert match is not None  # it matches anything
    return UNIT_BOUNDS.get(match["unit"], OTHER_BOUND) * abs(float(match["scale"] or 1))


@dataclass(frozen=True)
class Layout:
    """The numbers of one vector, in order. `low` and `high` are read-only, infinite where nothing bounds a number."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    low: FloatArray = field(compare=False)
    high: FloatArray = field(compare=False)

    @classmethod
    def of(cls, entries: Sequence[tuple[str, str, float, float]]) -> Layout:
        """Of (name, unit, min, max), as the core has them."""
        low, high = np.array([e[2] for e in entries]), np.array([e[3] for e in entries])
        low.flags.writeable = high.flags.writeable = False
        return cls(tuple(e[0] for e in entries), tuple(e[1] for e in entries), low, high)

    def __len__(self) -> int:
        return len(self.names)

    def index(self, name: str) -> int:
        """Where `name` stands. Raises KeyError with the names that are like it."""
        try:
            return self.names.index(name)
        except ValueError:
            close = difflib.get_close_matches(name, self.names) or self.names
            raise KeyError(f"no number is named {name!r}; there are {', '.join(close)}") from None

    def finite_bounds(self) -> tuple[FloatArray, FloatArray]:
        """Finite bounds: its own, wider by rounding, or those of the unit (`UNIT_BOUNDS`) where it has none."""
        units = np.array([unit_bound(unit) for unit in self.units])
        low = np.where(np.isfinite(self.low), self.low - ROUNDING * np.abs(self.low), -units)
        high = np.where(np.isfinite(self.high), self.high + ROUNDING * np.abs(self.high), units)
        return low, high


@dataclass(frozen=True)
class EnvironmentLayout:
    """Both vectors of an environment. A policy trained for one `hash` runs wherever it is the same."""

    observation: Layout
    action: Layout
    hash: str

    @classmethod
    def of(cls, environment: Any) -> EnvironmentLayout:
        """Of an environment of the core, `_core.Environment` or `_core.EnvironmentView`."""
        return cls(
            Layout.of(environment.observation_layout),
            Layout.of(environment.action_layout),
            environment.layout_hash,
        )
