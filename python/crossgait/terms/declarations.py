"""What terms are: a function each, with its weight and parameters."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from numbers import Real
from typing import Any, Literal, get_args

import numpy as np

from crossgait._core import reward_terms
from crossgait.errors import ConfigError
from crossgait.inputs import misfit

#: Observation groups: what the policy sees, and what a critic may see besides.
GROUPS = ("policy", "critic")
#: When events happen: as environments are made, as an episode begins, or now and then within one.
Mode = Literal["startup", "reset", "step", "interval"]
MODES: tuple[str, ...] = get_args(Mode)

Params = Mapping[str, Any]


class _Checked:
    """A term that is checked where it is declared."""

    def __post_init__(self) -> None:
        """Raise ConfigError for what it cannot be."""
        _check_term(self)


@dataclass(frozen=True)
class RewardTerm(_Checked):
    """`weight` times `function(env, **params)`, an array (n,), is added to every step's reward."""

    function: Callable[..., Any]
    weight: float = 1.0
    params: Params = field(default_factory=dict)


@dataclass(frozen=True)
class ObservationTerm(_Checked):
    """Numbers of `function(env, **params)`, an array (n,) or (n, k).

    Of a number x the group shows clip(scale (x + n)), n uniform in +-noise.
    """

    function: Callable[..., Any]
    params: Params = field(default_factory=dict)
    scale: float = 1.0
    clip: float = math.inf
    noise: float = 0.0


@dataclass(frozen=True)
class TerminationTerm(_Checked):
    """Ends the episodes where `function(env, **params)`, a bool array (n,), is true: truncated with `time_out`."""

    function: Callable[..., Any]
    params: Params = field(default_factory=dict)
    time_out: bool = False


@dataclass(frozen=True)
class EventTerm(_Checked):
    """Calls `function(env, indices, **params)`, which changes the environments of `indices` (an int array).

    `mode` is "startup" (once, in the first episode), "reset" (as an episode begins, before its first observation),
    "step" (after every step of a policy, where the episode goes on) or "interval" (within episodes, after times drawn
    uniformly from `interval`, s).
    """

    function: Callable[..., Any]
    mode: Mode = "reset"
    interval: tuple[float, float] | None = None
    params: Params = field(default_factory=dict)


@dataclass(frozen=True)
class CurriculumTerm(_Checked):
    """Calls `function(env, indices, **params)` when the episodes of `indices` have ended, before the next begin.

    An object that keeps something from rollout to rollout of a training has a `state()` and a `restore(state)`.
    """

    function: Callable[..., Any]
    params: Params = field(default_factory=dict)


