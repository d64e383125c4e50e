"""What studies are asked about, and what they take where nothing is said: subjects, engines, threads."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from numbers import Real
from pathlib import Path
from typing import Any

from crossgait import _core
from crossgait._core import Controller, EnvironmentConfig, Walk
from crossgait.errors import ConfigError
from crossgait.inputs import (
    ANYWHERE,
    POLICY_TYPES,
    CorePolicy,
    EnginesLike,
    PolicyLike,
    as_engines,
    as_policy,
    environment_for,
)
from crossgait.notes import tell_notes
from crossgait.progress import Progress, ProgressBar, shown

#: A gait's name, a `Walk` or a `Controller`; or a policy in its environment.
Subject = Walk | Controller | PolicyLike

#: Keywords of `Walk`, which `walk`, `compare` and `verdict` take beside a gait's name.
WALK_KEYWORDS = (
    "command",
    "parameters",
    "robot",
    "terrain",
    "seed",
    "friction",
    "contact",
    "seconds",
    "physics_dt",
    "control_dt",
    "settle",
    "compensation",
    "heading_hold",
    "terminations",
)
#: Of them those that an environment calls otherwise.
_KEYS = {"seed": "terrain_seed", "seconds": "episode_seconds", "settle": "settle_seconds"}


@dataclass(frozen=True)
class PolicyWalk:
    """A policy in its environment."""

    policy: CorePolicy
    environment: EnvironmentConfig


def subject_of(subject: Any, environment: Any, said: Mapping[str, Any], study: str) -> Walk | Controller | PolicyWalk:
    """Return what a study is about.

    Args:
        subject: a `Subject`.
        environment: of a policy; its own if None.
        said: arguments of the call, those of `WALK_KEYWORDS` and `speed` among them; None is not said.
        study: the function that asks, for messages.

    Raises:
        ConfigError: for what is no subject, or an environment of what has none.
        TypeError: for keywords beside a `Walk` or `Controller`, which says all of them itself.

    """
    options = {key: said[key] for key in (*WALK_KEYWORDS, "speed") if said.get(key) is not None}
    if "command" in options:
        options["command"] = velocity_of(options["command"], study)
    if isinstance(options.get("contact"), Mapping):
        options["contact"] = contact_text(options["contact"])
    if _is_policy(subject, environment):
        config = environment_for(environment, subject, source=study)
        config = _with_options(config, _with_command(options, study), study)
        tell_notes(config)
        return PolicyWalk(as_policy(subject, study), config)
    if environment is not None:
        raise ConfigError(study, "environment", "none beside a gait, a Walk or a Controller", "one")
    if isinstance(subject, str):
        named = _walk_of(subject, _with_command(options, study), study)
        tell_notes(named)
        return named
    if not isinstance(subject, (Walk, Controller)):
        expected = "a gait's name, a Walk, a Controller, or a policy (a name, a file, a Policy or a FunctionPolicy)"
        raise ConfigError(study, "subject", expected, type(subject).__name__)
    if options:
        raise TypeError(f"a {type(subject).__name__} says itself what {', '.join(options)} are")
    tell_notes(subject)
    return subject


def velocity_of(command: Any, study: str) -> tuple[float, float, float]:
    """Three numbers, or a mapping as environments have it, in which what is not said is 0."""
    names = ("vx", "vy", "yaw_rate")
    try:
        if isinstance(command, Mapping) and set(command) <= set(names):
            vx, vy, yaw_rate = (float(_core._as_written(command.get(name, 0.0))) for name in names)
        else:
            vx, vy, yaw_rate = (float(_core._as_written(v)) for v in _core._as_written(command))
    except (TypeError, ValueError, OverflowError):
        expected = "forward m/s, left m/s, yaw rate rad/s: three numbers, or a mapping of vx, vy, yaw_rate"
        raise ConfigError(study, "command", expected, repr(command)) from None
    return vx, vy, yaw_rate


def contact_text(settings: Mapping[str, Any]) -> str:
    """Settings of contact as an environment has them, as `Walk` takes them: impratio=100,solref=0.01:1."""
    texts = {k: ":".join(map(str, v)) if isinstance(v, (list, tuple)) else str(v) for k, v in settings.items()}
    return ",".join(f"{name}={text}" for name, text in texts.items())


def _with_command(options: Mapping[str, Any], study: str) -> Mapping[str, Any]:
    """Return the options with the command, straight ahead, that a speed stands for."""
    if "speed" not in options:
        return options
    speed = options["speed"]
    if "command" in options:
        raise ConfigError(study, "speed", "a speed or a command", "both")
    if isinstance(speed, bool) or not isinstance(speed, Real):
        raise ConfigError(study, "speed", "a number, m/s", repr(speed))
    return {key: value for key, value in options.items() if key != "speed"} | {"command": (float(speed), 0.0, 0.0)}


def _is_policy(subject: Any, environment: Any) -> bool:
    if not isinstance(subject, str):
        return isinstance(subject, POLICY_TYPES)
    if subject in _core.gaits() or subject.startswith("auto"):
        return False
    known = subject in ANYWHERE or _core.environment_of_policy(subject) is not None or Path(subject).is_file()
    return environment is not None or known


def _walk_of(gait: str, options: Mapping[str, Any], study: str) -> Walk:
    try:
        return Walk(gait, **options)
    except ConfigError as error:
        if error.source != "gait" or gait in _core.gaits() or gait.startswith("auto"):
            raise
        policies = f"or a policy: zero, random, {', '.join(_core.policy_names())}, a file"
        raise ConfigError(study, "subject", f"{error.expected}; {policies}", gait) from error


def _with_options(config: EnvironmentConfig, options: Mapping[str, Any], study: str) -> EnvironmentConfig:
    if "compensation" in options:
        raise ConfigError(study, "compensation", "none beside a policy, whose environment says how it moves", "one")
    keys: dict[str, Any] = {_KEYS.get(key, key): value for key, value in options.items()}
    if isinstance(keys.get("contact"), str):
        keys["contact"] = _contact_settings(keys["contact"])
    if "command" in keys and not isinstance(keys["command"], Mapping):
        keys["command"] = dict(zip(("vx", "vy", "yaw_rate"), keys["command"], strict=True))
    return config.updated(keys, study) if keys else config


def _contact_settings(text: str) -> dict[str, Any]:
    """Settings of contact as `Walk` takes them, impratio=100,solref=0.01:1, as an environment does."""
    settings: dict[str, Any] = {}
    for part in text.split(","):
        name, _, value = part.partition("=")
        try:
            numbers = [float(number) for number in value.split(":")]
        except ValueError:
            settings[name] = value
        else:
            settings[name] = numbers[0] if len(numbers) == 1 else numbers
    return settings


def default_engine() -> str:
    """Return the first available engine's name. Raises ConfigError if there is none."""
    available = _core.available_engines()
    if not available:
        raise ConfigError("engines", "available", "at least one engine", "none: see crossgait.engines()")
    return available[0]


