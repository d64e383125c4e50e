"""What a sweep is of: a file that spans a grid of runs (docs/sweeps.md)."""

from __future__ import annotations

import itertools
import json
import math
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from crossgait import _core
from crossgait._core import StartRanges, Terrain, Walk
from crossgait.errors import ConfigError, unknown_key
from crossgait.inputs import ANYWHERE, as_engines, environment_for
from crossgait.sweep.runs import Run, Subject, maker_of, run_of
from crossgait.sweep.strict_yaml import read_yaml, write_yaml

Json = dict[str, Any]

MOST_RUNS = 1_000_000  #: of a study: some 15 s of reading, and what a file of rows goes on from in half a minute


class _Kind(NamedTuple):
    """What a key may hold; a list of such is an axis of the grid."""

    expected: str
    holds: Callable[[Any], bool]


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**63


def _is_command(value: Any) -> bool:
    return value is None or (isinstance(value, list) and len(value) == 3 and all(map(_is_number, value)))


_TEXT = _Kind("text", lambda v: isinstance(v, str))
_NUMBER = _Kind("a finite number", _is_number)
_FLAG = _Kind("true or false", lambda v: isinstance(v, bool))
_COUNT = _Kind("a whole number from 0", _is_count)
_COMMAND = _Kind("[forward m/s, left m/s, yaw rate rad/s] or null", _is_command)
_NAMES = _Kind("a list of names", lambda v: isinstance(v, list) and all(isinstance(name, str) for name in v))
_SETTING = _Kind("a finite number or text", lambda v: _is_number(v) or isinstance(v, str))
_ANYTHING = _Kind("a value", lambda v: not isinstance(v, list))
_ENVIRONMENT = _Kind("a file, a policy's name or a mapping of keys", lambda v: isinstance(v, (str, dict)))
_OPTIONAL = _Kind("a finite number or null", lambda v: v is None or _is_number(v))

#: Keys of a walk, in the order of the grid: the last one changes first. `parameters` maps settings.
_WALK: dict[str, _Kind | None] = {
    "robot": _TEXT,
    "terrain": _TEXT,
    "gait": _TEXT,
    "command": _COMMAND,
    "parameters": None,
    "friction": _OPTIONAL,
    "contact": _TEXT,
    "seconds": _NUMBER,
    "physics_dt": _NUMBER,
    "control_dt": _NUMBER,
    "settle": _NUMBER,
    "compensation": _FLAG,
    "heading_hold": _FLAG,
    "terminations": _NAMES,
}
_POLICY: dict[str, _Kind | None] = {"environment": _ENVIRONMENT, "set": None, "policy": _TEXT}
_STUDY = ("engines", "variations", "starts", "seeds", "start_ranges", "walks", "policies")
_RANGES = ("position_m", "heading_rad", "push_mps")


