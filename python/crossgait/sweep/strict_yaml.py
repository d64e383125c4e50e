"""YAML as the core reads it: within a budget, keys once, and numbers as in YAML 1.2 (1e-3 is one)."""

from __future__ import annotations

import os
import re
from collections.abc import Hashable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from crossgait.errors import ConfigError
from crossgait.files import read_bytes

if TYPE_CHECKING:
    from yaml.nodes import MappingNode

#: What a file may hold at most. Bytes and levels are the core's; values are fewer, for what PyYAML takes for each.
MOST_BYTES, MOST_VALUES, MOST_LEVELS = 1 << 20, 20_000, 32


def _yaml() -> Any:
    try:
        import yaml
    except ImportError as error:
        raise ImportError("YAML is read with PyYAML: pip install crossgait[sweep] or crossgait[train]") from error
    return yaml


def yaml_loader() -> Any:
    """The class that makes values. Keys are texts, and stand once."""
    yaml = _yaml()

    class Loader(yaml.SafeLoader):  # type: ignore[misc,name-defined]
        def construct_mapping(self, node: MappingNode, deep: bool = False) -> dict[Hashable, Any]:
            seen = set()
            for key, _ in node.value:
                if not isinstance(key, yaml.ScalarNode):
                    raise yaml.constructor.ConstructorError(None, None, "a key that is no text", key.start_mark)
                if key.value in seen:
                    raise yaml.constructor.ConstructorError(
                        None, None, f"{key.value} stands there twice", key.start_mark
                    )
                seen.add(key.value)
            mapping: dict[Hashable, Any] = super().construct_mapping(node, deep)
            return mapping

    number = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)[eE][-+]?[0-9]+$")
    Loader.add_implicit_resolver("tag:yaml.org,2002:float", number, list("-+.0123456789"))
    return Loader


def read_yaml(path: str | os.PathLike[str]) -> Any:
    """What a file holds. Raises ConfigError."""
    return parse_yaml(read_text(path), os.fspath(path))


def read_text(path: str | os.PathLike[str]) -> str:
    """The text of a file. Raises ConfigError."""
    try:
        return read_bytes(path, MOST_BYTES).decode()
    except UnicodeDecodeError as error:
        raise ConfigError(os.fspath(path), "file", "a readable text file", str(error)) from error


def parse_yaml(text: str, source: str) -> Any:
    """What `text` says; `source` stands for the file in messages. Raises ConfigError."""
    with bad_yaml_refused(source):
        check_budget(text, source)
        return _yaml().load(text, yaml_loader())


@contextmanager
def bad_yaml_refused(source: str) -> Iterator[None]:
    """Raise ConfigError for what PyYAML refuses within: also values that are none of their kind (2020-13-45)."""
    try:
        yield
    except ConfigError:
        raise
    except (_yaml().YAMLError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        where = f"line {mark.line + 1}" if mark is not None else "file"
        raise ConfigError(source, where, "YAML", getattr(error, "problem", None) or str(error)) from error


def check_budget(text: str, source: str) -> None:
    """Count levels and values before anything is made of them; an alias counts as what it stands for."""
    yaml = _yaml()
    values = 0
    begun: list[tuple[str | None, int]] = []  # name, and count at its beginning, of every node that is not ended
    sizes: dict[str | None, int] = {}
    for event in yaml.parse(text, yaml.SafeLoader):
        line = f"line {event.start_mark.line + 1}"
        if isinstance(event, yaml.AliasEvent):
            # What names itself, or nothing before it, has no size.
            if event.anchor not in sizes:
                raise ConfigError(source, line, "an alias of what stands before it", f"*{event.anchor}")
            values += sizes[event.anchor]
        elif isinstance(event, yaml.CollectionEndEvent):
            name, before = begun.pop()
            sizes[name] = values - before
        elif isinstance(event, yaml.NodeEvent):
            values += 1
            if isinstance(event, yaml.CollectionStartEvent):
                begun.append((event.anchor, values - 1))
            else:
                sizes[event.anchor] = 1
        if len(begun) > MOST_LEVELS:
            raise ConfigError(source, line, f"at most {MOST_LEVELS} levels", "more")
        if values > MOST_VALUES:
            raise ConfigError(source, line, f"at most {MOST_VALUES} values", "more")


def write_yaml(document: Any) -> str:
    """As text, keys in their order."""
    text: str = _yaml().safe_dump(document, sort_keys=False, default_flow_style=None, width=100, allow_unicode=True)
    return text
