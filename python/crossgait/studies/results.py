"""What studies return: the same numbers as the commands' JSON, as objects to look at."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crossgait.errors import ConfigError, meant
from crossgait.studies.result import Answer, Json, Result, asked_for, flat
from crossgait.studies.walk_numbers import WalkNumbers
from crossgait.traces import Trace

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from crossgait._core import EnvironmentConfig


@dataclass(frozen=True, repr=False, eq=False)
class WalkResult(Answer, WalkNumbers):
    """One walk in one engine. Its numbers are attributes too: `result.mean_speed_mps`."""

    recorded: Trace | None = None  #: the trace, None unless it was asked for

    _study = "walk"
    _index = ("engine",)

    @property
    def trace(self) -> Trace:
        """Every control step. Raises ConfigError unless it was asked for."""
        return asked_for(self.recorded, "walk")

    if not TYPE_CHECKING:  # which knows them by WalkNumbers, and so sees what is misspelt

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_") or name == "document":  # of a copy that is not yet there
                raise AttributeError(name)
            if name in self.document:
                return self.document[name]
            hint = meant(name, dir(self), "the document has none either (to_dict)")
            raise AttributeError(f"a {type(self).__name__} has no '{name}': {hint}")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.document]

    def plot(self) -> Figure:
        """Draw way, height, attitude and footfalls over time."""
        from crossgait.studies import plots

        return plots.plot_traces([self.trace], self._headline())

    def _rows(self) -> list[Json]:
        return [flat(self.document)]


@dataclass(frozen=True, repr=False, eq=False)
class CompareResult(Answer):
    """The same walk in several engines."""

    recorded: dict[str, Trace] = field(default_factory=dict)  #: the traces, none unless they were asked for

    _study = "compare"
    _index = ("engine",)

    @property
    def traces(self) -> dict[str, Trace]:
        """Every control step, by engine. Raises ConfigError unless they were asked for."""
        return asked_for(self.recorded, "compare")

    @property
    def engines(self) -> list[str]:
        """Names, in the order of the runs."""
        return [run["engine"] for run in self.document["runs"]]

    @property
    def pairs(self) -> list[Json]:
        """How far every two of them lie apart."""
        pairs: list[Json] = self.document["pairs"]
        return pairs

    def plot(self) -> Figure:
        """Draw way, height, attitude and footfalls in every engine."""
        from crossgait.studies import plots

        run = self.document["runs"][0]
        title = f"{run['gait']} on {run['terrain']}"
        return plots.plot_traces(list(self.traces.values()), title)

    def _rows(self) -> list[Json]:
        return [flat(run) for run in self.document["runs"]]

    @property
    def groups(self) -> list[Json]:
        """Engines that did the same: `name`, `engines`, `outcome`, `apart_m` and the printed `sentence`."""
        groups: list[Json] = self.document["groups"]
        return groups


@dataclass(frozen=True, repr=False, eq=False)
class Verdict(Answer):
    """Whether a behaviour depends on the engine (docs/verdict.md), in two engines or more."""

    _study = "verdict"
    _index = ("a", "b", "key")

    @property
    def word(self) -> str:
        """`agrees`, `differs`, `step-dependent` or `unresolved`: of all pairs together."""
        word: str = self.document["word"]
        return word

    @property
    def outcomes(self) -> dict[str, dict[str, int]]:
        """How many runs came to which outcome, by engine."""
        outcomes: dict[str, dict[str, int]] = self.document["outcomes"]
        return outcomes

    @property
    def pairs(self) -> list[Json]:
        """Every two engines: `engines`, `word`, `reason`, `starts_needed`, `statistics` and what goes with them."""
        pairs: list[Json] = self.document["pairs"]
        return pairs

    def pair(self, a: str, b: str) -> Json:
        """One of them, either way round. Raises KeyError."""
        for pair in self.pairs:
            if {a, b} == set(pair["engines"]):
                return pair
        raise KeyError((a, b))

    def statistic(self, key: str, a: str | None = None, b: str | None = None) -> Json:
        """Judge one statistic, by its key: of the first pair, or of two engines. Raises KeyError."""
        pair = self.pairs[0] if a is None or b is None else self.pair(a, b)
        for row in pair["statistics"]:
            if row["key"] == key:
                statistic: Json = row
                return statistic
        known = [row["key"] for row in pair["statistics"]]
        raise KeyError(f"no statistic '{key}': " + meant(key, known, ", ".join(known)))

    @property
    def causes(self) -> dict[str, str]:
        """What gaps come from, a sentence for each statistic's key; empty unless it was explained."""
        found: dict[str, str] = {}
        for pair in self.pairs:
            for row in (pair["attribution"] or {"statistics": []})["statistics"]:
                if row["cause"]["sentence"]:
                    found.setdefault(row["key"], row["cause"]["sentence"])
        return found

    @property
    def clusters(self) -> list[list[str]]:
        """Engines that agree, each with all others of its cluster; the largest first."""
        return [group["engines"] for group in self.document["groups"]]

    @property
    def outlier(self) -> str | None:
        """The engine that stands apart, or the contact law of several; None if none is named (see `reason`)."""
        outlier = self.document["outlier"]
        return None if outlier is None else str(outlier["name"])

    @property
    def reason(self) -> str:
        """Why an outlier is named, or none."""
        reason: str = self.document["outlier_reason"]
        return reason

    def plot(self) -> Figure:
        """Draw every statistic's gap with its interval, in margins, by pair."""
        from crossgait.studies import plots

        return plots.plot_verdict(self.document)

    def _rows(self) -> list[Json]:
        rows = []
        for pair in self.pairs:
            a, b = pair["engines"]
            for s in pair["statistics"]:
                row = {"key": s["key"], "unit": s["unit"], "a": a, "b": b}
                row |= {"value_a": s["values"][0], "value_b": s["values"][1]}
                row |= {name: s[name] for name in ("gap", "low", "high", "margin", "word", "reason", "starts_needed")}
                row["gap_half"] = s["step"]["gap_half"] if s["step"] else None
                rows.append(row)
        return rows

    def _headline(self) -> str:
        return f"{self.word}: {self.summary}"


