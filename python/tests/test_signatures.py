"""What completion, type checkers and `help` know of every public class and function: names, types and defaults."""

from __future__ import annotations

import ast
import importlib
import inspect
import pydoc
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jedi
import pytest

import crossgait
from crossgait import _core
from crossgait.envs.keywords import EnvironmentKeys, VectorKeywords

STUB = ast.parse(Path(_core.__file__).with_name("_core.pyi").read_text())
CLASSES = {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}
FUNCTIONS = [node for node in STUB.body if isinstance(node, ast.FunctionDef)]
#: Modules with what users of the package import beside `crossgait` itself.
MODULES = ("crossgait", "crossgait.envs", "crossgait.sweep", "crossgait.terms", "crossgait.train", "crossgait.sb3")
#: What has one type everywhere: crossgait/inputs.py.
TAKEN = ("environment", "policy", "policies", "engine", "engines", "terrain", "terrains", "robot")


def is_public(name: str) -> bool:
    return not name.startswith("_") or name == "__init__"


def functions_of_the_stub() -> Iterator[tuple[str, ast.FunctionDef]]:
    yield from ((node.name, node) for node in FUNCTIONS if is_public(node.name))
    for owner, node in CLASSES.items():
        for member in node.body:
            is_setter = isinstance(member, ast.FunctionDef) and any(
                ast.unparse(mark).endswith(".setter") for mark in member.decorator_list
            )
            if isinstance(member, ast.FunctionDef) and is_public(member.name) and not is_setter:
                yield f"{owner}.{member.name}", member


def test_what_is_listed_is_there_to_be_used() -> None:
    listed = {name for name in dir(crossgait) if not name.startswith("_")}
    assert listed >= {"walk", "World", "terms", "envs"}
    assert not listed & {
        "arguments",
        "consent",
        "extras",
        "interpreter",
        "signatures",
        "tell_signatures",
        "annotations",
    }
    for name in listed - {"rl_games", "rsl_rl"}:  # of libraries that need not be there
        importlib.import_module(f"crossgait.{name}") if not hasattr(crossgait, name) else None
    with pytest.raises(TypeError, match=r"^walk\(\): too many positional arguments"):
        crossgait.walk("trot", "bullet")  # type: ignore[misc]


def test_every_argument_of_the_core_has_a_name_and_a_type() -> None:
    nameless = []
    for name, function in functions_of_the_stub():
        given = function.args
        arguments = [*given.posonlyargs, *given.args, *given.kwonlyargs]
        said = {argument.arg: ast.unparse(argument.annotation or ast.Constant("")) for argument in arguments}
        said.pop("self", None)
        if given.vararg or given.kwarg:
            nameless.append(f"{name}: *args")
        nameless += [f"{name}: {key}: {kind}" for key, kind in said.items() if re.fullmatch(r"arg\d*", key)]
        nameless += [f"{name}: {key}: {kind}" for key, kind in said.items() if kind in ("''", "object", "typing.Any")]
    assert not nameless


def python_functions() -> Iterator[tuple[str, Any]]:
    for module in map(importlib.import_module, MODULES):
        for name in getattr(module, "__all__", [n for n in vars(module) if not n.startswith("_")]):
            member = getattr(module, name)
            if getattr(member, "_is_protocol", False):
                continue
            if getattr(member, "__module__", "").startswith("crossgait.") and callable(member):
                yield f"{module.__name__}.{name}", member
            for key, method in vars(member).items() if isinstance(member, type) else ():
                method = getattr(method, "__func__", method)  # of class methods
                if inspect.isfunction(method) and not key.startswith("_") and method.__module__.startswith("crossgait"):
                    yield f"{module.__name__}.{name}.{key}", method


def test_every_argument_in_python_has_a_name_and_a_type() -> None:
    allowed = {"call", "env_method", "close_extras"}  # Stable-Baselines3's and Gymnasium's own
    wrong = []
    for name, function in python_functions():
        try:
            signature = inspect.signature(function)
        except ValueError:  # a class that is not constructed
            continue
        for parameter in signature.parameters.values():
            if parameter.name in ("self", "cls") or name.rpartition(".")[2] in allowed:
                continue
            kind = parameter.annotation if isinstance(parameter.annotation, str) else repr(parameter.annotation)
            bare = parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD) and kind in ("Any", "object")
            loose = kind == "Any" and parameter.name in TAKEN
            if bare or loose or parameter.annotation is parameter.empty:
                wrong.append(f"{name}: {parameter}")
    assert not wrong


def test_python_asks_the_core_for_signatures() -> None:
    signature = inspect.signature(crossgait.World)
    assert list(signature.parameters)[:4] == ["robot", "terrain", "engine", "friction"]
    assert signature.parameters["physics_dt"].default == 0.001
    assert signature.parameters["friction"].kind is inspect.Parameter.KEYWORD_ONLY
    assert "World(robot: " in pydoc.plain(pydoc.render_doc(crossgait.World))
    for name, node in CLASSES.items():
        constructors = [m for m in node.body if isinstance(m, ast.FunctionDef) and m.name == "__init__"]
        if constructors:
            given = constructors[-1].args
            said = [argument.arg for argument in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
            assert list(inspect.signature(getattr(_core, name)).parameters) == said[1:], name

    world = crossgait.World("scara_quadruped")
    assert list(inspect.signature(crossgait.World.step).parameters) == ["self", "targets", "substeps"]
    assert inspect.signature(world.step).parameters["substeps"].default == 1
    assert list(inspect.signature(world.step).parameters) == ["targets", "substeps"]
    assert list(inspect.signature(crossgait.Robot.load).parameters) == ["name_or_file"]
    assert not inspect.signature(crossgait.engines).parameters

    class Mine(crossgait.Terrain):
        def __init__(self, height: float) -> None:
            super().__init__(f"rough:amplitude={height}")

    assert list(inspect.signature(Mine).parameters) == ["height"]


def test_keywords_of_environments_are_those_of_their_configuration() -> None:
    said = set(inspect.signature(crossgait.EnvironmentConfig).parameters)
    assert set(EnvironmentKeys.__annotations__) == said - {"engine", "terrain", "of"}
    from crossgait.envs import QuadrupedVectorEnv

    of_vectors = set(inspect.signature(QuadrupedVectorEnv).parameters)
    # Wrappers set the rest themselves.
    assert set(VectorKeywords.__annotations__) >= of_vectors - {"num_envs", "autoreset_mode", "dtype", "keys"}
    stub = next(m for m in CLASSES["EnvironmentConfig"].body if isinstance(m, ast.FunctionDef) and m.name == "updated")
    assert {argument.arg for argument in stub.args.kwonlyargs} == said - {"preset", "action", "of"}


@pytest.mark.parametrize(
    ("call", "keywords"),
    [
        ("World(", {"robot", "terrain", "engine", "friction", "physics_dt", "gravity", "fixed_base"}),
        ("EnvironmentConfig(", {"preset", "policy_dt", "terminations"}),
        ("EnvironmentConfig().updated(", {"changes", "policy_dt"}),
        ("Walk(", {"gait", "seconds", "heading_hold"}),
        ("verdict(", {"subject", "engines", "margins"}),
    ],
)
def test_keywords_are_completed(call: str, keywords: set[str]) -> None:
    (found,) = jedi.Script(f"import crossgait\ncrossgait.{call}").get_signatures()[-1:]
    assert {parameter.name for parameter in found.params} >= keywords
