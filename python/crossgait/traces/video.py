"""Films of walks: `Trace.to_video`, and the part of `crossgait video` that draws. Needs `crossgait[video]`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from crossgait import _core
from crossgait.arguments import checking_arguments
from crossgait.commands import exit_code, say
from crossgait.errors import ConfigError
from crossgait.files import check_outputs, noting_reads, written_whole
from crossgait.progress import Progress, ProgressBar, shown
from crossgait.traces.scene import the_robot
from crossgait.traces.table import Numbers, TraceTable
from crossgait.viewing import film
from crossgait.viewing.mujoco_scene import Frame
from crossgait.viewing.rendering import Renderer

try:
    from PIL import Image, ImageDraw
except ImportError as error:
    raise ImportError("films need Pillow: pip install crossgait[video]") from error

#: Rounded to these multiples, without which players refuse H.264.
_EVEN = 2
_NAME_HEIGHT = 24  # px


@checking_arguments
def write(
    traces: Sequence[TraceTable],
    path: str | os.PathLike[str],
    robot: _core.Robot,
    terrain: _core.Terrain | None = None,
    *,
    fps: float = 30,
    slow: float = 1,
    width: int = 640,
    height: int = 480,
    azimuth: float = 130,
    elevation: float = -20,
    distance: float | None = None,
    look_at: Sequence[float] | None = None,
    shared_camera: bool = False,
    outcomes: Sequence[tuple[str, float]] | None = None,
    progress: Progress | bool | None = None,
) -> None:
    """Write walks as a film, one panel a trace, each with its name, how far it came, and how it ended.

    Args:
        traces: of one robot; those that end sooner stand still at their end.
        path: FILE.mp4 (H.264), FILE.gif or FILE.webp; appears whole or not at all.
        robot: that walked.
        terrain: that it walked on; flat by default.
        fps: frames per second.
        slow: times slower than it happened.
        width: of a panel, pixels, made even.
        height: of a panel, pixels, made even.
        azimuth: direction of the cameras' look, deg: 90 is along the world's y.
        elevation: of the cameras' look, deg.
        distance: of the cameras from what they look at, m; by the robot's size if None.
        look_at: what cameras that stand still look at, m; None for cameras that go along.
        shared_camera: all panels look at the middle of all robots, from where all are seen, so that one that slides
            back does not look like one that walks.
        outcomes: of each trace, in their order, a word for it ("fell") and when its panel begins to say so, s since the
            trace began; None for traces of which nothing is known.
        progress: as `crossgait.walk` takes it.

    Raises:
        ConfigError: for another ending, a trace of another robot, one without rows, times that do not ascend, more
            than `film` takes (docs/limits.md), or outcomes of some alone.
        RuntimeError: where no graphics context can be made.

    """
    film.check(path)
    for name, value in (("fps", fps), ("slow", slow)):
        if not (np.isfinite(value) and value > 0):
            raise ConfigError("film", name, "a number above zero", f"{value:g}")
    for trace in traces:
        if len(trace) == 0:
            raise ConfigError(trace.name or "trace", "rows", "one at least", "none")
        if not (np.diff(trace.time) > 0).all():
            raise ConfigError(trace.name or "trace", "time", "times that ascend", "one that does not")
        the_robot(trace, robot)
    if outcomes is not None and len(outcomes) != len(traces):
        raise ConfigError("film", "outcomes", f"one for each of {len(traces)} traces", str(len(outcomes)))
    size = (width - width % _EVEN, height - height % _EVEN)
    count = _count_frames(traces, fps * slow)
    film.check_size(path, count, count * size[0] * len(traces) * size[1])
    camera: dict[str, Any] = {"azimuth": azimuth, "elevation": elevation, "distance": distance, "look_at": look_at}
    renderers = [Renderer(robot, terrain, width=size[0], height=size[1], **camera) for _ in traces]
    told = shown(progress)
    try:
        with written_whole(path) as beside, film.writer(beside, fps) as sink:
            for frame in _frames(traces, robot, renderers, fps * slow, shared_camera, outcomes, told):
                sink.append_data(frame)
    finally:
        for renderer in renderers:
            renderer.close()
        if isinstance(told, ProgressBar):
            told.close()


def _frames(
    traces: Sequence[TraceTable],
    robot: _core.Robot,
    renderers: Sequence[Renderer],
    per_second: float,
    shared_camera: bool,
    outcomes: Sequence[tuple[str, float]] | None,
    told: Any,
) -> Iterator[Frame]:
    """Panels beside each other, `per_second` for each simulated second."""
    begin, end = _span(traces)
    count = _count_frames(traces, per_second)
    ends = outcomes if outcomes is not None else [("", end)] * len(traces)
    for number in range(count):
        now = begin + number / per_second
        states = [_state(trace, robot, now) for trace in traces]
        look = _shared_look(states) if shared_camera else (None, 0.0)
        last = number == count - 1  # says what is known at the end alone
        panels = [
            _named(
                renderer.frame(state, *look),
                _words(trace, state, word if last or now - trace.time[0] >= at else "") if len(traces) > 1 else "",
            )
            for trace, state, renderer, (word, at) in zip(traces, states, renderers, ends, strict=True)
        ]
        yield np.concatenate(panels, axis=1)
        if told is not None:
            told("drawing", (number + 1) / count)


def _span(traces: Sequence[TraceTable]) -> tuple[float, float]:
    return min(float(trace.time[0]) for trace in traces), max(float(trace.time[-1]) for trace in traces)


def _count_frames(traces: Sequence[TraceTable], per_second: float) -> int:
    begin, end = _span(traces)
    return max(1, round((end - begin) * per_second))


def _shared_look(states: Sequence[_core.State]) -> tuple[Numbers, float]:
    """Middle of all bases, and how much further away all are seen: by what they lie apart."""
    places = np.stack([state.p_WB for state in states])
    low, high = places.min(axis=0), places.max(axis=0)
    return (low + high) / 2, float(np.linalg.norm(high - low))


def _words(trace: TraceTable, state: _core.State, outcome: str) -> str:
    """Name, the way forward along x since the trace began, and the outcome where there is one by now."""
    way = f"{trace.name} {state.p_WB[0] - trace['p_WB.x'][0]:+.2f} m"
    return f"{way}, {outcome}" if outcome else way


def _state(trace: TraceTable, robot: _core.Robot, now: float) -> _core.State:
    """The last row that is not after `now`, or the first."""
    row = max(0, int(np.searchsorted(trace.time, now + 1e-9, side="right")) - 1)
    state = _core.State()
    state.time = now
    state.p_WB = np.array([trace[f"p_WB.{axis}"][row] for axis in "xyz"])
    state.q_WB = np.array([trace[f"q_WB.{axis}"][row] for axis in "wxyz"])
    state.q = np.array([trace[f"q.{joint}"][row] for joint in robot.joints])
    return state


def _named(frame: Frame, name: str) -> Frame:
    if not name:
        return frame
    picture = Image.fromarray(frame)
    draw = ImageDraw.Draw(picture)
    length = draw.textlength(name, font_size=_NAME_HEIGHT * 0.6)
    draw.rectangle((0, 0, length + 12, _NAME_HEIGHT), fill=(255, 255, 255))
    draw.text((6, 4), name, fill=(20, 24, 28), font_size=_NAME_HEIGHT * 0.6)
    return np.asarray(picture)


def _outcome(text: str) -> tuple[str, float]:
    words, _, seconds = text.rpartition("@")
    return words, float(seconds)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m crossgait.traces.video", description=__doc__)
    parser.add_argument("traces", nargs="+", metavar="TRACE.csv")
    parser.add_argument("--out", required=True, metavar="FILE.mp4|gif|webp")
    parser.add_argument("--robot", default="scara_quadruped")
    parser.add_argument("--terrain", default="flat")
    parser.add_argument("--seed", type=int, default=0, help="of a random terrain")
    parser.add_argument("--fps", type=float, default=30)
    parser.add_argument("--slow", type=float, default=1)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--height", type=int, default=480)
    parser.add_argument("--azimuth", type=float, default=130)
    parser.add_argument("--elevation", type=float, default=-20)
    parser.add_argument("--shared-camera", action="store_true")
    parser.add_argument(
        "--outcome", action="append", type=_outcome, metavar="WORDS@SECONDS", help="of each trace in turn"
    )
    return parser


def _run(options: argparse.Namespace) -> int:
    with noting_reads() as read:
        traces = [TraceTable.read_csv(file) for file in options.traces]
        robot = _core.Robot.load(options.robot)
        terrain = _core.Terrain(options.terrain, seed=options.seed)
    check_outputs([("--out", options.out)], read)
    write(
        traces,
        options.out,
        robot,
        terrain,
        fps=options.fps,
        slow=options.slow,
        width=options.width,
        height=options.height,
        azimuth=options.azimuth,
        elevation=options.elevation,
        shared_camera=options.shared_camera,
        outcomes=options.outcome,
        progress=None,
    )
    say(f"{options.out}: {os.path.getsize(options.out) / 1e6:.1f} MB")
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw traces. Returns the exit code: 2 for bad input."""
    options = _parser().parse_args(arguments)
    return exit_code("crossgait", lambda: _run(options))


if __name__ == "__main__":
    sys.exit(main())