@dataclass(frozen=True)
class Terms:
    """Terms by name, beside the tables of the configuration.

    Every function takes `env`, a `crossgait.Batch` of all environments, first. A term may be an object that is called,
    or a method of such an object, and remembers: it has a `reset(env, indices)`, called when episodes begin, or a
    `state()` and `restore(state)` of what it keeps beyond episodes, in plain values and arrays. Each batch of
    environments has a copy of such an object, the same one for all terms that are it.

    Attributes:
        rewards: names are none of the table's.
        observations: terms by group, "policy" and "critic".

    Raises:
        ConfigError: for what is no term, or none of its place.

    """

    rewards: Mapping[str, RewardTerm] = field(default_factory=dict)
    observations: Mapping[str, Mapping[str, ObservationTerm]] = field(default_factory=dict)
    terminations: Mapping[str, TerminationTerm] = field(default_factory=dict)
    events: Mapping[str, EventTerm] = field(default_factory=dict)
    curriculum: Mapping[str, CurriculumTerm] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check all of it."""
        if not isinstance(self.observations, Mapping):
            found = type(self.observations).__name__
            raise ConfigError("terms", "observations", f"a mapping of {' and '.join(GROUPS)}", found)
        for group in self.observations:
            if group not in GROUPS:
                raise ConfigError("terms", "observations", f"groups of {', '.join(GROUPS)}", str(group))
            _check(f"observations.{group}", self.observations[group], ObservationTerm)
        _check("rewards", self.rewards, RewardTerm)
        _check("terminations", self.terminations, TerminationTerm)
        _check("events", self.events, EventTerm)
        _check("curriculum", self.curriculum, CurriculumTerm)
        for name in self.rewards:
            if name in reward_terms():
                raise ConfigError("terms", f"rewards.{name}", "a name that is none of the table's", "one of them")

    @property
    def placed(self) -> list[tuple[str, Any]]:
        """All terms by their places: "rewards.feet_air_time"."""
        placed = []
        for each in fields(self):
            members = getattr(self, each.name)
            groups = (
                {f"{each.name}.{g}": t for g, t in members.items()}
                if each.name == "observations"
                else {each.name: members}
            )
            placed += [(f"{place}.{name}", term) for place, terms in groups.items() for name, term in terms.items()]
        return placed

    @property
    def names(self) -> list[str]:
        """Places of all terms."""
        return [place for place, _ in self.placed]


def _check(place: str, terms: Mapping[str, Any], kind: type) -> None:
    if not isinstance(terms, Mapping):
        raise ConfigError("terms", place, f"a mapping of names to {kind.__name__}", type(terms).__name__)
    for name, term in terms.items():
        if not isinstance(term, kind):
            raise ConfigError("terms", f"{place}.{name}", f"a {kind.__name__}", type(term).__name__)


def _check_term(term: Any) -> None:
    kind = type(term).__name__
    if not callable(term.function):
        raise ConfigError(kind, "function", "a function", repr(term.function))
    for key in ("weight", "scale", "noise", "clip"):
        if not isinstance(getattr(term, key, 0.0), Real):
            raise ConfigError(kind, key, "a number", repr(getattr(term, key)))
    for key in ("weight", "scale", "noise"):
        if not _is_finite(getattr(term, key, 0.0)):
            raise ConfigError(kind, key, "a finite number", repr(getattr(term, key)))
    if not isinstance(getattr(term, "time_out", False), bool):
        raise ConfigError(kind, "time_out", "True or False", repr(term.time_out))
    if getattr(term, "noise", 0.0) < 0:
        raise ConfigError(kind, "noise", "0 or more", repr(term.noise))
    if not getattr(term, "clip", 1.0) > 0:
        raise ConfigError(kind, "clip", "more than 0", repr(term.clip))
    if isinstance(term, EventTerm):
        _check_event(term)
    _check_params(kind, term)


def _check_params(kind: str, term: Any) -> None:
    """Whether the function takes what it will be given, as far as it says what it takes."""
    if not isinstance(term.params, Mapping):
        raise ConfigError(kind, "params", "a mapping of keywords", type(term.params).__name__)
    given = ("env", "indices") if isinstance(term, (EventTerm, CurriculumTerm)) else ("env",)
    if (wrong := misfit(term.function, given, term.params)) is not None:
        declared, why = wrong
        raise ConfigError(kind, "params", f"what {declared} takes beside {' and '.join(given)}", why)


def _check_event(event: EventTerm) -> None:
    if event.mode not in MODES:
        raise ConfigError("EventTerm", "mode", ", ".join(MODES), repr(event.mode))
    if (event.mode == "interval") != (event.interval is not None):
        raise ConfigError("EventTerm", "interval", "(min, max) s, of mode interval alone", repr(event.interval))
    if event.interval is not None and not _is_pair(event.interval):
        raise ConfigError("EventTerm", "interval", "(min, max), s", repr(event.interval))
    if event.interval is not None and not 0 < event.interval[0] <= event.interval[1] < math.inf:
        raise ConfigError("EventTerm", "interval", "0 < min <= max", repr(event.interval))


def _is_pair(value: Any) -> bool:
    return isinstance(value, (Sequence, np.ndarray)) and len(value) == 2 and all(isinstance(x, Real) for x in value)


def _is_finite(value: Any) -> bool:
    try:
        return math.isfinite(value)
    except OverflowError:  # of an integer beyond all floats
        return False
