"""What `gymnasium.make` is given, as a configuration of the core."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from crossgait._core import EnvironmentConfig, available_engines
from crossgait.errors import ConfigError, nearest
from crossgait.inputs import EnvironmentLike, as_environment
from crossgait.terms import Terms, with_terms

ConfigLike = EnvironmentLike | None

#: What environments take beside keys of the configuration.
_OWN = (
    *("config", "terms", "dtype", "render_mode", "width", "height", "camera"),
    *("num_envs", "workers", "max_episode_steps", "autoreset_mode"),
)


def make_config(
    action: str, config: ConfigLike, keys: Mapping[str, Any], terms: Terms | None = None
) -> EnvironmentConfig:
    """Read `config` and set `keys` in it, and `terms`; those that are None leave it as it is.

    Without a `config`, or in a mapping that does not say so, the action is `action` and the engine the first available
    one. Raises ConfigError, also if the configuration's action is another than `action`, "gait" or "joints"; TypeError
    if that is empty, as in the classes that environments share.
    """
    if not action:
        raise TypeError("the class says no `action`: make an AdaptiveGait or a JointControl environment")
    if config is None or isinstance(config, Mapping):
        beginning = {"action": action, "engine": available_engines()[0]} | dict(config or {})
        made = EnvironmentConfig.from_dict(beginning, "config")
    else:
        made = as_environment(config, "config")
    if made.action != action:
        raise ConfigError("config", "action", f"{action}, which this environment is of", made.action)
    given = {key: value for key, value in keys.items() if value is not None}
    for key in given:
        if (near := nearest(key, [*_OWN, *made.to_dict()])) in _OWN:
            raise TypeError(f"an environment has no keyword '{key}': did you mean '{near}'?")
    made = made.updated(given, "keyword arguments") if given else made
    return made if terms is None else with_terms(made, terms)
