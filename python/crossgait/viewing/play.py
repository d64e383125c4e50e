"""The command `python -m crossgait.viewing.play`: one episode of a policy, in a window or as a video."""

from __future__ import annotations

import argparse
import math
import os
import sys
from collections.abc import Sequence
from typing import Any

from crossgait import _core
from crossgait.commands import exit_code
from crossgait.errors import ConfigError
from crossgait.files import check_outputs, noting_reads, written_whole
from crossgait.inputs import EngineLike, EnvironmentLike, as_engine, environment_for
from crossgait.policies import Policy
from crossgait.policies.environment import environment_of
from crossgait.viewing import film

FRAME_RATE = 25  #: of videos, at most, 1/s

EPILOG = """\
examples:
  python -m crossgait.viewing.play runs/a/best.safetensors                    # in a window
  python -m crossgait.viewing.play runs/a/best.safetensors --video a.mp4 --engine bullet --seconds 5
"""


def play(
    policy: str | os.PathLike[str] | Policy,
    environment: EnvironmentLike | None = None,
    *,
    video: str | os.PathLike[str] | None = None,
    engine: EngineLike | None = None,
    seed: int = 0,
    seconds: float | None = None,
    size: tuple[int, int] = (640, 480),
) -> dict[str, Any]:
    """Run one episode and show it.

    Args:
        policy: a name, a file or a `Policy`.
        environment: what it runs in; the policy's own by default.
        video: file to write (.mp4 or .gif), whole or not at all; a window if None.
        engine: in the place of the environment's.
        seed: of the episode.
        seconds: ends it earlier, s.
        size: of frames, pixels.

    Returns:
        the episode's summary, with the keys of `crossgait walk --json`.

    Raises:
        ConfigError: for what cannot be read or made.
        RuntimeError: without a display for a window, or a graphics context for a video.

    """
    if video is not None:
        film.check(video)
    from crossgait.viewing.rendering import EnvironmentRenderer

    with noting_reads() as read:
        config = environment_for(environment, policy, source="play")
        core = _core.Environment(config, "" if engine is None else as_engine(engine, "play"))
        actor = policy.made_for(config) if isinstance(policy, Policy) else Policy.load(policy, config)
    check_outputs([("video", video)], read)
    renderer = EnvironmentRenderer(*size)
    try:
        if video is None:
            _episode(core, actor, seed, seconds, lambda: renderer.show(core))
        else:
            every = max(1, round(1 / (FRAME_RATE * config.policy_dt)))
            longest = min(config.episode_seconds, math.inf if seconds is None else seconds)
            frames = math.ceil(longest / (every * config.policy_dt)) + 1
            film.check_size(video, frames, frames * size[0] * size[1])
            with written_whole(video) as beside, film.writer(beside, 1 / (every * config.policy_dt)) as writer:
                count = [0]

                def draw() -> bool:
                    if count[0] % every == 0:
                        writer.append_data(renderer.frame(core))
                    count[0] += 1
                    return True

                _episode(core, actor, seed, seconds, draw)
    finally:
        renderer.close()
    return core.summary()


def _episode(core: _core.Environment, policy: Policy, seed: int, seconds: float | None, seen: Any) -> None:
    observation = core.reset(seed)
    policy.reset(seed)
    ended = not seen()
    while not ended and (seconds is None or core.info["time"] < seconds):
        observation, _, terminated, truncated = core.step(policy.act(observation))
        ended = not seen() or terminated or truncated  # the last state is seen, too


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m crossgait.viewing.play",
        description="One episode of a policy, in a window or as a video (docs/training.md).",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("policy", metavar="POLICY", help="a name, a file or folder, zero, random")
    parser.add_argument("--environment", metavar="FILE", help="or a policy's name (default: the policy's own)")
    parser.add_argument("--video", metavar="FILE", help=".mp4 or .gif; without it a window")
    parser.add_argument("--engine", metavar="NAME")
    parser.add_argument("--terrain", metavar="TERRAIN")
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="of the episode")
    parser.add_argument("--seconds", metavar="S", type=float, help="end earlier")
    parser.add_argument("--size", metavar="WxH", default="640x480")
    return parser


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal() and int(width) and int(height)):
        raise ConfigError("play", "--size", "WIDTHxHEIGHT, pixels", text)
    return int(width), int(height)


def _run(options: argparse.Namespace) -> int:
    environment = environment_of([options.policy], options.environment)
    if options.terrain:
        environment = environment.updated({"terrain": options.terrain}, "--terrain")
    check_outputs([("--video", options.video)], [("POLICY", options.policy), ("--environment", options.environment)])
    summary = play(
        options.policy,
        environment,
        video=options.video,
        engine=options.engine,
        seed=options.seed,
        seconds=options.seconds,
        size=_size(options.size),
    )
    print(f"{summary['outcome']}, {summary['distance_m']:.3f} m in {summary['simulated_seconds']:g} s")
    return 0


def main(arguments: Sequence[str] | None = None) -> int:
    """Do it; returns the exit code."""
    options = _parser().parse_args(arguments)
    return exit_code("crossgait.viewing.play", lambda: _run(options))


if __name__ == "__main__":
    sys.exit(main())
