"""What functions take: one way to say an environment, a policy, engines, a robot and a terrain, everywhere.

| what | as |
|---|---|
| environment | an `EnvironmentConfig`, its YAML file, a mapping of its keys, a `Walk`, or one that was made |
| policy | a name, a file or folder, a `Policy`, or a `FunctionPolicy` |
| engine | a name or an `Engine`; of several a sequence, or one text with commas |
| robot, terrain | a name, a file, a `Robot` or `Terrain` |
"""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from numbers import Integral
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from crossgait import _core
from crossgait._core import Engine, EnvironmentConfig, FunctionPolicy, Robot, Terrain, Walk
from crossgait.errors import ConfigError


@runtime_checkable
class PolicyObject(Protocol):
    """What `crossgait.Policy` is to functions that run policies."""

    @property
    def name(self) -> str:
        """For tables."""

    @property
    def environment(self) -> EnvironmentConfig | None:
        """That it was made for, if that is known."""

    @property
    def for_studies(self) -> str | _core._BundlePolicy:
        """What instances are made of."""

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write its network. Raises ConfigError if it is none."""


class MadeEnvironment(Protocol):
    """An environment of Gymnasium's, single or vector, which stands for its configuration."""

    @property
    def unwrapped(self) -> Any:
        """What wrappers are around; its `config` is what is taken."""


#: The path of a YAML file, its keys as a mapping, what was made of either, or a walk that the zero policy makes.
#: An environment that was made (Gymnasium's, or of the core) stands for its configuration.
EnvironmentLike = (
    str
    | os.PathLike[str]
    | Mapping[str, Any]
    | EnvironmentConfig
    | Walk
    | MadeEnvironment
    | _core.Environment
    | _core.VectorEnvironment
)
InterfaceLike = EnvironmentLike | _core.PolicyInterface  #: what a policy runs on
EngineLike = str | Engine
EnginesLike = str | Engine | Sequence[str | Engine]
RobotLike = str | os.PathLike[str] | Robot
TerrainLike = str | os.PathLike[str] | Terrain
PolicyLike = str | os.PathLike[str] | FunctionPolicy | PolicyObject  #: a PolicyObject is a `crossgait.Policy`
POLICY_TYPES = (str, os.PathLike, FunctionPolicy, PolicyObject)  #: the same, for isinstance
#: What the core takes for a policy: a text, a function, or a network in memory.
CorePolicy = str | FunctionPolicy | _core._BundlePolicy

ENVIRONMENT = "environment.yaml"  #: beside a policy's file: what it was made for
#: Policies that run in any environment.
ANYWHERE = ("zero", "random")


def as_environment(value: Any, source: str = "environment") -> EnvironmentConfig:
    """Any `EnvironmentLike`, as a configuration. Raises ConfigError, naming `source`, for anything else."""
    if isinstance(value, EnvironmentConfig):
        return value
    if isinstance(value, Mapping):
        return EnvironmentConfig.from_dict(value, source)
    if isinstance(value, (str, os.PathLike)):
        text = os.fspath(value)
        return EnvironmentConfig.load(_core.environment_of_policy(text) or text)
    if isinstance(value, Walk):
        return value.environment()
    config = getattr(getattr(value, "unwrapped", value), "config", None)
    if isinstance(config, EnvironmentConfig):
        return config
    expected = "an EnvironmentConfig, its YAML file, a mapping of its keys, a Walk or an environment"
    raise ConfigError(source, "environment", expected, type(value).__name__)


def as_policy(value: Any, source: str = "policy") -> CorePolicy:
    """Any `PolicyLike`, as the core takes it. Raises ConfigError, naming `source`, for anything else."""
    if isinstance(value, PolicyObject):
        return value.for_studies
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, FunctionPolicy):
        return value
    expected = "a name, a file, a Policy or a FunctionPolicy"
    if callable(value):
        expected += " (FunctionPolicy(make) of a function that makes functions)"
    raise ConfigError(source, "policy", expected, type(value).__name__)


def as_policies(value: Any, source: str = "policies") -> list[Any]:
    """One `PolicyLike` or several, as a list of such. Raises ConfigError for others, and for two of one name."""
    if isinstance(value, POLICY_TYPES) or not isinstance(value, Iterable):
        as_policy(value, source)  # says what is wrong with it
        return [value]
    policies = list(value)
    if not policies:
        raise ConfigError(source, "policies", "at least one", "none")
    names = [os.fspath(p) if isinstance(p, (str, os.PathLike)) else getattr(p, "name", None) for p in policies]
    check_names_apart([name for name in names if name is not None], source)
    return policies


def name_in_results(policy: Any, source: str = "policy") -> str:
    """What results call a `PolicyLike`: the text that it is loaded by, or its own name. Raises ConfigError."""
    known = as_policy(policy, source)
    return known if isinstance(known, str) else str(policy.name)


def check_names_apart(names: Sequence[str], source: str) -> None:
    """Raise ConfigError for a name that is there twice."""
    for name in names:
        if names.count(name) > 1:
            expected = "policies of different names, by which results tell them apart (FunctionPolicy(make, name))"
            raise ConfigError(source, "policies", expected, f"'{name}' twice")


