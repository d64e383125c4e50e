"""Whether a behaviour depends on the engine: a verdict on two engines or more."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from crossgait import _core
from crossgait._core import EnvironmentConfig, FunctionPolicy, StartRanges
from crossgait.progress import Progress
from crossgait.studies.choices import (
    Policy,
    ProgressShown,
    Subject,
    default_engine,
    environment_or_default,
    several_engines,
    walk_or_behaviour,
    worker_count,
)
from crossgait.studies.results import Verdict


def _setup_text(against: str | Mapping[str, str | float | Sequence[float]] | None) -> str | None:
    """Write a setup as `--against` takes it; None for none."""
    if against is None or isinstance(against, str):
        return against

    def number_text(number: float) -> str:
        return repr(float(number)).removesuffix(".0")

    def value_text(value: str | float | Sequence[float]) -> str:
        if isinstance(value, str):
            return value
        return ":".join(number_text(number) for number in ([value] if isinstance(value, (int, float)) else value))

    return ",".join(f"{name}={value_text(value)}" for name, value in against.items())


def verdict(
    subject: Subject | Policy = "trot",
    *,
    engines: Sequence[str] | None = None,
    against: str | Mapping[str, str | float | Sequence[float]] | None = None,
    environment: EnvironmentConfig | None = None,
    explain: bool = False,
    starts: int = 12,
    looks: int = 1,
    margins: Mapping[str, str | float] | None = None,
    confidence: float = 0.95,
    start_ranges: StartRanges | None = None,
    seed: int = 0,
    workers: int | None = None,
    runs: str | os.PathLike[str] = "",
    progress: Progress | bool | None = None,
    **options: Any,
) -> Verdict:
    """Judge whether a behaviour depends on the engine (docs/verdict.md).

    Args:
        subject: as `walk`; with an `environment` a policy: a name, a file, or a `FunctionPolicy`.
        engines: two or more, none of which is run twice; the first that there is and the first of other laws by
            default.
        against: another setup of the same world, under which each of `engines` (by default the first alone) is held
            against itself: {"friction": 0.4, "mass": "x1.1", "robot": "other.yaml"}, or text as `--against` takes it.
        environment: of a policy.
        explain: also say what gaps come from, of pairs that do not agree and whose differences are known.
        starts: from which every engine runs, at least 4; words are given from 6 on.
        looks: how often to look at most, after as many starts each; it ends with the first that settles every pair.
        margins: differences that would not matter, by the statistic's key, in place of its own: {"distance_m": 0.05}
            in its unit, or text as `--margin` takes it ("5%", "0.004/s", "5%,0.02").
        confidence: of all intervals of all pairs together.
        start_ranges: how far starts lie apart.
        seed: of the starts, and of a random terrain.
        workers: threads; as many as the process may use by default. Results do not depend on them.
        runs: a file of runs to take and to add to; "": none.
        progress: as `walk`.
        options: as `walk`.

    """
    stated = {
        key: margin if isinstance(margin, str) else repr(float(margin)) for key, margin in (margins or {}).items()
    }
    how = (starts, looks, confidence, stated, worker_count(workers), explain, os.fspath(runs), _setup_text(against))
    names = several_engines(engines) if against is None else list(engines or [default_engine()])
    ranges = start_ranges if start_ranges is not None else StartRanges()
    if environment is None and isinstance(subject, str) and _core.environment_of_policy(subject) is not None:
        environment = environment_or_default(None, subject)
    with ProgressShown(progress) as told:
        if environment is None and not isinstance(subject, FunctionPolicy):
            if isinstance(subject, str):
                options.setdefault("seed", seed)
            judged = _core._judge_walk(walk_or_behaviour(subject, options), names, ranges, seed, how, told)
        elif environment is not None and isinstance(subject, Policy) and not options:
            judged = _core._judge_policy(environment, subject, names, ranges, seed, how, told)
        else:
            raise TypeError("a policy is judged in an environment, which says all that options would")
    document, text = judged
    return Verdict(document, text)
