"""Which Pythons the package runs in; the core itself refuses sub-interpreters (docs/python.md)."""

from __future__ import annotations

import sysconfig


def check() -> None:
    """Raise ImportError in a free-threaded build of Python, for which nothing of Crossgait was built or tested."""
    if sysconfig.get_config_var("Py_GIL_DISABLED"):
        raise ImportError("crossgait needs a Python with the GIL: expected no free-threaded build (python3.13t)")


check()
