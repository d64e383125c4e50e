"""Runs in processes of this machine."""

from __future__ import annotations

import multiprocessing
import os
import queue
import signal
import threading
from collections import deque
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from typing import Any

from crossgait.sweep.executors import Make, Outcome
from crossgait.sweep.runs import Run, row_of

AHEAD = 2  #: runs that a worker has at a time: one to make, one to go on with
READY = "ready"


def _serve(connection: Connection, make: Make) -> None:
    """A worker's life. It ends when the other end of the connection does, also in the middle of a run."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the terminal's Ctrl-C is for the sweep
    todo: queue.SimpleQueue[Run] = queue.SimpleQueue()

    def listen() -> None:
        try:
            while True:
                todo.put(connection.recv())
        except (EOFError, OSError):
            os._exit(0)

    threading.Thread(target=listen, daemon=True).start()
    try:
        connection.send(READY)
        while True:
            connection.send(make(todo.get()))
    except OSError:
        os._exit(0)


class _Worker:
    def __init__(self, context: multiprocessing.context.SpawnContext, make: Make) -> None:
        self.connection, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs, make), daemon=True, name="crossgait-sweep")
        self.process.start()
        theirs.close()
        self.runs: deque[Run] = deque()
        self.ready = False

    def end(self) -> int | None:
        """End the process; returns its exit code, negative for the signal that it died of."""
        self.connection.close()
        self.process.kill()
        self.process.join()
        code = self.process.exitcode
        self.process.close()
        return code


class ProcessPool:
    """An `Executor` of processes; one that dies is replaced."""

    def __init__(self, workers: int, make: Make = row_of) -> None:
        """Start them. `make`, a function of a module, gives the row of a run."""
        self._make = make
        # Spawned, not forked: engines and interpreters have threads.
        self._context = multiprocessing.get_context("spawn")
        self.workers = workers
        self._all: list[_Worker] = []
        try:
            for _ in range(workers):
                self._all.append(_Worker(self._context, self._make))
        except BaseException:
            self.close()
            raise

    def has_room(self) -> bool:
        """As `Executor`."""
        return any(len(worker.runs) < AHEAD for worker in self._all)

    def submit(self, run: Run) -> None:
        """As `Executor`."""
        worker = min(self._all, key=lambda worker: len(worker.runs))
        worker.runs.append(run)
        with suppress(OSError):  # it has died, which `wait` sees
            worker.connection.send(run)

    def wait(self, seconds: float) -> list[Outcome]:
        """As `Executor`."""
        by_connection: dict[Any, _Worker] = {worker.connection: worker for worker in self._all}
        outcomes: list[Outcome] = []
        for connection in wait(list(by_connection), seconds):
            worker = by_connection[connection]
            try:
                message: str = worker.connection.recv()
            except (EOFError, OSError):
                outcomes += self._buried(worker)
                continue
            if message == READY:
                worker.ready = True
            else:
                outcomes.append(Outcome(worker.runs.popleft(), "made", message))
        return outcomes

    def _buried(self, worker: _Worker) -> list[Outcome]:
        """What a worker that died leaves behind: the first of its runs killed it."""
        worker.process.join(1)
        code = worker.process.exitcode
        worker.end()
        if not worker.ready:
            self._all.remove(worker)
            raise RuntimeError(f"a worker process ended before its first run ({_cause(code)})")
        self._all[self._all.index(worker)] = _Worker(self._context, self._make)
        first, *others = worker.runs or [None]
        crashed = [Outcome(first, "crashed", detail=_cause(code))] if first is not None else []
        return crashed + [Outcome(run, "lost") for run in others if run is not None]

    def close(self) -> None:
        """As `Executor`."""
        for worker in self._all:
            worker.end()
        self._all = []


def _cause(code: int | None) -> str:
    if code is None:
        return "no exit code"
    try:
        return f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
    except ValueError:
        return f"signal {-code}"
