"""What studies are asked about, and what they take where nothing is said: subjects, engines, environments, threads."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from crossgait import _core
from crossgait._core import Controller, EnvironmentConfig, FunctionPolicy, Walk
from crossgait.errors import ConfigError
from crossgait.progress import Progress, ProgressBar, shown

Subject = Walk | Controller | str
#: A name (zero, random, one of `crossgait.policy_names()`), a file, or a policy of your own. Without an environment a
#: policy that comes with Crossgait runs in its own.
Policy = str | FunctionPolicy


def walk_or_behaviour(subject: Subject, options: dict[str, Any]) -> Walk | Controller:
    """Return the subject, or the `Walk` of a gait by name with these options. Raises ConfigError."""
    if isinstance(subject, str):
        return Walk(subject, **options)
    if options:
        raise TypeError(f"a {type(subject).__name__} says itself what {', '.join(options)} are")
    return subject


def default_engine() -> str:
    """Return the first available engine's name. Raises ConfigError if there is none."""
    available = _core.available_engines()
    if not available:
        raise ConfigError("engines", "available", "at least one engine", "none: see crossgait.engines()")
    return available[0]


def several_engines(engines: Sequence[str] | None) -> list[str]:
    """Return the engines given; by default the first and the first of other laws. Raises ConfigError for one alone."""
    if engines is None:
        by_name = {engine.name: engine for engine in _core.engines() if engine.available}
        first = default_engine()
        engines = [first, *(n for n, e in by_name.items() if e.laws != by_name[first].laws)][:2]
    if len(engines) < 2:
        raise ConfigError("verdict", "engines", "two or more", ", ".join(engines))
    return list(engines)


def all_engines(engines: Sequence[str] | None) -> list[str]:
    """Return the engines given, or all that are available."""
    return list(engines) if engines is not None else _core.available_engines()


def environment_or_default(environment: EnvironmentConfig | None, policy: Policy | None = None) -> EnvironmentConfig:
    """The one given, that of a policy which comes with Crossgait, or the default."""
    if environment is not None:
        return environment
    own = _core.environment_of_policy(policy) if isinstance(policy, str) else None
    return EnvironmentConfig() if own is None else EnvironmentConfig.load(own)


def worker_count(workers: int | None) -> int:
    """Return the threads given, or as many as the process may use cores."""
    return workers if workers is not None else len(os.sched_getaffinity(0))


class ProgressShown:
    """Progress of one call; its bar is gone afterwards."""

    def __init__(self, progress: Progress | bool | None) -> None:
        self.progress = shown(progress)

    def __enter__(self) -> Progress | None:
        return self.progress

    def __exit__(self, *_: object) -> None:
        if isinstance(self.progress, ProgressBar):
            self.progress.close()
