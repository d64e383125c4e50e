"""Draws what studies found, with matplotlib: documents as of `--json`, and traces. Engines keep their colours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from crossgait.extras import needed_for

with needed_for("plots", "plot"):
    from matplotlib import pyplot as plt
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

from crossgait.errors import ConfigError
from crossgait.studies.palette import COLOURS, engine_styles
from crossgait.traces import Numbers, Trace

Json = dict[str, Any]

_WORDS = {"agrees": "#009E73", "differs": "#D55E00", "step-dependent": "#E69F00", "unresolved": "#888888"}
_LEGS = ("FL", "FR", "RL", "RR")


def _new(rows: int, height: float, *, share_x: bool = False) -> tuple[Figure, list[Axes]]:
    figure, axes = plt.subplots(rows, 1, figsize=(8, height), sharex=share_x, squeeze=False, layout="constrained")
    column = [row[0] for row in axes]
    for ax in column:
        ax.spines[["top", "right"]].set_visible(False)
        ax.grid(alpha=0.25)
    return figure, column


def _from_zero(ax: Axes) -> None:
    """Let the axis of amounts begin at 0: otherwise half a percent fills the picture as a half would."""
    low, high = ax.get_xlim()
    ax.set_xlim(min(low, 0), max(high, 0))


def roll_pitch_yaw(trace: Trace) -> Numbers:
    """Attitude of the base, N x 3, degrees (Z-Y-X convention); roll and yaw go on beyond 180."""
    w, x, y, z = (trace[f"q_WB.{axis}"] for axis in "wxyz")
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    attitude: Numbers = np.degrees(np.stack([np.unwrap(roll), pitch, np.unwrap(yaw)], axis=1))
    return attitude


def plot_traces(traces: Sequence[Trace], title: str) -> Figure:
    """Way, height, attitude and footfalls over time."""
    several = len(traces) > 1
    figure, axes = _new(5 if several else 4, 10 if several else 8, share_x=True)
    if several:
        _draw_distances(axes[0], traces)
    way, height, angles, feet = axes[-4:]
    styles = engine_styles([trace.name for trace in traces])
    for i, trace in enumerate(traces):
        colour, line = styles[trace.name]
        # Engines that agree lie on each other: those behind are wider.
        style: Json = {"color": colour, "linestyle": line, "linewidth": 1.2 + 0.8 * (len(traces) - 1 - i)}
        attitude = roll_pitch_yaw(trace)
        way.plot(trace.time, trace["p_WB.x"], label=trace.name, **style)
        height.plot(trace.time, 1e3 * trace["p_WB.z"], **style)
        angles.plot(trace.time, attitude[:, 0], **style)
        angles.plot(trace.time, attitude[:, 1], alpha=0.5, **style)
    way.set_ylabel("way, m")
    height.set_ylabel("height of base, mm")
    angles.set_ylabel("roll,\npitch (pale), deg")
    _draw_contacts(feet, traces)
    feet.set_xlabel("time, s")
    figure.legend(*way.get_legend_handles_labels(), loc="outside lower center", frameon=False, ncols=len(traces))
    figure.suptitle(title)
    return figure


def _draw_distances(ax: Axes, traces: Sequence[Trace]) -> None:
    """Draw how far every other base is from the first's, from a nanometre on."""
    first = traces[0]
    styles = engine_styles([trace.name for trace in traces])
    place = np.stack([first[f"p_WB.{axis}"] for axis in "xyz"])
    for trace in traces[1:]:
        rows = min(len(first.time), len(trace.time))
        other = np.stack([trace[f"p_WB.{axis}"] for axis in "xyz"])
        distance = np.linalg.norm(other[:, :rows] - place[:, :rows], axis=0)
        colour, line = styles[trace.name]
        ax.plot(trace.time[:rows], np.maximum(distance, 1e-9), color=colour, linestyle=line)
    ax.set_yscale("log")
    ax.set_ylabel(f"from {first.name}, m")


def _draw_contacts(ax: Axes, traces: Sequence[Trace]) -> None:
    """Draw bars where feet touch, one line per leg and engine."""
    height = 0.8 / len(traces)
    styles = engine_styles([trace.name for trace in traces])
    for k, trace in enumerate(traces):
        colour, line = styles[trace.name]
        for i, leg in enumerate(_LEGS):
            touches = np.concatenate([[0], trace[f"contact.{leg}"], [0]])
            begins, ends = np.flatnonzero(np.diff(touches) > 0), np.flatnonzero(np.diff(touches) < 0) - 1
            bars = [(trace.time[b], trace.time[e] - trace.time[b]) for b, e in zip(begins, ends, strict=True)]
            ax.broken_barh(bars, (i - 0.4 + k * height, height), color=colour, alpha=1 if line == "-" else 0.5)
    ax.set_yticks(range(len(_LEGS)), _LEGS)
    ax.invert_yaxis()
    ax.set_ylabel("feet on\nthe ground")
    ax.grid(visible=False)


