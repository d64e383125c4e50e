"""The environment that policies run in: named, or found beside one of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from crossgait import _core
from crossgait._core import EnvironmentConfig
from crossgait.errors import ConfigError
from crossgait.inputs import ENVIRONMENT as ENVIRONMENT
from crossgait.inputs import as_environment


def environment_of(policies: Sequence[str], given: str | None) -> EnvironmentConfig:
    """Of the file or the policy's name `given`, or the one of the first policy that has one. Raises ConfigError."""
    if given is not None:
        return as_environment(given, "--environment")
    for policy in policies:
        own = _core.environment_of_policy(policy)
        if own is not None:
            return EnvironmentConfig.load(own)
        beside = Path(policy).parent / ENVIRONMENT
        if policy.endswith((".safetensors", ".yaml")) and beside.exists():
            return EnvironmentConfig.load(beside)
    raise ConfigError(", ".join(policies), "environment", f"{ENVIRONMENT} beside a policy, or --environment", "none")
