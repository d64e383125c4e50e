"""What the commands `python -m crossgait.NAME` end with."""

from __future__ import annotations

import re
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from crossgait.errors import ConfigError
from crossgait.notes import Note, notes_said

WRONG_INPUT, INTERRUPTED = 2, 130  #: exit codes, as of `crossgait`

_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")


def say(text: str, *, error: bool = False) -> None:
    """Print a line for people: names come from files, so control characters stand as their numbers do in Python."""
    shown = _CONTROL.sub(lambda found: f"\\x{ord(found[0]):02x}", text)
    print(shown, file=sys.stderr if error else sys.stdout)


@contextmanager
def _ended_by_sigterm() -> Iterator[None]:
    """Let SIGTERM end what is done as Ctrl-C does, so that nothing half-written is left; a second one ends at once."""
    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGTERM) != signal.SIG_DFL:
        yield
        return

    def end(number: int, frame: FrameType | None) -> None:
        signal.signal(number, signal.SIG_DFL)
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def exit_code(name: str, work: Callable[[], int], interrupted: str = "") -> int:
    """Do a command's work, and say on standard error what went wrong.

    Args:
        name: of the module, in front of what is said.
        work: returns the exit code.
        interrupted: what is said of an interruption that `work` does not take itself.

    """
    try:
        with _ended_by_sigterm(), notes_said(lambda note: say(f"{name}: note: {note}", error=True)):
            return work()
    except (ConfigError, Note) as error:  # a note where a filter makes it an error
        say(f"{name}: {error}", error=True)
        return WRONG_INPUT
    except KeyboardInterrupt:
        if interrupted:
            say(interrupted, error=True)
        return INTERRUPTED
    except (ImportError, OSError, RuntimeError) as error:
        say(f"{name}: {error}", error=True)
        return 1
