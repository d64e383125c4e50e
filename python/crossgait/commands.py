"""What the commands `python -m crossgait.NAME` end with."""

from __future__ import annotations

import sys
from collections.abc import Callable

from crossgait.errors import ConfigError

WRONG_INPUT, INTERRUPTED = 2, 130  #: exit codes, as of `crossgait`


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
        print(f"{name}: {error}", file=sys.stderr)
        return WRONG_INPUT
    except KeyboardInterrupt:
        if interrupted:
            print(interrupted, file=sys.stderr)
        return INTERRUPTED
    except (ImportError, OSError, RuntimeError) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 1
