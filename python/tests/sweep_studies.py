"""Short studies, and what tests of sweeps do with them."""

from __future__ import annotations

import json
import os
import signal
from pathlib import Path

from crossgait.sweep import Outcome, Run, Study, row_of

#: 16 runs of .2 s: two grounds, two step heights, four starts.
SHORT = """
engines: [{engine}]
starts: 4
walks:
  - terrain: [flat, rough]
    parameters: {{step_height: [0.02, 0.03]}}
    seconds: 0.2
    settle: 0.1
"""


def study_file(folder: Path, text: str) -> Path:
    path = folder / "study.yaml"
    path.write_text(text)
    return path


def study(folder: Path, text: str) -> Study:
    return Study.load(study_file(folder, text))


def serial_rows(runs: list[Run]) -> list[bytes]:
    """What a loop makes, in the order of the file's lines."""
    return sorted(row_of(run).encode() + b"\n" for run in runs)


def lines(path: Path) -> list[bytes]:
    return sorted(path.read_bytes().splitlines(keepends=True))


class Serial:
    """An executor that makes runs itself, one by one, and may be told to misbehave."""

    workers = 1

    def __init__(self, outcomes: dict[str, list[str]] | None = None) -> None:
        self._runs: list[Run] = []
        self._outcomes = outcomes or {}
        self.made: list[str] = []

    def has_room(self) -> bool:
        return not self._runs

    def submit(self, run: Run) -> None:
        self._runs.append(run)

    def wait(self, seconds: float) -> list[Outcome]:
        run = self._runs.pop()
        kind = (self._outcomes.get(run.hash) or ["made"]).pop(0)
        if kind == "crashed":
            return [Outcome(run, "crashed", detail="signal SIGSEGV")]
        if kind == "lost":
            return [Outcome(run, "lost")]
        self.made.append(run.hash)
        return [Outcome(run, "made", row_of(run))]

    def close(self) -> None:
        self._runs = []


def crash(run: Run) -> str:
    """As an engine would that crashes at the second start."""
    if run.start == 1:
        os.kill(os.getpid(), signal.SIGSEGV)
    return row_of(run)


def hashes(path: Path) -> list[str]:
    return [json.loads(line)["hash"] for line in path.read_bytes().splitlines()]
