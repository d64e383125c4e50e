"""One run of a sweep: said in plain values, so that any process on any machine can make it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from crossgait import _core
from crossgait.errors import ConfigError


@dataclass(frozen=True, slots=True)
class Subject:
    """What moves, and how its starts are drawn."""

    walk: str  #: options of `Walk` as JSON; "" for a policy
    environment: str  #: of a policy, as YAML
    policy: str  #: as `crossgait rollout` takes it
    start_ranges: str  #: options of `StartRanges` as JSON
    seed: int  #: of the starts, and of a walk's random terrain

    def __str__(self) -> str:
        if not self.walk:
            config = _core.EnvironmentConfig.parse(self.environment)
            return f"{self.policy}, {config.robot} on {config.terrain}, seed {self.seed}"
        options = json.loads(self.walk)
        default = _core.Walk()
        named = {key: value for key, value in options.items() if key not in ("gait", "robot", "terrain", "parameters")}
        said = [f"{key} {json.dumps(value)}" for key, value in named.items() if value != getattr(default, key)]
        said += [f"{key}={value}" for key, value in options["parameters"].items()]
        return ", ".join([options["gait"], f"{options['robot']} on {options['terrain']}", *said, f"seed {self.seed}"])


@dataclass(frozen=True, slots=True)
class Run:
    """One run of it. `hash` is of everything that its result depends on (docs/study.md)."""

    subject: Subject
    engine: str
    variation: str
    start: int
    hash: str

    def __str__(self) -> str:
        varied = "" if self.variation == _core._variations()[0] else f", {self.variation}"
        return f"{self.hash}  {self.engine}{varied}, start {self.start}: {self.subject}"


# Runs come subject by subject; what is read for one is kept for the next.
@lru_cache(maxsize=8)
def maker_of(subject: Subject) -> _core._RunMaker:
    """What describes and makes its runs. Raises ConfigError for what cannot be read."""
    ranges = _core.StartRanges(**json.loads(subject.start_ranges))
    if subject.walk:
        walk = _core.Walk(**json.loads(subject.walk), seed=subject.seed)
        return _core._RunMaker.of_walk(walk, ranges, subject.seed)
    environment = _core.EnvironmentConfig.parse(subject.environment)
    return _core._RunMaker.of_policy(environment, subject.policy, ranges, subject.seed)


def run_of(subject: Subject, engine: str, variation: str, start: int) -> Run:
    """The run with its hash. Raises ConfigError."""
    return Run(subject, engine, variation, start, maker_of(subject).describe(engine, variation, start)[0])


def row_of(run: Run) -> str:
    """Make the run.

    Returns:
        its row: {"hash", "run", "result"} as one line of JSON without its end, or "error" for "result" if it cannot be
        made. The same on every machine, to the last bit.

    """
    try:
        row = maker_of(run.subject).make(run.engine, run.variation, run.start)
        made = str(json.loads(row)["hash"])
        if made != run.hash:
            raise ConfigError(
                "run", "hash", f"{run.hash}, as where the sweep began", f"{made}: files or versions differ here"
            )
    except Exception as error:
        text = str(error) if isinstance(error, ConfigError) else f"{type(error).__name__}: {error}"
        return failed_row(run, text)
    return row


def failed_row(run: Run, error: str) -> str:
    """The row of a run that could not be made."""
    try:
        said: Any = json.loads(maker_of(run.subject).describe(run.engine, run.variation, run.start)[1])
    except ConfigError:
        said = None  # what it was made of is gone, or is not to be found here
    row = {"hash": run.hash, "run": said, "error": error}
    return json.dumps(row, separators=(",", ":"), ensure_ascii=False)
