"""What `render_mode` may be."""

from __future__ import annotations

from collections.abc import Sequence

from crossgait.errors import ConfigError


def known_render_mode(mode: str | None, modes: Sequence[str]) -> str | None:
    """Return `mode`. Raises ConfigError unless it is one of `modes` or None."""
    if mode is not None and mode not in modes:
        raise ConfigError("environment", "render_mode", " or ".join(map(repr, modes)), repr(mode))
    return mode
