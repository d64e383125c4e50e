"""The commands of `crossgait` as functions: the same results, as objects."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from crossgait import _core
from crossgait._core import Behaviour, EnvironmentConfig, FunctionPolicy, StartRanges, Walk
from crossgait.errors import ConfigError
from crossgait.progress import Progress, ProgressBar, shown
from crossgait.results import (
    Bench,
    CompareResult,
    Conformance,
    CourseResult,
    Rollout,
    Transfer,
    Tuning,
    Verdict,
    Verdicts,
    WalkResult,
)
from crossgait.traces import Trace

Subject = Walk | Behaviour | str
#: A name (zero, random, one of `crossgait.policy_names()`), a file, or a policy of your own. Without an environment a
#: policy that comes with Crossgait runs in its own.
Policy = str | FunctionPolicy


def _subject(subject: Subject, options: dict[str, Any]) -> Walk | Behaviour:
    if isinstance(subject, str):
        return Walk(subject, **options)
    if options:
        raise TypeError(f"a {type(subject).__name__} says itself what {', '.join(options)} are")
    return subject


def _default_engine() -> str:
    available = _core.available_engines()
    if not available:
        raise ConfigError("engines", "available", "at least one engine", "none: see crossgait.engines()")
    return available[0]


def _two_engines(engines: Sequence[str] | None) -> list[str]:
    if engines is None:
        by_name = {engine.name: engine for engine in _core.engines() if engine.available}
        first = _default_engine()
        engines = [first, *(n for n, e in by_name.items() if e.laws != by_name[first].laws)][:2]
    if len(engines) != 2 or engines[0] == engines[1]:
        raise ConfigError("verdict", "engines", "two different engines", ", ".join(engines))
    return list(engines)


def _engines(engines: Sequence[str] | None) -> list[str]:
    return list(engines) if engines is not None else _core.available_engines()


def _environment(environment: EnvironmentConfig | None, policy: Policy | None = None) -> EnvironmentConfig:
    """The one given, that of a policy which comes with Crossgait, or the default."""
    if environment is not None:
        return environment
    own = _core.environment_of_policy(policy) if isinstance(policy, str) else None
    return EnvironmentConfig.parse("{}") if own is None else EnvironmentConfig.load(own)


def _workers(workers: int | None) -> int:
    return workers if workers is not None else len(os.sched_getaffinity(0))


class _Shown:
    """Progress of one call; its bar is gone afterwards."""

    def __init__(self, progress: Progress | bool | None) -> None:
        self.progress = shown(progress)

    def __enter__(self) -> Progress | None:
        return self.progress

    def __exit__(self, *_: object) -> None:
        if isinstance(self.progress, ProgressBar):
            self.progress.close()


def walk(
    subject: Subject = "trot",
    *,
    engine: str | None = None,
    trace: bool = False,
    progress: Progress | bool | None = None,
    **options: Any,
) -> WalkResult:
    """Walk in one engine.

    Args:
        subject: a gait's name, a `Walk`, or a `Behaviour` of your own.
        engine: see `crossgait.engines()`; the first by default.
        trace: also keep every control step.
        progress: a function, False, True or None (a bar where somebody is looking).
        options: of `Walk`, with a gait's name.

    Raises:
        ConfigError: for what cannot be read or made.

    """
    what = _subject(subject, options)
    name = engine or _default_engine()
    with _Shown(progress) as told:
        (document, text), recorded = _core._walk(what, name, trace, told)
    if recorded is None:
        return WalkResult(document, text)
    names, tables = recorded
    return WalkResult(document, text, Trace(names, tables[0], name=name))


def compare(
    subject: Subject = "trot",
    *,
    engines: Sequence[str] | None = None,
    trace: bool = False,
    position_tolerance: float = 1e-3,
    joint_tolerance: float = 1e-2,
    attitude_tolerance: float = 1e-2,
    progress: Progress | bool | None = None,
    **options: Any,
) -> CompareResult:
    """Walk the same in several engines, side by side.

    Args:
        subject: as `walk`.
        engines: two or more; all that are available by default.
        trace: also keep every control step of every engine.
        position_tolerance: when two engines of different laws count as apart, m.
        joint_tolerance: the same for joint angles, rad.
        attitude_tolerance: the same for orientation, rad.
        progress: as `walk`.
        options: as `walk`.

    """
    what = _subject(subject, options)
    names = _engines(engines)
    with _Shown(progress) as told:
        (document, text), recorded = _core._compare(
            what, names, trace, position_tolerance, joint_tolerance, attitude_tolerance, told
        )
    traces = {}
    if recorded is not None:
        columns, tables = recorded
        traces = {name: Trace(columns, table, name=name) for name, table in zip(names, tables, strict=True)}
    return CompareResult(document, text, traces)


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
        _two_engines(engines),
        subject,
        environment,
        (starts, limit, confidence, _workers(workers), explain, os.fspath(runs)),
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
        (starts, limit, confidence, _workers(workers), explain, os.fspath(runs)),
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
        environment = _environment(None, subject)
    with _Shown(progress) as told:
        if environment is None and not isinstance(subject, FunctionPolicy):
            if isinstance(subject, str):
                options.setdefault("seed", seed)
            return _core._judge_walk(_subject(subject, options), engines, ranges, seed, *how, told)
        if environment is not None and isinstance(subject, Policy) and not options:
            return _core._judge_policy(environment, subject, engines, ranges, seed, *how, told)
        raise TypeError("a policy is judged in an environment, which says all that options would")


def rollout(
    policies: Policy | Sequence[Policy] = "zero",
    environment: EnvironmentConfig | None = None,
    *,
    episodes: int = 3,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress | bool | None = None,
) -> Rollout:
    """Run whole episodes of policies, all on the same worlds.

    Args:
        policies: `zero`, `random`, files of policies, or a `FunctionPolicy` of your own.
        environment: its engine is the one they run in.
        episodes: of every policy.
        seed: of the first episode.
        workers: as `verdict`.
        progress: as `walk`.

    """
    chosen = [policies] if isinstance(policies, Policy) else list(policies)
    config = _environment(environment, chosen[0] if chosen else None)
    with _Shown(progress) as told:
        document, text = _core._rollout(config, chosen, episodes, _workers(workers), seed, told)
    return Rollout(document, text)


def transfer(
    policy: Policy,
    environment: EnvironmentConfig | None = None,
    *,
    engines: Sequence[str] | None = None,
    terrains: Sequence[str] = ("flat", "rough"),
    episodes: int = 3,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress | bool | None = None,
) -> Transfer:
    """Run one policy, and none, in every engine on every ground."""
    config = _environment(environment, policy)
    names = _engines(engines)
    with _Shown(progress) as told:
        document, text = _core._transfer(config, policy, names, list(terrains), episodes, _workers(workers), seed, told)
    return Transfer(document, text)


def course(
    policy: Policy = "zero",
    environment: EnvironmentConfig | None = None,
    *,
    course: str = "hard",
    sections: Sequence[str] = (),
    engines: Sequence[str] | None = None,
    episodes: int = 20,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress | bool | None = None,
) -> CourseResult:
    """Run a policy, or with `zero` the gait alone, on every section of a course of hard ground (docs/course.md).

    Args:
        policy: as `rollout` takes one.
        environment: what moves the robot; ground, loads, pushes and the speed that is asked for are the course's.
        course: a name, or a file.
        sections: names of those to run; all by default.
        engines: the environment's by default.
        episodes: runs of each section.
        seed: of the first run.
        workers: as `verdict`.
        progress: as `walk`.

    """
    config = _environment(environment, policy)
    names = [config.engine] if engines is None else list(engines)
    with _Shown(progress) as told:
        document, text = _core._course(
            config, policy, course, list(sections), names, episodes, _workers(workers), seed, told
        )
    return CourseResult(document, text)


def tune(
    environment: EnvironmentConfig | None = None,
    *,
    engines: Sequence[str] | None = None,
    iterations: int = 10,
    population: int = 16,
    terrains: int = 2,
    unseen: int = 3,
    seed: int = 0,
    course: str | None = None,
    workers: int | None = None,
    progress: Progress | bool | None = None,
) -> Tuning:
    """Search for faster gait parameters in the environment's engine, and check them in all `engines`.

    With a `course` (a name or a file) search for the score on it instead, in the engine of `engines` where it is the
    lowest; `terrains` and `unseen` are then runs of its sections.
    """
    config = _environment(environment)
    names = _engines(engines)
    with _Shown(progress) as told:
        (document, text), tuned = _core._tune(
            config, names, iterations, population, terrains, unseen, _workers(workers), seed, course, told
        )
    return Tuning(document, text, tuned)


def bench(
    *,
    engines: Sequence[str] | None = None,
    sections: Sequence[str] = (),
    quick: bool = False,
    progress: Progress | bool | None = None,
) -> Bench:
    """Measure speed and accuracy of the engines; `sections` of speed, accuracy, analytic, feet, or all."""
    names = _engines(engines)
    with _Shown(progress) as told:
        document, text = _core._bench(names, list(sections), quick, told)
    return Bench(document, text)


def conformance(engine: str, *, only: Sequence[str] = (), progress: Progress | bool | None = None) -> Conformance:
    """Check an engine against what every engine is held to; `only` some checks, by name, or all."""
    with _Shown(progress) as told:
        document, text = _core._conformance(engine, list(only), told)
    return Conformance(document, text)
