"""Where tasks are made: what the pool of processes and Ray have in common."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, Literal, Protocol, TypeVar

Task = TypeVar("Task")
Made = TypeVar("Made")

#: Makes a task elsewhere, a run's row of a run; behind the task comes what was shared, if anything was.
Make = Callable[..., Made]


@dataclass(frozen=True)
class Outcome(Generic[Task, Made]):
    """What became of one task that was handed out."""

    task: Task
    #: `made`: it is there; `crashed`: its process died of it; `lost`: its process died of something else
    kind: Literal["made", "crashed", "lost"]
    made: Made | None = None
    detail: str = ""  #: of a crash


class Executor(Protocol[Task, Made]):
    """Makes tasks elsewhere. Used by one thread."""

    workers: int  #: that make tasks at this moment

    def share(self, value: Any) -> None:
        """Hand `value` to `make` with every task that is handed out from now on; it goes to each worker once."""

    def has_room(self) -> bool:
        """Whether to hand out another task: a few wait, so that no worker does."""

    def submit(self, task: Task) -> None:
        """Hand out a task."""

    def wait(self, seconds: float) -> list[Outcome[Task, Made]]:
        """What has come back, as soon as something has, or after this time."""

    def close(self) -> None:
        """Drop what is not done, at once."""
