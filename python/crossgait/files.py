"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def written_whole(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Where to write what is to be at `path`: it is moved there at the end, or is gone if something goes wrong.

    Raises OSError.
    """
    target = Path(path)
    # A folder, so that the file is made by whoever writes it, with the permissions of any other file.
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=".crossgait-") as folder:
        beside = Path(folder) / target.name
        yield beside
        os.replace(beside, target)
