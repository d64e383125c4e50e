"""What files say, value by value, each with its place: "deploy.yaml: line 4"."""

from __future__ import annotations

import ast
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NoReturn

from crossgait.errors import ConfigError
from crossgait.files import read_bytes
from crossgait.sweep import strict_yaml

_MOST_VALUES = 20_000


class Stated:
    """A value of a file: a mapping, a list or a scalar. Remembers whether anybody has looked at it."""

    def __init__(self, raw: Any, source: str, line: int | str, path: str = "") -> None:
        self.raw = raw  #: dict or list of Stated, or a scalar
        self.source, self.line, self.path = source, line, path
        self.read = False

    @property
    def place(self) -> str:
        """Where it stands, in words."""
        return f"{self.source}: {f'line {self.line}' if isinstance(self.line, int) else self.line}"

    def fail(self, expected: str, found: str | None = None) -> NoReturn:
        """Report it as wrong."""
        where = f"line {self.line}, {self.path}" if isinstance(self.line, int) else str(self.line)
        shown = (
            "a mapping" if isinstance(self.raw, dict) else "a list" if isinstance(self.raw, list) else repr(self.raw)
        )
        raise ConfigError(self.source, where, expected, found if found is not None else shown)

    def find(self, *keys: str) -> Stated | None:
        """What stands below these keys; None if there is nothing, or null."""
        value: Stated | None = self
        self.read = True
        for key in keys:
            raw = value.raw if value is not None else None
            value = raw.get(key) if isinstance(raw, dict) else None
            if value is not None:
                value.read = True
        return None if value is None or value.raw is None else value

    def at(self, *keys: str) -> Stated:
        """The same of what has to be there."""
        found = self.find(*keys)
        if found is None:
            raise ConfigError(self.source, ".".join(filter(None, (self.path, *keys))), "a value", "none")
        return found

    def entries(self) -> dict[str, Stated]:
        """Keys and values of a mapping."""
        if not isinstance(self.raw, dict):
            self.fail("a mapping")
        self.read = True
        return self.raw

    def items(self) -> list[Stated]:
        """Elements of a list."""
        if not isinstance(self.raw, list):
            self.fail("a list")
        self.read = True
        return self.raw

    def number(self) -> float:
        """A finite number."""
        self.read = True
        if isinstance(self.raw, bool) or not isinstance(self.raw, (int, float)) or not math.isfinite(self.raw):
            self.fail("a finite number")
        return float(self.raw)

    def integer(self) -> int:
        """A whole number."""
        value = self.number()
        if value != int(value):
            self.fail("a whole number")
        return int(value)

    def text(self) -> str:
        """A text."""
        self.read = True
        if not isinstance(self.raw, str):
            self.fail("a text")
        return self.raw

    def boolean(self) -> bool:
        """True or false."""
        self.read = True
        if not isinstance(self.raw, bool):
            self.fail("true or false")
        return self.raw

    def numbers(self, count: int | None = None) -> list[float]:
        """A list of finite numbers; a single number stands for `count` of them."""
        self.read = True
        if not isinstance(self.raw, list):
            return [self.number()] * (count or 1)
        found = [item.number() for item in self.raw]
        if count is not None and len(found) != count:
            self.fail(f"{count} numbers", f"{len(found)}")
        return found

    def texts(self) -> list[str]:
        """A list of texts."""
        return [item.text() for item in self.items()]

    def skip(self) -> None:
        """Look at all of it: what says nothing that matters here."""
        self.read = True
        for part in self._parts():
            part.skip()

    def _parts(self) -> list[Stated]:
        if isinstance(self.raw, dict):
            return list(self.raw.values())
        return self.raw if isinstance(self.raw, list) else []

    def unread(self) -> Iterator[Stated]:
        """The outermost values that nobody has looked at, but for those that are null."""
        for part in self._parts():
            if part.read:
                yield from part.unread() if isinstance(part.raw, (dict, list)) else ()
            elif part.raw is not None:
                yield part


def of_yaml(file: str) -> Stated:
    """A YAML file; tags of Python's, as Isaac Lab writes them, are read as the lists and texts that they are of."""
    yaml = strict_yaml._yaml()
    text = strict_yaml.read_text(file)
    with strict_yaml.bad_yaml_refused(file):
        strict_yaml.check_budget(text, file)
        root = yaml.compose(text, strict_yaml.yaml_loader())
        if root is None:
            raise ConfigError(file, "file", "a mapping", "an empty file")
        return _of_node(root, Path(file).name, "", root.start_mark.line + 1, yaml)


def _of_node(node: Any, source: str, path: str, line: int, yaml: Any) -> Stated:
    raw: Any
    if isinstance(node, yaml.MappingNode):
        raw = {}
        for key, value in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise ConfigError(source, f"line {key.start_mark.line + 1}", "a key of text", "another")
            if key.value in raw:
                raise ConfigError(
                    source, f"line {key.start_mark.line + 1}, {path}", "every key once", f"{key.value} twice"
                )
            below = f"{path}.{key.value}" if path else key.value
            raw[key.value] = _of_node(value, source, below, key.start_mark.line + 1, yaml)
        return Stated(raw, source, line, path)
    if isinstance(node, yaml.SequenceNode):
        raw = [
            _of_node(item, source, f"{path}[{i}]", item.start_mark.line + 1, yaml) for i, item in enumerate(node.value)
        ]
        return Stated(raw, source, line, path)
    return Stated(_scalar(node, yaml), source, line, path)


def _scalar(node: Any, yaml: Any) -> Any:
    if not node.tag.startswith("tag:yaml.org,2002:") or node.tag.startswith("tag:yaml.org,2002:python"):
        return node.value or node.tag.rsplit(":", 1)[-1]  # a name of Python's, never looked up
    return strict_yaml.yaml_loader()("").construct_object(node)


