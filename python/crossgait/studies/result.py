"""What every result of a study is: a document with its text, a table, a picture."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from crossgait import _core
from crossgait.errors import ConfigError
from crossgait.extras import needed_for
from crossgait.files import Named, check_outputs, written_whole
from crossgait.traces import Trace

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure
    from typing_extensions import Self

Json = dict[str, Any]
Kind = TypeVar("Kind", bound="Result")


@dataclass(frozen=True, repr=False, eq=False)
class Result:
    """One study's result. `str(result)` is the table that the command prints."""

    document: Json  #: what `--json` writes
    text: str

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read what `save`, or the command's `--json`, wrote; `Result.load` reads that of any study.

        The file has the numbers, not the table that the command prints, nor traces: `str(result)` is its headline.
        Raises ConfigError for a file that is no result, or one of another study.
        """
        file = os.fspath(path)
        document: Json = json.loads(_core._read_result_text(file))
        said = document.get("schema")
        schema = said if isinstance(said, dict) else {}
        name = schema.get("name")
        kinds = _kinds(cls)
        if not isinstance(name, str) or name not in kinds:
            raise ConfigError(file, "schema.name", f"a result of {' or '.join(sorted(kinds))}", repr(name))
        if (version := schema.get("version")) != _core.SCHEMA_VERSION:
            raise ConfigError(file, "schema.version", repr(_core.SCHEMA_VERSION), repr(version))
        kind: type[Self] = kinds[name]
        result = kind(document, "")
        try:
            result._rows()
            _files_of(document)
            object.__setattr__(result, "text", _text(result.summary))
        except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
            expected = f"what a result of {name} has (docs/schemas/{name}.json)"
            raise ConfigError(file, "document", expected, f"{type(error).__name__}: {error}") from error
        result.note_inputs([("what was read", file)])
        return result

    def __eq__(self, other: object) -> bool:
        """Whether it is the same study with the same numbers, whenever and on however fast a machine each was made."""
        if not isinstance(other, Result):
            return NotImplemented
        return type(self) is type(other) and _without_times(self.document) == _without_times(other.document)

    def __hash__(self) -> int:
        return hash(_hashable(_without_times(self.document)))

    @property
    def summary(self) -> str:
        """What came out, in a sentence."""
        summary: str = self.document["summary"] if "summary" in self.document else self._headline()
        return summary

    def to_dict(self) -> Json:
        """Return a copy of the document, keys as in docs/schemas."""
        copy: Json = json.loads(json.dumps(self.document))
        return copy

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the document as JSON, whole or not at all. Raises ConfigError for a file that it is a result of."""
        files = _files_of(self.document)
        check_outputs([("path", path)], [*(("what was read", file) for file in files), *self._inputs])
        with written_whole(path) as beside, open(beside, "w") as file:
            json.dump(self.document, file, indent=2)
            file.write("\n")

    def note_inputs(self, files: Sequence[Named]) -> None:
        """Remember which files it was made of: it, and traces of it, are not written over them."""
        object.__setattr__(self, "_inputs", tuple(files))
        recorded = getattr(self, "recorded", None)
        for trace in recorded.values() if isinstance(recorded, dict) else [recorded]:
            if trace is not None:
                trace.inputs = tuple(files)

    _inputs: ClassVar[tuple[Named, ...]] = ()

    def to_frame(self) -> pd.DataFrame:
        """Return the result's main table: columns are keys of the document, indices what tells its rows apart."""
        with needed_for("tables", "frames"):
            import pandas as pd

        index = list(self._index)
        rows = [{**dict.fromkeys(index), **row} for row in self._rows()]
        frame = pd.DataFrame(rows, columns=None if rows else index).set_index(index)
        # Results say the terms that came to something; where one has a column, others came to nothing.
        for column in frame.columns:
            if str(column).startswith("reward_terms."):
                frame[column] = frame[column].fillna(0.0)
        return frame

    def plot(self) -> Figure:
        """Draw it with matplotlib."""
        raise NotImplementedError

    _study: ClassVar[str] = ""  #: the command's name, and its document's schema
    _index: ClassVar[tuple[str, ...]] = ("name",)

    def _rows(self) -> list[Json]:
        raise NotImplementedError

    def _headline(self) -> str:
        raise NotImplementedError

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<crossgait.{type(self).__name__}: {self._headline()}>"

    def _repr_html_(self) -> str:
        # The text begins with the answer, as the headline does: once is enough.
        answer, _, rest = self.text.partition("\n\n")
        if answer != self.document.get("summary"):
            answer, rest = self._headline(), self.text
        return f"<p><b>{html.escape(answer)}</b></p><pre>{html.escape(rest)}</pre>"


def _kinds(kind: type[Kind]) -> dict[str, type[Kind]]:
    """The class, if it is of one study, by its name; else those below it that are."""
    if kind._study:
        return {kind._study: kind}
    return {name: each for below in kind.__subclasses__() for name, each in _kinds(below).items()}


def _files_of(document: Json) -> dict[str, str]:
    """What it was made of, by their names as shown."""
    provenance: Any = document.get("provenance", {})
    files = provenance.get("files", {})
    if not isinstance(files, dict):
        raise TypeError("provenance.files")
    return files


def _text(summary: Any) -> str:
    if not isinstance(summary, str):
        raise TypeError("summary")
    return summary


def _hashable(value: Any) -> Any:
    """Values that are equal are so as tuples and sets, and have one hash: 0.0 and -0.0, 1 and 1.0."""
    if isinstance(value, dict):
        return frozenset((key, _hashable(one)) for key, one in value.items())
    return tuple(map(_hashable, value)) if isinstance(value, list) else value


def _without_times(value: Any) -> Any:
    """A document without what differs from run to run, and what says how it was made, as `crossgait rerun` compares."""
    if isinstance(value, dict):
        return {key: _without_times(one) for key, one in value.items() if key not in ("wall_seconds", "provenance")}
    return [_without_times(one) for one in value] if isinstance(value, list) else value


def flat(summary: Json) -> Json:
    """One level of keys: `duty_factor.FL`."""
    row: Json = {}
    for key, value in summary.items():
        if key in ("schema", "provenance"):
            continue
        if isinstance(value, dict):
            row.update({f"{key}.{name}": item for name, item in value.items()})
        elif isinstance(value, list):
            row.update({f"{key}.{axis}": item for axis, item in zip("xyz", value, strict=False)})
        else:
            row[key] = value
    return row


Recorded = TypeVar("Recorded", Trace, dict[str, Trace])


def asked_for(recorded: Recorded | None, study: str) -> Recorded:
    """Return what was recorded. Raises ConfigError if nothing was."""
    if recorded is None or recorded == {}:
        raise ConfigError(study, "trace", "trace=True when it was made", "none")
    return recorded


class Answer(Result):
    """A result that begins with a sentence, to repeat to a colleague."""

    def _headline(self) -> str:
        answer: str = self.document["summary"]
        return answer
