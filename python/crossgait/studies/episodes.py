"""Episodes of policies: rollouts, transfers, courses, and a search for the gait's parameters."""

from __future__ import annotations

from collections.abc import Sequence

from crossgait import _core
from crossgait._core import EnvironmentConfig
from crossgait.progress import Progress
from crossgait.studies.choices import Policy, ProgressShown, all_engines, environment_or_default, worker_count
from crossgait.studies.results import CourseResult, Rollout, Transfer, Tuning


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
    config = environment_or_default(environment, chosen[0] if chosen else None)
    with ProgressShown(progress) as told:
        document, text = _core._rollout(config, chosen, episodes, worker_count(workers), seed, told)
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
    config = environment_or_default(environment, policy)
    names = all_engines(engines)
    with ProgressShown(progress) as told:
        document, text = _core._transfer(
            config, policy, names, list(terrains), episodes, worker_count(workers), seed, told
        )
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
    config = environment_or_default(environment, policy)
    names = [config.engine] if engines is None else list(engines)
    with ProgressShown(progress) as told:
        document, text = _core._course(
            config, policy, course, list(sections), names, episodes, worker_count(workers), seed, told
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
    config = environment_or_default(environment)
    names = all_engines(engines)
    with ProgressShown(progress) as told:
        (document, text), tuned = _core._tune(
            config, names, iterations, population, terrains, unseen, worker_count(workers), seed, course, told
        )
    return Tuning(document, text, tuned)
