"""YAML as the core reads it: keys once, and numbers as in YAML 1.2 (1e-3 is one)."""

from __future__ import annotations

import os
import re
from collections.abc import Hashable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crossgait.errors import ConfigError

if TYPE_CHECKING:
    from yaml.nodes import MappingNode


def _yaml() -> Any:
    try:
        import yaml
    except ImportError as error:
        raise ImportError("YAML is read with PyYAML: pip install crossgait[sweep] or crossgait[train]") from error
    return yaml


def _loader() -> Any:
    yaml = _yaml()

    class Loader(yaml.SafeLoader):  # type: ignore[misc,name-defined]
        def construct_mapping(self, node: MappingNode, deep: bool = False) -> dict[Hashable, Any]:
            seen = set()
            for key, _ in node.value:
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
    source = os.fspath(path)
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(source, "file", "a readable text file", str(error)) from error
    return parse_yaml(text, source)


def parse_yaml(text: str, source: str) -> Any:
    """What `text` says; `source` stands for the file in messages. Raises ConfigError."""
    try:
        return _yaml().load(text, _loader())
    except _yaml().YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f"line {mark.line + 1}" if mark is not None else "file"
        raise ConfigError(source, where, "YAML", getattr(error, "problem", None) or str(error)) from error


def write_yaml(document: Any) -> str:
    """As text, keys in their order."""
    text: str = _yaml().safe_dump(document, sort_keys=False, default_flow_style=None, width=100, allow_unicode=True)
    return text