def plot_verdict(document: Json) -> Figure:
    """Every statistic's gap with its interval, in margins, by pair; shaded: within the margin."""
    pairs = document["pairs"]
    keys = list(dict.fromkeys(s["key"] for pair in pairs for s in pair["statistics"]))
    figure, (ax,) = _new(1, 1.5 + (0.25 + 0.1 * len(pairs)) * len(keys))
    for i, pair in enumerate(pairs):
        place = 0.7 * ((i + 0.5) / len(pairs) - 0.5)
        for s in pair["statistics"]:
            low, gap, high = np.array([s["low"], s["gap"], s["high"]]) / (s["margin"] or 1)
            y, colour = keys.index(s["key"]) + place, _WORDS[s["word"]]
            ax.plot([low, high], [y, y], color=colour, linewidth=2)
            ax.plot(gap, y, "o", color=colour, markersize=4)
    ax.axvspan(-1, 1, color="#eeeeee", zorder=0)
    for word, colour in _WORDS.items():
        ax.plot([], [], "o", color=colour, label=word)
    ax.legend(frameon=False, loc="upper right", bbox_to_anchor=(1, -0.12), ncols=4)
    ax.set_yticks(range(len(keys)), keys)
    ax.invert_yaxis()
    ax.set_xscale("symlog", linthresh=1)
    less = ", ".join(f"{b} less {a}" for a, b in (pair["engines"] for pair in pairs[:4]))
    ax.set_xlabel(f"gap in margins (linear up to 1), {less}{' ...' if len(pairs) > 4 else ''}")
    ax.set_title(f"{document['behaviour']}: {document['word']}")
    return figure


def plot_rollout(document: Json) -> Figure:
    """Speed and return of every episode."""
    runs = document["policies"]
    figure, axes = _new(2, 5)
    for i, run in enumerate(runs):
        for ax, key in zip(axes, ("mean_speed_mps", "total_reward"), strict=True):
            values = [episode[key] for episode in run["episodes"]]
            ax.plot(values, np.full(len(values), i), "o", alpha=0.7, color=COLOURS[i % len(COLOURS)])
            ax.plot([float(np.mean(values))], [i], "|", markersize=18, color="black")
    for ax, label in zip(axes, ("mean speed, m/s", "return"), strict=True):
        ax.set_yticks(range(len(runs)), [run["policy"] for run in runs])
        ax.set_ylim(len(runs) - 0.5, -0.5)
        ax.set_xlabel(label)
        _from_zero(ax)
    return figure


def plot_transfer(document: Json) -> Figure:
    """Speed of the policy and of the gait alone, in every engine on every ground."""
    cells = document["cells"]
    figure, (ax,) = _new(1, 1.5 + 0.45 * len(cells))
    for i, cell in enumerate(cells):
        for key, shift, colour in (("baseline", 0.12, "#888888"), ("policy", -0.12, COLOURS[0])):
            speed = cell[key]["mean_speed_mps"]
            label = {"baseline": "without", "policy": document["policy"]}[key] if i == 0 else None
            ax.errorbar(speed["mean"], i + shift, xerr=speed["deviation"], fmt="o", color=colour, label=label)
    ax.set_yticks(range(len(cells)), [f"{cell['terrain']}, {cell['engine']}" for cell in cells])
    ax.invert_yaxis()
    ax.set_xlabel("mean speed, m/s (bars: deviation over episodes)")
    _from_zero(ax)
    ax.legend(frameon=False)
    return figure


def plot_course(document: Json) -> Figure:
    """Score of every section, by engine."""
    cells = document["cells"]
    sections = list(dict.fromkeys(cell["section"]["name"] for cell in cells))
    engines = list(dict.fromkeys(cell["engine"] for cell in cells))
    styles = engine_styles(engines)
    figure, (ax,) = _new(1, 1.5 + 0.3 * len(sections))
    for i, cell in enumerate(cells):
        engine = engines.index(cell["engine"])
        ax.errorbar(
            cell["score"]["mean"],
            sections.index(cell["section"]["name"]) + 0.15 * (engine - (len(engines) - 1) / 2),
            xerr=cell["score"]["deviation"],
            fmt="o",
            color=styles[cell["engine"]][0],
            markerfacecolor=styles[cell["engine"]][0] if styles[cell["engine"]][1] == "-" else "none",
            label=cell["engine"] if i < len(engines) else None,
        )
    ax.set_yticks(range(len(sections)), sections)
    ax.invert_yaxis()
    ax.set_xlim(-0.02, 1.02)
    ax.set_xlabel("distance made over distance asked for (bars: deviation over runs)")
    ax.legend(frameon=False)
    return figure


