"""Whether a behaviour depends on the engine: verdicts on two engines and on more."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from crossgait import _core
from crossgait._core import EnvironmentConfig, FunctionPolicy, StartRanges
from crossgait.errors import ConfigError
from crossgait.progress import Progress
from crossgait.studies.choices import (
    Policy,
    ProgressShown,
    Subject,
    environment_or_default,
    two_engines,
    walk_or_behaviour,
    worker_count,
)
from crossgait.studies.results import Verdict, Verdicts


def verdict(
    subject: Subject | Policy = "trot",
    *,
    engines: Sequence[str] | None = None,
    environment: EnvironmentConfig | None = None,
    explain: bool = False,
    starts: int = 12,
    limit: float = 1.0,
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
        engines: two; the first that there is and the first of other laws by default.
        environment: of a policy.
        explain: also say what the gap comes from.
        starts: from which both engines run, at least 4.
        limit: gap over spread up to which engines agree.
        confidence: of all words together.
        start_ranges: how far starts lie apart.
        seed: of the starts, and of a random terrain.
        workers: threads; as many as the process may use by default. Results do not depend on them.
        runs: a file of runs to take and to add to; "": none.
        progress: as `walk`.
        options: as `walk`.

    """
    document, text = _judged(
        two_engines(engines),
        subject,
        environment,
        (starts, limit, confidence, worker_count(workers), explain, os.fspath(runs)),
        start_ranges,
        seed,
        progress,
        options,
    )
    return Verdict(document, text)


def verdicts(
    subject: Subject | Policy,
    engines: Sequence[str],
    environment: EnvironmentConfig | None = None,
    *,
    explain: bool = False,
    starts: int = 12,
    limit: float = 1,
    confidence: float = 0.95,
    start_ranges: StartRanges | None = None,
    seed: int = 0,
    workers: int | None = None,
    runs: str | os.PathLike[str] = "",
    progress: Progress | bool | None = None,
    **options: Any,
) -> Verdicts:
    """Judge a behaviour in more than two engines: which agree, and whether one stands apart.

    Args:
        subject: as `verdict`.
        engines: three or more; none is run twice.
        environment: of a policy.
        explain: also say what the gaps come from, of pairs that do not agree and whose differences are known.
        starts: as `verdict`.
        limit: as `verdict`.
        confidence: of all words of all pairs together.
        start_ranges: as `verdict`.
        seed: as `verdict`.
        workers: as `verdict`.
        runs: as `verdict`.
        progress: as `walk`.
        options: as `walk`.

    """
    if len(engines) < 3:
        raise ConfigError("verdicts", "engines", "three or more; crossgait.verdict judges two", ", ".join(engines))
    document, text = _judged(
        list(engines),
        subject,
        environment,
        (starts, limit, confidence, worker_count(workers), explain, os.fspath(runs)),
        start_ranges,
        seed,
        progress,
        options,
    )
    return Verdicts(document, text)


def _judged(
    engines: list[str],
    subject: Subject | Policy,
    environment: EnvironmentConfig | None,
    how: tuple[int, float, float, int, bool, str],
    start_ranges: StartRanges | None,
    seed: int,
    progress: Progress | bool | None,
    options: dict[str, Any],
) -> tuple[Any, str]:
    ranges = start_ranges if start_ranges is not None else StartRanges()
    if environment is None and isinstance(subject, str) and subject in _core.policy_names():
        environment = environment_or_default(None, subject)
    with ProgressShown(progress) as told:
        if environment is None and not isinstance(subject, FunctionPolicy):
            if isinstance(subject, str):
                options.setdefault("seed", seed)
            return _core._judge_walk(walk_or_behaviour(subject, options), engines, ranges, seed, *how, told)
        if environment is not None and isinstance(subject, Policy) and not options:
            return _core._judge_policy(environment, subject, engines, ranges, seed, *how, told)
        raise TypeError("a policy is judged in an environment, which says all that options would")
