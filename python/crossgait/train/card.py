"""At the end of a run: card.md, which says what the policy is worth, and plots of how it came about."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from crossgait.errors import ConfigError
from crossgait.files import written_whole
from crossgait.train import evaluation, record
from crossgait.train.plan import Plan
from crossgait.train.trainer import BEST, EVALUATIONS, PROGRESS, Clock

Json = dict[str, Any]

CARD = "card.md"
#: Headings of the table of results, by statistic.
_COLUMNS = {
    "total_reward": "return",
    "mean_speed_mps": "speed, m/s",
    "cost_of_transport": "cost of transport",
    "drag": "drag",
    "slip_per_path": "slip per path",
}


def write(plan: Plan, folder: Path, state: Json) -> str:
    """Evaluate the best policy once more, on seeds of its own, write card and plots; returns what to print."""
    best, asked = str(folder / BEST), plan["evaluation"]
    # Other episodes than those that chose the best policy, which is the best on these partly by luck.
    settings = (plan.evaluated, plan.evaluation_engines, asked["final_episodes"], asked["seed"] + 1)
    results = evaluation.evaluate([best, "zero"], *settings, workers=plan["workers"], progress=None)
    table = _table({"policy": results[best], "zero": results["zero"]})
    pictures = _pictures(plan, folder)
    spent = Clock(state["spent"])
    lines = [f"# {folder.resolve().name}", "", *_what(plan, folder, state), "", "## Results", ""]
    lines += [
        f"{asked['final_episodes']} episodes in each engine, the same for all, on terrain seeds "
        f"{asked['terrain_seeds'][0]} to {asked['terrain_seeds'][1]}, which training did not see; mean +- standard "
        "deviation over episodes. One training run: the spread over training seeds takes several.",
        "",
        *table,
        "",
        "## Time",
        "",
        _time(spent),
    ]
    if plan["verdict"]:
        lines += ["", "## Verdict", "", *_verdict(plan, best)]
    lines += ["", "## Curves", "", *(f"![{name}]({name}.png)" for name in pictures)]
    if not pictures:
        lines.append("None: matplotlib is not installed.")
    with written_whole(folder / CARD) as beside:
        beside.write_text("\n".join(lines) + "\n")
    return "\n".join([*table, "", _time(spent), f"{folder / CARD}"]) + "\n"


def _what(plan: Plan, folder: Path, state: Json) -> list[str]:
    commands = [json.loads(line) for line in (folder / "commands.jsonl").read_text().splitlines()]
    first, versions = commands[0], commands[-1]["versions"]
    engines = ", ".join(f"{name} ({count})" for name, count in plan.engines)
    git = first["git"]
    source = f"`{git['commit'][:12]}`{' with changes' if git['changed'] else ''}" if git else "not under Git"
    environment = plan["environment"]
    reward = ", ".join(f"{name} {weight:g}" for name, weight in environment["reward"].items())
    times = len(commands) - 1
    return [
        f"PPO on {environment['robot']}, actions: {environment['action']}, seed {plan['seed']}.",
        "",
        f"- Policy: `{BEST}`, after {state['best']['steps']} of {_steps(folder)} steps: the best by the lowest "
        f"{plan['evaluation']['score']} of {', '.join(plan.evaluation_engines)}.",
        f"- Trained in: {engines} (environments).",
        f"- Reward: {reward}.",
        f"- Stages: {'; '.join(_stages(plan))}.",
        f"- Made by `{' '.join(first['command'])}`" + (f", gone on with {times} times" if times else "") + ".",
        f"- Source: {source}; {', '.join(f'{name} {version}' for name, version in versions.items())}; "
        f"{first['processors']} processors.",
        "- All of it: `config.yaml`; run it by `environment.yaml`.",
    ]


def _steps(folder: Path) -> int:
    return int(record.read(folder / PROGRESS)[-1]["steps"])


def _stages(plan: Plan) -> list[str]:
    texts = []
    for stage in plan.stages:
        command = ", ".join(f"{key} {low:g} to {high:g}" for key, (low, high) in stage.command.items())
        texts.append(f"from {stage.begin}: {stage.environment.terrain}" + (f", {command}" if command else ""))
    return texts


def _table(results: dict[str, dict[str, Json]]) -> list[str]:
    heads = ["engine", "policy", *_COLUMNS.values(), "ended early"]
    lines = [f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for engine in next(iter(results.values())):
        for policy, by_engine in results.items():
            said = by_engine[engine]
            cells = [_cell(said.get(name)) for name in _COLUMNS]
            ended = f"{evaluation.failures(said)} of {said['episodes']}"
            lines.append(f"| {' | '.join([engine, policy, *cells, ended])} |")
    return lines


def _cell(told: Json | None) -> str:
    return f"{told['mean']:.4g} +- {told['deviation']:.2g}" if told else "-"


def _time(clock: Clock) -> str:
    shares = ", ".join(f"{name} {100 * share:.1f} %" for name, share in clock.shares().items())
    total = sum(clock.spent.values())
    return (
        f"{record.duration(total)}, of which evaluations {record.duration(clock.spent['evaluation'])}. "
        f"Of the rest: {shares}."
    )


def _verdict(plan: Plan, best: str) -> list[str]:
    import crossgait

    try:
        said = crossgait.verdict(best, environment=plan.evaluated, progress=False)
    except ConfigError as error:
        return [f"None: {error}"]
    return ["```", str(said), "```"]


def _pictures(plan: Plan, folder: Path) -> list[str]:
    """Names of the pictures that were made; none without matplotlib."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return []
    rows, evaluated = record.read(folder / PROGRESS), record.read(folder / EVALUATIONS)
    groups = {
        "learning-curve": {"in training, reward per step": ["reward"]},
        "reward-terms": {"weighted reward per step": [n for n in rows[0] if n.startswith("reward.")]},
        "parameters": {name: [f"parameter.{name}"] for name in plan["environment"].get("adapt", [])},
    }
    made = []
    for name, axes in groups.items():
        if not axes:
            continue
        extra = 1 if name == "learning-curve" else 0
        figure = Figure(figsize=(8, 1 + 2.2 * (len(axes) + extra)), layout="constrained")
        places = figure.subplots(len(axes) + extra, 1, sharex=True, squeeze=False)[:, 0]
        for ax, (label, columns) in zip(places, axes.items(), strict=False):
            _draw(ax, rows, columns, label)
        if extra:
            scores = [f"{engine}.{plan['evaluation']['score']}" for engine in plan.evaluation_engines]
            _draw(places[-1], evaluated, [*scores, "zero"], f"evaluated, {plan['evaluation']['score']}")
        places[-1].set_xlabel("steps")
        with written_whole(folder / f"{name}.png") as beside:
            figure.savefig(beside, dpi=110)
        made.append(name)
    return made


def _draw(ax: Any, rows: list[record.Row], columns: list[str], label: str) -> None:
    for column in columns:
        points = [(row["steps"], row[column]) for row in rows if row.get(column) is not None]
        name = column.removeprefix("reward.").removeprefix("parameter.")
        if column == "zero" and points:  # of the same episodes every time: a level, not a curve
            ax.axhline(points[-1][1], color="#444444", linestyle="--", linewidth=1, label=name)
            continue
        ax.plot([x for x, _ in points], [y for _, y in points], ".-", label=name, linewidth=1, markersize=3)
    ax.set_ylabel(label)
    ax.grid(alpha=0.3)
    if len(columns) > 1:
        ax.legend(frameon=False, fontsize="small")
