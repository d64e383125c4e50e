"""What the commands `python -m crossgait.NAME` end with."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable

from crossgait.errors import ConfigError

WRONG_INPUT, INTERRUPTED = 2, 130  #: exit codes, as of `crossgait`

_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")


def say(text: str, *, error: bool = False) -> None:
    """Print a line for people: names come from files, so control characters stand as their numbers do in Python."""
    shown = _CONTROL.sub(lambda found: f"\\x{ord(found[0]):02x}", text)
    print(shown, file=sys.stderr if error else sys.stdout)


def exit_code(name: str, work: Callable[[], int], interrupted: str = "") -> int:
    """Do a command's work, and say on standard error what went wrong.

    Args:
        name: of the module, in front of what is said.
        work: returns the exit code.
        interrupted: what is said of an interruption that `work` does not take itself.

    """
    try:
        return work()
    except ConfigError as error:
        say(f"{name}: {error}", error=True)
        return WRONG_INPUT
    except KeyboardInterrupt:
        if interrupted:
            say(interrupted, error=True)
        return INTERRUPTED
    except (ImportError, OSError, RuntimeError) as error:
        say(f"{name}: {error}", error=True)
        return 1