@dataclass(frozen=True)
class Study:
    """A grid of runs, everything said."""

    source: str  #: the file
    document: Json  #: as in the file, with every default

    @staticmethod
    def load(path: str | os.PathLike[str]) -> Study:
        """Read a file. Raises ConfigError naming file, key, what was expected and what was found."""
        source = os.fspath(path)
        study = Study(source, _with_defaults(source, read_yaml(path)))
        if (count := study.count()) > MOST_RUNS:
            raise ConfigError(source, "study", f"at most {MOST_RUNS} runs; several files make more", f"{count}")
        return study

    def count(self) -> int:
        """How many runs the grid has, those that are said twice or are left out included. Raises ConfigError."""
        asked = self.document["starts"]
        subjects = 0
        for name, kinds in (("walks", _WALK), ("policies", _POLICY)):
            for i, block in enumerate(self.document[name]):
                subjects += math.prod(_count(self.source, *axis) for axis in _axes(block, kinds, f"{name}[{i}]"))
        each = (len(self.document[key]) for key in ("seeds", "engines", "variations"))
        return subjects * math.prod(each) * (asked if isinstance(asked, int) else len(asked))

    def to_yaml(self) -> str:
        """The whole study, with every default."""
        return write_yaml(self.document)

    def subjects(self) -> Iterator[Subject]:
        """What moves, each with every seed. Raises ConfigError."""
        return (subject for subject, _ in self._subjects())

    def settings(self) -> dict[str, Json]:
        """What the study says of each run, by the run's hash: its keys, those that have several values first.

        Keys of `parameters` and `set` stand under their own names: `step_height`, `friction`. Lists are tuples.

        Raises:
            ConfigError: as `runs`.

        """
        said = {run.hash: settings for run, settings in reversed(list(self._runs()))}
        values: dict[str, set[str]] = {}
        for settings in said.values():
            for key, value in settings.items():
                values.setdefault(key, set()).add(repr(value))
        order = sorted(values, key=lambda key: len(values[key]) < 2)  # stays as it is otherwise
        return {name: {key: settings.get(key) for key in order} for name, settings in said.items()}

    def _subjects(self) -> Iterator[tuple[Subject, Json]]:
        """With what the file says of each, by key."""
        ranges = json.dumps(self.document["start_ranges"])
        for i, block in enumerate(self.document["walks"]):
            for options in self._grid(block, _WALK, f"walks[{i}]"):
                for seed in self.document["seeds"]:
                    yield Subject(self._walk(options, seed, f"walks[{i}]"), "", "", ranges, seed), _said(options)
        for i, block in enumerate(self.document["policies"]):
            for options in self._grid(block, _POLICY, f"policies[{i}]"):
                policy = self._policy(options["policy"], f"policies[{i}].policy")
                environment = self._environment(options, policy, f"policies[{i}]")
                for seed in self.document["seeds"]:
                    yield Subject("", environment, policy, ranges, seed), _said(options)

    def runs(self) -> list[Run]:
        """All runs, each once, in the order of the grid: subject, engine, variation, start.

        Variations under which a behaviour's time steps are no whole numbers are left out, as a verdict does.

        Raises:
            ConfigError: for a robot, terrain or environment that cannot be read.

        """
        runs: dict[str, Run] = {}
        for run, _ in self._runs():
            runs.setdefault(run.hash, run)
        return list(runs.values())

    def _runs(self) -> Iterator[tuple[Run, Json]]:
        """With what the file says of each; what is said twice comes twice."""
        maker_of.cache_clear()  # files may have changed since
        asked = self.document["starts"]
        starts = range(asked) if isinstance(asked, int) else asked
        for subject, said in self._subjects():
            try:
                maker_of(subject)
            except ConfigError as error:
                raise self._error("grid", error) from error
            for engine, variation in itertools.product(self.document["engines"], self.document["variations"]):
                if not _allows(subject, engine, variation):
                    continue
                for start in starts:
                    yield run_of(subject, engine, variation, start), said

    def _error(self, where: str, error: ConfigError) -> ConfigError:
        return ConfigError(self.source, f"{where}, {error.source}: {error.element}", error.expected, error.found)

    def _grid(self, block: Json, kinds: dict[str, _Kind | None], where: str) -> Iterator[Json]:
        axes = [
            _settings(self.source, value, kind, at) if nested else _choices(self.source, value, kind, at)
            for value, kind, nested, at in _axes(block, kinds, where)
        ]
        for values in itertools.product(*axes):
            yield dict(zip(block, values, strict=True))

    def _beside(self, text: str) -> str:
        """A file from the study's folder; anything else, such as a bundled robot's name, as it is."""
        folder = Path(self.source).resolve().parent
        for name, settings in ((text, ""), _split(text)):  # FILE.png:height=.05
            if name and (folder / name).is_file():
                return str(folder / name) + settings
        return text

    def _walk(self, options: Json, seed: int, where: str) -> str:
        own = {**options, "robot": self._beside(options["robot"]), "terrain": self._beside(options["terrain"])}
        try:
            Walk(**own, seed=seed)
            Terrain(own["terrain"], seed=seed)
        except ConfigError as error:
            raise self._error(where, error) from error
        return json.dumps(own)

    def _environment(self, options: Json, policy: str, where: str) -> str:
        """What a block says, or else the policy's own, with what is set over it."""
        named = options["environment"]
        try:
            given = self._with_files(named) if isinstance(named, dict) else self._found(named) or None
            config = environment_for(given, policy, source=f"{where}.environment")
            return config.updated(self._with_files(options["set"]), f"{where}.set").to_yaml()
        except ConfigError as error:
            raise self._error(where, error) from error

    def _with_files(self, keys: Json) -> Json:
        """Keys of an environment, those that name files from the study's folder."""
        return {
            key: self._beside(value) if key in ("robot", "terrain") and isinstance(value, str) else value
            for key, value in keys.items()
        }

    def _found(self, text: str) -> str:
        """A policy's name as it is, and any other file or folder from the study's folder."""
        place = Path(self.source).resolve().parent / text
        return str(place) if text and text not in _core.policy_names() and place.exists() else text

    def _policy(self, text: str, where: str) -> str:
        if text in (known := (*ANYWHERE, *_core.policy_names())):
            return text
        if (found := self._found(text)) == text and not Path(text).is_absolute():
            raise ConfigError(self.source, where, f"{', '.join(known)}, a policy's file or folder", text)
        return found


