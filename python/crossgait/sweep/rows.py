"""Rows on disk: a file that only grows, of one writer, in the core's format of stored runs (docs/study.md).

Lock, torn last lines and what counts as a row are as in the core's `RunStore`: either goes on where the other ended.
"""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from crossgait._core import EnvironmentConfig
from crossgait.errors import ConfigError
from crossgait.extras import needed_for
from crossgait.files import lock, written_whole

if TYPE_CHECKING:
    import pandas as pd

    from crossgait.sweep.study import Study

SYNC_SECONDS = 2.0  #: what a power cut may cost at most


_BEGIN = b'{"hash":"0123456789abcdef","run":{'  #: of every row, with any digits
_HASH = range(9, 25)  #: places of the digits


def _is_torn(line: bytes, has_rows_before: bool) -> bool:
    """Whether a last line without end is what the writer of a row leaves that is stopped on its way.

    That is the beginning of a row as far as it goes, and no whole value behind which something else stands. Of a file
    that has no row before it, the whole of the hash has to be there: `{"hash":"my` is somebody's.
    """
    if not has_rows_before and len(line) <= _HASH.stop:
        return False
    for i, (found, byte) in enumerate(zip(line, _BEGIN, strict=False)):
        if found not in b"0123456789abcdef" if i in _HASH else found != byte:
            return False
    try:
        json.JSONDecoder().raw_decode(line.decode(errors="replace"))
    except ValueError:
        return True
    return False


def _whole_lines(path: Path) -> Iterator[tuple[bytes, dict[str, Any]]]:
    """Lines with what they say; a last one may lack its end, and is none if it was cut off. Raises ConfigError."""
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            if not line.endswith(b"\n") and _is_torn(line, number > 1):
                return
            try:
                row = json.loads(line)
                if not isinstance(row["hash"], str) or not ("error" in row or isinstance(row["result"], dict)):
                    raise ValueError("no hash with a result or an error")
            except (ValueError, KeyError, TypeError, RecursionError) as error:
                found = f"no {error}" if isinstance(error, KeyError) else str(error)
                raise ConfigError(str(path), f"line {number}", "a stored run", found) from error
            yield line, row


class RowFile:
    """The file of one sweep, while it is being written. `with` it: another writer is refused meanwhile."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Open it, which changes nothing that is there. Raises ConfigError."""
        self.path = Path(path)
        self.failed: dict[str, bool] = {}  #: hashes that are there, and whether the run failed
        self._dirty = False
        self._synced = time.monotonic()
        if self.path.exists() and not self.path.is_file():
            raise ConfigError(str(path), "file", "a regular file", "a folder, pipe or device")
        try:
            self._file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o644)
        except OSError as error:
            raise ConfigError(str(path), "file", "one that can be written", str(error.strerror)) from error
        try:
            lock(self._file, self.path, "file", "one writer at a time")
            whole, self._lacks_end = 0, False
            for line, row in _whole_lines(self.path):
                whole += len(line)
                self._lacks_end = not line.endswith(b"\n")
                self.failed[row["hash"]] = "error" in row
            self._torn = range(whole, os.fstat(self._file).st_size)  #: bytes of a line that was cut off
        except BaseException:
            os.close(self._file)
            raise

    def __enter__(self) -> RowFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.sync()
            if kind is None:
                self._check_place()
        finally:
            os.close(self._file)  # and with it the lock

    def _check_place(self) -> None:
        """Programs that ask for no lock remove or replace a file, and what is appended then is nowhere."""
        opened = os.fstat(self._file)
        try:
            found = "another in its place" if not os.path.samestat(opened, os.stat(self.path)) else ""
        except OSError:
            found = "none"
        if found:
            expected = "the file that was opened, at its path as long as it is written"
            raise ConfigError(str(self.path), "file", expected, f"{found}: what was added since is lost")

    def add(self, row: str) -> None:
        """Append a row, whole or not at all; once it returns, the row outlives this process. Raises ConfigError."""
        said = json.loads(row)
        self._check_place()
        if self._torn:
            self._cut(self._torn.start, self._torn.stop)
            self._torn = range(0)
        data = memoryview((("\n" if self._lacks_end else "") + row + "\n").encode())
        before, written = os.fstat(self._file).st_size, 0
        try:
            while written < len(data):
                written += os.write(self._file, data[written:])
        except OSError as error:
            # Only what is ours: whoever does not ask for the lock may have written behind it.
            if written and os.fstat(self._file).st_size == before + written:
                self._cut(before, before + written)
            raise ConfigError(str(self.path), "file", "room for a row", str(error.strerror)) from error
        self._lacks_end = False
        self.failed[said["hash"]] = "error" in said
        self._dirty = True
        if time.monotonic() - self._synced > SYNC_SECONDS:
            self.sync()

    def _cut(self, size: int, expected: int) -> None:
        """Leave the first `size` bytes of `expected`."""
        if (found := os.fstat(self._file).st_size) != expected:
            expected_size, other = f"{expected} bytes, as it was read", f"{found}: another program writes it"
            raise ConfigError(str(self.path), "file", expected_size, other)
        os.ftruncate(self._file, size)

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

    Raises:
        ConfigError: if the target is the file itself, which may hold other rows too.

    """
    if os.path.exists(target) and os.path.samefile(path, target):
        raise ConfigError(os.fspath(target), "--sorted", "another file than that of the rows", "the same")
    rows = {row["hash"]: line.rstrip(b"\n") + b"\n" for line, row in _whole_lines(Path(path))}
    there = [rows[name] for name in hashes if name in rows]
    with written_whole(target) as beside, beside.open("wb") as file:
        file.writelines(there)
        file.flush()
        os.fsync(file.fileno())
    return len(there)


def _flat(value: Any, name: str, row: dict[str, Any]) -> None:
    if isinstance(value, dict):
        for key, item in value.items():
            _flat(item, f"{name}.{key}" if name else key, row)
    else:
        row[name] = _groupable(value)


def _groupable(value: Any) -> Any:
    """A value that tables group by: a tuple for a list, the number itself for a list of one number."""
    if not isinstance(value, list):
        return json.dumps(value) if isinstance(value, dict) else value
    if len(value) == 1 and isinstance(value[0], (int, float)):
        return value[0]
    return tuple(_groupable(item) for item in value)


_ELSEWHERE = ("engine:", "robot:", "terrain:")  #: keys of a run's environment that stand beside it


def _environment(behaviour: dict[str, Any]) -> dict[str, Any]:
    """What is run, with a policy's environment as keys in the place of its text, where this version reads it."""
    text = behaviour.get("environment")
    if not isinstance(text, str):
        return behaviour
    # Without keys that are empty in it: engine, robot and terrain, which stand beside it.
    said = [line for line in text.splitlines() if not line.startswith(_ELSEWHERE)]
    try:
        keys = EnvironmentConfig.parse("\n".join(said)).to_dict()
    except ConfigError:
        return behaviour
    return behaviour | {"environment": {k: v for k, v in keys.items() if f"{k}:" not in _ELSEWHERE}}