@dataclass(frozen=True, repr=False, eq=False)
class Rollout(Answer):
    """Whole episodes of policies in one engine."""

    recorded: dict[str, Trace] = field(default_factory=dict)  #: the traces, none unless they were asked for

    _study = "rollout"
    _index = ("policy", "episode")

    @property
    def traces(self) -> dict[str, Trace]:
        """Every step of each policy's first episode. Raises ConfigError unless they were asked for."""
        return asked_for(self.recorded, "rollout")

    def plot(self) -> Figure:
        """Draw speed and return of every episode."""
        from crossgait.studies import plots

        return plots.plot_rollout(self.document)

    def _rows(self) -> list[Json]:
        return [
            {"policy": run["policy"], "episode": number, **flat(episode)}
            for run in self.document["policies"]
            for number, episode in enumerate(run["episodes"])
        ]


def _of_episodes(summary: Json) -> Json:
    """Means over episodes under their names, as of one episode, and their deviations: `distance_m.deviation`."""
    row = flat(summary)
    return {key.removesuffix(".mean"): value for key, value in row.items()}


@dataclass(frozen=True, repr=False, eq=False)
class Transfer(Result):
    """One policy, and none (`baseline`), over engines and grounds."""

    _study = "transfer"
    _index = ("terrain", "engine")

    def plot(self) -> Figure:
        """Draw the speed with the policy and without, in every engine on every ground."""
        from crossgait.studies import plots

        return plots.plot_transfer(self.document)

    def _rows(self) -> list[Json]:
        return [
            {"terrain": cell["terrain"], "engine": cell["engine"]}
            | _of_episodes(cell["policy"])
            | {f"baseline.{key}": value for key, value in _of_episodes(cell["baseline"]).items()}
            for cell in self.document["cells"]
        ]

    def _headline(self) -> str:
        engines = dict.fromkeys(cell["engine"] for cell in self.document["cells"])
        return f"{Path(self.document['policy']).name} in {', '.join(engines)}"


@dataclass(frozen=True, repr=False, eq=False)
class CourseResult(Answer):
    """A policy on every section of a course."""

    _study = "course"
    _index = ("section", "engine")

    def score(self, engine: str | None = None) -> float:
        """Over all sections, 0 to 1, in an engine; in the first if none is named."""
        found = [s for s in self.document["scores"] if engine in (None, s["engine"])]
        if not found:
            raise ConfigError("course", "engine", "one that it was run in", repr(engine))
        return float(found[0]["mean"])

    def plot(self) -> Figure:
        """Draw the score of every section, by engine."""
        from crossgait.studies import plots

        return plots.plot_course(self.document)

    def _rows(self) -> list[Json]:
        return [
            {"section": cell["section"]["name"], **flat({k: v for k, v in cell.items() if k != "section"})}
            for cell in self.document["cells"]
        ]


