"""What a training run does, everything said: made of a YAML file or a preset (docs/training.md)."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crossgait import _core
from crossgait._core import EnvironmentConfig, PolicyInterface
from crossgait.errors import ConfigError
from crossgait.sweep.strict_yaml import parse_yaml, read_yaml, write_yaml
from crossgait.train.keys import COMMAND, STAGE, TABLE, Json, filled, is_range, shown

_PRESETS = Path(__file__).parent / "presets"


def presets() -> list[str]:
    """Names that `Plan.preset` takes."""
    return sorted(path.stem for path in _PRESETS.glob("*.yaml"))


@dataclass(frozen=True)
class Stage:
    """A part of the curriculum."""

    index: int
    begin: int  #: steps after which it begins
    environment: EnvironmentConfig
    command: dict[str, tuple[float, float]]  #: ranges that each episode draws its command from; empty: none


@dataclass(frozen=True)
class Plan:
    """A training run, checked."""

    source: str  #: the file
    document: Json  #: as in the file, with every default; its environment stands in place
    stages: tuple[Stage, ...]
    evaluated: EnvironmentConfig  #: the last stage's, on held-out ground

    @staticmethod
    def load(path: str | os.PathLike[str], changes: Sequence[str] = ()) -> Plan:
        """Read a file; `changes` are KEY=VALUE, in its place. Raises ConfigError."""
        return Plan.parse(read_yaml(path), os.fspath(path), Path(path).parent, changes)

    @staticmethod
    def preset(name: str, changes: Sequence[str] = ()) -> Plan:
        """One that the package brings. Raises ConfigError."""
        if name not in presets():
            raise ConfigError("train", "preset", f"one of {', '.join(presets())}", name)
        return Plan.load(_PRESETS / f"{name}.yaml", changes)

    @staticmethod
    def parse(given: Any, source: str, folder: Path | None = None, changes: Sequence[str] = ()) -> Plan:
        """Of what a file holds; files that it names are found from `folder`. Raises ConfigError."""
        given = {} if given is None else given
        if not isinstance(given, dict):
            raise ConfigError(source, "file", "a mapping", shown(given))
        given = json.loads(json.dumps(given))
        for change in changes:
            _apply(given, change)
        document = filled(source, given, TABLE)
        base = _base(source, document, folder or Path())
        stages = tuple(_stages(source, document, base, folder or Path()))
        _place(document["evaluation"]["set"], source, "evaluation.set", folder or Path())
        plan = Plan(source, document, stages, _evaluated(source, document, stages[-1].environment))
        _check(plan)
        return plan

    def to_yaml(self) -> str:
        """The whole, with every default."""
        return write_yaml(self.document)

    def __getitem__(self, key: str) -> Any:
        return self.document[key]

    def stage(self, steps: int) -> Stage:
        """The one that a rollout belongs to which begins after so many steps."""
        return [stage for stage in self.stages if stage.begin <= steps][-1]

    @property
    def engines(self) -> list[tuple[str, int]]:
        """Engines with the number of environments that each has."""
        return _shared_out(self.document["engines"], self.document["environments"])

    @property
    def evaluation_engines(self) -> list[str]:
        """Where the policy is evaluated."""
        return list(self.document["evaluation"]["engines"] or _core.available_engines())


def _apply(document: Json, change: str) -> None:
    """Set what KEY.KEY=VALUE says, its value as in YAML."""
    path, equals, text = change.partition("=")
    if not equals or not path:
        raise ConfigError("--set", change, "KEY=VALUE", "no =" if not equals else "no key")
    *above, last = path.split(".")
    at = document
    for key in above:
        at = at.setdefault(key, {})
        if not isinstance(at, dict):
            raise ConfigError("--set", path, f"a mapping at {key}", shown(at))
    at[last] = parse_yaml(text, f"--set {path}")


def _base(source: str, document: Json, folder: Path) -> EnvironmentConfig:
    given = document["environment"]
    if isinstance(given, str):
        config = EnvironmentConfig.load(os.fspath(folder / given))
    else:
        _place(given, source, "environment", folder)
        config = _of_core(EnvironmentConfig.parse, given, f"{source}: environment")
    if document["randomisation"]:
        config = _updated(config, {"randomisation": document["randomisation"]}, f"{source}: randomisation")
    config = _updated(config, {"engine": next(iter(document["engines"]))}, source)
    # In place and by whole paths, so that the run's folder is all that it takes to go on.
    written = parse_yaml(config.to_yaml(), f"{source}: environment")
    del written["engine"]
    document["environment"], document["randomisation"] = written, {}
    return config


def _place(keys: Json, source: str, where: str, folder: Path) -> None:
    """Name files in `keys` by whole paths, from `folder`. Raises ConfigError for an engine, named elsewhere."""
    if "engine" in keys:
        raise ConfigError(source, f"{where}.engine", "no engine: `engines` names them", shown(keys["engine"]))
    for key in ("robot", "terrain"):
        if isinstance(keys.get(key), str):
            file, colon, settings = keys[key].partition(":")
            if (folder / file).is_file():
                keys[key] = f"{(folder / file).resolve()}{colon}{settings}"


def _updated(config: EnvironmentConfig, keys: Json, source: str) -> EnvironmentConfig:
    return _of_core(config.updated, keys, source) if keys else config


def _of_core(read: Callable[[str, str], EnvironmentConfig], keys: Json, source: str) -> EnvironmentConfig:
    """What the core makes of `keys`; its errors name the key, as the line is none of the file's."""
    try:
        return read(json.dumps(keys), source)
    except ConfigError as error:
        element = re.sub(r"^line \d+(, )?", "", error.element) or "value"
        raise ConfigError(error.source, element, error.expected, error.found) from error


