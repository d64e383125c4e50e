"""The program `crossgait`, as the package carries it."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import NoReturn

from crossgait import _core


def main() -> NoReturn:
    """Become the program, with the arguments of this one."""
    program = Path(_core.__file__).parent / "bin" / "crossgait"
    os.environ.setdefault("CROSSGAIT_PYTHON", sys.executable)  # what draws its films
    os.execv(program, ["crossgait", *sys.argv[1:]])


if __name__ == "__main__":
    main()
