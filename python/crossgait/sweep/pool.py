"""Tasks in processes of this machine."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import queue
import signal
import threading
from collections import deque
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from typing import Any, Generic

from crossgait import _core
from crossgait.errors import ConfigError
from crossgait.sweep.executors import Made, Make, Outcome, Task
from crossgait.sweep.runs import row_of

AHEAD = 2  #: tasks that a worker has at a time: one to make, one to go on with
READY = "ready"  #: what a worker says first
SHARED, TASK = "shared", "task"  #: kinds of what it is sent


def usable_cores() -> int:
    """How many cores this process may use."""
    return len(os.sched_getaffinity(0))


def _serve(connection: Connection, make: Make[Any]) -> None:
    """A worker's life. It ends when the other end of the connection does, also in the middle of a task."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the terminal's Ctrl-C is for the process that hands out
    todo: queue.SimpleQueue[tuple[Any, ...]] = queue.SimpleQueue()

    def listen() -> None:
        shared: tuple[Any, ...] = ()
        try:
            while True:
                kind, value = connection.recv()
                if kind == SHARED:
                    shared = (value,)
                else:
                    todo.put((value, *shared))
        except (EOFError, OSError):
            os._exit(0)

    threading.Thread(target=listen, daemon=True).start()
    try:
        connection.send(READY)
        while True:
            connection.send(make(*todo.get()))
    except OSError:
        os._exit(0)


class _Worker(Generic[Task]):
    def __init__(self, context: multiprocessing.context.SpawnContext, make: Make[Any]) -> None:
        self.connection, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs, make), daemon=True, name="crossgait-worker")
        self.process.start()
        theirs.close()
        self.tasks: deque[Task] = deque()
        self.ready = False
        self.shared: object = None  #: what it was sent last

    def end(self) -> int | None:
        """End the process; returns its exit code, negative for the signal that it died of."""
        self.connection.close()
        self.process.kill()
        self.process.join()
        code = self.process.exitcode
        self.process.close()
        return code


class ProcessPool(Generic[Task, Made]):
    """An `Executor` of processes; one that dies is replaced."""

    def __init__(self, workers: int, make: Make[Made] = row_of) -> None:  # type: ignore[assignment]  # of runs
        """Start them. `make`, a function of a module, makes a task; by default the row of a run."""
        if not 1 <= workers <= _core.MOST_WORKERS:
            raise ConfigError("processes", "workers", f"1 to {_core.MOST_WORKERS}", str(workers))
        self._make = make
        # Spawned, not forked: engines and interpreters have threads.
        self._context = multiprocessing.get_context("spawn")
        self.workers = workers
        self._all: list[_Worker[Task]] = []
        self._shared: Any = None  # as it is sent
        try:
            for _ in range(workers):
                self._all.append(_Worker(self._context, self._make))
        except BaseException:
            self.close()
            raise

    def share(self, value: Any) -> None:
        """As `Executor`. Raises ConfigError for what cannot be sent to a process, such as a function within another."""
        try:
            self._shared = pickle.dumps((SHARED, value))
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise ConfigError("processes", "shared", "values and functions of modules", str(error)) from error

    def has_room(self) -> bool:
        """As `Executor`."""
        return any(len(worker.tasks) < AHEAD for worker in self._all)

    def submit(self, task: Task) -> None:
        """As `Executor`."""
        worker = min(self._all, key=lambda worker: len(worker.tasks))
        worker.tasks.append(task)
        with suppress(OSError):  # it has died, which `wait` sees
            if worker.shared is not self._shared:
                worker.connection.send_bytes(self._shared)
                worker.shared = self._shared
            worker.connection.send((TASK, task))

    def wait(self, seconds: float) -> list[Outcome[Task, Made]]:
        """As `Executor`."""
        by_connection: dict[Any, _Worker[Task]] = {worker.connection: worker for worker in self._all}
        outcomes: list[Outcome[Task, Made]] = []
        for connection in wait(list(by_connection), seconds):
            worker = by_connection[connection]
            try:
                message: Any = worker.connection.recv()
            except (EOFError, OSError):
                outcomes += self._buried(worker)
                continue
            if not worker.ready:  # its first message is READY
                worker.ready = True
            else:
                outcomes.append(Outcome(worker.tasks.popleft(), "made", message))
        return outcomes

    def _buried(self, worker: _Worker[Task]) -> list[Outcome[Task, Made]]:
        """What a worker that died leaves behind: the first of its tasks killed it."""
        worker.process.join(1)
        code = worker.process.exitcode
        worker.end()
        if not worker.ready:
            self._all.remove(worker)
            raise RuntimeError(f"a worker process ended before its first task ({_cause(code)})")
        self._all[self._all.index(worker)] = _Worker(self._context, self._make)
        outcomes: list[Outcome[Task, Made]] = [Outcome(task, "lost") for task in worker.tasks]
        if outcomes:
            outcomes[0] = Outcome(worker.tasks[0], "crashed", detail=_cause(code))
        return outcomes

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
