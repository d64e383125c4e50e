"""Whether a behaviour depends on the engine: a verdict on two engines or more."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from crossgait import _core
from crossgait._core import StartRanges, Walk
from crossgait.arguments import checking_arguments
from crossgait.inputs import EnginesLike, EnvironmentLike, RobotLike, TerrainLike, as_engines
from crossgait.progress import Progress
from crossgait.studies.choices import (
    PolicyWalk,
    ProgressShown,
    Subject,
    default_engine,
    several_engines,
    subject_of,
    worker_count,
)
from crossgait.studies.results import Verdict


def _setup_text(against: str | Mapping[str, str | float | Sequence[float]] | None) -> str | None:
    """Write a setup as `--against` takes it; None for none."""
    if against is None or isinstance(against, str):
        return against

    def number_text(number: float) -> str:
        return repr(float(number)).removesuffix(".0")

    def value_text(value: str | float | Sequence[float]) -> str:
        if isinstance(value, str):
            return value
        return ":".join(number_text(number) for number in ([value] if isinstance(value, (int, float)) else value))

    return ",".join(f"{name}={value_text(value)}" for name, value in against.items())


@checking_arguments
def verdict(
    subject: Subject = "trot",
    *,
    engines: EnginesLike | None = None,
    against: str | Mapping[str, str | float | Sequence[float]] | None = None,
    environment: EnvironmentLike | None = None,
    explain: bool = False,
    starts: int = 12,
    looks: int = 1,
    margins: Mapping[str, str | float] | None = None,
    confidence: float = 0.95,
    start_ranges: StartRanges | None = None,
    seed: int = 0,
    workers: int | None = None,
    runs: str | os.PathLike[str] = "",
    progress: Progress | bool | None = None,
    command: Sequence[float] | Mapping[str, float] | None = None,
    speed: float | None = None,
    parameters: Mapping[str, float | str] | None = None,
    robot: RobotLike | None = None,
    terrain: TerrainLike | None = None,
    friction: float | None = None,
    contact: str | Mapping[str, Any] | None = None,
    seconds: float | None = None,
    physics_dt: float | None = None,
    control_dt: float | None = None,
    settle: float | None = None,
    compensation: bool | None = None,
    heading_hold: bool | None = None,
    terminations: Sequence[str] | None = None,
) -> Verdict:
    """Judge whether a behaviour depends on the engine (docs/verdict.md).

    Args:
        subject: as `walk`.
        engines: two or more, none of which is run twice; the first that there is and the first of other laws by
            default.
        against: another setup of the same world, under which each of `engines` (by default the first alone) is held
            against itself: {"friction": 0.4, "mass": "x1.1", "robot": "other.yaml"}, or text as `--against` takes it.
        environment: as `walk`; so are the arguments from `command` on.
        explain: also say what gaps come from, of pairs that do not agree and whose differences are known.
        starts: from which every engine runs, at least 4; words are given from 6 on.
        looks: how often to look at most, after as many starts each; it ends with the first that settles every pair.
        margins: differences that would not matter, by the statistic's key, in place of its own: {"distance_m": 0.05}
            in its unit, or text as `--margin` takes it ("5%", "0.004/s", "5%,0.02").
        confidence: of all intervals of all pairs together.
        start_ranges: how far starts lie apart.
        seed: of the starts, and of a random terrain.
        workers: threads; as many as the process may use by default. Results do not depend on them.
        runs: a file of runs to take and to add to; "": none.
        progress: as `walk`.
        command: forward m/s, left m/s, yaw rate rad/s.
        speed: straight ahead, m/s, in the place of a command.
        parameters: of the gait.
        robot: that walks.
        terrain: that it walks on.
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
    said = locals()
    stated = {
        key: margin if isinstance(margin, str) else repr(float(margin)) for key, margin in (margins or {}).items()
    }
    how = (starts, looks, confidence, stated, worker_count(workers), explain, os.fspath(runs), _setup_text(against))
    if against is None:
        names = several_engines(engines, "verdict")
    else:
        names = [default_engine()] if engines is None else as_engines(engines, "verdict")
    ranges = start_ranges if start_ranges is not None else StartRanges()
    # The seed is of the starts; of a gait's random terrain, too, and of no Walk, Controller or environment.
    what = subject_of(subject, environment, said | {"seed": None}, "verdict")
    if isinstance(subject, str) and isinstance(what, Walk):
        what = Walk(**what.to_dict() | {"seed": seed})
    with ProgressShown(progress) as told:
        if isinstance(what, PolicyWalk):
            judged = _core._judge_policy(what.environment, what.policy, names, ranges, seed, how, told)
        else:
            judged = _core._judge_walk(what, names, ranges, seed, how, told)
    document, text = judged
    return Verdict(document, text)
