"""Runs on a Ray cluster."""

from __future__ import annotations

import logging
import queue
from concurrent.futures import Future
from typing import Any

from crossgait.sweep.executors import Make, Outcome
from crossgait.sweep.runs import Run, row_of

AHEAD = 2  #: tasks in flight for each CPU: one to make, one to go on with


def _ray() -> Any:
    try:
        import ray
    except ImportError as error:
        raise ImportError("a sweep on a cluster needs Ray: pip install crossgait[ray]") from error
    return ray


class RayCluster:
    """An `Executor` of Ray tasks, one CPU each.

    The file's writer is the only one; nodes hand rows back. Nodes may come and go: what runs on one that is lost is
    made on another. Files that the study names have to be found on every node by the same path.
    """

    def __init__(self, address: str, workers: int | None = None, make: Make = row_of) -> None:
        """Connect, if this process is not connected yet; `workers` CPUs at most.

        Args:
            address: HOST:PORT, ray://HOST:PORT, or auto.
            workers: by default all that the cluster has.
            make: gives the row of a run.

        Raises:
            ConnectionError: if there is no cluster.

        """
        self._ray = _ray()
        self._connected_here = not self._ray.is_initialized()
        if self._connected_here:
            self._ray.init(address=address, logging_level=logging.ERROR, log_to_driver=False)
        self._limit = workers

        def task(run: Run) -> str:
            return make(run)

        # A crash is counted here; nothing is made again behind the sweep's back.
        self._task = self._ray.remote(num_cpus=1, max_retries=0)(task)
        self._runs: dict[Any, Run] = {}
        self._done: queue.SimpleQueue[tuple[Any, Future[str]]] = queue.SimpleQueue()
        self.workers = self._count()

    def _count(self) -> int:
        cpus = int(self._ray.cluster_resources().get("CPU", 0))
        return cpus if self._limit is None else min(cpus, self._limit)

    def has_room(self) -> bool:
        """As `Executor`."""
        # With a limit on workers nothing waits: Ray would begin it.
        allowed = AHEAD * self.workers if self._limit is None else self.workers
        return len(self._runs) < max(allowed, 1)

    def submit(self, run: Run) -> None:
        """As `Executor`."""
        ref = self._task.remote(run)
        self._runs[ref] = run
        # Asking Ray which of thousands are done would take longer, the more there are.
        ref.future().add_done_callback(lambda future: self._done.put((ref, future)))

    def wait(self, seconds: float) -> list[Outcome]:
        """As `Executor`."""
        try:
            outcomes = [self._outcome(*self._done.get(timeout=seconds))]
        except queue.Empty:
            self.workers = self._count()
            return []
        while not self._done.empty():
            outcomes.append(self._outcome(*self._done.get()))
        return outcomes

    def _outcome(self, ref: Any, future: Future[str]) -> Outcome:
        run = self._runs.pop(ref)
        errors = self._ray.exceptions
        try:
            return Outcome(run, "made", future.result())
        except (errors.WorkerCrashedError, errors.OutOfMemoryError) as error:
            return Outcome(run, "crashed", detail=type(error).__name__)
        except (errors.NodeDiedError, errors.LocalRayletDiedError, errors.ObjectLostError):
            self.workers = self._count()
            return Outcome(run, "lost")

    def close(self) -> None:
        """As `Executor`."""
        for ref in self._runs:
            self._ray.cancel(ref, force=True)
        self._runs = {}
        if self._connected_here:
            self._ray.shutdown()
