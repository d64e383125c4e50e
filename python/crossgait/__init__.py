"""One quadruped stack over several physics engines."""

from __future__ import annotations

from crossgait._core import (
    Contact,
    Engine,
    EnvironmentConfig,
    FootContact,
    Robot,
    Snapshot,
    State,
    Terrain,
    Walk,
    World,
    __version__,
    available_engines,
    body_poses,
    engines,
    models_dir,
    robots,
)
from crossgait.errors import ConfigError

__all__ = [
    "ConfigError",
    "Contact",
    "Engine",
    "EnvironmentConfig",
    "FootContact",
    "Robot",
    "Snapshot",
    "State",
    "Terrain",
    "Walk",
    "World",
    "__version__",
    "available_engines",
    "body_poses",
    "engines",
    "models_dir",
    "robots",
]