def load(path: str | os.PathLike[str], study: Study | str | os.PathLike[str] | None = None) -> pd.DataFrame:
    """Rows of a sweep as a table, by hash in the order of the file.

    What was run is in columns named as in the specification (`engine`, `start`, `seed`, `behaviour.gait`,
    `behaviour.robot.name`, `behaviour.parameters.step_height`, `behaviour.environment.friction`), statistics by their
    keys (`distance_m`), and `error` says why a run has none. A file that is being written can be read.

    Args:
        path: the file of rows.
        study: that they are of, or its file: then its rows alone, in the order of its grid, and what it says comes
            first, by its own names (`friction`, `policy`, `step_height`), axes before the rest, to group by.

    Raises:
        ConfigError: for what is no file of rows, or a study that cannot be read.
        ImportError: without pandas, or for a study's file without PyYAML.

    """
    with needed_for("tables", "frames"):
        import pandas as pd
    said_of = None if study is None else _settings_of(study)
    rows: dict[str, dict[str, Any]] = {}
    for _, said in _whole_lines(Path(path)):
        if said_of is not None and said["hash"] not in said_of:
            continue
        row: dict[str, Any] = {"hash": said["hash"]} | (said_of or {}).get(said["hash"], {})
        run = said.get("run") or {}
        _flat(run | {"behaviour": _environment(run["behaviour"])} if "behaviour" in run else run, "", row)
        result = dict(said.get("result", {}))
        if "seconds" in result:
            result["simulated_seconds"] = result.pop("seconds")  # as walks call it; `seconds` is what is asked for
        row.update(result)
        row["error"] = said.get("error")
        rows[said["hash"]] = row
    order = rows if said_of is None else [name for name in said_of if name in rows]
    columns = None if rows else ["hash", "error"]
    return pd.DataFrame([rows[name] for name in order], columns=columns).set_index("hash")


def _settings_of(study: Study | str | os.PathLike[str]) -> dict[str, dict[str, Any]]:
    from crossgait.sweep.study import Study  # which needs PyYAML

    loaded = study if isinstance(study, Study) else Study.load(study)
    settings = loaded.settings()
    return {run.hash: settings[run.hash] for run in loaded.runs()}
