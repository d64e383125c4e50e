"""Terms at work: what their functions return, checked, for the environments of a batch."""

from __future__ import annotations

import copy
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait._core import Batch
from crossgait.errors import ConfigError
from crossgait.terms.declarations import GROUPS, ObservationTerm, Terms
from crossgait.terms.kept import Keepers, has, owner_of, remembers

FloatArray = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.intp]

#: What the core holds of Python's: see python/bindings/terms.cpp.
held: dict[int, Any] = {}

LARGEST = 1e6  #: numbers of observations stay within it, as the spaces of environments say


class RunningTerms:
    """The terms of a batch of environments; it remembers what is to come of events, and the last rewards.

    Attributes:
        reward_values: of the last `rewards`, weighted, by name, each (n,).

    """

    def __init__(self, terms: Terms, env: Batch) -> None:
        """Nothing is called before `begin`."""
        # What remembers is of these environments alone.
        self._remembering: list[Any] = []
        self.terms, self.env = self._own(terms), env
        self._resetting = [owner for owner in self._remembering if has(owner, "reset")]
        self._keepers = Keepers(self.terms)
        self.reward_values: dict[str, FloatArray] = {}
        self._seeds, self._moment = [0], 0  # what noise of `shown` is drawn from
        self._count = env.num_envs
        self._started = False
        self._intervals = {name: event for name, event in terms.events.items() if event.mode == "interval"}
        self._due = {name: np.zeros(self._count) for name in self._intervals}
        self._every_step = {name: event for name, event in self.terms.events.items() if event.mode == "step"}

    def _own(self, terms: Terms) -> Terms:
        copies: dict[int, Any] = {}  # one object for all terms that are it

        def mine(members: Mapping[str, Any]) -> dict[str, Any]:
            return {name: self._copied(term, copies) for name, term in members.items()}

        observations = {group: mine(members) for group, members in terms.observations.items()}
        parts = (terms.terminations, terms.events, terms.curriculum)
        return Terms(mine(terms.rewards), observations, *map(mine, parts))

    def _copied(self, term: Any, copies: dict[int, Any]) -> Any:
        if not remembers(owner_of(term.function)):
            return term
        function = copy.deepcopy(term.function, copies)
        owner = owner_of(function)
        if not any(owner is known for known in self._remembering):
            self._remembering.append(owner)
        return replace(term, function=function)

    def seed(self, seed: int | Sequence[int]) -> None:
        """Begin the random numbers of terms anew."""
        self.env.random = np.random.default_rng(seed)
        self._seeds = list(seed) if isinstance(seed, Sequence) else [seed]
        self._moment = 0

    def begin(self, indices: Indices) -> bool:
        """Episodes of `indices` have begun; return whether events may have changed them."""
        self._moment += 1
        for owner in self._resetting:
            owner.reset(self.env, indices)
        changed = False
        for name, event in self.terms.events.items():
            if event.mode == "reset" or (event.mode == "startup" and not self._started):
                _call(f"events.{name}", event, self.env, indices)
                changed = True
            elif event.mode == "interval":
                self._draw(name, indices)
        self._started = True
        return changed

    def _draw(self, name: str, indices: Indices) -> None:
        low, high = self._intervals[name].interval or (0.0, 0.0)
        self._due[name][indices] = self.env.random.uniform(low, high, len(indices))

    def change(self, going: Flags) -> None:
        """Do the events of mode step, and those of mode interval that are due, where episodes go on."""
        if self._every_step and len(indices := np.flatnonzero(going)):
            for name, event in self._every_step.items():
                _call(f"events.{name}", event, self.env, indices)
        for name, event in self._intervals.items():
            due = self._due[name]
            due -= self.env.step_dt
            indices = np.flatnonzero((due <= 1e-9) & going)  # rounding of sums of time steps
            if len(indices):
                _call(f"events.{name}", event, self.env, indices)
                self._draw(name, indices)

    def end(self, indices: Indices) -> None:
        """Episodes of `indices` have ended, and the next are about to begin."""
        for name, term in self.terms.curriculum.items():
            _call(f"curriculum.{name}", term, self.env, indices)

    def terminations(self) -> tuple[Flags, Flags]:
        """Return which episodes terms terminate and truncate. A step was made."""
        self._moment += 1
        ended = np.zeros((2, self._count), np.bool_)
        for name, term in self.terms.terminations.items():
            value = _array_of(f"terminations.{name}", term, self.env)
            if value.dtype != np.bool_ or value.shape != (self._count,):
                raise _wrong(f"terminations.{name}", f"bool of shape ({self._count},)", value)
            ended[int(term.time_out)] |= value
        return ended[0], ended[1]

    def rewards(self) -> FloatArray:
        """Return the sum of weight times value, (n,)."""
        total = np.zeros(self._count)
        for name, term in self.terms.rewards.items():
            value = _numbers_of(f"rewards.{name}", term, self.env)
            if value.shape != (self._count,):
                raise _wrong(f"rewards.{name}", f"shape ({self._count},)", value)
            value = term.weight * value
            self.reward_values[name] = value
            total += value
        # One look at the sum: what is not finite does not leave it.
        if not np.isfinite(total).all():
            for name, value in self.reward_values.items():
                _check_finite(f"rewards.{name}", value)
        return total

    def observe(self, group: str) -> FloatArray:
        """Return the numbers of a group's terms beside each other, (n, width), and draw their noise."""
        return self._observed(group, self.env.random)

    def shown(self, group: str) -> FloatArray:
        """The same to look at, with a noise of its own that changes from step to step: looking changes nothing."""
        noisy = any(term.noise for term in self.terms.observations.get(group, {}).values())
        return self._observed(group, np.random.default_rng([*self._seeds, self._moment]) if noisy else self.env.random)

    def _observed(self, group: str, random: np.random.Generator) -> FloatArray:
        if group not in GROUPS:
            raise ConfigError("terms", "group", f"one of {', '.join(GROUPS)}", repr(group))
        terms = self.terms.observations.get(group, {})
        parts = [self._observe(f"observations.{group}.{name}", term, random) for name, term in terms.items()]
        return np.concatenate(parts, axis=1) if parts else np.zeros((self._count, 0))

    def _observe(self, place: str, term: ObservationTerm, random: np.random.Generator) -> FloatArray:
        value = _numbers_of(place, term, self.env)
        if value.ndim == 1:
            value = value[:, None]
        if value.ndim != 2 or value.shape[0] != self._count:
            raise _wrong(place, f"shape ({self._count},) or ({self._count}, k)", value)
        if term.noise:
            value = value + random.uniform(-term.noise, term.noise, value.shape)
        if term.scale != 1:
            value = value * term.scale
        if term.clip < np.inf:
            value = value.clip(-term.clip, term.clip)
        if not (np.abs(value) <= LARGEST).all():
            _check_finite(place, value)
            raise ConfigError("terms", place, f"numbers within +-{LARGEST:g}", f"{np.abs(value).max():g}")
        return value

    def kept(self) -> dict[str, Any]:
        """What goes on from one rollout of a training to the next, in plain values and arrays. Raises ConfigError."""
        return {"started": self._started, "parameters": self.env.parameters, "states": self._keepers.state()}

    def keep(self, kept: dict[str, Any]) -> None:
        """Go on from what was `kept`, by others of as many environments, which have begun. Raises ConfigError."""
        self._started = kept["started"]
        self._keepers.restore(kept["states"])
        for i, parameters in enumerate(kept["parameters"]):
            if parameters:
                self.env.set_parameters(parameters, [i])

    def save(self) -> Any:
        """What the rest depends on."""
        remembered = [vars(owner) for owner in self._remembering]
        return copy.deepcopy((self.env.random.bit_generator.state, self._due, self._started, remembered))

    def restore(self, saved: Any) -> None:
        """Continue there."""
        state, due, self._started, remembered = copy.deepcopy(saved)
        for owner, attributes in zip(self._remembering, remembered, strict=True):
            vars(owner).update(attributes)
        self.env.random.bit_generator.state = state
        for name, times in due.items():
            self._due[name][:] = times


