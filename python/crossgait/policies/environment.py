"""The environment that policies run in: named, or found beside one of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from crossgait import _core
from crossgait._core import EnvironmentConfig
from crossgait.errors import ConfigError
from crossgait.inputs import ENVIRONMENT as ENVIRONMENT


def environment_of(policies: Sequence[str], given: str | None) -> EnvironmentConfig:
    """Of the file `given`, or the one beside the first policy that is a file. Raises ConfigError."""
    if given is not None:
        return EnvironmentConfig.load(given)
    for policy in policies:
        own = _core.environment_of_policy(policy)
        if own is not None:
            return EnvironmentConfig.load(own)
        beside = Path(policy).parent / ENVIRONMENT
        if policy.endswith((".safetensors", ".yaml")) and beside.exists():
            return EnvironmentConfig.load(beside)
    raise ConfigError(", ".join(policies), "environment", f"{ENVIRONMENT} beside a policy, or --environment", "none")
