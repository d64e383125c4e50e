"""From a policy and what came with it to a folder that runs everywhere."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crossgait._core import EnvironmentConfig, PolicyInterface, Robot
from crossgait.errors import ConfigError, unknown_key
from crossgait.files import (
    check_outputs,
    from_root,
    locked_folder,
    noting_reads,
    read_bytes,
    replace_together,
    staged,
    written_whole,
)
from crossgait.importing import environment, forms, network, stated, terms
from crossgait.importing.actuator import ACTUATOR_FILE, write_actuator
from crossgait.importing.contract import SETTINGS, Contract, Field
from crossgait.importing.stated import Stated
from crossgait.sweep import strict_yaml

ENVIRONMENT_FILE, TABLE_FILE = "environment.yaml", "import.json"


@dataclass(frozen=True)
class Imported:
    """What an import wrote, and where each of its fields comes from.

    Attributes:
        policy: the policy's file.
        environment_file: the environment's.
        environment: its configuration.
        fields: with the place where each was said, `robot` or `default`.
        unstated: names of fields that nobody said.
        unread: places of keys that say nothing which an import takes.

    """

    policy: str
    environment_file: str
    environment: dict[str, Any]
    fields: list[Field]
    unstated: list[str]
    unread: list[str]

    @property
    def folder(self) -> str:
        """What `--policy` takes."""
        return os.path.dirname(self.policy)

    def __fspath__(self) -> str:
        """Stand for the folder, wherever a policy is taken."""
        return self.folder

    def to_dict(self) -> dict[str, Any]:
        """Keys as `crossgait import --json` has them."""
        return {
            "policy": self.policy,
            "environment_file": self.environment_file,
            "environment": self.environment,
            "fields": [{"name": f.name, "value": f.value, "source": f.source} for f in self.fields],
            "unstated": self.unstated,
            "unread": self.unread,
        }

    def __str__(self) -> str:
        rows = [(f.name, _short(f.value), f.source) for f in self.fields]
        widths = [max(len(row[i]) for row in rows) for i in range(2)]
        lines = [f"{name:<{widths[0]}}  {value:<{widths[1]}}  {source}" for name, value, source in rows]
        lines.append("")
        lines.append("Nobody said: " + (", ".join(self.unstated) or "nothing") + ".")
        if self.unread:
            lines.append("Not taken: " + ", ".join(self.unread) + ".")
        lines.append(f"{self.policy} runs in {self.environment_file}: crossgait rollout --policy {self.folder}")
        return "\n".join(lines)


def _short(value: Any) -> str:
    """A value in one line of at most 60 characters."""
    if isinstance(value, dict) and value and all(isinstance(v, (int, float)) for v in value.values()):
        value = environment.one_or_each(value)
    if isinstance(value, dict):
        text = ", ".join(f"{k} {_short(v)}" for k, v in value.items())
    elif isinstance(value, list):
        text = ", ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in value)
    else:
        text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 60 else text[:57] + "..."


def import_policy(
    policy: str | os.PathLike[str],
    robot: str | os.PathLike[str],
    out: str | os.PathLike[str],
    sources: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
    *,
    settings: Mapping[str, Any] | None = None,
    joint_order: str | None = None,
    config_class: str | None = None,
) -> Imported:
    """Make a folder of a published policy: its network, its environment, and where every field comes from.

    Args:
        policy: FILE.onnx, TorchScript, a checkpoint of rsl_rl (with its agent.yaml), or a bundle.
        robot: a bundled robot's name or a file.
        out: the folder, whose name becomes the policy's; made if it is not there.
        sources: files that came with it: deploy.yaml, env.yaml, agent.yaml, config.yaml and base.yaml of rsl_rl and
            rl_sar, classes of legged_gym (FILE.py). Metadata of an ONNX file is read by itself.
        settings: fields that the caller says, by their names in the table, as a file would.
        joint_order: the convention that joints without names follow; that of the form by default.
        config_class: of Python files, which class.

    Raises:
        ConfigError: naming the place of what is wrong, what an environment cannot say, and both places of what is
            said twice and differently

    """
    file, name = os.fspath(policy), os.fspath(robot)
    files = [os.fspath(sources)] if isinstance(sources, (str, os.PathLike)) else [os.fspath(s) for s in sources]
    with noting_reads() as read:
        contract = Contract(Robot.load(name))
        roots, agent = _read_files(files, config_class)
        if file.endswith(".onnx"):
            roots += _metadata(file)
    folder = Path(os.path.normpath(from_root(out)))
    outputs = [("--out", folder / each) for each in (*_may_be_written(folder), TABLE_FILE)]
    check_outputs(outputs, [("the policy", file), *read])
    _check_folder(folder)
    if not roots and not settings:
        raise ConfigError(file, "interface", "a file that says it (--from), or metadata in it", "neither")
    _say_settings(contract, settings or {})
    folders = tuple(os.path.dirname(os.path.abspath(source)) for source in files)
    for root in roots:
        forms.find_form(root).read(root, contract, forms.Options(joint_order, folders))
    _require(contract, file)
    made = environment.make_environment(contract, name)
    with locked_folder(folder):
        return _write(file, folder, contract, made, roots, agent)


def _may_be_written(folder: Path) -> list[str]:
    """Names of what an import's network and environment may be, those of another form among them."""
    return [
        *(f"{folder.name}{ending}" for ending in (".onnx", ".yaml", ".safetensors")),
        ENVIRONMENT_FILE,
        ACTUATOR_FILE,
    ]


