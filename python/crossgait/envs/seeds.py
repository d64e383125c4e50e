"""Seeds and options of `reset`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from numbers import Integral
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait.errors import ConfigError


def episode_seed(seed: int | None, random: np.random.Generator) -> int:
    """What the core is reset with: `seed` itself, or one drawn from `random`. Raises ConfigError beyond 64 bits."""
    if seed is None:
        return int(random.integers(2**63))
    if seed >= 2**64:
        raise ConfigError("reset", "seed", "0 to 2^64 - 1", str(seed))
    return int(seed)


def episode_seeds(seeds: Sequence[int | None], count: int, random: np.random.Generator) -> list[int]:
    """One for each environment, those that are None drawn from `random`. Raises ConfigError for others."""
    if isinstance(seeds, (str, bytes, bytearray)):
        raise ConfigError("reset", "seed", f"an integer, or {count} of them", repr(seeds))
    if len(seeds) != count:
        raise ConfigError("reset", "seed", f"an integer, or {count} of them", f"{len(seeds)}")
    for seed in seeds:
        if seed is not None and (isinstance(seed, bool) or not isinstance(seed, Integral) or not 0 <= seed < 2**64):
            raise ConfigError("reset", "seed", "integers of 0 to 2^64 - 1, or None", repr(seed))
    return [episode_seed(seed, random) for seed in seeds]


def reset_mask(options: Mapping[str, Any] | None, count: int) -> npt.NDArray[np.bool_] | None:
    """Which environments are to begin an episode; None for all. Raises ConfigError, also for any other option."""
    if options is not None and not isinstance(options, Mapping):
        raise ConfigError("reset", "options", "a mapping", repr(options))
    refuse_options({key: value for key, value in (options or {}).items() if key != "reset_mask"}, "reset_mask alone")
    if not options:
        return None
    mask = options["reset_mask"]
    if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_ or mask.shape != (count,) or not mask.any():
        expected = f"a NumPy array of bool of shape ({count},), at least one of them True"
        raise ConfigError("reset", "reset_mask", expected, repr(mask))
    return mask


def refuse_options(options: Mapping[str, Any] | None, known: str = "none") -> None:
    """Raise ConfigError: there are none, or those that are `known` are no more among them."""
    if options:
        raise ConfigError("reset", "options", known, ", ".join(map(str, options)))