class EpisodeTerms:
    """The terms of one environment, as the core calls them: `_core.EnvironmentConfig._with_terms`."""

    def __init__(self, terms: Terms, env: Batch) -> None:
        """Of a batch of one."""
        self.running = RunningTerms(terms, env)
        self._one = np.zeros(1, np.intp)
        self._going = np.ones(1, np.bool_)

    def end(self) -> None:
        """The episode is over."""
        self.running.end(self._one)

    def begin(self, seed: int) -> None:
        """An episode has begun."""
        self.running.seed(seed)
        self.running.begin(self._one)

    def step(self) -> tuple[float, bool, bool, list[float]]:
        """Reward of a step, whether it ends the episode (terminated, truncated), and the rewards of terms."""
        terminated, truncated = self.running.terminations()
        reward = self.running.rewards()
        values = [float(value[0]) for value in self.running.reward_values.values()]
        return float(reward[0]), bool(terminated[0]), bool(truncated[0]), values

    def change(self) -> None:
        """The episode goes on."""
        self.running.change(self._going)

    def observe(self) -> FloatArray:
        """What the policy sees beside the blocks."""
        return np.asarray(self.running.observe("policy")[0])

    def save(self) -> Any:
        """As `RunningTerms.save`."""
        return self.running.save()

    def restore(self, saved: Any) -> None:
        """As `RunningTerms.restore`."""
        self.running.restore(saved)


