"""What is raised for input that is wrong."""

from __future__ import annotations


class ConfigError(ValueError):
    """What was wrong, where, what was expected and what was found."""

    def __init__(self, source: str, element: str, expected: str, found: str) -> None:
        super().__init__(source, element, expected, found)
        self.source = source
        self.element = element
        self.expected = expected
        self.found = found

    def __str__(self) -> str:
        return f"{self.source}: {self.element}: expected {self.expected}, found {self.found}"
