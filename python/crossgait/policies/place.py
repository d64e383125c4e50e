"""Where something stands that is wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn

from crossgait.errors import ConfigError


@dataclass(frozen=True)
class Place:
    """A part of a model: the file or model, and the node or layer."""

    source: str
    element: str

    def fail(self, expected: str, found: str) -> NoReturn:
        """Raise ConfigError."""
        raise ConfigError(self.source, self.element, expected, found)
