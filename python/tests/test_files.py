"""Files that appear whole or not at all."""

from __future__ import annotations

import fcntl
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from crossgait.errors import ConfigError
from crossgait.files import written_whole

KILLED = """
import os, signal, sys
from crossgait.files import written_whole
with written_whole(sys.argv[1]) as beside:
    beside.write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_what_goes_wrong_leaves_the_old_file(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("old")
    with pytest.raises(UnicodeEncodeError), written_whole(file) as beside:
        beside.write_text("new \ud800")  # which cannot be written
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
    assert file.read_text() == "old"


def test_what_a_link_leads_to_is_written(tmp_path: Path) -> None:
    link = tmp_path / "link"
    (tmp_path / "folder").mkdir()
    link.symlink_to(Path("folder") / "file")
    with written_whole(link) as beside:
        beside.write_text("new")
    assert link.is_symlink()
    assert (tmp_path / "folder" / "file").read_text() == "new"


def test_a_device_is_written_to() -> None:
    with written_whole("/dev/null") as beside:
        assert beside == Path("/dev/null")


def test_a_file_that_somebody_is_writing_is_left(tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    with file.open("w") as held:

        def write() -> None:
            with written_whole(file) as beside:
                fcntl.flock(held, fcntl.LOCK_EX)  # while it is being written
                beside.write_text("table")

        with pytest.raises(ConfigError, match="a file that nobody is writing"):
            write()
        with pytest.raises(ConfigError, match=f"process {os.getpid()} is writing"), written_whole(file):
            pass
    assert [path.name for path in tmp_path.iterdir()] == ["rows.jsonl"]
    assert file.read_text() == ""


def test_what_a_killed_writer_left_is_removed(tmp_path: Path) -> None:
    file = tmp_path / "file"
    ended = subprocess.run([sys.executable, "-c", KILLED, str(file)], check=False)
    assert ended.returncode == -signal.SIGKILL
    (left,) = tmp_path.iterdir()
    for name in (".crossgait-mine", ".crossgait-.tmp", "crossgait-abcdefgh.tmp"):
        (tmp_path / name).mkdir()
    before = set(tmp_path.iterdir()) - {left}
    with written_whole(tmp_path / "another") as live:
        live.write_text("whole")
        with written_whole(file) as beside:
            beside.write_text("new")
    assert set(tmp_path.iterdir()) == before | {file, tmp_path / "another"}
    assert (tmp_path / "another").read_text() == "whole"  # who still writes keeps its folder


def test_what_a_killed_core_left_is_removed(tmp_path: Path) -> None:
    left, held = tmp_path / "map.png.crossgait-12-0.tmp", tmp_path / "b.crossgait-13-0.tmp"
    for file in (left, held):
        file.write_text("half")
    with held.open() as lives:
        fcntl.flock(lives, fcntl.LOCK_EX | fcntl.LOCK_NB)
        with written_whole(tmp_path / "file") as beside:
            beside.write_text("new")
    assert {path.name for path in tmp_path.iterdir()} == {"file", held.name}


def test_what_is_written_outlives_a_power_cut(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[int] = []

    def sync(file: int) -> None:
        assert not (tmp_path / "file").exists()  # before it is in its place
        synced.append(os.fstat(file).st_size)

    monkeypatch.setattr(os, "fsync", sync)
    with written_whole(tmp_path / "file") as beside:
        beside.write_text("new")
    assert synced == [3]
