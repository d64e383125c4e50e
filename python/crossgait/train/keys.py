"""What the keys of a training file may hold, and their defaults: one table (docs/training-file.md explains each)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from crossgait.errors import ConfigError, unknown_key

Json = dict[str, Any]


class Key(NamedTuple):
    """What a key may hold; `expected` says it in messages."""

    default: Any
    expected: str
    holds: Callable[[Any], bool]


def is_number(value: Any) -> bool:
    """Whether it is a finite number."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def is_range(value: Any) -> bool:
    """Whether it is [min, max]."""
    return isinstance(value, list) and len(value) == 2 and all(map(is_number, value)) and value[0] <= value[1]


def _whole(default: Any, least: int, *, optional: bool = False) -> Key:
    def holds(value: Any) -> bool:
        return isinstance(value, int) and not isinstance(value, bool) and least <= value < 2**63

    return _maybe(Key(default, f"a whole number from {least}", holds), optional)


def _number(default: Any, least: float, most: float = math.inf, *, optional: bool = False) -> Key:
    expected = f"a number from {least:g}" + (f" to {most:g}" if most < math.inf else "")
    return _maybe(Key(default, expected, lambda v: is_number(v) and least <= v <= most), optional)


def _maybe(key: Key, optional: bool) -> Key:
    if not optional:
        return key
    return Key(key.default, f"{key.expected} or null", lambda v: v is None or key.holds(v))


def _flag(default: bool) -> Key:
    return Key(default, "true or false", lambda v: isinstance(v, bool))


def _one_of(default: str, *words: str) -> Key:
    return Key(default, " or ".join(words), lambda v: v in words)


def _is_rate(value: Any) -> bool:
    ends = value if isinstance(value, list) and len(value) == 2 else [value]
    return all(is_number(end) and end >= 0 for end in ends)


def _is_shares(value: Any) -> bool:
    if isinstance(value, (str, list)):
        return _is_names(value)
    return isinstance(value, dict) and bool(value) and all(is_number(v) and v > 0 for v in value.values())


def _is_sizes(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(v, int) and not isinstance(v, bool) and v > 0 for v in value)


def _is_names(value: Any) -> bool:
    names = [value] if isinstance(value, str) else value
    return isinstance(names, list) and bool(names) and all(isinstance(name, str) and name for name in names)


_SEEDS = Key([1_000_000, 1_000_999], "[first, last] seed", is_range)

#: Every key with its default; a mapping is a section.
TABLE: dict[str, Key | dict[str, Key]] = {
    "environment": Key({}, "a file, a policy's name or a mapping of keys", lambda v: isinstance(v, (str, dict))),
    "engines": Key({"mujoco": 1.0}, "engines by name, or with shares above zero", _is_shares),
    "environments": _whole(16, 1),
    "workers": _whole(None, 1, optional=True),
    "block": _whole(None, 1, optional=True),
    "threads": _whole(1, 1),
    "steps": _whole(1_000_000, 1),
    "seed": _whole(0, 0),
    "algorithm": {
        "n_steps": _whole(400, 2),
        "batch_size": _whole(1600, 2),
        "n_epochs": _whole(5, 1),
        "learning_rate": Key(3e-4, "a rate, or [first, last]", _is_rate),
        "gamma": _number(0.99, 0, 1),
        "gae_lambda": _number(0.95, 0, 1),
        "clip_range": _number(0.2, 0),
        "clip_range_vf": _number(None, 0, optional=True),
        "normalize_advantage": _flag(True),
        "ent_coef": _number(0.0, 0),
        "vf_coef": _number(0.5, 0),
        "max_grad_norm": _number(0.5, 0),
        "target_kl": _number(None, 0, optional=True),
    },
    "network": {
        "hidden": Key([256, 256], "a list of widths", _is_sizes),
        "activation": _one_of("tanh", "tanh", "elu", "relu"),
        "log_std_init": _number(-1.0, -20, 5),
    },
    "normalise": {
        "observation": _flag(True),
        "reward": _flag(True),
        "clip_observation": _number(10.0, 1e-3),
        "clip_reward": _number(10.0, 1e-3),
    },
    "randomisation": Key({}, "a mapping as of an environment", lambda v: isinstance(v, dict)),
    "curriculum": Key([], "a list of stages", lambda v: isinstance(v, list)),
    "evaluation": {
        "engines": _maybe(Key(None, "names of engines", _is_names), optional=True),
        "every": _whole(100_000, 1),
        "episodes": _whole(4, 1),
        "final_episodes": _whole(20, 1),
        "seed": _whole(1, 0),
        "terrain_seeds": _SEEDS,
        "score": _one_of("total_reward", "total_reward", "mean_speed_mps", "distance_m", "course"),
        "course": Key("hard", "a course's name or file", lambda v: isinstance(v, str)),
        "set": Key({}, "a mapping of an environment's keys", lambda v: isinstance(v, dict)),
    },
    "hierarchy": Key(None, "a mapping or null", lambda v: v is None or isinstance(v, dict)),
    "verdict": _flag(False),
}

_PART: dict[str, Key] = {
    "steps": _whole(None, 1, optional=True),
    "set": Key({}, "a mapping of this file's keys", lambda v: isinstance(v, dict)),
}
_SEES: dict[str, Key] = {
    "observation": Key([], "a list of names", lambda v: isinstance(v, list) and all(isinstance(n, str) for n in v))
}
#: Of `hierarchy`.
HIERARCHY: dict[str, Key | dict[str, Key]] = {
    "planner_dt": _number(0.1, 1e-6),
    "planner": _SEES | _PART,
    "residual": _SEES | _PART,
    "together": dict(_PART),
}

_SET: dict[str, Key] = {
    "set": Key({}, "a mapping of an environment's keys", lambda v: isinstance(v, dict)),
    "command": Key({}, "a mapping of vx, vy, yaw_rate to [min, max]", lambda v: isinstance(v, dict)),
}
#: Of a stage of the curriculum.
STAGE: dict[str, Key] = {"from": _whole(0, 0), "mix": Key([], "a list of shares", lambda v: isinstance(v, list))} | _SET
#: Of a share of a stage's environments.
SHARE: dict[str, Key] = {"share": _number(1.0, 1e-3)} | _SET
COMMAND = ("vx", "vy", "yaw_rate")
#: Beginnings of the names of actions, of the members of a hierarchical policy.
PLANNER, RESIDUAL = "delta.", "residual."


def filled(source: str, given: Any, table: Mapping[str, Key | dict[str, Key]], where: str = "") -> Json:
    """`given` with every default of `table`. Raises ConfigError for what is unknown or of the wrong kind."""
    place = where.rstrip(".") or "file"
    if not isinstance(given, dict):
        raise ConfigError(source, place, "a mapping", shown(given))
    for key in given:
        if key not in table:
            raise unknown_key(source, f"{where}{key}", key, table)
    result: Json = {}
    for name, key in table.items():
        if isinstance(key, dict):
            result[name] = filled(source, given.get(name, {}), key, f"{where}{name}.")
            continue
        value = given.get(name, key.default)
        if not key.holds(value):
            raise ConfigError(source, f"{where}{name}", key.expected, shown(value))
        result[name] = value
    return result


def shown(value: Any) -> str:
    """A value as messages show it."""
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."
