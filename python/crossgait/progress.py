"""How far a long call is."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

#: Called now and then with what is being done and the share of it that is done, 0 to 1.
Progress = Callable[[str, float], None]


class ProgressBar:
    """A bar of tqdm for each stage, after the first two seconds. What it raises ends the call."""

    def __init__(self, delay: float = 2.0) -> None:
        self._bar: Any = None
        self._stage = ""
        self._begin = time.monotonic()
        self._delay = delay

    def __call__(self, stage: str, share: float) -> None:
        """Show that `share` of `stage` is done."""
        if time.monotonic() - self._begin < self._delay:
            return
        if self._bar is None or stage != self._stage:
            self.close()
            self._stage = stage
            self._bar = _new_bar(stage)
        self._bar.n = round(100 * share)
        self._bar.refresh()

    def close(self) -> None:
        """Leave the line."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None


def _new_bar(stage: str) -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError as error:
        raise ImportError("bars of progress need tqdm: pip install tqdm", name=error.name) from error

    return tqdm(
        total=100,
        desc=stage,
        unit="%",
        leave=False,
        bar_format="{desc}: {percentage:3.0f} %|{bar}| {remaining}",
    )


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and hasattr(shell, "kernel")


def shown(progress: Progress | bool | None) -> Progress | None:
    """What a `progress` argument means.

    Args:
        progress: a function; False for none; True for a bar; None for a bar where somebody is looking (a terminal or
            a notebook) and tqdm is installed.

    """
    if progress is None:
        if not (sys.stderr.isatty() or _in_notebook()):
            return None
        try:
            import tqdm  # noqa: F401
        except ImportError:
            return None
        return ProgressBar()
    if progress is True:
        return ProgressBar()
    return progress or None
