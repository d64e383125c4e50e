"""What a missing package says: which it is, and how it is installed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def needed_for(what: str, extra: str) -> Iterator[None]:
    """Around imports of packages that come with `crossgait[extra]`, without which there is no `what`."""
    try:
        yield
    except ImportError as error:
        package = (error.name or "more").partition(".")[0]
        raise ImportError(f"{what} need {package}: pip install 'crossgait[{extra}]'", name=error.name) from error
