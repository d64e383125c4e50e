"""What a training run does, everything said: made of a YAML file or a preset (docs/training.md)."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from crossgait import _core
from crossgait._core import EnvironmentConfig, PolicyInterface
from crossgait.errors import ConfigError
from crossgait.inputs import as_engines, as_environment
from crossgait.sweep.strict_yaml import parse_yaml, read_yaml, write_yaml
from crossgait.terms import Terms, with_terms
from crossgait.train.keys import (
    COMMAND,
    HIERARCHY,
    PLANNER,
    RESIDUAL,
    SHARE,
    STAGE,
    TABLE,
    Json,
    filled,
    is_range,
    shown,
)

_PRESETS = Path(__file__).parent / "presets"


def presets() -> list[str]:
    """Names that `Plan.preset` takes."""
    return sorted(path.stem for path in _PRESETS.glob("*.yaml"))


#: Ranges that each episode draws its command from, by vx, vy and yaw_rate; none: the environment's own command.
Commands = dict[str, tuple[float, float]]


#: What is to be otherwise than in a file: KEY=VALUE, one or several, or values by key.
Changes = str | Sequence[str] | Mapping[str, Any]


@dataclass(frozen=True)
class Share:
    """What some of the environments of a stage meet."""

    share: float  #: of the environments, beside the others' shares
    environment: EnvironmentConfig
    command: Commands


@dataclass(frozen=True)
class Stage:
    """A part of the curriculum."""

    index: int
    begin: int  #: steps after which it begins
    environment: EnvironmentConfig  #: without what single shares change
    mix: tuple[Share, ...]  #: at least one


@dataclass(frozen=True)
class Plan:
    """A training run, checked."""

    source: str  #: the file
    document: Json  #: as in the file, with every default; its environment stands in place
    stages: tuple[Stage, ...]
    evaluated: EnvironmentConfig  #: the last stage's, on held-out ground
    parts: Mapping[str, Plan] = field(default_factory=dict)  #: of a hierarchical policy, in order; of one policy none

    @staticmethod
    def load(path: str | os.PathLike[str], changes: Changes = ()) -> Plan:
        """Read a file; `changes` are KEY=VALUE, one or several, or a mapping, in its place. Raises ConfigError."""
        return Plan.parse(read_yaml(path), os.fspath(path), Path(path).parent, changes)

    @staticmethod
    def preset(name: str, changes: Changes = ()) -> Plan:
        """One that the package brings; `changes` as `load`. Raises ConfigError."""
        if name not in presets():
            raise ConfigError("train", "preset", f"one of {', '.join(presets())}", name)
        return Plan.load(_PRESETS / f"{name}.yaml", changes)

    @staticmethod
    def parse(given: Any, source: str = "plan", folder: Path | None = None, changes: Changes = ()) -> Plan:
        """Of a file's text, or what it holds; files that it names are found from `folder`. Raises ConfigError."""
        given = parse_yaml(given, source) if isinstance(given, str) else given
        given = {} if given is None else given
        if not isinstance(given, dict):
            raise ConfigError(source, "file", "a mapping", shown(given))
        given = json.loads(json.dumps(given))
        if "terms" in given:
            expected = "none: they are functions of the program that trained, which begins with Plan.with_terms"
            raise ConfigError(source, "terms", expected, shown(given["terms"]))
        for change in _written(changes):
            _apply_change(given, change)
        document = filled(source, given, TABLE)
        if not isinstance(document["engines"], dict):  # names alone: equal shares
            document["engines"] = dict.fromkeys(as_engines(document["engines"]), 1.0)
        if isinstance(document["evaluation"]["engines"], str):
            document["evaluation"]["engines"] = as_engines(document["evaluation"]["engines"])
        base = _base_environment(source, document, folder or Path())
        stages = tuple(_stages(source, document, base, folder or Path()))
        _resolve_files(document["evaluation"]["set"], source, "evaluation.set", folder or Path())
        _resolve_files(document["evaluation"], source, "evaluation", folder or Path())
        plan = Plan(source, document, stages, _evaluated(source, document, stages[-1].environment))
        _check(plan)
        return plan if document["hierarchy"] is None else replace(plan, parts=_parts(plan, folder or Path()))

    def with_terms(self, terms: Terms) -> Plan:
        """Return the plan with `terms` in all of its environments, for a `Trainer` of this process.

        Curricula are of training alone: evaluations have the other terms as they began. The file names them, and so
        cannot be trained from: functions are in no file. Raises ConfigError, also for a hierarchical policy, whose
        parts see other observations.
        """
        if self.parts:
            raise ConfigError(self.source, "terms", "none of a hierarchical policy", "some")
        changed = self._with_environments(lambda environment: with_terms(environment, terms))
        judged = replace(terms, curriculum={}) if terms.curriculum else terms
        evaluated = with_terms(self.evaluated, judged)
        return replace(changed, evaluated=evaluated, document=self.document | {"terms": terms.names})

    def without_terms(self) -> tuple[Plan, Terms | None]:
        """Return the plan as its file has it, which can be pickled, and the terms that it was given."""
        terms = self.stages[0].environment.terms
        if terms is None:
            return self, None
        document = {key: value for key, value in self.document.items() if key != "terms"}
        plain = self._with_environments(lambda environment: environment._without_terms())
        return replace(plain, document=document), terms

    def _with_environments(self, change: Callable[[EnvironmentConfig], EnvironmentConfig]) -> Plan:
        stages = tuple(
            replace(
                stage,
                environment=change(stage.environment),
                mix=tuple(replace(share, environment=change(share.environment)) for share in stage.mix),
            )
            for stage in self.stages
        )
        return replace(self, stages=stages, evaluated=change(self.evaluated))

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

    def shared_out(self, stage: Stage) -> list[tuple[str, Share, int]]:
        """The environments of a stage: engine, what they meet, and how many."""
        dealt = []
        for engine, count in self.engines:
            shares = _shared_out({str(i): share.share for i, share in enumerate(stage.mix)}, count)
            dealt += [(engine, stage.mix[int(i)], number) for i, number in shares if number > 0]
        return dealt

    @property
    def evaluation_engines(self) -> list[str]:
        """Where the policy is evaluated."""
        return list(self.document["evaluation"]["engines"] or _core.available_engines())


