"""Files that appear whole or not at all, and files that one process at a time may write."""

from __future__ import annotations

import errno
import fcntl
import os
import re
import shutil
import stat
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from crossgait.errors import ConfigError

_TEMPORARY = re.compile(r"\.crossgait-\w+\.tmp")


@contextmanager
def written_whole(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Where to write what is to be at `path`: it is moved there at the end, or is gone if something goes wrong.

    What a symbolic link leads to is replaced, not the link; what is no file (a device) is written to. What processes
    that were killed have left in the folder is removed. Raises OSError; and ConfigError of a file whose lock somebody
    holds, a store that is being written.
    """
    target = Path(os.path.realpath(path))
    if target.exists() and not target.is_file():
        yield target
        return
    _check_not_locked(target, path)
    _remove_left_over(target.parent)
    # A folder, so that the file is made by whoever writes it, with the permissions of any other file.
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=".crossgait-", suffix=".tmp") as folder:
        held = _hold(folder)
        try:
            beside = Path(folder) / target.name
            yield beside
            _check_not_locked(target, path)  # it may have become one meanwhile
            os.replace(beside, target)
        finally:
            os.close(held)


def _check_not_locked(target: Path, path: str | os.PathLike[str]) -> None:
    """Raise ConfigError if somebody holds the lock of what is to be replaced, as `LockedFile` of the core does."""
    try:
        file = os.open(target, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError:
        return  # there is none, or writing says what is wrong
    try:
        fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in (errno.EWOULDBLOCK, errno.EACCES):
            found = f"one that {_holder(file)} is writing"
            raise ConfigError(os.fspath(path), "output file", "a file that nobody is writing", found) from error
    finally:
        os.close(file)


def _hold(folder: str) -> int:
    """Lock a folder, which says that its process lives."""
    file = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
    with suppress(OSError):  # where there are no locks, nothing is removed either
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    return file


def _remove_left_over(folder: Path) -> None:
    with suppress(OSError):
        for left in os.scandir(folder):
            # Younger ones may be about to be locked.
            if _TEMPORARY.fullmatch(left.name) and time.time() - left.stat().st_mtime > 1:
                with suppress(OSError):
                    _remove_unless_held(left.path)


def _remove_unless_held(folder: str) -> None:
    file = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        shutil.rmtree(folder)
    finally:
        os.close(file)


def read_bytes(path: str | os.PathLike[str], most: int) -> bytes:
    """What a regular file holds, of at most so many bytes.

    Folders, devices and pipes, which may never end, are refused unread. Raises ConfigError.
    """
    source = os.fspath(path)
    try:
        # Not waiting for somebody to write to a pipe.
        with open(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC), "rb") as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode):  # a folder has raised already
                raise ConfigError(source, "file", "a readable file", "a pipe or device")
            data = b"" if status.st_size > most else file.read(most + 1)
    except OSError as error:
        raise ConfigError(source, "file", "a readable file", str(error.strerror)) from error
    if max(status.st_size, len(data)) > most:
        raise ConfigError(source, "file", f"at most {most} bytes", f"{max(status.st_size, len(data))} or more")
    return data


def lock(file: int, path: str | os.PathLike[str], element: str, expected: str) -> None:
    """Take the lock of an open file (`flock`), which ends when it is closed, or its process ends, however it does.

    Run stores of the core take the same one. Raises ConfigError of `element`, naming the process that holds it, where
    the kernel tells; or if the file system has no locks.
    """
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
            expected, found = "a file system with locks (flock)", str(error.strerror)
        else:
            found = f"one that {_holder(file)} is writing"
        raise ConfigError(os.fspath(path), element, expected, found) from error


def _holder(file: int) -> str:
    """Who has the lock, in words; the kernel does not tell of processes in other containers or on other machines."""
    there = os.fstat(file)
    wanted = f"{os.major(there.st_dev):02x}:{os.minor(there.st_dev):02x}:{there.st_ino}"
    try:
        locks = Path("/proc/locks").read_text().splitlines()
    except OSError:
        locks = []
    for words in map(str.split, locks):  # "7: FLOCK ADVISORY WRITE 1234 fd:00:5326004 0 EOF"
        if len(words) > 5 and words[1] == "FLOCK" and words[5] == wanted:
            return f"process {words[4]}"
    return "another process"
