"""Episodes of policies: rollouts, transfers, courses, and a search for the gait's parameters."""

from __future__ import annotations

import os
from collections.abc import Sequence

from crossgait import _core
from crossgait.arguments import checking_arguments
from crossgait.inputs import (
    EnginesLike,
    EnvironmentLike,
    PolicyLike,
    TerrainLike,
    as_engines,
    as_environment,
    as_names,
    as_policies,
    as_policy,
    check_names_apart,
    environment_for,
    name_in_results,
    terrain_texts,
)
from crossgait.notes import tell_notes
from crossgait.progress import Progress
from crossgait.studies.choices import ProgressShown, all_engines, worker_count
from crossgait.studies.results import CourseResult, Rollout, Transfer, Tuning
from crossgait.studies.walks import traces_of


@checking_arguments
def rollout(
    policies: PolicyLike | Sequence[PolicyLike] = "zero",
    environment: EnvironmentLike | None = None,
    *,
    episodes: int = 3,
    seed: int = 0,
    trace: bool = False,
    workers: int | None = None,
    progress: Progress | bool | None = None,
) -> Rollout:
    """Run whole episodes of policies, all on the same worlds.

    Args:
        policies: one or several: `zero`, `random`, names, files, a `Policy`, or a `FunctionPolicy` of your own.
        environment: an `EnvironmentConfig`, its file, or a mapping of its keys; the first policy's own by default.
            Its engine is the one they run in.
        episodes: of every policy.
        seed: of the first episode.
        trace: also keep every step of every policy's first episode.
        workers: as `verdict`.
        progress: as `walk`.

    """
    chosen = as_policies(policies, "rollout")
    config = environment_for(environment, *chosen, source="rollout")
    tell_notes(config)
    known = [as_policy(policy, "rollout") for policy in chosen]
    check_names_apart([name_in_results(policy, "rollout") for policy in chosen], "rollout")
    with ProgressShown(progress) as told:
        (document, text), recorded = _core._rollout(config, known, episodes, worker_count(workers), seed, trace, told)
    return Rollout(document, text, traces_of(recorded, [run["policy"] for run in document["policies"]]))


@checking_arguments
def transfer(
    policy: PolicyLike,
    environment: EnvironmentLike | None = None,
    *,
    engines: EnginesLike | None = None,
    terrains: TerrainLike | Sequence[TerrainLike] = ("flat", "rough"),
    episodes: int = 3,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress | bool | None = None,
) -> Transfer:
    """Run one policy, and none, in every engine on every ground.

    Args:
        policy: as `rollout` takes one.
        environment: as `rollout`.
        engines: all that are available by default.
        terrains: names, files or a `Terrain` each.
        episodes: in every engine on every ground.
        seed: of the first episode.
        workers: as `verdict`.
        progress: as `walk`.

    """
    config = environment_for(environment, policy, source="transfer")
    tell_notes(config)
    names = all_engines(engines, "transfer")
    grounds = terrain_texts(terrains, "transfer")
    with ProgressShown(progress) as told:
        document, text = _core._transfer(
            config, as_policy(policy, "transfer"), names, grounds, episodes, worker_count(workers), seed, told
        )
    return Transfer(document, text)


@checking_arguments
def course(
    policy: PolicyLike = "zero",
    environment: EnvironmentLike | None = None,
    *,
    course: str | os.PathLike[str] = "hard",
    sections: str | Sequence[str] = (),
    engines: EnginesLike | None = None,
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
    config = environment_for(environment, policy, source="course")
    tell_notes(config)
    names = [config.engine] if engines is None else as_engines(engines, "course")
    chosen, of_course = as_policy(policy, "course"), as_names(sections, "course", "sections")
    with ProgressShown(progress) as told:
        document, text = _core._course(
            config, chosen, os.fspath(course), of_course, names, episodes, worker_count(workers), seed, told
        )
    return CourseResult(document, text)


@checking_arguments
def tune(
    environment: EnvironmentLike | None = None,
    *,
    engines: EnginesLike | None = None,
    iterations: int = 10,
    population: int = 16,
    terrains: int = 2,
    unseen: int = 3,
    seed: int = 0,
    course: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    progress: Progress | bool | None = None,
) -> Tuning:
    """Search for faster gait parameters in the environment's engine, and check them in all `engines`.

    With a `course` (a name or a file) search for the score on it instead, in the engine of `engines` where it is the
    lowest; `terrains` and `unseen` are then runs of its sections.
    """
    config = as_environment({} if environment is None else environment, "tune")
    tell_notes(config)
    names = all_engines(engines, "tune")
    of_course = None if course is None else os.fspath(course)
    with ProgressShown(progress) as told:
        (document, text), tuned = _core._tune(
            config, names, iterations, population, terrains, unseen, worker_count(workers), seed, of_course, told
        )
    return Tuning(document, text, tuned)
