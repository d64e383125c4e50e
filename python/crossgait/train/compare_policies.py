"""`python -m crossgait.train.compare_policies`: policies beside each other, in every engine on every ground."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from crossgait import _core
from crossgait.commands import exit_code, say
from crossgait.errors import ConfigError
from crossgait.files import check_outputs, noting_reads, written_whole
from crossgait.inputs import (
    EnginesLike,
    EnvironmentLike,
    PolicyLike,
    TerrainLike,
    as_engines,
    as_policies,
    environment_for,
    name_in_results,
    terrain_texts,
)
from crossgait.notes import tell_notes
from crossgait.policies import Policy
from crossgait.policies.environment import environment_of
from crossgait.train.evaluation import evaluate, failures

Json = dict[str, Any]

EPILOG = """\
examples:
  python -m crossgait.train.compare_policies runs/a/best.safetensors runs/b/best.safetensors zero
  python -m crossgait.train.compare_policies mine.safetensors zero --environment env.yaml --json result.json
"""


def compare_policies(
    policies: PolicyLike | Sequence[PolicyLike],
    environment: EnvironmentLike | None = None,
    *,
    engines: EnginesLike | None = None,
    terrains: TerrainLike | Sequence[TerrainLike] | None = None,
    episodes: int = 10,
    seed: int = 0,
    workers: int | None = None,
) -> Json:
    """Run all policies on the same episodes, in every engine on every ground.

    Args:
        policies: one or several, as `crossgait.rollout` takes them, each of another name.
        environment: whose randomisation spreads the episodes; the first policy's own by default.
        engines: all that are available by default.
        terrains: the environment's own by default.
        episodes: of each policy, engine and ground.
        seed: that episodes follow from.
        workers: threads; as many as the process may use cores by default.

    Returns:
        `cells`: one for each engine, ground and policy, with what `crossgait rollout --json` says of all episodes; and
        what was asked for.

    Raises:
        ConfigError: for what cannot be read or made.

    """
    if episodes < 1:
        raise ConfigError("compare_policies", "episodes", "at least 1", str(episodes))
    chosen = as_policies(policies, "compare_policies")
    asked = environment_for(environment, *chosen, source="compare_policies")
    tell_notes(asked)
    by_name = {name_in_results(policy, "compare_policies"): policy for policy in chosen}
    where = as_engines(engines, "compare_policies") if engines else _core.available_engines()
    cells = []
    for terrain in terrain_texts(terrains, "compare_policies") if terrains else [asked.terrain]:
        config = asked.updated({"terrain": terrain}, "terrain")
        done = evaluate(by_name, config, where, episodes, seed, workers, progress=None)
        cells += [
            {"engine": engine, "terrain": terrain, "policy": policy, "all": done[policy][engine]}
            for engine in where
            for policy in by_name
        ]
    return {"episodes": episodes, "seed": seed, "cells": cells}


def table(document: Json) -> str:
    """For people: mean ± standard deviation over episodes."""
    heads = [
        "terrain",
        "engine",
        "policy",
        "return",
        "speed, m/s",
        "cost of transport",
        "swing contact",
        "slip",
        "ended early",
    ]
    rows = [heads]
    for cell in document["cells"]:
        said = cell["all"]
        keys = ("total_reward", "mean_speed_mps", "cost_of_transport", "swing_contact_ratio", "slip_per_path")
        ended = f"{failures(said)} of {said['episodes']}"
        what = (cell["terrain"], cell["engine"], _short(cell["policy"]))
        rows.append([*what, *(_cell(said.get(key)) for key in keys), ended])
    widths = [max(len(row[i]) for row in rows) for i in range(len(heads))]
    lines = ["  ".join(f"{text:<{width}}" for text, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    return "\n".join([lines[0], "-" * len(lines[0]), *lines[1:]])


def _short(policy: str) -> str:
    path = Path(policy)
    return str(Path(*path.parts[-2:])) if len(path.parts) > 1 else policy


def _cell(told: Json | None) -> str:
    if not told or not math.isfinite(told["mean"]):
        return "-"
    return f"{told['mean']:.4g} ± {told['deviation']:.2g}"


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m crossgait.train.compare_policies",
        description="Policies on the same episodes, in every engine on every ground (docs/training.md).",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("policies", metavar="POLICY", nargs="+", help="a name, a file or folder, zero, random")
    parser.add_argument("--environment", metavar="FILE", help="or a policy's name (default: the first policy's own)")
    parser.add_argument("--engines", metavar="A,B", help="(default: all that are available)")
    parser.add_argument("--terrain", metavar="TERRAIN", action="append", help="again for more; the environment's")
    parser.add_argument("--episodes", metavar="N", type=int, default=10, help="(default: 10)")
    parser.add_argument("--seed", metavar="N", type=int, default=0)
    parser.add_argument("--workers", metavar="N", type=int)
    parser.add_argument("--json", metavar="FILE", help="write the result; - is standard output")
    return parser


def _run(options: argparse.Namespace) -> int:
    with noting_reads() as read:
        environment = environment_of(options.policies, options.environment)
        for policy in options.policies:
            Policy.load(policy, environment)
    named = [("POLICY", policy) for policy in options.policies]
    check_outputs([("--json", options.json)], [*named, ("--environment", options.environment), *read])
    document = compare_policies(
        options.policies,
        environment,
        engines=options.engines.split(",") if options.engines else None,
        terrains=options.terrain,
        episodes=options.episodes,
        seed=options.seed,
        workers=options.workers,
    )
    text = json.dumps(document, indent=2) + "\n"
    if options.json == "-":
        sys.stdout.write(text)
        return 0
    if options.json:
        with written_whole(options.json) as beside:
            beside.write_text(text)
    say(table(document))
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Do it; returns the exit code."""
    options = _parser().parse_args(arguments)
    return exit_code("crossgait.train.compare_policies", lambda: _run(options))


if __name__ == "__main__":
    sys.exit(main())
