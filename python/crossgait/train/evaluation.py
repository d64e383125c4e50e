"""How good a policy is, in every engine: whole episodes of the core on ground that training does not see."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from crossgait import studies
from crossgait._core import EnvironmentConfig
from crossgait.inputs import PolicyLike
from crossgait.train.plan import Plan

Json = dict[str, Any]

#: The score of a course stands beside the statistics of its runs by this name.
COURSE = "course"
#: What tables show of episodes, with its unit.
SHOWN = {
    "total_reward": "",
    "mean_speed_mps": "m/s",
    "cost_of_transport": "",
    "swing_contact_ratio": "",
    "slip_per_path": "",
}


def evaluate(
    policies: Sequence[str] | Mapping[str, PolicyLike],
    environment: EnvironmentConfig,
    engines: Sequence[str],
    episodes: int,
    seed: int,
    workers: int | None = None,
    progress: bool | None = False,
) -> dict[str, dict[str, Json]]:
    """By policy (in the order and by the names given) and engine, what `crossgait rollout --json` says of all episodes.

    All policies and engines meet the same episodes. `progress` is as of `crossgait.rollout`.
    """
    by_name = policies if isinstance(policies, Mapping) else {name: name for name in policies}
    results: dict[str, dict[str, Json]] = {name: {} for name in by_name}
    run = list(by_name.values())
    for engine in engines:
        config = environment.updated({"engine": engine}, "engine")
        done = studies.rollout(run, config, episodes=episodes, seed=seed, workers=workers, progress=progress)
        for name, said in zip(by_name, done.document["policies"], strict=True):
            results[name][engine] = said["all"]
    return results


def evaluate_on_course(
    policies: Sequence[str],
    course: str,
    environment: EnvironmentConfig,
    engines: Sequence[str],
    runs: int,
    seed: int,
    workers: int | None = None,
    progress: bool | None = False,
) -> dict[str, dict[str, Json]]:
    """The same of a course, with so many runs of every section, and beside it `course` and `sections`, the scores."""
    results: dict[str, dict[str, Json]] = {policy: {} for policy in policies}
    for policy in policies:
        options: Json = {"engines": engines, "episodes": runs, "seed": seed, "workers": workers, "progress": progress}
        done = studies.course(policy, environment, course=course, **options).document
        for scored in done["scores"]:
            cells = [cell for cell in done["cells"] if cell["engine"] == scored["engine"]]
            results[policy][scored["engine"]] = _over_sections(cells) | {
                COURSE: {"mean": scored["mean"], "deviation": scored["deviation"]},
                "sections": {cell["section"]["name"]: cell["score"] for cell in cells},
            }
    return results


def of_plan(
    policies: Sequence[str], plan: Plan, episodes: int, seed: int, progress: bool | None = False
) -> dict[str, dict[str, Json]]:
    """Where a plan's policies are evaluated: in its `evaluated` environment, or on its course, in its engines."""
    asked, workers = plan["evaluation"], plan["workers"]
    where = (plan.evaluated, plan.evaluation_engines, episodes, seed, workers, progress)
    if asked["score"] == COURSE:
        return evaluate_on_course(policies, asked["course"], *where)
    return evaluate(policies, *where)


def _over_sections(cells: Sequence[Json]) -> Json:
    """Means of the sections' means, which count alike, with the deviation from section to section."""
    runs = [cell["all"] for cell in cells]
    said: Json = {key: sum(run[key] for run in runs) for key in ("episodes", "ended_early")}
    said["outcomes"] = Counter[str]()
    for run in runs:
        said["outcomes"].update(run["outcomes"])
    for name in SHOWN:
        means = [run[name]["mean"] for run in runs if run.get(name)]
        if means:
            said[name] = {"mean": statistics.fmean(means), "deviation": statistics.pstdev(means)}
    return said


def score(by_engine: dict[str, Json], statistic: str) -> float:
    """The mean of `statistic` in the engine where it is the lowest."""
    return min(float(said[statistic]["mean"]) for said in by_engine.values())


def failures(said: Json) -> int:
    """Episodes that an outcome cut short."""
    return int(said["ended_early"])


def row(by_engine: dict[str, Json], statistic: str) -> Json:
    """One flat row: the score and, by engine, means, deviations and failures."""
    flat: Json = {"score": score(by_engine, statistic)}
    for engine, said in by_engine.items():
        for name in (*SHOWN, *([COURSE] if COURSE in said else [])):
            told = said.get(name)
            flat[f"{engine}.{name}"] = told["mean"] if told else None
            flat[f"{engine}.{name}.deviation"] = told["deviation"] if told else None
        flat[f"{engine}.failures"] = failures(said)
    return flat
