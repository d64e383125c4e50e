"""Films of walks."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import imageio.v3
import numpy as np
import pytest
from PIL import Image, ImageSequence

import crossgait
from crossgait.traces import video
from crossgait.viewing import film

PROGRAM = str(Path(sys.executable).with_name("crossgait"))
SECONDS = 0.4


@pytest.fixture(scope="module")
def walked() -> list[crossgait.Trace]:
    traces = [crossgait.walk("trot", engine=engine, seconds=SECONDS, trace=True).trace for engine in both()]
    assert all(trace is not None for trace in traces)
    return [trace for trace in traces if trace is not None]


def frames_of(film: Path) -> np.ndarray:
    """Every frame: N x height x width x 3."""
    if film.suffix == ".mp4":
        return np.asarray(imageio.v3.imread(film, plugin="FFMPEG"))
    with Image.open(film) as pictures:
        return np.stack([np.asarray(picture.convert("RGB")) for picture in ImageSequence.Iterator(pictures)])


def both() -> list[str]:
    return crossgait.available_engines()[:2]


# Pipes to ffmpeg, which the library that reads the file leaves to the collector.
@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("kind", film.KINDS)
def test_a_film_has_its_frames_and_something_moves(
    kind: str, walked: list[crossgait.Trace], scara: crossgait.Robot, tmp_path: Path
) -> None:
    film = tmp_path / f"walk{kind}"
    video.write(walked, film, scara, fps=20, slow=2, width=160, height=121)
    frames = frames_of(film)
    assert frames.shape == (round(SECONDS * 2 * 20), 120, 160 * len(walked), 3)
    changed = np.abs(frames[-1].astype(int) - frames[0].astype(int)).max(axis=2) > 30
    for panel in np.split(changed, len(walked), axis=1):
        assert panel.mean() > 0.01  # legs, and squares of the floor
    assert list(tmp_path.iterdir()) == [film]


def test_a_trace_that_ends_sooner_stands_still(
    walked: list[crossgait.Trace], scara: crossgait.Robot, tmp_path: Path
) -> None:
    half = crossgait.Trace(walked[0].names, walked[0].values[: len(walked[0]) // 2], name="half")
    video.write([half, walked[0]], tmp_path / "walk.gif", scara, fps=20, width=160, height=120)
    left, right = np.split(imageio.v3.imread(tmp_path / "walk.gif"), 2, axis=2)
    still, moving = (np.abs(panel[-1].astype(int) - panel[-3].astype(int)).mean() for panel in (left, right))
    assert still == 0 < moving  # all frames have one palette


def test_a_shared_camera_shows_where_robots_are_to_each_other(
    walked: list[crossgait.Trace], scara: crossgait.Robot, tmp_path: Path
) -> None:
    # The same robot twice, once 0.3 m ahead: a shared camera shows one ground, and two robots in different places.
    trace = walked[0]
    ahead = trace.values.copy()
    ahead[:, trace.names.index("p_WB.x")] += 0.3
    pair = [trace, crossgait.Trace(trace.names, ahead, name=trace.name)]
    apart = []
    for shared in (False, True):
        film = tmp_path / "pair.webp"
        video.write(pair, film, scara, fps=5, width=160, height=120, azimuth=90, shared_camera=shared)
        left, right = np.split(frames_of(film).astype(int), 2, axis=2)
        apart.append(np.abs(left - right).mean())
    # Of cameras of their own the squares of the floor differ all over the picture; it was 9.4 and 4.4.
    assert 1 < apart[1] < 0.7 * apart[0]


def test_panels_say_how_walks_ended_from_then_on(
    walked: list[crossgait.Trace], scara: crossgait.Robot, tmp_path: Path
) -> None:
    pair = [walked[0], walked[0]]
    film = tmp_path / "pair.webp"
    video.write(pair, film, scara, fps=10, width=320, height=60, outcomes=[("fell", SECONDS / 2), ("walked", 99)])
    left, right = np.split(frames_of(film).astype(int), 2, axis=2)
    differs = [np.abs(a - b)[:20].max() > 100 for a, b in zip(left, right, strict=True)]  # white and black, or the sky
    half = len(differs) // 2
    assert not any(differs[:half])
    assert all(differs[half:])
    with pytest.raises(crossgait.ConfigError, match="outcomes: expected one for each of 2 traces, found 1"):
        video.write(pair, film, scara, outcomes=[("fell", 0)])


def test_bad_input_leaves_no_film(walked: list[crossgait.Trace], scara: crossgait.Robot, tmp_path: Path) -> None:
    with pytest.raises(crossgait.ConfigError, match=r"\.mp4 or \.gif or \.webp"):
        video.write(walked, tmp_path / "walk.avi", scara)
    with pytest.raises(crossgait.ConfigError, match="robot"):
        walked[0].to_video(tmp_path / "walk.mp4", "serial_quadruped")
    empty = crossgait.Trace(walked[0].names, walked[0].values[:0], name="empty")
    with pytest.raises(crossgait.ConfigError, match="empty: rows"):
        video.write([empty], tmp_path / "walk.mp4", scara)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
def test_the_command_walks_and_draws(tmp_path: Path) -> None:
    small = ["--fps", "10", "--width", "160", "--height", "120"]
    command = [PROGRAM, "video", "walk.mp4", "--seconds", "0.5", "--engines", ",".join(both()), *small]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    assert imageio.v3.improps(tmp_path / "walk.mp4", plugin="FFMPEG").shape[1:] == (120, 160 * len(both()), 3)
    assert [file.name for file in tmp_path.iterdir()] == ["walk.mp4"]


def test_the_command_says_what_is_wrong(tmp_path: Path) -> None:
    (tmp_path / "bad.csv").write_text("time,q.a\n0,1\n")
    for arguments, words in [
        (["walk.avi", "--seconds", "0.1"], ".mp4 or .gif or .webp"),
        (["walk.mp4", "bad.csv"], "expected the robot that walked"),
        (["walk.mp4", "missing.csv"], "missing.csv"),
    ]:
        done = subprocess.run([PROGRAM, "video", *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=300)
        assert done.returncode == 2, done.stderr
        assert words in done.stderr
        assert not (tmp_path / arguments[0]).exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_painter_too(number: signal.Signals, walked: list[crossgait.Trace], tmp_path: Path) -> None:
    """To the program alone, as `kill` sends it."""
    trace = tmp_path / "long.csv"
    values = np.repeat(walked[0].values[:1], 2, axis=0)
    values[:, 0] = [0, 600]
    crossgait.Trace(walked[0].names, values).to_csv(trace)
    command = [PROGRAM, "video", str(tmp_path / "film.mp4"), str(trace), "--width", "64", "--height", "64"]

    def listen() -> None:  # what runs in the background may ignore them
        for each in (signal.SIGINT, signal.SIGTERM):
            signal.signal(each, signal.SIG_DFL)

    program = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, preexec_fn=listen)
    until = time.monotonic() + 60
    while not list(tmp_path.glob(".crossgait-*/film.mp4")) and program.poll() is None and time.monotonic() < until:
        time.sleep(0.05)
    children = Path(f"/proc/{program.pid}/task/{program.pid}/children").read_text().split()
    assert children
    program.send_signal(number)
    _, errors = program.communicate(timeout=60)
    assert program.returncode == 130, errors
    assert not any(Path("/proc", child).exists() for child in children)
    assert list(tmp_path.iterdir()) == [trace]
