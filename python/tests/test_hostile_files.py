"""Files that others may have written: none makes a reader wait for ever, or take memory without end."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

import crossgait
from crossgait._core import EnvironmentConfig
from crossgait.errors import ConfigError
from crossgait.sweep import Study, load, write_sorted
from crossgait.traces import video
from crossgait.train import record
from crossgait.train.plan import Plan


@pytest.fixture(autouse=True)
def not_for_ever() -> Iterator[None]:
    def end(number: int, frame: FrameType | None) -> None:
        raise TimeoutError("a reader waits")

    before = signal.signal(signal.SIGALRM, end)
    signal.alarm(30)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


def from_torch(file: Path) -> None:
    pytest.importorskip("torch")
    crossgait.Policy.from_torch(file, EnvironmentConfig())


def from_sb3(file: Path) -> None:
    pytest.importorskip("stable_baselines3")
    crossgait.Policy.from_sb3(file, EnvironmentConfig())


def from_onnx(file: Path) -> None:
    pytest.importorskip("onnxruntime")
    crossgait.Policy.from_onnx(file, EnvironmentConfig())


def vecnormalize(file: Path) -> None:
    pytest.importorskip("stable_baselines3")
    from crossgait.policies import sb3_reader

    sb3_reader._normalisation(str(file), crossgait.policies.policy.interface_of(EnvironmentConfig()), "model")


def imported(file: Path) -> None:
    pytest.importorskip("torch")
    from crossgait.importing.network import write_network

    write_network(str(file), crossgait.policies.policy.interface_of(EnvironmentConfig()), file.parent)


def checkpoint(file: Path) -> None:
    pytest.importorskip("stable_baselines3")
    from crossgait.train import checkpoint
    from crossgait.train.folder import CHECKPOINT

    (file.parent / CHECKPOINT).symlink_to(file)
    checkpoint.read(file.parent)


READERS: dict[str, Callable[[Path], Any]] = {
    "rows": load,
    "sorted": lambda file: write_sorted(file, [], file.parent / "sorted"),
    "study": Study.load,
    "plan": Plan.load,
    "trace": crossgait.Trace.read_csv,
    "policy": lambda file: crossgait.Policy.load(file, EnvironmentConfig()),
    "environment": lambda file: EnvironmentConfig.load(file),
    "table": record.read,
    "torch": from_torch,
    "sb3": from_sb3,
    "vecnormalize": vecnormalize,
    "onnx": from_onnx,
    "imported": imported,
    "checkpoint": checkpoint,
}


@pytest.mark.parametrize("kind", ["pipe", "device", "folder"])
@pytest.mark.parametrize("reader", READERS)
def test_only_regular_files_are_read(reader: str, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # files below it may run code
    monkeypatch.setattr("crossgait.policies.torch_reader.require_consent", lambda *_: None)
    monkeypatch.setattr("crossgait.policies.sb3_reader.require_consent", lambda *_: None, raising=False)
    file = tmp_path / "file"
    if kind == "pipe":
        os.mkfifo(file)
    elif kind == "device":
        file.symlink_to("/dev/zero")
    else:
        file.mkdir()
    if kind == "folder" and reader == "policy":
        pytest.skip("a folder may be a policy's")
    with pytest.raises(ConfigError):
        READERS[reader](file)


def test_a_row_has_an_end(tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    with file.open("wb") as rows:
        rows.write(b'{"hash":"')
        rows.truncate(1 << 30)
    with pytest.raises(ConfigError, match="line 1: expected at most 1048576 bytes"):
        load(file)


def columns(trace: crossgait.Trace, times: list[float]) -> crossgait.Trace:
    values = np.repeat(trace.values[:1], len(times), axis=0)
    values[:, trace.names.index("time")] = times
    return crossgait.Trace(trace.names, values, name="made")


def test_a_trace_is_as_the_core_reads_it(tmp_path: Path) -> None:
    file = tmp_path / "trace.csv"
    file.write_text("time,a\n0,1\n0.5,2\n")
    trace = crossgait.Trace.read_csv(file)
    assert trace.names == ["time", "a"]
    assert trace.values.tolist() == [[0, 1], [0.5, 2]]
    for text in ("time\n1\n0\n", "time\n1\n1\n", "time\n", "a\n1\n", "time\nnan\n", "time,a\n1\n"):
        file.write_text(text)
        with pytest.raises(ConfigError):
            crossgait.Trace.read_csv(file)
    file.write_text(",".join(["time", *map(str, range(5000))]) + "\n")
    with pytest.raises(ConfigError, match="4096"):
        crossgait.Trace.read_csv(file)
    with file.open("wb") as large:
        large.truncate(65 << 20)
    with pytest.raises(ConfigError, match="64 MiB"):
        crossgait.Trace.read_csv(file)


def test_a_film_has_an_end(scara: crossgait.Robot, tmp_path: Path) -> None:
    trace = crossgait.walk("trot", seconds=0.1, trace=True).trace
    assert trace is not None
    with pytest.raises(ConfigError, match="at most 36000 frames"):
        video.write([columns(trace, [0, 1e6])], tmp_path / "film.mp4", scara)
    with pytest.raises(ConfigError, match="pixels in all frames of a GIF or WebP"):
        video.write([columns(trace, [0, 1000])], tmp_path / "film.gif", scara)
    with pytest.raises(ConfigError, match="times that ascend"):
        video.write([columns(trace, [1, 0.5])], tmp_path / "film.gif", scara)
    assert list(tmp_path.iterdir()) == []
