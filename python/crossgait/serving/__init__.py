"""Engines in processes of their own: what a Python file calls to be one.

A file whose last line is `crossgait.serve_engine(MyEngine, library="...", laws={...})` is an engine, chosen by name as
any other: `crossgait walk --engine python:my_engine.py`. docs/engines-in-processes.md has the whole of it.
"""

from crossgait.serving.server import serve_engine
from crossgait.serving.tree import TreeEngine, rotated, turned
from crossgait.serving.world import (
    MOST_CONTACTS,
    Array,
    ContactPoint,
    EngineContact,
    EngineState,
    Equations,
    ServableEngine,
    ServedWorld,
)

__all__ = [
    "MOST_CONTACTS",
    "Array",
    "ContactPoint",
    "EngineContact",
    "EngineState",
    "Equations",
    "ServableEngine",
    "ServedWorld",
    "TreeEngine",
    "rotated",
    "serve_engine",
    "turned",
]
