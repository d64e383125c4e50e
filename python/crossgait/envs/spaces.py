"""Gymnasium's spaces of a layout."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from crossgait.errors import ConfigError
from crossgait.layout import EnvironmentLayout


def observation_dtype(dtype: npt.DTypeLike) -> np.dtype[Any]:
    """float64 or float32. Raises ConfigError for anything else."""
    try:
        made = np.dtype(dtype)
    except TypeError:  # of what NumPy knows nothing of
        made = None
    if made is None or made not in (np.float64, np.float32):
        found = made.name if made is not None and made.isnative else repr(dtype)
        raise ConfigError("environment", "dtype", "float64 or float32", found)
    return made


def observation_space(layout: EnvironmentLayout, dtype: np.dtype[Any]) -> spaces.Box:
    """Finite bounds: crossgait.layout says which."""
    low, high = layout.observation.box
    return spaces.Box(low.astype(dtype), high.astype(dtype), dtype=dtype.type)


def action_space(layout: EnvironmentLayout) -> spaces.Box:
    """Of float32, in the layout's bounds."""
    low, high = layout.action.low, layout.action.high
    return spaces.Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)


def action_array(action: npt.ArrayLike) -> npt.NDArray[Any]:
    """An action, or those of all environments, as the core takes it. Raises ConfigError for what is no real numbers."""
    if isinstance(action, np.ndarray) and action.dtype in (np.float64, np.float32):
        return action
    try:
        array = np.asarray(action)
        if array.dtype.kind in "fiub":
            return array.astype(np.float64)
        found = f"an array of {array.dtype}"
    except (TypeError, ValueError, OverflowError) as error:  # of lists of different lengths, numbers without end
        found = str(error)
    raise ConfigError("environment", "action", "an array of real numbers", found)