@dataclass(frozen=True, repr=False, eq=False)
class Tuning(Result):
    """Gait parameters that were searched for."""

    environment: EnvironmentConfig | None = None  #: with the tuned parameters

    _study = "tune"
    _index = ("generation",)

    def plot(self) -> Figure:
        """Draw the best score over generations."""
        from crossgait.studies import plots

        return plots.plot_tuning(self.document)

    def _rows(self) -> list[Json]:
        return [{"generation": i, "best": score} for i, score in enumerate(self.document["history"])]

    def _headline(self) -> str:
        course, history = self.document.get("course"), self.document["history"]
        if not history:
            return "not tuned"
        return f"tuned to {history[-1]:.3f} {'m/s' if course is None else f'on course {course}'}"


@dataclass(frozen=True, repr=False, eq=False)
class Diagnosis(Answer):
    """Why a policy does not do what it is asked."""

    environment: EnvironmentConfig | None = None  #: with the first of the ranking; as it is if there is none

    _study = "diagnose"
    _index = ("field",)

    @property
    def healthy(self) -> bool:
        """Whether it does what it is asked."""
        return bool(self.document["healthy"])

    @property
    def cause(self) -> str | None:
        """`contract`, `physics` or `policy`; None if it is healthy, or if none is named (see `abstained`)."""
        cause: str | None = self.document["cause"]
        return cause

    @property
    def abstained(self) -> bool:
        """Whether explanations fit as well as one another, or none does."""
        return bool(self.document["abstained"])

    @property
    def ranking(self) -> list[Json]:
        """Changes, best first: `field`, `from`, `to`, `effect`, `low`, `high`, `confidence`, `cures`."""
        ranking: list[Json] = self.document["ranking"]
        return ranking

    def plot(self) -> Figure:
        """Draw what every change takes away of the score, with its interval."""
        from crossgait.studies import plots

        return plots.plot_diagnosis(self.document)

    def _rows(self) -> list[Json]:
        return self.ranking


class Scores(Answer):
    """How well policies do what they are asked, each in each engine."""

    _study = "score"
    _index = ("policy", "engine")

    def plot(self) -> Figure:
        """Draw the score of every policy by engine, with its interval."""
        from crossgait.studies import plots

        return plots.plot_scores(self.document["cells"])

    def _rows(self) -> list[Json]:
        cells: list[Json] = self.document["cells"]
        return cells


class Matrix(Answer):
    """Where policies were trained against where they run. `document["cells"]` has every policy, as `Scores` do."""

    _study = "matrix"
    _index = ("trained_in", "engine")

    def plot(self) -> Figure:
        """Draw the score of every home's policies by engine, with its interval."""
        from crossgait.studies import plots

        named = [{"policy": f"trained in {row['trained_in'] or '?'}", **row} for row in self._rows()]
        return plots.plot_scores(named)

    def _rows(self) -> list[Json]:
        homes: list[Json] = self.document["homes"]
        return homes


@dataclass(frozen=True, repr=False, eq=False)
class Bench(Result):
    """Speed and accuracy of the engines on the same motions."""

    _study = "bench"
    _index = ("scene", "engine")

    def plot(self) -> Figure:
        """Draw the time of a physics step in every scene, over the first engine's."""
        from crossgait.studies import plots

        return plots.plot_bench(self._rows())

    def _rows(self) -> list[Json]:
        return [flat(row) for row in self.document.get("speed", {}).get("scenes", [])]

    def _headline(self) -> str:
        return f"benchmark of {', '.join(b if isinstance(b, str) else b['name'] for b in self.document['engines'])}"


@dataclass(frozen=True, repr=False, eq=False)
class Conformance(Result):
    """What an engine made of the checks that every engine is held to."""

    _study = "conformance"
    _index = ("check", "what")

    @property
    def passed(self) -> bool:
        """Whether no check failed."""
        return bool(self.document["failed"] == 0)

    def plot(self) -> Figure:
        """Draw every number over its bound."""
        from crossgait.studies import plots

        return plots.plot_conformance(self._rows())

    def _rows(self) -> list[Json]:
        return [
            {"check": check["name"], "status": check["status"], **number}
            for check in self.document["checks"]
            for number in check["measurements"] or [{}]
        ]

    def _headline(self) -> str:
        d = self.document
        return f"{d['engine']['name']}: {d['passed']} passed, {d['failed']} failed, {d['skipped']} skipped"
