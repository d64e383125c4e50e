"""Rows on disk: a file that only grows, of one writer, in the core's format of stored runs (docs/study.md).

Lock, torn last lines and what counts as a row are as in the core's `RunStore`: either goes on where the other ended.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from crossgait import _core
from crossgait._core import EnvironmentConfig
from crossgait.errors import ConfigError
from crossgait.extras import needed_for
from crossgait.files import check_outputs, opened, written_whole

if TYPE_CHECKING:
    import pandas as pd

    from crossgait.sweep.study import Study

MOST_BYTES = 16 << 30  #: of a file, as the core has it
MOST_ROW = 1 << 20  #: bytes of a row


def _whole_lines(path: Path) -> Iterator[tuple[bytes, dict[str, Any]]]:
    """Lines with what they say; a last one may lack its end, and is none if it was cut off. Raises ConfigError."""
    with opened(path) as file:
        if (size := os.fstat(file.fileno()).st_size) > MOST_BYTES:
            raise ConfigError(str(path), "file", f"at most {MOST_BYTES} bytes", str(size))
        number = 0
        while line := file.readline(MOST_ROW + 2):
            number += 1
            if len(line) > MOST_ROW + 1:
                raise ConfigError(str(path), f"line {number}", f"at most {MOST_ROW} bytes", "more")
            if not line.endswith(b"\n") and _core._is_torn_row(line, number > 1):
                return
            _core._check_row(line.removesuffix(b"\n"), str(path), number)
            yield line, json.loads(line)


def _is_kept(row: dict[str, Any], kept: Mapping[str, Any]) -> bool:
    """Whether it says what its run came to: a run that was made is there, whatever failed besides."""
    return "error" not in row or row["hash"] not in kept


class RowFile:
    """The file of one sweep, while it is being written. `with` it: another writer is refused meanwhile.

    It is the core's `RunStore`: what is a row, its lock, its index and its torn last line are those of verdicts.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Open it, which changes nothing that is there. Raises ConfigError."""
        self.path = Path(path)
        self._store = _core._RunStore(os.fspath(path))

    def __enter__(self) -> RowFile:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.sync()
            if kind is None:
                self._store.check_place()
        finally:
            self._store.close()  # and with it the lock

    def has_failed(self, run: str) -> bool | None:
        """Whether the run of this hash failed; None if it has no row. What was made once counts as made."""
        return self._store.has_failed(run)

    def add(self, row: str) -> None:
        """Append a row, whole or not at all; once it returns, the row outlives this process. Raises ConfigError."""
        self._store.add(row)

    def sync(self) -> None:
        """See that the rows outlive a power cut."""
        self._store.sync()


def write_sorted(path: str | os.PathLike[str], hashes: Iterable[str], target: str | os.PathLike[str]) -> int:
    """Write the rows of these runs in this order, whole or not at all.

    The same study gives the same bytes, in whatever order its runs were made.

    Returns:
        how many there were.

    Raises:
        ConfigError: if the target is the file itself, which may hold other rows too, or that is no file of rows.

    """
    check_outputs([("--sorted", target)], [("the rows", path), ("the rows", f"{os.fspath(path)}.index")])
    rows: dict[str, bytes] = {}
    for line, row in _whole_lines(Path(path)):
        if _is_kept(row, rows):
            rows[row["hash"]] = line.rstrip(b"\n") + b"\n"
    there = [rows[name] for name in hashes if name in rows]
    with written_whole(target) as beside, beside.open("wb") as file:
        file.writelines(there)
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


def _row(said: dict[str, Any], settings: dict[str, Any]) -> dict[str, Any]:
    """What a line says, a column each."""
    row: dict[str, Any] = settings.copy()
    run = said.get("run") or {}
    _flat(run | {"behaviour": _environment(run["behaviour"])} if "behaviour" in run else run, "", row)
    result = dict(said.get("result", {}))
    if "seconds" in result:
        result["simulated_seconds"] = result.pop("seconds")  # as walks call it; `seconds` is what is asked for
        if result["simulated_seconds"] > 0 and result.get("distance_m") is not None:
            speed = result["distance_m"] / result["simulated_seconds"]
            result["mean_speed_mps"] = speed if math.isfinite(speed) else None
    return row | result | {"hash": said["hash"], "error": said.get("error")}


def load(path: str | os.PathLike[str], study: Study | str | os.PathLike[str] | None = None) -> pd.DataFrame:
    """Rows of a sweep as a table, by hash in the order of the file.

    What was run is in columns named as in the specification (`engine`, `start`, `seed`, `behaviour.gait`,
    `behaviour.robot.name`, `behaviour.parameters.step_height`, `behaviour.environment.friction`), statistics by their
    keys (`distance_m`, and `mean_speed_mps` of it and the time), and `error` says why a run has none. A file that is
    being written can be read.

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
        if (said_of is not None and said["hash"] not in said_of) or not _is_kept(said, rows):
            continue
        try:
            rows[said["hash"]] = _row(said, (said_of or {}).get(said["hash"], {}))
        except (AttributeError, TypeError) as error:  # of another's run, whose hash is right
            raise ConfigError(str(path), f"hash {said['hash']}", "what a run holds", str(error)) from error
    order = rows if said_of is None else [name for name in said_of if name in rows]
    columns = None if rows else ["hash", "error"]
    return pd.DataFrame([rows[name] for name in order], columns=columns).set_index("hash")


def _settings_of(study: Study | str | os.PathLike[str]) -> dict[str, dict[str, Any]]:
    from crossgait.sweep.study import Study  # which needs PyYAML

    loaded = study if isinstance(study, Study) else Study.load(study)
    settings = loaded.settings()
    return {run.hash: settings[run.hash] for run in loaded.runs()}