def _stages(source: str, document: Json, base: EnvironmentConfig, folder: Path) -> list[Stage]:
    stages: list[Stage] = []
    for i, given in enumerate(document["curriculum"] or [{}]):
        where = f"curriculum[{i}]"
        said = filled(source, given, STAGE, f"{where}.")
        if (i == 0 and said["from"] != 0) or (i > 0 and said["from"] <= stages[-1].begin):
            expected = "0 for the first stage" if i == 0 else f"more than {stages[-1].begin}"
            raise ConfigError(source, f"{where}.from", expected, str(said["from"]))
        for key, value in said["command"].items():
            if key not in COMMAND or not is_range(value):
                raise ConfigError(source, f"{where}.command.{key}", "vx, vy or yaw_rate with [min, max]", shown(value))
        _place(said["set"], source, f"{where}.set", folder)
        environment = _updated(base, said["set"], f"{source}: {where}.set")
        command = {key: (float(low), float(high)) for key, (low, high) in said["command"].items()}
        stages.append(Stage(i, said["from"], environment, command))
    return stages


def _evaluated(source: str, document: Json, last: EnvironmentConfig) -> EnvironmentConfig:
    asked = document["evaluation"]
    held_out = {"randomisation": {"terrain_seed": asked["terrain_seeds"]}}
    config = _updated(last, held_out, f"{source}: evaluation.terrain_seeds")
    return _updated(config, asked["set"], f"{source}: evaluation.set")


def _terrain_seeds(config: EnvironmentConfig) -> tuple[float, float]:
    said = parse_yaml(config.to_yaml(), "environment")
    low, high = said.get("randomisation", {}).get("terrain_seed", [said["terrain_seed"]] * 2)
    return low, high


def _check(plan: Plan) -> None:
    """What only making the environments tells. Raises ConfigError."""
    document, source = plan.document, plan.source
    counts = plan.engines
    for engine, count in counts:
        if count == 0:
            raise ConfigError(source, "environments", f"enough for a share of {engine}", str(document["environments"]))
    low, high = document["evaluation"]["terrain_seeds"]
    layouts = {}
    for stage in plan.stages:
        first, last = _terrain_seeds(stage.environment)
        if first <= high and low <= last:
            found = f"[{low}, {high}], where training has [{first:g}, {last:g}]"
            raise ConfigError(source, "evaluation.terrain_seeds", "seeds that training does not see", found)
        layouts[stage.index] = PolicyInterface(stage.environment).layout_hash
        if layouts[stage.index] != layouts[0]:
            raise ConfigError(source, f"curriculum[{stage.index}].set", "the first stage's layout", "another")
    if PolicyInterface(plan.evaluated).layout_hash != layouts[0]:
        raise ConfigError(source, "evaluation.set", "the layout of training", "another")
    _check_engines(source, "engines", [name for name, _ in counts], plan.evaluated)
    _check_engines(source, "evaluation.engines", plan.evaluation_engines, plan.evaluated)
    rollout = document["environments"] * document["algorithm"]["n_steps"]
    if document["algorithm"]["batch_size"] > rollout:
        expected = f"at most environments x n_steps, {rollout}"
        raise ConfigError(source, "algorithm.batch_size", expected, str(document["algorithm"]["batch_size"]))


def _check_engines(source: str, key: str, engines: Sequence[str], environment: EnvironmentConfig) -> None:
    for engine in engines:
        try:
            _core.Environment(environment, engine)
        except ConfigError as error:
            raise ConfigError(source, f"{key}: {engine}", error.expected, error.found) from error


def _shared_out(shares: dict[str, float], count: int) -> list[tuple[str, int]]:
    """By largest remainders, so that the counts add up."""
    total = sum(shares.values())
    exact = {name: count * share / total for name, share in shares.items()}
    counts = {name: int(number) for name, number in exact.items()}
    by_remainder = sorted(exact, key=lambda name: counts[name] - exact[name])
    for name in by_remainder[: count - sum(counts.values())]:
        counts[name] += 1
    return list(counts.items())