def several_engines(engines: EnginesLike | None, study: str) -> list[str]:
    """Return the engines given; by default the first and the first of other laws. Raises ConfigError for one alone."""
    if engines is None:
        by_name = {engine.name: engine for engine in _core.engines() if engine.available}
        first = default_engine()
        names = [first, *(n for n, e in by_name.items() if e.laws != by_name[first].laws)][:2]
    else:
        names = as_engines(engines, study)
    if len(names) < 2:
        raise ConfigError(study, "engines", "two or more", ", ".join(names))
    return names


def all_engines(engines: EnginesLike | None, study: str) -> list[str]:
    """Return the engines given, or all that are available."""
    return as_engines(engines, study) if engines is not None else _core.available_engines()


def worker_count(workers: int | None) -> int:
    """Return the threads given, or as many as the process may use cores. Raises ConfigError for none."""
    if workers is not None and not 1 <= workers <= _core.MOST_WORKERS:
        raise ConfigError("study", "workers", f"1 to {_core.MOST_WORKERS}", str(workers))
    return workers if workers is not None else len(os.sched_getaffinity(0))


class ProgressShown:
    """Progress of one call; its bar is gone afterwards."""

    def __init__(self, progress: Progress | bool | None) -> None:
        self.progress: Callable[[str, float], None] | None = shown(progress)

    def __enter__(self) -> Progress | None:
        return self.progress

    def __exit__(self, *_: object) -> None:
        if isinstance(self.progress, ProgressBar):
            self.progress.close()
