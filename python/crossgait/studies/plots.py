"""Draws what studies found, with matplotlib: documents as of `--json`, and traces. Engines keep their colours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crossgait.errors import ConfigError
from crossgait.traces import Numbers, Trace

Json = dict[str, Any]

# Okabe and Ito's palette (2008): told apart by the colour-blind, too.
_PALETTE = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00")
_WORDS = {"agrees": "#009E73", "differs": "#D55E00", "step-dependent": "#E69F00", "unresolved": "#888888"}
_LEGS = ("FL", "FR", "RL", "RR")


def _new(rows: int, height: float, *, share_x: bool = False) -> tuple[Figure, list[Axes]]:
    figure, axes = plt.subplots(rows, 1, figsize=(8, height), sharex=share_x, squeeze=False, layout="constrained")
    column = [row[0] for row in axes]
    for ax in column:
        ax.spines[["top", "right"]].set_visible(False)
        ax.grid(alpha=0.25)
    return figure, column


def roll_pitch_yaw(trace: Trace) -> Numbers:
    """Attitude of the base, N x 3, degrees (Z-Y-X convention)."""
    w, x, y, z = (trace[f"q_WB.{axis}"] for axis in "wxyz")
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1, 1))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    attitude: Numbers = np.degrees(np.stack([roll, pitch, np.unwrap(yaw)], axis=1))
    return attitude


def _draw_traces(traces: Sequence[Trace], title: str) -> Figure:
    figure, axes = _new(4, 8, share_x=True)
    for colour, trace in zip(_PALETTE, traces, strict=False):
        attitude = roll_pitch_yaw(trace)
        axes[0].plot(trace.time, trace["p_WB.x"], color=colour, label=trace.name)
        axes[1].plot(trace.time, 1e3 * trace["p_WB.z"], color=colour)
        axes[2].plot(trace.time, attitude[:, 0], color=colour)
        axes[2].plot(trace.time, attitude[:, 1], color=colour, linestyle="--")
    axes[0].set_ylabel("way, m")
    axes[1].set_ylabel("height of base, mm")
    axes[2].set_ylabel("roll (solid),\npitch (dashed), deg")
    _draw_contacts(axes[3], traces)
    axes[3].set_xlabel("time, s")
    axes[0].legend(frameon=False, ncols=len(traces))
    figure.suptitle(title)
    return figure


def _draw_contacts(ax: Axes, traces: Sequence[Trace]) -> None:
    """Draw bars where feet touch, one line per leg and engine."""
    height = 0.8 / len(traces)
    for k, (colour, trace) in enumerate(zip(_PALETTE, traces, strict=False)):
        for i, leg in enumerate(_LEGS):
            touches = np.concatenate([[0], trace[f"contact.{leg}"], [0]])
            begins, ends = np.flatnonzero(np.diff(touches) > 0), np.flatnonzero(np.diff(touches) < 0) - 1
            bars = [(trace.time[b], trace.time[e] - trace.time[b]) for b, e in zip(begins, ends, strict=True)]
            ax.broken_barh(bars, (i - 0.4 + k * height, height), color=colour)
    ax.set_yticks(range(len(_LEGS)), _LEGS)
    ax.invert_yaxis()
    ax.set_ylabel("feet on\nthe ground")
    ax.grid(visible=False)


def plot_traces(traces: Sequence[Trace], title: str, study: str) -> Figure:
    """Way, height, attitude and footfalls over time. Raises ConfigError, naming the study, without a trace."""
    if not traces:
        raise ConfigError(study, "trace", "trace=True when it was made", "none")
    return _draw_traces(traces, title)


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
            ax.plot(values, np.full(len(values), i), "o", alpha=0.7, color=_PALETTE[i % len(_PALETTE)])
            ax.plot([float(np.mean(values))], [i], "|", markersize=18, color="black")
    for ax, label in zip(axes, ("mean speed, m/s", "return"), strict=True):
        ax.set_yticks(range(len(runs)), [run["policy"] for run in runs])
        ax.set_ylim(len(runs) - 0.5, -0.5)
        ax.set_xlabel(label)
    return figure


def plot_transfer(document: Json) -> Figure:
    """Speed of the policy and of the gait alone, in every engine on every ground."""
    cells = document["cells"]
    figure, (ax,) = _new(1, 1.5 + 0.45 * len(cells))
    for i, cell in enumerate(cells):
        for key, shift, colour in (("baseline", 0.12, "#888888"), ("policy", -0.12, _PALETTE[0])):
            speed = cell[key]["mean_speed_mps"]
            label = {"baseline": "without", "policy": document["policy"]}[key] if i == 0 else None
            ax.errorbar(speed["mean"], i + shift, xerr=speed["deviation"], fmt="o", color=colour, label=label)
    ax.set_yticks(range(len(cells)), [f"{cell['terrain']}, {cell['engine']}" for cell in cells])
    ax.invert_yaxis()
    ax.set_xlabel("mean speed, m/s (bars: deviation over episodes)")
    ax.legend(frameon=False)
    return figure


def plot_course(document: Json) -> Figure:
    """Score of every section, by engine."""
    cells = document["cells"]
    sections = list(dict.fromkeys(cell["section"]["name"] for cell in cells))
    engines = list(dict.fromkeys(cell["engine"] for cell in cells))
    figure, (ax,) = _new(1, 1.5 + 0.3 * len(sections))
    for i, cell in enumerate(cells):
        engine = engines.index(cell["engine"])
        ax.errorbar(
            cell["score"]["mean"],
            sections.index(cell["section"]["name"]) + 0.15 * (engine - (len(engines) - 1) / 2),
            xerr=cell["score"]["deviation"],
            fmt="o",
            color=_PALETTE[engine % len(_PALETTE)],
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
        ax.errorbar(change["effect"], i, xerr=ends, fmt="o", color=_PALETTE[0 if change["cures"] else 1])
    ax.set_yticks(range(len(ranking)), [change["field"] for change in ranking])
    ax.invert_yaxis()
    ax.set_xlabel(f"taken away of a score of {document['score']:.2f} (bars: 95 % over seeds)")
    return figure


def plot_tuning(document: Json) -> Figure:
    """Best score over generations."""
    figure, (ax,) = _new(1, 3.5)
    ax.step(range(len(document["history"])), document["history"], where="post", color=_PALETTE[0])
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
    for colour, engine in zip(_PALETTE, engines, strict=False):
        ratio = {row["scene"]: row["ratio"] for row in rows if row["engine"] == engine}
        ax.plot(
            range(len(scenes)),
            [ratio.get(scene, np.nan) for scene in scenes],
            "o-",
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
