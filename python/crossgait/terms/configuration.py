"""A configuration with terms: what every function takes for an environment."""

from __future__ import annotations

from functools import partial

from crossgait import _core
from crossgait._core import EnvironmentConfig
from crossgait.errors import ConfigError
from crossgait.inputs import EnvironmentLike, as_environment
from crossgait.terms.declarations import Terms
from crossgait.terms.running import EpisodeTerms, widths


def with_terms(environment: EnvironmentLike, terms: Terms) -> EnvironmentConfig:
    """Return the configuration with `terms`, in the place of those that it had.

    Whatever runs it in this process has them: environments, rollouts, verdicts, training. They are in no file: its
    YAML names them, and cannot be read back, nor can the configuration be pickled. One episode is begun to see how many
    numbers terms observe.

    Raises:
        ConfigError: for a wrong configuration, or a term whose function returns what it must not.

    """
    if not isinstance(terms, Terms):
        raise ConfigError("environment", "terms", "a crossgait.terms.Terms", type(terms).__name__)
    config = as_environment(environment)._without_terms()
    entries = []
    if terms.observations:
        core = _core.Environment(config)
        core.reset(0)
        found = widths(terms, core.batch())
        taken = {entry[0] for entry in core.observation_layout}
        for name, width in found.get("policy", {}).items():
            term = terms.observations["policy"][name]
            numbers = [name] if width == 1 else [f"{name}[{i}]" for i in range(width)]
            for number in numbers:
                if number in taken:
                    expected = "a name that none of the configuration's observations has"
                    raise ConfigError("terms", f"observations.policy.{name}", expected, number)
            unit = "-" if term.scale == 1 else f"- x {term.scale:g}"
            entries += [(number, unit, -term.clip, term.clip) for number in numbers]
    make = partial(EpisodeTerms, terms)
    return config._with_terms(terms, make, terms.names, list(terms.rewards), entries)


def group_width(config: EnvironmentConfig, group: str) -> int:
    """How many numbers the terms of an observation group show; 0 without any. Raises ConfigError."""
    terms: Terms | None = config.terms
    if terms is None or not terms.observations.get(group):
        return 0
    core = _core.Environment(config._without_terms())
    core.reset(0)
    return sum(widths(terms, core.batch())[group].values())
