"""Walks in one engine, and the same walk in several: of a gait, a controller or a policy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from crossgait import _core
from crossgait.arguments import checking_arguments
from crossgait.errors import ConfigError
from crossgait.inputs import EngineLike, EnginesLike, EnvironmentLike, RobotLike, TerrainLike, as_engine
from crossgait.progress import Progress
from crossgait.studies.choices import PolicyWalk, ProgressShown, Subject, all_engines, default_engine, subject_of
from crossgait.studies.results import CompareResult, WalkResult
from crossgait.traces import Trace


@checking_arguments
def walk(
    subject: Subject = "trot",
    *,
    engine: EngineLike | None = None,
    environment: EnvironmentLike | None = None,
    trace: bool = False,
    progress: Progress | bool | None = None,
    command: Sequence[float] | Mapping[str, float] | None = None,
    speed: float | None = None,
    parameters: Mapping[str, float | str] | None = None,
    robot: RobotLike | None = None,
    terrain: TerrainLike | None = None,
    seed: int | None = None,
    friction: float | None = None,
    contact: str | Mapping[str, Any] | None = None,
    seconds: float | None = None,
    physics_dt: float | None = None,
    control_dt: float | None = None,
    settle: float | None = None,
    compensation: bool | None = None,
    heading_hold: bool | None = None,
    terminations: Sequence[str] | None = None,
) -> WalkResult:
    """Walk in one engine: with a policy its first episode.

    Args:
        subject: a gait's name, a `Walk`, or a `Controller` of your own; or a policy: a name, a file, a `Policy` or a
            `FunctionPolicy`.
        engine: see `crossgait.engines()`; by default the first, or that of a policy's environment.
        environment: of a policy; its own by default.
        trace: also keep every control step, or every step of the policy.
        progress: a function, False, True or None (a bar where somebody is looking).
        command: forward m/s, left m/s, yaw rate rad/s.
        speed: straight ahead, m/s, in the place of a command.
        parameters: of the gait, by name, in the place of its own.
        robot: a name, a file or a `Robot`.
        terrain: a name, a file or a `Terrain`.
        seed: of a random terrain, and of a policy's episode.
        friction: between robot and ground.
        contact: other settings, as `--contact` takes them.
        seconds: how long at most, s.
        physics_dt: s.
        control_dt: s.
        settle: standing before the first step, s.
        compensation: make up for the servos' lag and give; not beside a policy.
        heading_hold: steer to the heading that the command leads to.
        terminations: outcomes that end it.

    Raises:
        ConfigError: for what cannot be read or made.

    """
    what = subject_of(subject, environment, locals(), "walk")
    with ProgressShown(progress) as told:
        if isinstance(what, PolicyWalk):
            config = what.environment
            name = config.engine if engine is None else as_engine(engine, "walk")
            (document, text), recorded = _core._walk_policy(config, what.policy, name, config.terrain_seed, trace, told)
        else:
            name = default_engine() if engine is None else as_engine(engine, "walk")
            (document, text), recorded = _core._walk(what, name, trace, told)
    return WalkResult(document, text, traces_of(recorded, [name]).get(name))


@checking_arguments
def compare(
    subject: Subject = "trot",
    *,
    engines: EnginesLike | None = None,
    environment: EnvironmentLike | None = None,
    trace: bool = False,
    position_tolerance: float = 1e-3,
    joint_tolerance: float = 1e-2,
    attitude_tolerance: float = 1e-2,
    progress: Progress | bool | None = None,
    command: Sequence[float] | Mapping[str, float] | None = None,
    speed: float | None = None,
    parameters: Mapping[str, float | str] | None = None,
    robot: RobotLike | None = None,
    terrain: TerrainLike | None = None,
    seed: int | None = None,
    friction: float | None = None,
    contact: str | Mapping[str, Any] | None = None,
    seconds: float | None = None,
    physics_dt: float | None = None,
    control_dt: float | None = None,
    settle: float | None = None,
    compensation: bool | None = None,
    heading_hold: bool | None = None,
    terminations: Sequence[str] | None = None,
) -> CompareResult:
    """Walk the same in several engines, side by side.

    Args:
        subject: as `walk`.
        engines: two or more; all that are available by default.
        environment: as `walk`; so are the arguments from `command` on.
        trace: also keep every control step of every engine.
        position_tolerance: when two engines of different laws count as apart, m.
        joint_tolerance: the same for joint angles, rad.
        attitude_tolerance: the same for orientation, rad.
        progress: as `walk`.
        command: forward m/s, left m/s, yaw rate rad/s.
        speed: straight ahead, m/s, in the place of a command.
        parameters: of the gait.
        robot: that walks.
        terrain: that it walks on.
        seed: of a random terrain, and of a policy's episode.
        friction: between robot and ground.
        contact: other settings of contact.
        seconds: how long at most, s.
        physics_dt: s.
        control_dt: s.
        settle: standing before the first step, s.
        compensation: make up for the servos' lag and give; not beside a policy.
        heading_hold: steer to the heading that the command leads to.
        terminations: outcomes that end it.

    """
    what = subject_of(subject, environment, locals(), "compare")
    names = all_engines(engines, "compare")
    if len(names) < 2:
        raise ConfigError("compare", "engines", "two or more", ", ".join(names))
    tolerances = (position_tolerance, joint_tolerance, attitude_tolerance)
    with ProgressShown(progress) as told:
        if isinstance(what, PolicyWalk):
            config = what.environment
            (document, text), recorded = _core._compare_policy(
                config, what.policy, names, config.terrain_seed, trace, *tolerances, told
            )
        else:
            (document, text), recorded = _core._compare(what, names, trace, *tolerances, told)
    return CompareResult(document, text, traces_of(recorded, names))


def traces_of(recorded: list[tuple[list[str], Any]] | None, names: Sequence[str]) -> dict[str, Trace]:
    """Return traces by name; none if none were recorded."""
    pairs = zip(names, recorded or [], strict=recorded is not None)
    return {name: Trace(columns, table, name=name) for name, (columns, table) in pairs}
