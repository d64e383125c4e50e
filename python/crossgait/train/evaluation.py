"""How good a policy is, in every engine: whole episodes of the core on ground that training does not see."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from crossgait._core import EnvironmentConfig
from crossgait.studies import rollout

Json = dict[str, Any]

#: What tables show of episodes, with its unit.
SHOWN = {"total_reward": "", "mean_speed_mps": "m/s", "cost_of_transport": "", "drag": "", "slip_per_path": ""}


def evaluate(
    policies: Sequence[str],
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
    results: dict[str, dict[str, Json]] = {policy: {} for policy in policies}
    for engine in engines:
        config = environment.updated(json.dumps({"engine": engine}), "engine")
        done = rollout(list(policies), config, episodes=episodes, seed=seed, workers=workers, progress=progress)
        for policy, said in zip(policies, done.document["policies"], strict=True):
            results[policy][engine] = said["all"]
    return results


def score(by_engine: dict[str, Json], statistic: str) -> float:
    """The mean of `statistic` in the engine where it is the lowest."""
    return min(float(said[statistic]["mean"]) for said in by_engine.values())


def failures(said: Json) -> int:
    """Episodes that an outcome cut short."""
    return sum(int(n) for name, n in said["outcomes"].items() if name not in ("walked", "slid", "no_progress"))


def row(by_engine: dict[str, Json], statistic: str) -> Json:
    """One flat row: the score and, by engine, means, deviations and failures."""
    flat: Json = {"score": score(by_engine, statistic)}
    for engine, said in by_engine.items():
        for name in SHOWN:
            told = said.get(name)
            flat[f"{engine}.{name}"] = told["mean"] if told else None
            flat[f"{engine}.{name}.deviation"] = told["deviation"] if told else None
        flat[f"{engine}.failures"] = failures(said)
    return flat
