"""Files that appear whole or not at all."""

from __future__ import annotations

import fcntl
import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from crossgait.errors import ConfigError
from crossgait.files import append_whole, written_whole

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


def test_a_place_without_room_is_named(tmp_path: Path) -> None:
    """Full at a number of bytes: a limit of the process, which the kernel says as it says a full disk."""
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    rows = tmp_path / "rows"
    append_whole(rows, b"12345678")
    resource.setrlimit(resource.RLIMIT_FSIZE, (12, old[1]))  # Python ignores the signal that comes with it
    try:
        too_large = r"file: output file: expected a place that can be written, found File too large"
        with pytest.raises(ConfigError, match=too_large), written_whole(tmp_path / "file") as beside:
            beside.write_bytes(bytes(100))
        for more in (b"123456", b"1234567"):
            with pytest.raises(ConfigError, match=r"rows: output file: expected a place that can be written"):
                append_whole(rows, more)
            assert rows.read_bytes() == b"12345678"  # not half of it
        append_whole(rows, b"1234")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
    assert rows.read_bytes() == b"123456781234"
    assert [path.name for path in tmp_path.iterdir()] == ["rows"]


def test_a_current_folder_that_was_removed_is_named(tmp_path: Path) -> None:
    """In a process of its own, whose current folder is gone."""
    code = """
import os, sys
folder = os.path.abspath("gone")
os.mkdir(folder)
os.chdir(folder)
os.rmdir(folder)
import crossgait
result = crossgait.walk(seconds=0.1)
try:
    result.save("walk.json")
except crossgait.ConfigError as error:
    print(error)
result.save(sys.argv[1])
"""
    run = [sys.executable, "-c", code, str(tmp_path / "walk.json")]
    said = subprocess.run(run, cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    assert said == "walk.json: file: expected a current folder that is there, found one that was removed\n"
    assert (tmp_path / "walk.json").exists()
