"""What is raised for input that is wrong."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class ConfigError(ValueError):
    """What was wrong, where, what was expected and what was found."""

    def __init__(self, source: str, element: str, expected: str, found: str) -> None:
        super().__init__(source, element, expected, found)
        self.source = source
        self.element = element
        self.expected = expected
        self.found = found

    def __str__(self) -> str:
        return _printable(f"{self.source}: {self.element}: expected {self.expected}, found {self.found}")


def _printable(text: str) -> str:
    """A text without what a terminal would do instead of showing it, as the core's errors are."""
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode() for c in text)


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the one of `known` that a mistyped name may have meant; None if none is near."""
    return next(iter(difflib.get_close_matches(name, list(known), n=1, cutoff=0.7)), None)


def meant(name: str, known: Iterable[str], otherwise: str) -> str:
    """Ask whether the one of `known` was meant that is nearest to a mistyped name; `otherwise` where none is near."""
    near = nearest(name, known)
    return f"did you mean '{near}'?" if near else otherwise


def unknown_key(source: str, element: str, key: str, known: Iterable[str]) -> ConfigError:
    """Make the error of a key that is none of `known`, with the one that may have been meant."""
    names = list(known)
    near = nearest(key, names)
    found = f"unknown key '{key}'" + (f" (did you mean {near}?)" if near else "")
    return ConfigError(source, element, f"one of the keys {', '.join(names)}", found)
