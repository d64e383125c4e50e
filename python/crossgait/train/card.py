"""At the end of a run: card.md, which says what the policy is worth, and plots of how it came about."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from crossgait.errors import ConfigError
from crossgait.files import written_whole
from crossgait.train import evaluation, record
from crossgait.train.folder import CARD, EVALUATIONS, PROGRESS, commands_of
from crossgait.train.plan import Plan
from crossgait.train.trainer import Clock, Trained

Json = dict[str, Any]

_SPREAD = "Mean ± standard deviation. One training run: the spread over training seeds takes several."
#: Headings of the table of results, by statistic.
_COLUMNS = {
    evaluation.COURSE: "course",
    "total_reward": "return",
    "mean_speed_mps": "speed, m/s",
    "cost_of_transport": "cost of transport",
    "swing_contact_ratio": "swing contact",
    "slip_per_path": "slip per path",
}


def write(plan: Plan, folder: Path, trained: Sequence[Trained]) -> str:
    """Evaluate the best policies once more, on seeds of their own, write card and plots; returns what to print.

    `trained` is the policy, or the parts of a hierarchical one.
    """
    asked = plan["evaluation"]
    # Other episodes than those that chose the best policy, which is the best on these partly by luck.
    policies = [*(str(part.best) for part in trained), "zero"]
    results = evaluation.of_plan(policies, plan, asked["final_episodes"], asked["seed"] + 1, progress=None)
    by_name = {part.name: results[str(part.best)] for part in trained} | {"zero": results["zero"]}
    table, times = _table(by_name), [_time(part) for part in trained]
    lines = [f"# {folder.resolve().name}", "", *_what(plan, folder, trained), "", "## Results", ""]
    lines += [f"{_evaluated_on(plan)} {_SPREAD}", "", *table, "", *_sections(by_name), "## Time", "", *times]
    if plan["verdict"]:
        best = max(trained, key=lambda part: float(part.state["best"]["score"]))
        lines += ["", "## Verdict", "", *_verdict(plan, best)]
    lines += ["", "## Curves", "", *(link for part in trained for link in _pictures(part, folder))]
    if lines[-1] == "":
        lines.append("None: matplotlib is not installed.")
    with written_whole(folder / CARD) as beside:
        beside.write_text("\n".join(lines) + "\n")
    return "\n".join([*table, "", *times, f"{folder / CARD}"]) + "\n"


def _what(plan: Plan, folder: Path, trained: Sequence[Trained]) -> list[str]:
    commands = commands_of(folder)
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
        *(_which(part, folder) for part in trained),
        f"- Trained in: {engines} (environments).",
        f"- Reward: {reward}.",
        *(f"- Stages of the {part.name}: {'; '.join(_stages(part.plan))}." for part in trained),
        f"- Made by `{' '.join(first['command'])}`" + (f", gone on with {times} times" if times else "") + ".",
        f"- Source: {source}; {', '.join(f'{name} {version}' for name, version in versions.items())}; "
        f"{first['processors']} processors.",
        "- All of it: `config.yaml`; run it by `environment.yaml`.",
    ]


def _which(part: Trained, folder: Path) -> str:
    last = int(record.read(part.folder / PROGRESS)[-1]["steps"])
    dt, asked = part.plan.stages[0].environment.policy_dt, part.plan["evaluation"]
    return (
        f"- {part.name.capitalize()}: `{part.best.relative_to(folder)}`, after {part.state['best']['steps']} of {last} "
        f"steps of {dt:g} s ({last * dt / 3600:.1f} h of simulated time): the best by the lowest {asked['score']} of "
        f"{', '.join(part.plan.evaluation_engines)}."
    )


def _stages(plan: Plan) -> list[str]:
    texts = []
    for stage in plan.stages:
        met = []
        for share in stage.mix:
            command = ", ".join(f"{key} {low:g} to {high:g}" for key, (low, high) in share.command.items())
            met.append(share.environment.terrain + (f", {command}" if command else ""))
        texts.append(f"from {stage.begin}: {' / '.join(met)}")
    return texts


def _evaluated_on(plan: Plan) -> str:
    asked = plan["evaluation"]
    if asked["score"] == evaluation.COURSE:
        runs = f"{asked['final_episodes']} runs of every section in each engine"
        return f"Course `{asked['course']}`, {runs}; deviations of the score from run to run, else between sections."
    low, high = asked["terrain_seeds"]
    return (
        f"{asked['final_episodes']} episodes in each engine, the same for all, on terrain seeds {low} to {high}, which "
        "training did not see."
    )


def _sections(results: dict[str, dict[str, Json]]) -> list[str]:
    """Scores on a course, section by section; nothing without one."""
    columns = {
        f"{policy}, {engine}": said["sections"]
        for policy, by_engine in results.items()
        for engine, said in by_engine.items()
        if evaluation.COURSE in said
    }
    if not columns:
        return []
    lines = [f"| section | {' | '.join(columns)} |", "|" + "---|" * (1 + len(columns))]
    for section in next(iter(columns.values())):
        lines.append(f"| {section} | {' | '.join(_cell(column[section]) for column in columns.values())} |")
    return [*lines, ""]


def _table(results: dict[str, dict[str, Json]]) -> list[str]:
    first = next(iter(next(iter(results.values())).values()))
    columns = {name: head for name, head in _COLUMNS.items() if name in first or name != evaluation.COURSE}
    heads = ["engine", "policy", *columns.values(), "ended early"]
    lines = [f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for engine in next(iter(results.values())):
        for policy, by_engine in results.items():
            said = by_engine[engine]
            cells = [_cell(said.get(name)) for name in columns]
            ended = f"{evaluation.failures(said)} of {said['episodes']}"
            lines.append(f"| {' | '.join([engine, policy, *cells, ended])} |")
    return lines


def _cell(told: Json | None) -> str:
    return f"{told['mean']:.4g} ± {told['deviation']:.2g}" if told else "-"


def _time(part: Trained) -> str:
    clock = Clock(part.state["spent"])
    shares = ", ".join(f"{name} {100 * share:.1f} %" for name, share in clock.shares().items())
    total, evaluations = sum(clock.spent.values()), clock.spent["evaluation"]
    return (
        f"{part.name.capitalize()}: {record.duration(total)}, of which evaluations {record.duration(evaluations)}. "
        f"Of the rest: {shares}."
    )


def _verdict(plan: Plan, best: Trained) -> list[str]:
    import crossgait

    try:
        said = crossgait.verdict(str(best.best), environment=plan.evaluated, progress=False)
    except ConfigError as error:
        return [f"None: {error}"]
    return ["```", str(said), "```"]


def _pictures(part: Trained, folder: Path) -> list[str]:
    """Links from `folder` to the pictures that were made; none without matplotlib."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return []
    plan = part.plan
    rows, evaluated = record.read(part.folder / PROGRESS), record.read(part.folder / EVALUATIONS)
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
        picture = part.folder / f"{name}.png"
        with written_whole(picture) as beside:
            figure.savefig(beside, dpi=110)
        made.append(f"![{part.name}: {name}]({picture.relative_to(folder)})")
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
        ax.legend(frameon=False, fontsize="small", loc="center left", bbox_to_anchor=(1, 0.5))