def _check_folder(folder: Path) -> None:
    """Raise ConfigError where an import would take the place of anything but another import."""
    for each in (*_may_be_written(folder), TABLE_FILE):
        if (folder / each).is_symlink():
            raise ConfigError(str(folder), each, "a file of an import's own", "a link")
    there = [each for each in _may_be_written(folder) if (folder / each).exists()]
    if there and not (folder / TABLE_FILE).exists():
        expected = f"a new one, or that of an earlier import, which has {TABLE_FILE}"
        raise ConfigError(str(folder), "folder", expected, ", ".join(there))


@contextmanager
def _named_by(stage: Path, folder: Path) -> Iterator[None]:
    """Errors within name files of the stage as they will be called."""
    try:
        yield
    except ConfigError as error:
        source = error.source.replace(os.fspath(stage), os.fspath(folder))
        raise ConfigError(source, error.element, error.expected, error.found) from error


def _write(
    file: str, folder: Path, contract: Contract, made: dict[str, Any], roots: list[Stated], agent: Stated | None
) -> Imported:
    environment_file = folder / ENVIRONMENT_FILE
    # Beside the folder's files until all of it is known to work. What runs the policy wants its environment: it goes
    # first and comes last, so that no network ever stands beside that of another.
    with staged(folder) as stage, _named_by(stage, folder):
        if contract.actuator is not None:
            made["joints"]["actuator"] = write_actuator(contract.actuator, stage)
        (stage / ENVIRONMENT_FILE).write_text(environment.to_text(made))
        config = EnvironmentConfig.load(stage / ENVIRONMENT_FILE)
        written = network.write_network(file, PolicyInterface(config), stage, agent)
        names = sorted(each.name for each in stage.iterdir() if each.name != ENVIRONMENT_FILE)
        replace_together(stage, folder, [*names, ENVIRONMENT_FILE], _may_be_written(folder))
    written = os.fspath(folder / os.path.basename(written))
    config = EnvironmentConfig.load(environment_file)
    unread = [
        f"{u.path or u.line} ({u.place})" for root in [*roots, *([agent] if agent else [])] for u in root.unread()
    ]
    found = Imported(
        written, str(environment_file), config.to_dict(), list(contract.fields.values()), contract.unstated, unread
    )
    with written_whole(folder / TABLE_FILE) as beside:
        beside.write_text(json.dumps(found.to_dict(), indent=1) + "\n")
    return found


