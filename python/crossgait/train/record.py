"""What a run writes while it goes on: CSV, TensorBoard where it is installed, a line on the terminal."""

from __future__ import annotations

import csv
import io
import sys
import time
from pathlib import Path
from typing import Any

from crossgait.errors import ConfigError
from crossgait.files import append_whole, read_bytes, written_whole

Row = dict[str, Any]
MOST_BYTES = 256 << 20  #: of a table


class Table:
    """A CSV file that grows by whole rows. Columns are those of its first row; later ones may leave some out."""

    def __init__(self, path: Path, key: str, last: int | None) -> None:
        """Open it, and take back rows whose `key` is beyond `last`: a run goes on from a checkpoint before them."""
        self.path = path
        self._columns: list[str] = []
        if last is None:
            path.unlink(missing_ok=True)
        elif path.exists():
            rows = [row for row in read(path) if _number(path, row, key) <= last]
            self._columns = list(rows[0]) if rows else []
            with written_whole(path) as beside:
                beside.write_text("".join([self._text(self._columns), *map(self._line, rows)]) if rows else "")

    def add(self, row: Row) -> None:
        """Append one row. Raises ConfigError where there is no room."""
        text = ""
        if not self._columns:
            self._columns = list(row)
            text = self._text(self._columns)
        append_whole(self.path, (text + self._line(row)).encode())

    def _line(self, row: Row) -> str:
        return self._text([row.get(name) for name in self._columns])

    @staticmethod
    def _text(values: list[Any]) -> str:
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerow(["" if value is None else value for value in values])
        return text.getvalue()


def read(path: Path) -> list[Row]:
    """Rows of a table, numbers as numbers and what is missing as None; a torn last line is none."""
    if not path.exists():
        return []
    try:
        lines = read_bytes(path, MOST_BYTES).decode().splitlines(keepends=True)
    except UnicodeDecodeError as error:
        raise ConfigError(str(path), "file", "a table of this run, in UTF-8", str(error)) from error
    whole = [line for line in lines if line.endswith("\n")]
    rows = []
    for number, row in enumerate(csv.DictReader(whole), 2):
        if None in row or None in row.values():
            raise ConfigError(str(path), f"line {number}", "as many values as the first has names", "another number")
        rows.append({k: _value(v) for k, v in row.items()})
    return rows


def _number(path: Path, row: Row, key: str) -> float:
    value = row.get(key)
    if not isinstance(value, (int, float)):
        raise ConfigError(str(path), key, "a number in each row", "none" if value is None else repr(value))
    return value


def _value(text: str) -> Any:
    if text == "":
        return None
    try:
        return int(text)
    except ValueError:
        try:
            return float(text)
        except ValueError:
            return text


class Board:
    """TensorBoard's files, if it is installed; nothing otherwise."""

    def __init__(self, folder: Path) -> None:
        self._writer: Any = None
        try:
            from torch.utils.tensorboard import SummaryWriter
        except ImportError:
            return
        self._writer = SummaryWriter(str(folder / "tensorboard"))

    def add(self, group: str, steps: int, row: Row) -> None:
        """Every number of a row."""
        if self._writer is not None:
            for name, value in row.items():
                if isinstance(value, (int, float)):
                    self._writer.add_scalar(f"{group}/{name}", value, steps)

    def close(self) -> None:
        """Write what is left."""
        if self._writer is not None:
            self._writer.close()


class Line:
    """How far it is: one line of a terminal, rewritten; one every half minute elsewhere, if asked for."""

    def __init__(self, wanted: bool | None, title: str = "") -> None:
        self._title = f"{title}: " if title else ""
        self._terminal = sys.stderr.isatty()
        self._wanted = self._terminal if wanted is None else wanted
        self._next = 0.0

    def __call__(self, steps: int, total: int, steps_per_second: float, row: Row) -> None:
        """Say it."""
        if not self._wanted or time.monotonic() < self._next:
            return
        self._next = time.monotonic() + (0.5 if self._terminal else 30)
        left = duration((total - steps) / steps_per_second) if steps_per_second > 0 else "?"
        speed = f", {row['speed_mps']:.3f} m/s" if row.get("speed_mps") is not None else ""
        pace = f"{steps}/{total} steps, {steps_per_second:.0f} steps/s, {left} left"
        text = f"{self._title}{pace}, reward {row['reward']:.4g}{speed}"
        sys.stderr.write(f"\r\x1b[K{text}" if self._terminal else f"{text}\n")
        sys.stderr.flush()

    def clear(self) -> None:
        """Leave the line."""
        if self._wanted and self._terminal:
            sys.stderr.write("\r\x1b[K")
            sys.stderr.flush()


def duration(seconds: float) -> str:
    """In words: "40 s", "12 min", "3.1 h"."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
