"""Rows on disk: a file that only grows, of one writer, in the core's format of stored runs (docs/study.md)."""

from __future__ import annotations

import errno
import fcntl
import json
import os
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from crossgait.errors import ConfigError

if TYPE_CHECKING:
    import pandas as pd

SYNC_SECONDS = 2.0  #: what a power cut may cost at most


def _whole_lines(path: Path) -> Iterator[tuple[bytes, dict[str, Any]]]:
    """Lines with what they say; a last line that was cut off is none. Raises ConfigError."""
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            if not line.endswith(b"\n"):
                return
            try:
                row = json.loads(line)
                if not isinstance(row["hash"], str) or not ("error" in row or isinstance(row["result"], dict)):
                    raise ValueError("no hash with a result or an error")
            except (ValueError, KeyError, TypeError) as error:
                found = f"no {error}" if isinstance(error, KeyError) else str(error)
                raise ConfigError(str(path), f"line {number}", "a stored run", found) from error
            yield line, row


class RowFile:
    """The file of one sweep, while it is being written. `with` it: another writer is refused meanwhile."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Open it, and cut off a torn last line. Raises ConfigError."""
        self.path = Path(path)
        self.failed: dict[str, bool] = {}  #: hashes that are there, and whether the run failed
        self._dirty = False
        self._synced = time.monotonic()
        try:
            self._file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise ConfigError(str(path), "file", "one that can be written", str(error.strerror)) from error
        try:
            self._lock()
            self._size = 0
            for line, row in _whole_lines(self.path):
                self._size += len(line)
                self.failed[row["hash"]] = "error" in row
            os.ftruncate(self._file, self._size)
        except BaseException:
            os.close(self._file)
            raise

    def _lock(self) -> None:
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
                raise ConfigError(str(self.path), "file", "a file system with locks", str(error.strerror)) from error
            raise ConfigError(str(self.path), "file", "one sweep at a time", "another that is writing") from error

    def __enter__(self) -> RowFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.sync()
        finally:
            os.close(self._file)  # and with it the lock

    def add(self, row: str) -> None:
        """Append a row, whole or not at all. Raises ConfigError where there is no room."""
        said = json.loads(row)
        data = memoryview((row + "\n").encode())
        try:
            written = 0
            while written < len(data):
                written += os.write(self._file, data[written:])
        except OSError as error:
            os.ftruncate(self._file, self._size)
            raise ConfigError(str(self.path), "file", "room for a row", str(error.strerror)) from error
        self._size += len(data)
        self.failed[said["hash"]] = "error" in said
        self._dirty = True
        if time.monotonic() - self._synced > SYNC_SECONDS:
            self.sync()

    def sync(self) -> None:
        """See that the rows outlive a power cut."""
        if self._dirty:
            os.fsync(self._file)
            self._dirty = False
        self._synced = time.monotonic()


def write_sorted(path: str | os.PathLike[str], hashes: Iterable[str], target: str | os.PathLike[str]) -> int:
    """Write the rows of these runs in this order, whole or not at all.

    The same study gives the same bytes, in whatever order its runs were made.

    Returns:
        how many there were.

    """
    rows = {row["hash"]: line for line, row in _whole_lines(Path(path))}
    there = [rows[name] for name in hashes if name in rows]
    new = Path(f"{os.fspath(target)}.new")
    with new.open("wb") as file:
        file.writelines(there)
        file.flush()
        os.fsync(file.fileno())
    new.replace(target)
    return len(there)


def _flat(value: Any, name: str, row: dict[str, Any]) -> None:
    if isinstance(value, dict):
        for key, item in value.items():
            _flat(item, f"{name}.{key}" if name else key, row)
    else:
        row[name] = value


def load(path: str | os.PathLike[str]) -> pd.DataFrame:
    """Rows of a sweep as a table, by hash in the order of the file.

    What was run is in columns named as in the specification (`engine`, `start`, `seed`, `behaviour.gait`,
    `behaviour.robot.name`, `behaviour.parameters.step_height`), statistics by their names (`mean speed`), and `error`
    says why a run has none. A file that is being written can be read. Raises ConfigError.
    """
    try:
        import pandas as pd
    except ImportError as error:
        raise ImportError("tables need pandas: pip install crossgait[frames]") from error
    rows: dict[str, dict[str, Any]] = {}
    for _, said in _whole_lines(Path(path)):
        row: dict[str, Any] = {"hash": said["hash"]}
        _flat(said.get("run") or {}, "", row)
        row.update(said.get("result", {}))
        row["error"] = said.get("error")
        rows[said["hash"]] = row
    return pd.DataFrame(rows.values(), columns=None if rows else ["hash", "error"]).set_index("hash")