def _read_files(files: list[str], config_class: str | None) -> tuple[list[Stated], Stated | None]:
    """What the files state, each by itself but for Python's, which inherit from one another; agent.yaml apart."""
    python = [file for file in files if file.endswith(".py")]
    roots = [stated.of_classes(python, config_class)] if python else []
    agent = None
    for file in files:
        if file in python:
            continue
        root = stated.of_yaml(file)
        keys = root.raw if isinstance(root.raw, dict) else {}
        if ("policy" in keys or "actor" in keys) and (
            "algorithm" in keys or "runner_class_name" in keys or "num_steps_per_env" in keys
        ):
            agent = root
        else:
            roots.append(root)
    # What says joints by name comes first: others go by their order.
    return sorted(roots, key=lambda root: not _names_joints(root)), agent


def _names_joints(root: Stated) -> bool:
    bodies = [root.raw] + [v.raw for v in root.raw.values()] if isinstance(root.raw, dict) else []
    return any(isinstance(body, dict) and "joint_names" in body for body in bodies)


def _metadata(file: str) -> list[Stated]:
    try:
        import onnx
    except ImportError as error:
        raise ImportError("ONNX files need onnx and onnxruntime: pip install crossgait[onnx]") from error
    try:
        model = onnx.load_model_from_string(read_bytes(file, network.MOST_BYTES))
    except ConfigError:
        raise
    except Exception as error:  # of no common type
        raise ConfigError(file, "file", "an ONNX file", str(error).strip().splitlines()[0]) from error
    entries = {prop.key: prop.value for prop in model.metadata_props}
    if "observation_names" not in entries:
        return []
    return [stated.of_texts(entries, os.path.basename(file))]


def _say_settings(contract: Contract, settings: Mapping[str, Any]) -> None:
    """What the caller says: `joints.order` as names or a convention, `observation` as items of an environment's."""
    place = SETTINGS
    for key, value in settings.items():
        if key == "joints.order":
            names = (
                Stated([Stated(str(v), place, key) for v in value], place, key) if not isinstance(value, str) else None
            )
            if names is not None:
                contract.say_named_order(names)
            else:
                contract.say_convention(str(value), place)
        elif key == "observation":
            items = [item if isinstance(item, dict) else {"block": item} for item in value]
            terms.say_terms(contract, [(item, place) for item in items], Stated(value, place, key))
        elif key in _BY_JOINT:
            contract.say(key, _by_joint(key, value, contract.robot.servos), place)
        elif key in _ALONE or key.startswith("start."):
            contract.say(key, value, place)
        else:
            raise unknown_key("settings", key, key, [*_BY_JOINT, *_ALONE, "joints.order", "observation", "start.*"])


_BY_JOINT = (
    *(f"joints.{key}" for key in ("home", "offset", "scale", "lower", "upper")),
    *(f"servos.{key}" for key in environment.SERVOS),
)
_ALONE = (
    *("joints.limit", "joints.delay", "joints.filter", "joints.command", "joints.observed"),
    *("policy_dt", "physics_dt", "episode_seconds", "friction", "command", "command.ranges"),
    *("clock", "height_scan", "constants", "history.by", "history.order", "history.before"),
)


def _by_joint(key: str, value: Any, servos: Sequence[str]) -> dict[str, float]:
    """A number for every servo, or some by name. Raises ConfigError."""
    given = value if isinstance(value, Mapping) else dict.fromkeys(servos, value)
    for joint, number in given.items():
        if joint not in servos:
            raise unknown_key("settings", key, joint, servos)
        if isinstance(number, bool) or not isinstance(number, (int, float)) or not math.isfinite(number):
            raise ConfigError("settings", f"{key}.{joint}" if given is value else key, "a finite number", repr(number))
    return {joint: float(number) for joint, number in given.items()}


def _require(contract: Contract, file: str) -> None:
    if not contract.joints:
        contract.say_convention("file", "robot")
        contract.unstated.append("joints.order")
    if contract.get("observation") is None:
        raise ConfigError(file, "observation", "a source that says what the network sees", "none")


def settings_of(texts: list[str]) -> dict[str, Any]:
    """Of NAME=VALUE, values as YAML. Raises ConfigError."""
    found = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals:
            raise ConfigError("--set", "setting", "NAME=VALUE", f"'{text}'")
        found[name] = strict_yaml.parse_yaml(value, f"--set {name}")
    return found