def _parts(plan: Plan, folder: Path) -> dict[str, Plan]:
    """What each part of a hierarchical policy is trained by: the file's own keys, and over them the part's."""
    source, document = plan.source, plan.document
    said = document["hierarchy"] = filled(source, document["hierarchy"], HIERARCHY, "hierarchy.")
    _check_members(plan, said)
    plans = {}
    for name in ("planner", "residual", "together"):
        own = dict(said[name]["set"])
        if found := next((key for key in ("hierarchy", "environment", "seed") if key in own), None):
            raise ConfigError(source, f"hierarchy.{name}.set.{found}", "a key that parts may differ in", "another")
        given = _merge_sections(document | {"hierarchy": None, "steps": said[name]["steps"] or document["steps"]}, own)
        if name == "planner":  # coarse steps, evaluated as a part of the whole
            fine = given["environment"]["policy_dt"]
            given["environment"]["policy_dt"] = said["planner_dt"]
            given["evaluation"]["set"].setdefault("policy_dt", fine)
        if name == "together":  # both members bring their normalisation along
            given["normalise"]["observation"] = False
        plans[name] = Plan.parse(given, f"{source}: hierarchy.{name}", folder)
    return plans


def _check_members(plan: Plan, said: Json) -> None:
    environment = plan.stages[0].environment
    whole, fine, pace = PolicyInterface(environment), environment.policy_dt, said["planner_dt"]
    steps = round(pace / fine)
    if steps < 1 or abs(steps * fine - pace) > 1e-9 * fine:
        raise ConfigError(
            plan.source, "hierarchy.planner_dt", f"a multiple of the policy step, {fine:g} s", f"{pace:g}"
        )
    for name, part, dt in (("planner", PLANNER, pace), ("residual", RESIDUAL, fine)):
        try:
            whole.member(part, observation=said[name]["observation"], policy_dt=dt)
        except ConfigError as error:
            raise ConfigError(plan.source, f"hierarchy.{name}: {error.element}", error.expected, error.found) from error


def _merge_sections(below: Json, above: Json) -> Json:
    """A copy of `below` with what `above` says in its place, section by section."""
    merged: Json = json.loads(json.dumps(below))
    for key, value in above.items():
        nested = isinstance(TABLE.get(key), dict) and isinstance(value, dict)
        merged[key] = merged[key] | value if nested else value
    return merged


def _apply_change(document: Json, change: str) -> None:
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


def _written(changes: Changes) -> Sequence[str]:
    """Return changes as commands have them."""
    if isinstance(changes, Mapping):
        return [f"{key}={json.dumps(value)}" for key, value in changes.items()]
    return [changes] if isinstance(changes, str) else changes


def _base_environment(source: str, document: Json, folder: Path) -> EnvironmentConfig:
    given = document["environment"]
    if isinstance(given, str):
        file = folder / given
        config = as_environment(file if file.is_file() else given, f"{source}: environment")
    else:
        _resolve_files(given, source, "environment", folder)
        config = _read_config(EnvironmentConfig.from_dict, given, f"{source}: environment")
    if document["randomisation"]:
        config = _updated(config, {"randomisation": document["randomisation"]}, f"{source}: randomisation")
    config = _updated(config, {"engine": next(iter(document["engines"]))}, source)
    # In place and by whole paths, so that the run's folder is all that it takes to go on.
    document["environment"] = {key: value for key, value in config.to_dict().items() if key != "engine"}
    document["randomisation"] = {}
    return config


