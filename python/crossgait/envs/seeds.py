"""Seeds and options of `reset`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from crossgait.errors import ConfigError


def episode_seed(seed: int | None, random: np.random.Generator) -> int:
    """What the core is reset with: `seed` itself, or one drawn from `random`. Raises ConfigError beyond 64 bits."""
    if seed is None:
        return int(random.integers(2**63))
    if seed >= 2**64:
        raise ConfigError("reset", "seed", "0 to 2^64 - 1", str(seed))
    return int(seed)


def refuse_options(options: Mapping[str, Any] | None) -> None:
    """Raise ConfigError: there are none."""
    if options:
        raise ConfigError("reset", "options", "none", ", ".join(map(str, options)))
