"""Walks in one engine, and the same walk in several."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from crossgait import _core
from crossgait.progress import Progress
from crossgait.studies.choices import ProgressShown, Subject, all_engines, default_engine, walk_or_behaviour
from crossgait.studies.results import CompareResult, WalkResult
from crossgait.traces import Trace


def walk(
    subject: Subject = "trot",
    *,
    engine: str | None = None,
    trace: bool = False,
    progress: Progress | bool | None = None,
    **options: Any,
) -> WalkResult:
    """Walk in one engine.

    Args:
        subject: a gait's name, a `Walk`, or a `Controller` of your own.
        engine: see `crossgait.engines()`; the first by default.
        trace: also keep every control step.
        progress: a function, False, True or None (a bar where somebody is looking).
        options: of `Walk`, with a gait's name.

    Raises:
        ConfigError: for what cannot be read or made.

    """
    what = walk_or_behaviour(subject, options)
    name = engine or default_engine()
    with ProgressShown(progress) as told:
        (document, text), recorded = _core._walk(what, name, trace, told)
    if recorded is None:
        return WalkResult(document, text)
    names, tables = recorded
    return WalkResult(document, text, Trace(names, tables[0], name=name))


def compare(
    subject: Subject = "trot",
    *,
    engines: Sequence[str] | None = None,
    trace: bool = False,
    position_tolerance: float = 1e-3,
    joint_tolerance: float = 1e-2,
    attitude_tolerance: float = 1e-2,
    progress: Progress | bool | None = None,
    **options: Any,
) -> CompareResult:
    """Walk the same in several engines, side by side.

    Args:
        subject: as `walk`.
        engines: two or more; all that are available by default.
        trace: also keep every control step of every engine.
        position_tolerance: when two engines of different laws count as apart, m.
        joint_tolerance: the same for joint angles, rad.
        attitude_tolerance: the same for orientation, rad.
        progress: as `walk`.
        options: as `walk`.

    """
    what = walk_or_behaviour(subject, options)
    names = all_engines(engines)
    with ProgressShown(progress) as told:
        (document, text), recorded = _core._compare(
            what, names, trace, position_tolerance, joint_tolerance, attitude_tolerance, told
        )
    traces = {}
    if recorded is not None:
        columns, tables = recorded
        traces = {name: Trace(columns, table, name=name) for name, table in zip(names, tables, strict=True)}
    return CompareResult(document, text, traces)
