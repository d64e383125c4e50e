"""Tasks on a Ray cluster."""

from __future__ import annotations

import logging
import queue
from concurrent.futures import Future
from typing import Any, Generic

from crossgait.extras import needed_for
from crossgait.sweep.executors import Made, Make, Outcome, Task
from crossgait.sweep.runs import row_of

AHEAD = 2  #: tasks in flight for each CPU: one to make, one to go on with


def _ray() -> Any:
    with needed_for("tasks on a cluster", "ray"):
        import ray
    return ray


class RayCluster(Generic[Task, Made]):
    """An `Executor` of Ray tasks, one CPU each.

    What is made comes back to this process, the only one that writes. Nodes may come and go: what is under way on one
    that is lost is made on another. Files that tasks name have to be found on every node by the same path.
    """

    def __init__(
        self,
        address: str,
        workers: int | None = None,
        make: Make[Made] = row_of,  # type: ignore[assignment]  # of runs
    ) -> None:
        """Connect, if this process is not connected yet; `workers` CPUs at most.

        Args:
            address: HOST:PORT, ray://HOST:PORT, or auto.
            workers: by default all that the cluster has.
            make: makes a task; by default the row of a run.

        Raises:
            ConnectionError: if there is no cluster.

        """
        self._ray = _ray()
        self._connected_here = not self._ray.is_initialized()
        if self._connected_here:
            self._ray.init(address=address, logging_level=logging.ERROR, log_to_driver=False)
        self._limit = workers

        def made(task: Task, *shared: Any) -> Made:
            return make(task, *shared)

        # A crash is counted here; nothing is made again behind our back.
        self._make = self._ray.remote(num_cpus=1, max_retries=0)(made)
        self._shared: tuple[Any, ...] = ()
        self._tasks: dict[Any, Task] = {}
        self._done: queue.SimpleQueue[tuple[Any, Future[Made]]] = queue.SimpleQueue()
        self.workers = self._count()

    def _count(self) -> int:
        cpus = int(self._ray.cluster_resources().get("CPU", 0))
        return cpus if self._limit is None else min(cpus, self._limit)

    def share(self, value: Any) -> None:
        """As `Executor`."""
        self._shared = (self._ray.put(value),)

    def has_room(self) -> bool:
        """As `Executor`."""
        # With a limit on workers nothing waits: Ray would begin it.
        allowed = AHEAD * self.workers if self._limit is None else self.workers
        return len(self._tasks) < max(allowed, 1)

    def submit(self, task: Task) -> None:
        """As `Executor`."""
        ref = self._make.remote(task, *self._shared)
        self._tasks[ref] = task
        # Asking Ray which of thousands are done would take longer, the more there are.
        ref.future().add_done_callback(lambda future: self._done.put((ref, future)))

    def wait(self, seconds: float) -> list[Outcome[Task, Made]]:
        """As `Executor`."""
        try:
            outcomes = [self._outcome(*self._done.get(timeout=seconds))]
        except queue.Empty:
            self.workers = self._count()
            return []
        while not self._done.empty():
            outcomes.append(self._outcome(*self._done.get()))
        return outcomes

    def _outcome(self, ref: Any, future: Future[Made]) -> Outcome[Task, Made]:
        task = self._tasks.pop(ref)
        errors = self._ray.exceptions
        try:
            return Outcome(task, "made", future.result())
        except (errors.WorkerCrashedError, errors.OutOfMemoryError) as error:
            return Outcome(task, "crashed", detail=type(error).__name__)
        except (errors.NodeDiedError, errors.LocalRayletDiedError, errors.ObjectLostError):
            self.workers = self._count()
            return Outcome(task, "lost")

    def close(self) -> None:
        """As `Executor`."""
        for ref in self._tasks:
            self._ray.cancel(ref, force=True)
        self._tasks = {}
        if self._connected_here:
            self._ray.shutdown()