def _said(options: Json) -> Json:
    """Settings of one block, those of `parameters` and `set` among them, in values that tables group by."""
    nested = {**options.get("parameters", {}), **options.get("set", {})}
    flat = {key: value for key, value in options.items() if key not in ("parameters", "set")} | nested
    return {key: _groupable(value) for key, value in flat.items()}


def _groupable(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(_groupable(item) for item in value)
    return json.dumps(value) if isinstance(value, dict) else value


def _split(text: str) -> tuple[str, str]:
    name, colon, settings = text.rpartition(":")
    return name, colon + settings


def _allows(subject: Subject, engine: str, variation: str) -> bool:
    if variation == _core._variations()[0]:
        return True
    try:
        return maker_of(subject).allows(engine, variation)
    except ConfigError:
        return True  # its runs say what is wrong


def _axes(block: Json, kinds: dict[str, _Kind | None], where: str) -> Iterator[tuple[Any, _Kind, bool, str]]:
    """Of a block: value, kind, whether it maps settings that are axes themselves, and where it stands."""
    for key, value in block.items():
        kind = kinds[key]
        settings = _SETTING if key == "parameters" else _ANYTHING
        yield value, kind or settings, kind is None, f"{where}.{key}"


def _count(source: str, value: Any, kind: _Kind, nested: bool, where: str) -> int:
    """How many values an axis has, without making them. Raises ConfigError."""
    if not nested:
        return len(_choices(source, value, kind, where))
    return sum(math.prod(map(len, axes)) for _, axes in _settings_axes(source, value, kind, where))


def _choices(source: str, value: Any, kind: _Kind, where: str) -> list[Any]:
    if kind.holds(value):
        return [value]
    if isinstance(value, list) and value:
        for i, item in enumerate(value):
            if not kind.holds(item):
                raise ConfigError(source, f"{where}[{i}]", kind.expected, _shown(item))
        return value
    raise ConfigError(source, where, f"{kind.expected}, or a list of such", _shown(value))


def _settings_axes(source: str, value: Any, kind: _Kind, where: str) -> Iterator[tuple[Json, list[list[Any]]]]:
    """Of mappings, whose values may be axes too. A value that is a list itself stands in one of its own."""
    for i, mapping in enumerate(value if isinstance(value, list) else [value]):
        here = f"{where}[{i}]" if isinstance(value, list) else where
        _check_mapping(source, mapping, here)
        axes = []
        for key, item in mapping.items():
            nested = kind is _ANYTHING and isinstance(item, list) and item
            axes.append(item if nested else _choices(source, item, kind, f"{here}.{key}"))
        yield mapping, axes


def _settings(source: str, value: Any, kind: _Kind, where: str) -> list[Json]:
    grid: list[Json] = []
    for mapping, axes in _settings_axes(source, value, kind, where):
        grid += [dict(zip(mapping, values, strict=True)) for values in itertools.product(*axes)]
    if not grid:
        raise ConfigError(source, where, "settings, or a list of such", _shown(value))
    return grid


def _check_mapping(source: str, value: Any, where: str) -> None:
    if not isinstance(value, dict) or not all(isinstance(key, str) for key in value):
        raise ConfigError(source, where, "keys and their values", _shown(value))


def _check_keys(source: str, value: Any, known: tuple[str, ...], where: str) -> None:
    _check_mapping(source, value, where)
    for key in value:
        if key not in known:
            at = f"{where}.{key}" if where != "study" else key
            raise unknown_key(source, at, key, known)


def _shown(value: Any) -> str:
    text = json.dumps(value, default=str)
    return text if len(text) <= 80 else text[:77] + "..."


def _with_defaults(source: str, given: Any) -> Json:
    given = {} if given is None else given
    _check_keys(source, given, _STUDY, "study")
    if not given.get("walks") and not given.get("policies"):
        raise ConfigError(source, "study", "walks, policies, or both", "neither")
    variations = given.get("variations", [_core._variations()[0]])
    variations = _core._variations() if variations == "all" else variations
    available = _core.available_engines()
    document: Json = {
        "engines": _names(source, _engines(given.get("engines", available)), available, "engines"),
        "variations": _names(source, variations, _core._variations(), "variations"),
        "starts": _starts(source, given.get("starts", 1)),
        "seeds": _choices(source, given.get("seeds", 0), _COUNT, "seeds"),
        "start_ranges": _ranges(source, given.get("start_ranges", {})),
    }
    walk = Walk()
    defaults = {key: {} if key == "parameters" else getattr(walk, key) for key in _WALK}
    document["walks"] = _blocks(source, given.get("walks", []), defaults, "walks")
    defaults = {"environment": "", "set": {}, "policy": "zero"}
    document["policies"] = _blocks(source, given.get("policies", []), defaults, "policies")
    return document


def _engines(value: Any) -> Any:
    """One text with commas as the list that it is, as everywhere."""
    return as_engines(value) if isinstance(value, str) else value


def _names(source: str, value: Any, known: list[str], where: str) -> list[str]:
    names: list[str] = _choices(source, value, _TEXT, where)
    for name in names:
        if name not in known:
            raise ConfigError(source, where, f"of {', '.join(known)}", name)
    return names


def _starts(source: str, value: Any) -> int | list[int]:
    if not isinstance(value, list):
        if not _is_count(value) or value == 0:
            raise ConfigError(source, "starts", "how many, or a list of their numbers", _shown(value))
        return int(value)
    return _choices(source, value, _COUNT, "starts")


def _ranges(source: str, value: Any) -> Json:
    _check_keys(source, value, _RANGES, "start_ranges")
    default = StartRanges()
    ranges = {key: value.get(key, getattr(default, key)) for key in _RANGES}
    for key, item in ranges.items():
        kind = _NUMBER if key == "heading_rad" else _OPTIONAL
        if not kind.holds(item) or (item is not None and item < 0):
            raise ConfigError(source, f"start_ranges.{key}", f"{kind.expected}, not negative", _shown(item))
    return ranges


def _blocks(source: str, value: Any, defaults: Json, where: str) -> list[Json]:
    if not isinstance(value, list):
        raise ConfigError(source, where, "a list of blocks", _shown(value))
    blocks = []
    for i, block in enumerate(value):
        _check_keys(source, block, tuple(defaults), f"{where}[{i}]")
        blocks.append({key: block.get(key, default) for key, default in defaults.items()})
    return blocks
