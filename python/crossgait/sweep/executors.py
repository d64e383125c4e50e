"""Where runs are made: what the pool of processes and Ray have in common."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

from crossgait.sweep.runs import Run

Make = Callable[[Run], str]  #: gives the row of a run; `row_of`


@dataclass(frozen=True)
class Outcome:
    """What became of one run that was handed out."""

    run: Run
    #: `made`: there is a row; `crashed`: its process died of it; `lost`: its process died of something else
    kind: Literal["made", "crashed", "lost"]
    row: str = ""
    detail: str = ""  #: of a crash


class Executor(Protocol):
    """Makes runs elsewhere. Used by one thread."""

    workers: int  #: that make runs at this moment

    def has_room(self) -> bool:
        """Whether to hand out another run: a few wait, so that no worker does."""

    def submit(self, run: Run) -> None:
        """Hand out a run."""

    def wait(self, seconds: float) -> list[Outcome]:
        """What has come back, as soon as something has, or after this time."""

    def close(self) -> None:
        """Drop what is not done, at once."""