def of_texts(entries: dict[str, str], source: str) -> Stated:
    """Metadata of a file: texts by key, numbers and lists of them separated by commas."""

    def value(key: str, text: str) -> Stated:
        parts = [part.strip() for part in text.split(",")]
        where = f"metadata {key}"
        if len(parts) == 1:
            return Stated(_number_or_text(parts[0]), source, where, key)
        return Stated([Stated(_number_or_text(part), source, where, key) for part in parts], source, where, key)

    return Stated({key: value(key, text) for key, text in entries.items()}, source, "metadata")


def _number_or_text(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text


def of_classes(files: list[str], name: str | None) -> Stated:
    """A class of Python files, with what it inherits from classes of the same files: read, never executed.

    Args:
        files: one or more
        name: of the class; needed where several have a nested `control` and inherit from one another no further

    """
    modules = {}
    for file in files:
        try:
            modules[file] = ast.parse(read_bytes(file, 1 << 20))
        except SyntaxError as error:
            raise ConfigError(file, f"line {error.lineno}", "Python", str(error.msg)) from error
        except (ValueError, RecursionError, MemoryError) as error:
            raise ConfigError(file, "file", "Python", str(error)) from error
    return _Classes(modules).stated(name)


class _Classes:
    """Classes of files, by name."""

    def __init__(self, modules: dict[str, ast.Module]) -> None:
        self.classes = {
            node.name: (node, Path(file).name)
            for file, module in modules.items()
            for node in module.body
            if isinstance(node, ast.ClassDef)
        }
        self.source = ", ".join(Path(file).name for file in modules)

    def stated(self, name: str | None) -> Stated:
        if name is None:
            bases = {ast.unparse(base) for node, _ in self.classes.values() for base in node.bases}
            last = [n for n, (node, _) in self.classes.items() if n not in bases and "control" in self._members(n)]
            if len(last) != 1:
                found = f"{len(last)} ({', '.join(last)})" if last else "none"
                raise ConfigError(
                    self.source, "class", "one class with a nested class `control`; --class names it", found
                )
            name = last[0]
        if name not in self.classes:
            raise ConfigError(self.source, "class", f"one of {', '.join(self.classes)}", f"'{name}'")
        return self._stated(name, name, 0)

    def _members(self, name: str) -> set[str]:
        return {node.name for node in self.classes[name][0].body if isinstance(node, ast.ClassDef)}

    def _stated(self, name: str, path: str, depth: int) -> Stated:
        node, source = self.classes[name]
        return self._of_class(node, source, path, depth)

    def _of_class(self, node: ast.ClassDef, source: str, path: str, depth: int) -> Stated:
        if depth > 16:
            raise ConfigError(source, f"line {node.lineno}", "at most 16 levels of classes", "more")
        raw: dict[str, Stated] = {}
        for base in node.bases:
            raw.update(self._base(ast.unparse(base), depth + 1))
        for statement in node.body:
            if isinstance(statement, ast.ClassDef):
                raw[statement.name] = self._of_class(statement, source, f"{path}.{statement.name}", depth + 1)
            elif isinstance(statement, (ast.Assign, ast.AnnAssign)) and statement.value is not None:
                targets = statement.targets if isinstance(statement, ast.Assign) else [statement.target]
                for target in targets:
                    if isinstance(target, ast.Name):
                        raw[target.id] = _of_expression(statement.value, source, f"{path}.{target.id}", raw)
        return Stated(raw, source, node.lineno, path)

    def _base(self, name: str, depth: int) -> dict[str, Stated]:
        outer, *inner = name.split(".")
        if outer not in self.classes:
            return {}
        stated: Stated | None = self._stated(outer, outer, depth)
        for part in inner:
            stated = stated.raw.get(part) if stated is not None and isinstance(stated.raw, dict) else None
        return dict(stated.raw) if stated is not None and isinstance(stated.raw, dict) else {}


def _key_text(key: ast.expr | None) -> str:
    if key is None:
        return "**"  # of a mapping that is taken in
    return key.value if isinstance(key, ast.Constant) and isinstance(key.value, str) else ast.unparse(key)


def _of_expression(node: ast.expr, source: str, path: str, known: dict[str, Stated]) -> Stated:
    line = node.lineno
    if isinstance(node, ast.Dict):
        raw: Any = {}
        for key, value in zip(node.keys, node.values, strict=True):
            text = _key_text(key)
            raw[text] = _of_expression(value, source, f"{path}.{text}", known)
        return Stated(raw, source, line, path)
    if isinstance(node, (ast.List, ast.Tuple)):
        return Stated(
            [_of_expression(e, source, f"{path}[{i}]", known) for i, e in enumerate(node.elts)], source, line, path
        )
    return Stated(_computed(node, known), source, line, path)


def _computed(node: ast.expr, known: dict[str, Stated]) -> Any:
    """A constant, or arithmetic of constants; any other expression as its text."""
    if isinstance(node, ast.Constant):
        return node.value
    if isinstance(node, ast.Name) and node.id in known and isinstance(known[node.id].raw, (int, float, str)):
        return known[node.id].raw
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        value = _computed(node.operand, known)
        if isinstance(value, (int, float)):
            return -value if isinstance(node.op, ast.USub) else value
    if isinstance(node, ast.BinOp):
        left, right = _computed(node.left, known), _computed(node.right, known)
        if isinstance(left, (int, float)) and isinstance(right, (int, float)):
            if isinstance(node.op, ast.Add):
                return left + right
            if isinstance(node.op, ast.Sub):
                return left - right
            if isinstance(node.op, ast.Mult):
                return left * right
            if isinstance(node.op, ast.Div) and right != 0:
                return left / right
    return ast.unparse(node)
