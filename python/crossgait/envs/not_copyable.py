"""Environments hold an engine's world, which cannot be copied."""

from __future__ import annotations

from typing import NoReturn, SupportsIndex


class NotCopyable:
    """Refuses `copy`, `deepcopy` and pickling."""

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        raise TypeError(
            f"{type(self).__name__} cannot be copied or pickled: it holds a world of a physics engine. "
            "Make another of the same arguments (its `spec` can be pickled), and carry an episode over with "
            "`core.save()` and `core.restore()` or by its seed"
        )
