"""The sweep: hands out what is missing, and is the one who writes."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from types import FrameType
from typing import Any

from crossgait.errors import ConfigError
from crossgait.sweep.executors import Executor, Outcome
from crossgait.sweep.rows import RowFile
from crossgait.sweep.runs import Run, failed_row

LOOK_SECONDS = 0.2  #: how often Ctrl-C and progress are looked at
CRASHES = 2  #: of its process, after which a run counts as failed


@dataclass
class Summary:
    """How far a sweep is."""

    runs: int  #: of the study
    there_before: int = 0  #: of them, when it began
    made: int = 0
    failed: int = 0  #: of those that were made
    crashes: int = 0  #: of processes that made them
    lost: int = 0  #: runs that were handed out again because a node or its process was gone
    seconds: float = 0.0
    workers: int = 0
    interrupted: bool = False

    @property
    def missing(self) -> int:
        """Of the study, neither there nor made."""
        return self.runs - self.there_before - self.made

    @property
    def runs_per_second(self) -> float:
        """Made by this sweep."""
        return self.made / self.seconds if self.seconds > 0 else 0.0

    def to_dict(self) -> dict[str, Any]:
        """Everything, for a program."""
        return {**asdict(self), "missing": self.missing, "runs_per_second": self.runs_per_second}


Listener = Callable[[Summary], None]


class _Stop:
    """Set by SIGINT and SIGTERM; the second SIGINT acts as ever."""

    def __init__(self) -> None:
        self.asked = False

    @contextmanager
    def listening(self) -> Iterator[_Stop]:
        if threading.current_thread() is not threading.main_thread():
            yield self
            return
        before = {number: signal.getsignal(number) or signal.SIG_DFL for number in (signal.SIGINT, signal.SIGTERM)}

        def ask(number: int, frame: FrameType | None) -> None:
            self.asked = True
            signal.signal(number, before[signal.Signals(number)])

        for number in before:
            signal.signal(number, ask)
        try:
            yield self
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


def sweep(
    runs: Sequence[Run],
    rows: str | os.PathLike[str],
    executor: Callable[[], Executor[Run, str]],
    *,
    retry_failed: bool = False,
    listener: Listener | None = None,
) -> Summary:
    """Make what is missing.

    Args:
        runs: of a study (`Study.runs`).
        rows: the file; what it holds is not made again.
        executor: called if there is anything to make.
        retry_failed: also make again what failed before.
        listener: told a few times a second.

    Returns:
        what was done; also after SIGINT and SIGTERM, when `interrupted` is set. All rows that came back are kept.

    Raises:
        ConfigError: if the file holds something else, is being written by another sweep, or has no room.

    """
    if not callable(executor):
        expected = "a function that makes one, such as functools.partial(ProcessPool, 4)"
        raise ConfigError("sweep", "executor", expected, type(executor).__name__)
    if isinstance(runs, (str, os.PathLike)) or not isinstance(runs, Sequence):
        raise ConfigError("sweep", "runs", "runs of a study: Study.load(file).runs()", type(runs).__name__)
    with RowFile(rows) as file:
        again = (None, True) if retry_failed else (None,)
        todo = deque(run for run in runs if file.has_failed(run.hash) in again)
        summary = Summary(runs=len(runs), there_before=len(runs) - len(todo))
        if todo:
            workers = executor()
            try:
                with _Stop().listening() as stop:
                    _make(todo, file, workers, stop, summary, listener)
            finally:
                workers.close()
    return summary


def _make(
    todo: deque[Run],
    file: RowFile,
    workers: Executor[Run, str],
    stop: _Stop,
    summary: Summary,
    listener: Listener | None,
) -> None:
    begin = time.monotonic()
    crashes: Counter[str] = Counter()
    in_flight = 0
    while (todo or in_flight) and not stop.asked:
        while todo and workers.has_room():
            workers.submit(todo.popleft())
            in_flight += 1
        for outcome in workers.wait(LOOK_SECONDS):
            in_flight -= 1
            if (row := _row(outcome, crashes, summary)) is None:
                todo.appendleft(outcome.task)
            else:
                file.add(row)
                summary.made += 1
                summary.failed += bool(file.has_failed(outcome.task.hash))
        summary.seconds = time.monotonic() - begin
        summary.workers = workers.workers
        if listener is not None:
            listener(summary)
    summary.interrupted = bool(todo or in_flight)


def _row(outcome: Outcome[Run, str], crashes: Counter[str], summary: Summary) -> str | None:
    """The row that it comes to; None: to be made again."""
    if outcome.kind == "made":
        return outcome.made
    if outcome.kind == "lost":
        summary.lost += 1
        return None
    summary.crashes += 1
    crashes[outcome.task.hash] += 1
    if crashes[outcome.task.hash] < CRASHES:
        return None
    return failed_row(outcome.task, f"the process that made it crashed, {CRASHES} times: {outcome.detail}")