def _call(place: str, term: Any, *arguments: Any) -> Any:
    """What a term's function returns; an error of its own says which term it is of, where Python's errors can."""
    try:
        return term.function(*arguments, **term.params)
    except Exception as error:
        if sys.version_info >= (3, 11):
            error.add_note(f"in the term {place}")
        raise


def _returned(place: str, term: Any, env: Batch) -> Any:
    value = _call(place, term, env)
    if value is None:
        raise ConfigError("terms", place, "an array, a number for each environment", "None: is a return missing?")
    return value


def _array_of(place: str, term: Any, env: Batch) -> npt.NDArray[Any]:
    value = _returned(place, term, env)
    try:
        return np.asarray(value)
    except Exception as error:  # of whatever NumPy asks for its numbers
        raise ConfigError("terms", place, "an array, a number for each environment", _found(value, error)) from error


def _numbers_of(place: str, term: Any, env: Batch) -> FloatArray:
    value = _array_of(place, term, env)
    try:
        return np.asarray(value, np.float64)
    except (TypeError, ValueError) as error:
        raise ConfigError("terms", place, "numbers", _found(value, error)) from error


def _found(value: Any, error: Exception) -> str:
    return f"{type(value).__name__} ({error})"


def _wrong(place: str, expected: str, value: npt.NDArray[Any]) -> ConfigError:
    return ConfigError("terms", place, expected, f"{value.dtype} of shape {value.shape}")


def _check_finite(place: str, value: FloatArray) -> None:
    wrong = np.argwhere(~np.isfinite(value))
    if len(wrong):
        found = value[tuple(wrong[0])]
        raise ConfigError("terms", place, "finite numbers", f"{found} in environment {wrong[0][0]}")


def widths(terms: Terms, env: Batch) -> Mapping[str, dict[str, int]]:
    """How many numbers each observation term has, by group; `env` has begun."""
    running = RunningTerms(terms, env)
    running.seed(0)
    running.begin(np.arange(env.num_envs))
    return {
        group: {
            name: running._observe(f"observations.{group}.{name}", term, env.random).shape[1]
            for name, term in members.items()
        }
        for group, members in terms.observations.items()
    }
