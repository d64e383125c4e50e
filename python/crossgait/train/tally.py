"""What a rollout's environments did, summed up for one row of progress.csv."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

Numbers = dict[str, float | None]


class Tally:
    """Sums over the steps of one rollout."""

    def __init__(self, count: int) -> None:
        self.steps = 0
        self.episodes = 0  #: that ended
        self.failures: dict[str, int] = {}  #: by outcome, of those that ended by one
        self._reward = 0.0
        self._terms: dict[str, float] = {}
        self._way = self._time = 0.0  # m and s of ended episodes
        self._now: list[tuple[float, float]] = [(0.0, 0.0)] * count  # of those that go on

    def add(self, rewards: npt.NDArray[Any], dones: npt.NDArray[Any], infos: Sequence[dict[str, Any]]) -> None:
        """One step of every environment."""
        self.steps += len(infos)
        self._reward += float(rewards.sum())
        for i, info in enumerate(infos):
            for name, value in info["reward_terms"].items():
                self._terms[name] = self._terms.get(name, 0.0) + value
            if dones[i]:
                self._end(i, info)
            else:
                self._now[i] = (info["distance"], info["time"])

    def _end(self, i: int, info: dict[str, Any]) -> None:
        self.episodes += 1
        self._way += info["distance"]
        self._time += info["time"]
        self._now[i] = (0.0, 0.0)
        if not info["TimeLimit.truncated"]:
            outcome = info["outcome"]
            self.failures[outcome] = self.failures.get(outcome, 0) + 1

    @staticmethod
    def sum_of(parts: Sequence[Tally]) -> Tally:
        """Return the tally of the environments of all `parts`, one after the other."""
        whole = Tally(0)
        for part in parts:
            whole.steps += part.steps
            whole.episodes += part.episodes
            whole._reward += part._reward
            whole._way += part._way
            whole._time += part._time
            whole._now += part._now
            for mine, theirs in ((whole.failures, part.failures), (whole._terms, part._terms)):
                for name, value in theirs.items():
                    mine[name] = mine.get(name, 0) + value  # type: ignore[assignment]  # of counts a count
        return whole

    def numbers(self) -> Numbers:
        """Means per step, m/s, and counts of episodes."""
        steps = max(1, self.steps)
        way = self._way + sum(way for way, _ in self._now)
        time = self._time + sum(time for _, time in self._now)
        failures = sum(self.failures.values())
        row: Numbers = {
            "reward": self._reward / steps,
            "speed_mps": way / time if time > 0 else None,
            "episodes_ended": self.episodes,
            "failures": failures,
            "falls": self.failures.get("fell", 0),
            "failures_per_minute": 60 * failures / time if time > 0 else None,
        }
        return row | {f"reward.{name}": value / steps for name, value in self._terms.items()}


def of_environments(
    summaries: Sequence[dict[str, Any]], parameters: Sequence[dict[str, float] | None], adapted: Sequence[str]
) -> Numbers:
    """Of the episodes that go on at the end of a rollout: means of drag, slip and the parameters that adapt."""
    row: Numbers = {}
    for key in ("swing_contact_ratio", "slip_per_path", "cost_of_transport"):
        row[key] = _mean([s[key] for s in summaries if s["simulated_seconds"] > 0 and s.get(key) is not None])
    there = [p for p in parameters if p is not None]
    for name in adapted if there else ():
        row[f"parameter.{name}"] = _mean([p[name] for p in there])
    return row


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if values else None