def _resolve_files(keys: Json, source: str, where: str, folder: Path) -> None:
    """Name files in `keys` by whole paths, from `folder`. Raises ConfigError for an engine, named elsewhere."""
    if "engine" in keys:
        raise ConfigError(source, f"{where}.engine", "no engine: `engines` names them", shown(keys["engine"]))
    for key in ("robot", "terrain", "course"):
        if isinstance(keys.get(key), str):
            file, colon, settings = keys[key].partition(":")
            if (folder / file).is_file():
                keys[key] = f"{(folder / file).resolve()}{colon}{settings}"


def _updated(config: EnvironmentConfig, keys: Json, source: str) -> EnvironmentConfig:
    return _read_config(config.updated, keys, source) if keys else config


def _read_config(read: Callable[[Json, str], EnvironmentConfig], keys: Json, source: str) -> EnvironmentConfig:
    """What the core makes of `keys`; its errors name the key, as the line is none of the file's."""
    try:
        return read(keys, source)
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
        environment, command = _apply_settings(source, said, base, where, folder)
        mix = [
            Share(float(one["share"]), *_apply_settings(source, one, environment, f"{where}.mix[{k}]", folder, command))
            for k, one in enumerate(filled(source, m, SHARE, f"{where}.mix[{k}].") for k, m in enumerate(said["mix"]))
        ]
        stages.append(Stage(i, said["from"], environment, tuple(mix or [Share(1.0, environment, command)])))
    return stages


def _apply_settings(
    source: str, said: Json, base: EnvironmentConfig, where: str, folder: Path, over: Commands | None = None
) -> tuple[EnvironmentConfig, Commands]:
    """What `set` and `command` of a stage or a share make of a base and its commands."""
    for key, value in said["command"].items():
        if key not in COMMAND or not is_range(value):
            raise ConfigError(source, f"{where}.command.{key}", "vx, vy or yaw_rate with [min, max]", shown(value))
    _resolve_files(said["set"], source, f"{where}.set", folder)
    command = {key: (float(low), float(high)) for key, (low, high) in said["command"].items()}
    return _updated(base, said["set"], f"{source}: {where}.set"), (over or {}) | command


def _evaluated(source: str, document: Json, last: EnvironmentConfig) -> EnvironmentConfig:
    asked = document["evaluation"]
    held_out = {"randomisation": {"terrain_seed": asked["terrain_seeds"]}}
    config = _updated(last, held_out, f"{source}: evaluation.terrain_seeds")
    return _updated(config, asked["set"], f"{source}: evaluation.set")


def _terrain_seeds(config: EnvironmentConfig) -> tuple[float, float]:
    low, high = config.randomisation.get("terrain_seed", [config.terrain_seed] * 2)
    return low, high


def _check(plan: Plan) -> None:
    """What only making the environments tells. Raises ConfigError."""
    document, source = plan.document, plan.source
    counts = plan.engines
    for engine, count in counts:
        if count == 0:
            raise ConfigError(source, "environments", f"enough for a share of {engine}", str(document["environments"]))
    low, high = document["evaluation"]["terrain_seeds"]
    layout = PolicyInterface(plan.stages[0].environment).layout_hash
    for stage in plan.stages:
        for k, share in enumerate(stage.mix):
            first, last = _terrain_seeds(share.environment)
            if first <= high and low <= last:
                found = f"[{low}, {high}], where training has [{first:g}, {last:g}]"
                raise ConfigError(source, "evaluation.terrain_seeds", "seeds that training does not see", found)
            if PolicyInterface(share.environment).layout_hash != layout:
                where = f"curriculum[{stage.index}]" + (f".mix[{k}]" if len(stage.mix) > 1 else "")
                raise ConfigError(source, f"{where}.set", "the first stage's layout", "another")
        dealt = {share.environment for _, share, _ in plan.shared_out(stage)}
        if len(dealt) < len({share.environment for share in stage.mix}):
            expected = f"enough for {len(stage.mix)} shares in every engine"
            raise ConfigError(source, f"curriculum[{stage.index}].mix", expected, f"{document['environments']}")
    if PolicyInterface(plan.evaluated).layout_hash != layout:
        raise ConfigError(source, "evaluation.set", "the layout of training", "another")
    _check_engines(source, "engines", [name for name, _ in counts], plan.evaluated)
    _check_engines(source, "evaluation.engines", plan.evaluation_engines, plan.evaluated)
    if document["evaluation"]["score"] == "course":
        try:
            _core.course_sections(document["evaluation"]["course"])
        except ConfigError as error:
            raise ConfigError(source, f"evaluation.course: {error.element}", error.expected, error.found) from error
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
