"""The numbers of a walk over time: columns by name, from and to CSV."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from crossgait import _core
from crossgait.errors import ConfigError
from crossgait.extras import needed_for
from crossgait.files import Named, check_outputs, written_whole

if TYPE_CHECKING:
    import pandas as pd
    from typing_extensions import Self

Numbers = npt.NDArray[np.float64]


class TraceTable:
    """A table of numbers, a row per control step; columns as `crossgait walk --trace` has them, SI units.

    `Trace` adds the files of viewers, whose writers take this.
    """

    def __init__(self, names: list[str], values: Numbers, *, name: str = "") -> None:
        self.names = names
        self.values = values
        self.name = name  #: of the engine
        self.inputs: tuple[Named, ...] = ()  #: files that it was made of, which it is not written over
        self._index = {column: i for i, column in enumerate(names)}

    def __len__(self) -> int:
        return len(self.values)

    def __iter__(self) -> Iterator[str]:
        """Go through the names of the columns."""
        return iter(self.names)

    def keys(self) -> Sequence[str]:
        """Names of the columns, as a mapping has them."""
        return self.names

    def __contains__(self, column: object) -> bool:
        return column in self._index

    def __getitem__(self, column: str) -> Numbers:
        """A column, without a copy."""
        try:
            column_values: Numbers = self.values[:, self._index[column]]
        except KeyError:
            found = column if isinstance(column, str) else repr(column)
            parts = self.group(column) if isinstance(column, str) else {}
            groups = dict.fromkeys(name.partition(".")[0] for name in self.names)
            known = f"one of trace.names ({len(self.names)}, of the groups {', '.join(groups)})"
            if parts:
                parted = ", ".join(f"{column}.{part}" for part in parts)
                known = f"one of its parts, {parted}, or trace.group({column!r})"
            raise ConfigError("trace", "column", known, found) from None
        return column_values

    @property
    def time(self) -> Numbers:
        """Simulated seconds, the settling before the motion among them.

        What results say (`outcome_at_s`, `parted_at_s`) is since the motion began, a control step before the first row.
        """
        return self["time"]

    def group(self, prefix: str) -> dict[str, Numbers]:
        """The columns `prefix.NAME` by NAME, such as `q`, `load` or `param`."""
        return {name.removeprefix(f"{prefix}."): self[name] for name in self.names if name.startswith(f"{prefix}.")}

    def to_frame(self, *, grouped: bool = False) -> pd.DataFrame:
        """A pandas DataFrame, its index the time.

        With `grouped` its columns have two levels, as `group` has them: `frame["torque"]["FL_knee"]`, `frame["p_WB"]`.
        """
        with needed_for("tables", "frames"):
            import pandas as pd

        columns: Any = self.names[1:]
        if grouped:
            parts = (name.partition(".") for name in self.names[1:])
            columns = pd.MultiIndex.from_tuples([(what, of) for what, _, of in parts], names=["quantity", "of"])
        return pd.DataFrame(self.values[:, 1:], columns=columns, index=pd.Index(self.time, name="time"))

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write what `crossgait report` reads. The file appears whole or not at all."""
        check_outputs([("path", path)], self.inputs)
        with written_whole(path) as beside, open(beside, "w") as file:
            file.write(",".join(self.names) + "\n")
            for row in self.values:
                file.write(",".join(f"{value:.17g}" for value in row) + "\n")

    @classmethod
    def read_csv(cls, path: str | os.PathLike[str]) -> Self:
        """Read what `crossgait walk --trace` wrote, at most 64 MiB (docs/hostile-input.md). Raises ConfigError."""
        names, values = _core._read_trace(os.fspath(path))
        trace = cls(names, values, name=Path(path).stem)
        trace.inputs = (("the trace", path),)
        return trace

    def __repr__(self) -> str:
        seconds = self.time[-1] - self.time[0] if len(self) else 0.0
        size = f"{len(self)} rows, {len(self.names)} columns, {seconds:g} s"
        return f"<crossgait.{type(self).__name__} {self.name!r}: {size}>"