def plot_diagnosis(document: Json) -> Figure:
    """What every change takes away of the score, with its interval."""
    ranking = document["ranking"]
    figure, (ax,) = _new(1, 1.5 + 0.3 * len(ranking))
    for i, change in enumerate(ranking):
        ends = [[change["effect"] - change["low"]], [change["high"] - change["effect"]]]
        ax.errorbar(change["effect"], i, xerr=ends, fmt="o", color=COLOURS[0 if change["cures"] else 1])
    ax.set_yticks(range(len(ranking)), [change["field"] for change in ranking])
    ax.invert_yaxis()
    ax.set_xlabel(f"taken away of a score of {document['score']:.2f} (bars: 95 % over seeds)")
    return figure


def plot_scores(cells: Sequence[Json]) -> Figure:
    """Score of every policy by engine, with its interval; 0 is best."""
    policies = list(dict.fromkeys(cell["policy"] for cell in cells))
    engines = list(dict.fromkeys(cell["engine"] for cell in cells))
    figure, (ax,) = _new(1, 1.5 + 0.3 * len(policies) * len(engines))
    for shift, (engine, (colour, _)) in enumerate(engine_styles(engines).items()):
        own = [cell for cell in cells if cell["engine"] == engine]
        places = [policies.index(cell["policy"]) + 0.8 * (shift / len(engines) - 0.5) for cell in own]
        values = [cell["value"] for cell in own]
        ends = [[c["value"] - c["low"] for c in own], [c["high"] - c["value"] for c in own]]
        ax.errorbar(values, places, xerr=ends, fmt="o", color=colour, label=engine)
    ax.set_yticks(range(len(policies)), policies)
    ax.invert_yaxis()
    ax.set_xlabel("score: 0 is best, 3 and more a fall (bars: 95 %)")
    _from_zero(ax)
    ax.legend()
    return figure


def plot_tuning(document: Json) -> Figure:
    """Best score over generations."""
    figure, (ax,) = _new(1, 3.5)
    ax.step(range(len(document["history"])), document["history"], where="post", color=COLOURS[0])
    ax.set_xlabel("generation")
    ax.set_ylabel("best score" if "course" in document else "best score, m/s")
    return figure


def plot_bench(rows: Sequence[Json]) -> Figure:
    """Time of a physics step in every scene, over the first engine's."""
    if not rows:
        raise ConfigError("bench", "sections", "speed among them", "none")
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    engines = list(dict.fromkeys(row["engine"] for row in rows))
    figure, (ax,) = _new(1, 4)
    for engine, (colour, line) in engine_styles(engines).items():
        ratio = {row["scene"]: row["ratio"] for row in rows if row["engine"] == engine}
        ax.plot(
            range(len(scenes)),
            [ratio.get(scene, np.nan) for scene in scenes],
            marker="o",
            linestyle=line,
            color=colour,
            label=engine,
        )
    ax.set_xticks(range(len(scenes)), scenes)
    ax.set_yscale("log")
    ax.set_ylabel(f"time of a step over {engines[0]}'s")
    ax.legend(frameon=False)
    return figure


def plot_conformance(rows: Sequence[Json]) -> Figure:
    """Every number that has an upper bound above zero, over that bound: what is left of 1 is margin."""
    rows = [row for row in rows if row.get("high") and row["value"] is not None]
    figure, (ax,) = _new(1, max(3.5, 0.18 * len(rows)))
    over = [max(abs(row["value"]) / row["high"], 1e-6) for row in rows]
    colours = [_WORDS["agrees"] if row["holds"] else _WORDS["differs"] for row in rows]
    ax.scatter(over, range(len(rows)), color=colours, s=12)
    ax.axvline(1, color="black", linewidth=0.8)
    ax.set_yticks(range(len(rows)), [f"{row['check']}: {row['what']}" for row in rows], fontsize=6)
    ax.invert_yaxis()
    ax.set_xscale("log")
    ax.set_xlabel("number over its bound")
    return figure
