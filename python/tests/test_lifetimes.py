"""What an object hands out is right after it is gone. scripts/quality/test-lifetimes runs this under valgrind."""

from __future__ import annotations

import gc
import inspect
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from crossgait import EnvironmentConfig, Robot, Terrain, World, _core, gaits

ROUGH = EnvironmentConfig.parse("terrain: rough\nepisode_seconds: .02\nsettle_seconds: .02")
ACTION = np.zeros(16)


def stepped_world() -> World:
    robot = Robot.load("scara_quadruped")
    world = World(robot, Terrain("rough", seed=2))
    world.step(np.array([robot.home[i] for i in robot.servo_indices]), 100)
    return world


def stepped_environment() -> _core.Environment:
    environment = _core.Environment(ROUGH)
    environment.reset(1)
    environment.step(ACTION)
    return environment


def stepped_batch() -> _core.VectorEnvironment:
    batch = _core.VectorEnvironment(ROUGH, 3, workers=2, auto_reset="same_step")
    batch.reset(1)
    for _ in range(10):  # to the end of the episodes
        batch.step(np.zeros((3, 16)))
    return batch


def moving_gait() -> _core.GaitGenerator:
    gait = _core.GaitGenerator()
    gait.update(0.01)
    return gait


Read = Callable[[Any], object]

# What is made, and what its methods return beside its properties.
OWNERS: dict[str, tuple[Callable[[], Any], dict[str, Read]]] = {
    "robot": (lambda: Robot.load("scara_quadruped"), {"legs": _core.legs, "yaml": lambda r: r.to_yaml()}),
    "terrain": (lambda: Terrain("rough", seed=3), {}),
    "world": (
        stepped_world,
        {"mass_matrix": lambda w: w.mass_matrix(), "save": lambda w: w.save(), "pose": lambda w: w.body_pose(0)},
    ),
    "leg": (
        lambda: _core.legs(Robot.load("scara_quadruped"))["FL"],
        {"inverse": lambda leg: leg.inverse(np.array([[0.0, 0.0, -0.06]] * 4))},
    ),
    "gait": (moving_gait, {"update": lambda g: g.update(0.01)}),
    "environment": (
        stepped_environment,
        {"reset": lambda e: e.reset(2), "step": lambda e: e.step(ACTION), "save": lambda e: e.save()},
    ),
    "batch": (
        stepped_batch,
        {
            "reset": lambda b: b.reset(2),
            "step": lambda b: b.step(np.zeros((3, 16))),
            "environment": lambda b: b.environment(1),
            "arrays": lambda b: b.batch(),
            "info": lambda b: b.info(2),
            "final_info": lambda b: b.final_info(2),
        },
    ),
    "configuration": (lambda: EnvironmentConfig.parse("terrain: rough"), {"yaml": lambda c: c.to_yaml()}),
    "engines": (_core.engines, {}),
    "gaits": (gaits, {"parameters": lambda _: _core.gait_parameters()}),
}


def parts(value: object, path: str, depth: int = 0) -> Iterator[tuple[str, object]]:
    """All that can be reached from a value: (path, part), the value itself first."""
    yield path, value
    if depth == 6:
        return
    if isinstance(value, dict):
        for key, item in value.items():
            yield from parts(item, f"{path}[{key!r}]", depth + 1)
    elif isinstance(value, list | tuple):
        for i, item in enumerate(value[:40]):
            yield from parts(item, f"{path}[{i}]", depth + 1)
    elif type(value).__module__.startswith("crossgait"):
        for name in properties(type(value)):
            yield from parts(getattr(value, name), f"{path}.{name}", depth + 1)


def properties(kind: type) -> list[str]:
    return [
        name
        for name, member in inspect.getmembers(kind)
        if not name.startswith("_") and inspect.isdatadescriptor(member)
    ]


def is_leaf(value: object) -> bool:
    return isinstance(value, np.ndarray | str | float | int | None)


def owned(value: object) -> object:
    """The same, sharing nothing."""
    return value.copy() if isinstance(value, np.ndarray) else str(value)


def overwrite_freed_memory() -> None:
    """So that what was freed does not look as it did."""
    blocks = [np.full(size, 1e300) for size in (1, 3, 4, 12, 20, 69, 400, 5000) for _ in range(50)]
    del blocks


@pytest.mark.parametrize("name", OWNERS)
def test_what_is_handed_out_outlives_its_owner(name: str) -> None:
    make, reads = OWNERS[name]
    owner = make()
    kept = [(path, part) for path, part in parts(owner, name) if part is not owner]
    for what, read in reads.items():
        kept += parts(read(owner), f"{name} {what}")
    expected = {path: owned(part) for path, part in kept if is_leaf(part)}
    assert len(expected) > 3
    del owner, make
    gc.collect()
    overwrite_freed_memory()
    # Each part alone, without what it was a part of; objects are read anew.
    while kept:
        path, part = kept.pop(0)
        gc.collect(0)
        if is_leaf(part):
            assert np.array_equal(owned(part), expected[path]), path
        else:
            assert [p for p, _ in parts(part, path)], path


def test_every_class_that_shows_anything_is_looked_at() -> None:
    seen = set()
    for name, (make, reads) in OWNERS.items():
        owner = make()
        for part in (owner, *(read(owner) for read in reads.values())):
            seen |= {type(value) for _, value in parts(part, name)}
    shows = {
        kind
        for _, kind in inspect.getmembers(_core, inspect.isclass)
        if properties(kind) and not issubclass(kind, Exception)
    }
    # Plain values: every property is a number, a string or a copy made for the asking (test_policies, test_studies).
    plain = {
        "Controller",
        "FunctionPolicy",
        "MlpNetwork",
        "Policy",
        "PolicyBundle",
        "PolicyInterface",
        "StartRanges",
        "Walk",
    }
    assert {kind.__name__ for kind in shows - seen} <= plain
