"""Who imports whom in the package, read from its files: imports in functions, and of types alone, count as well."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "crossgait"
ABOVE_ALL = ("crossgait", "crossgait.__main__")  #: import what they like


def sources(package: Path) -> dict[str, str]:
    """By module, its text; a folder's `__init__.py` is the folder."""
    found = {}
    for file in package.rglob("*.py"):
        parts = file.relative_to(package.parent).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file.read_text()
    return found


def imports(files: dict[str, str]) -> dict[str, set[str]]:
    """By module, those of the same package that it imports: `from a import b` is of a.b if that is one, else of a."""
    found = {}
    for module, text in files.items():
        names = set()
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Import):
                names |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{module}: imports say whole names"
                inside = {f"{node.module}.{alias.name}" for alias in node.names}
                compiled = {name for name in inside if name.endswith("._core")}
                names |= inside & files.keys()
                names |= {str(node.module)} if inside - files.keys() - compiled else set()
        found[module] = (names & files.keys()) - {module}
    return found


def circle(graph: dict[str, set[str]]) -> list[str]:
    """Names of which each leads to the next and the last to the first; none if there is no such circle."""
    done: set[str] = set()

    def visit(name: str, way: list[str]) -> list[str]:
        if name in way:
            return way[way.index(name) :]
        if name not in done:
            for other in sorted(graph.get(name, ())):
                if found := visit(other, [*way, name]):
                    return found
            done.add(name)
        return []

    return next((found for name in sorted(graph) if (found := visit(name, []))), [])


def rooms() -> dict[str, set[str]]:
    """By room, those that it may import: the table of docs/architecture.md."""
    rows = re.findall(
        r"^\| `python/crossgait/(.*?)` \|.*\| (.*) \|$", (ROOT / "docs/architecture.md").read_text(), re.M
    )
    return {room.rstrip("/"): set(re.findall(r"`(.*?)/?`", allowed)) for room, allowed in rows}


def room_of(module: str) -> str:
    """A folder, a file that has a row of its own, or `*.py`, the files that every room stands on."""
    name = module.split(".")[1]
    if (PACKAGE / name).is_dir():
        return name
    return f"{name}.py" if f"{name}.py" in rooms() else "*.py"


@pytest.mark.parametrize(
    ("texts", "found"),
    [
        ({"p.a": "from p import b", "p.b": "def f():\n    from p.a import g"}, ["p.a", "p.b"]),
        (
            {"p.a": "if TYPE_CHECKING:\n    import p.b", "p.b": "import p.c", "p.c": "from p.a import f"},
            ["p.a", "p.b", "p.c"],
        ),
        ({"p": "from p.a import f", "p.a": "from p import _core, b", "p.b": "import numpy"}, []),
        ({"p": "from p.a import f", "p.a": "from p import f"}, ["p", "p.a"]),
    ],
    ids=["in a function", "of types alone", "the compiled module", "through the package"],
)
def test_a_circle_would_be_found(texts: dict[str, str], found: list[str]) -> None:
    assert circle(imports({"p": ""} | texts)) == found


def test_no_module_imports_itself_in_the_end() -> None:
    graph = imports(sources(PACKAGE))
    assert len(graph) > 60  # there are some 70
    assert sum(map(len, graph.values())) > 150
    assert circle(graph) == []


def test_rooms_import_what_their_rows_allow() -> None:
    allowed = rooms()
    assert circle({room: others - {room} for room, others in allowed.items()}) == []
    folders = {folder.name for folder in PACKAGE.iterdir() if (folder / "__init__.py").exists()}
    assert allowed.keys() == folders | {"*.py", "sb3.py", "rsl_rl.py", "rl_games.py"}
    wrong = [
        f"{module} imports {other}"
        for module, others in imports(sources(PACKAGE)).items()
        if module not in ABOVE_ALL
        for other in others
        if other not in ABOVE_ALL and room_of(other) not in {room_of(module), "*.py", *allowed[room_of(module)]}
    ]
    assert wrong == []
