"""What is limited or doubtful in what is about to run is said, as the command line says it in notes."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from crossgait._core import Controller, EnvironmentConfig, Walk

_MAKERS = ("crossgait", "gymnasium")


class Note(UserWarning):
    """What is limited or doubtful in a walk or an environment; a filter of `warnings` hides it or makes it an error."""


def tell_notes(subject: Walk | Controller | EnvironmentConfig) -> None:
    """Warn of what is limited or doubtful in it, where the caller's program called Crossgait."""
    notes = subject.walk.notes if isinstance(subject, Controller) else subject.notes
    for note in notes:
        warnings.warn(note, Note, stacklevel=_level_of_caller())


def _level_of_caller() -> int:
    """Return how far up, as `warnings.warn` of the function that calls this counts, the first frame of others is.

    Gymnasium's, which makes environments for the caller, are not others'.
    """
    level, frame = 1, sys._getframe(1)
    while frame.f_back is not None and str(frame.f_globals.get("__name__", "")).partition(".")[0] in _MAKERS:
        level, frame = level + 1, frame.f_back
    return level


@contextmanager
def notes_said(say: Callable[[str], None]) -> Iterator[None]:
    """Have notes told by `say`, each once, where a command runs that has no program to point at."""
    known = set()
    with warnings.catch_warnings():
        show = warnings.showwarning

        def told(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
            if issubclass(category, Note):
                if str(message) not in known:
                    say(str(message))
                known.add(str(message))
            else:
                show(message, category, *where, **more)

        warnings.showwarning = told
        yield