def environment_for(environment: Any, *policies: Any, source: str = "environment") -> EnvironmentConfig:
    """The environment that is given; otherwise that of the first policy which has one of its own.

    That of a `Policy` is the one that it was made for; of a name, of a folder and of a file the one beside it. What
    runs anywhere (zero, random) has none, and by itself runs in the default one.

    Raises:
        ConfigError: for a file with none beside it, or a function, which does not say what it is for.

    """
    if environment is not None:
        return as_environment(environment, source)
    for policy in policies:
        if isinstance(policy, (str, os.PathLike)):
            own = _environment_beside(os.fspath(policy))
        else:
            own = policy.environment if isinstance(policy, PolicyObject) else None
        if own is not None:
            return own
    for policy in policies:
        if isinstance(policy, (FunctionPolicy, PolicyObject)):
            raise ConfigError(policy.name, "environment", "environment=, that the policy is for", "none")
    return EnvironmentConfig()


def _environment_beside(policy: str) -> EnvironmentConfig | None:
    if (own := _core.environment_of_policy(policy)) is not None:
        return EnvironmentConfig.load(own)
    if policy in ANYWHERE:
        return None
    if not Path(policy).is_file():
        known = f"zero, random, {', '.join(_core.policy_names())}, a file or a folder"
        raise ConfigError("policy", policy, known, "nothing of that name")
    if (beside := Path(policy).parent / ENVIRONMENT).is_file():
        return EnvironmentConfig.load(beside)
    raise ConfigError(policy, "environment", f"environment=, or {ENVIRONMENT} beside the policy", "none")


def whole_number(value: Any, source: str, element: str) -> int:
    """An integer of 1 or more. Raises ConfigError for anything else."""
    if isinstance(value, bool) or not isinstance(value, Integral) or value < 1:
        raise ConfigError(source, element, "an integer of at least 1", repr(value))
    return int(value)


def misfit(
    function: Callable[..., Any], arguments: Sequence[Any] = (), keywords: Mapping[str, Any] | None = None
) -> tuple[str, str] | None:
    """Return a function as it is declared, and why it does not take these; None if it does, or does not say."""
    try:
        signature = inspect.signature(function, follow_wrapped=False)
    except (TypeError, ValueError):
        return None
    try:
        signature.bind(*arguments, **(keywords or {}))
    except TypeError as error:
        return f"{getattr(function, '__name__', type(function).__name__)}{signature}", str(error)
    return None


def check_maker(make: Callable[..., Any], kind: str, argument: str) -> None:
    """Raise ConfigError for what cannot be called without arguments, as far as it says what it takes."""
    if (wrong := misfit(make)) is not None:
        expected = (
            f"a function without arguments that returns one of {argument}: `lambda: f` of an f that keeps nothing"
        )
        raise ConfigError(kind, "make", expected, wrong[0])


def as_engine(value: Any, source: str = "engine") -> str:
    """The name of an engine. Raises ConfigError for what is none."""
    if isinstance(value, Engine):
        return value.name
    if isinstance(value, str):
        return value
    raise ConfigError(source, "engine", f"one of {', '.join(_core.available_engines())}", repr(value))


def engine_called(name: str) -> Engine:
    """An engine by its name, as pickles have it. Raises ConfigError for one that is not known here."""
    for engine in _core.engines():
        if engine.name == name:
            return engine
    raise ConfigError("engines", "engine", f"one of {', '.join(e.name for e in _core.engines())}", name)


def as_engines(value: Any, source: str = "engines") -> list[str]:
    """Names of engines: of one, of several in a sequence, or in one text with commas as commands take it."""
    return [as_engine(item, source) for item in _parts(value, Engine)]


def as_names(value: str | Iterable[str], source: str, element: str) -> list[str]:
    """Names of anything: one, several in a sequence, or in one text with commas. Raises ConfigError for others."""
    names = _parts(value, str)
    for name in names:
        if not isinstance(name, str):
            raise ConfigError(source, element, "names", repr(name))
    return names


def _parts(value: Any, single: type) -> list[Any]:
    if isinstance(value, str):
        return [part.strip() for part in value.split(",")]
    return [value] if isinstance(value, single) or not isinstance(value, Iterable) else list(value)


def as_robot(value: RobotLike) -> Robot:
    """A robot. Raises ConfigError for what cannot be read."""
    return value if isinstance(value, Robot) else Robot.load(value)


def as_terrain(value: TerrainLike) -> Terrain:
    """A terrain. Raises ConfigError for what cannot be made."""
    return value if isinstance(value, Terrain) else Terrain(value)


def terrain_texts(values: Any, source: str = "terrains") -> list[str]:
    """Terrains as environments name them, of one or of several. Raises ConfigError for others."""
    # A text has commas of its own: rough:amplitude=.01,seed=3.
    single = isinstance(values, (str, os.PathLike, Terrain)) or not isinstance(values, Iterable)
    texts = []
    for value in [values] if single else values:
        if not isinstance(value, (str, os.PathLike, Terrain)):
            expected = "a name, a file or a Terrain (an array becomes one by Terrain.from_heights)"
            raise ConfigError(source, "terrain", expected, type(value).__name__)
        texts.append(EnvironmentConfig(terrain=value).terrain)
    return texts
