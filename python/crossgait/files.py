"""Files that appear whole or not at all, and files that one process at a time may write."""

from __future__ import annotations

import errno
import fcntl
import os
import stat
import tempfile
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from crossgait import _core
from crossgait.errors import ConfigError

Named = tuple[str, str | os.PathLike[str] | None]  #: an option or what else names a file, and the file; None: none

CHECKPOINT_BYTES = 256 << 20  #: of a file of PyTorch's or Stable-Baselines3's at most


class _Noted(threading.local):
    """What each `noting_reads` of a thread has noted so far, the innermost last."""

    def __init__(self) -> None:
        self.lists: list[list[str]] = []


_noted = _Noted()


def check_outputs(outputs: Iterable[Named], inputs: Iterable[Named] = ()) -> None:
    """Check, before any work, that what is to be written is nothing that is read, and each a file of its own.

    By which file it is and not by its name, as the core's commands do. `-` is standard output; devices and pipes take
    what several write. Raises ConfigError naming the output's option.
    """
    written = [(option, os.fspath(path)) for option, path in outputs if path is not None]
    written = [(option, path) for option, path in written if path != "-" and _is_replaced(path)]
    for i, (option, path) in enumerate(written):
        from_root(path)  # whether there is such a place
        if _is_standard_output(path):
            raise ConfigError("command line", option, "a file of its own", f'"{path}", where standard output goes')
        for other, another in written[:i]:
            if _is_same(path, another):
                raise ConfigError("command line", option, "a file of its own", f'"{path}" again, of {other}')
    for source, file in inputs:
        if file is None:
            continue
        for option, path in written:
            if _is_same(path, os.fspath(file)):
                found = f'"{path}", which is {os.fspath(file)} of {source}'
                raise ConfigError("command line", option, "a file that is not read", found)


def _is_replaced(path: str) -> bool:
    return not os.path.exists(path) or os.path.isfile(path)


def _check_name(path: str | os.PathLike[str]) -> None:
    if b"\0" in os.fsencode(path):  # where the system would take the name to end
        raise ConfigError(os.fspath(path), "file", "a name without a byte of zero", "one in it")


def from_root(path: str | os.PathLike[str]) -> str:
    """A path from the root. Raises ConfigError where the current folder, from which it is, was removed."""
    _check_name(path)
    try:
        return os.path.join("" if os.path.isabs(path) else os.getcwd(), os.fspath(path))
    except FileNotFoundError as error:
        expected, found = "a current folder that is there", "one that was removed"
        raise ConfigError(os.fspath(path), "file", expected, found) from error


def _is_standard_output(path: str) -> bool:
    try:
        return os.path.samestat(os.stat(path), os.fstat(1))
    except OSError:  # it is not there, or standard output is closed
        return False


def _is_same(path: str, other: str) -> bool:
    try:
        return os.path.realpath(path) == os.path.realpath(other) or os.path.samefile(path, other)
    except OSError:  # one is not there
        return False


@contextmanager
def noting_reads() -> Iterator[list[Named]]:
    """Note what this package and the core read on this thread, for `check_outputs`: the list is whole at the end."""
    core, read, mine = _core._FilesRead(), list[Named](), list[str]()
    _noted.lists.append(mine)
    try:
        yield read
    finally:
        _noted.lists.pop()
        read += [("what is read", path) for path in dict.fromkeys([*mine, *core.paths()])]
        core.close()


@contextmanager
def written_whole(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Where to write what is to be at `path`: it is moved there at the end, or is gone if something goes wrong.

    What a symbolic link leads to is replaced, not the link; what is no file (a device) is written to. It outlives a
    power cut. What processes that were killed have left in the folder is removed. Raises OSError; and ConfigError of a
    file whose lock somebody holds, a store that is being written, or where there is no room.
    """
    with _needing_room(path), _beside(path) as beside:
        yield beside


@contextmanager
def _needing_room(path: str | os.PathLike[str]) -> Iterator[None]:
    """Raise ConfigError naming the file where its device is full or fails, which libraries say without a name."""
    try:
        yield
    except OSError as error:
        if error.errno not in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO):
            raise
        expected = "a place that can be written"
        raise ConfigError(os.fspath(path), "output file", expected, os.strerror(error.errno)) from error


def append_whole(path: Path, data: bytes) -> None:
    """Add bytes to a file that nobody else writes, all of them or none. Raises ConfigError where there is no room."""
    with _needing_room(path), open(path, "ab", buffering=0) as file:
        size = os.fstat(file.fileno()).st_size
        try:
            if (file.write(data) or 0) < len(data):
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        except OSError:
            os.ftruncate(file.fileno(), size)
            raise


@contextmanager
def _beside(path: str | os.PathLike[str]) -> Iterator[Path]:
    target = Path(os.path.realpath(from_root(path)))
    if target.exists() and not target.is_file():
        yield target
        return
    _check_not_locked(target, path)
    there = target.exists()
    if there and not os.access(target, os.W_OK, effective_ids=True):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), os.fspath(path))
    _core._remove_left_over(os.fspath(target.parent))
    if not target.parent.is_dir():
        expected = "a place that can be written"
        raise ConfigError(os.fspath(path), "output file", expected, f"no folder {target.parent}")
    # A folder, so that the file is made by whoever writes it, with the permissions of any other file.
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=".crossgait-", suffix=".tmp") as folder:
        held = _hold(folder)
        try:
            beside = Path(folder) / target.name
            yield beside
            if there:  # it may be read by as many as before
                os.chmod(beside, stat.S_IMODE(target.stat().st_mode))
            _sync(beside)
            _check_not_locked(target, path)  # it may have become one meanwhile
            os.replace(beside, target)
        finally:
            os.close(held)


@contextmanager
def staged(folder: Path) -> Iterator[Path]:
    """Where to write what `replace_together` moves into `folder`, under the folder's name; gone at the end."""
    _core._remove_left_over(os.fspath(folder))
    with tempfile.TemporaryDirectory(dir=folder, prefix=".crossgait-", suffix=".tmp") as beside:
        held = _hold(beside)
        try:
            stage = Path(beside) / folder.name
            stage.mkdir()
            yield stage
        finally:
            os.close(held)


def replace_together(stage: Path, folder: Path, names: list[str], others: Iterable[str]) -> None:
    """Move files of a stage into its folder, where they belong together.

    The last of `names` says that all are there: it is removed first and comes last. What else `others` name there is of
    what they replace, and is removed. Raises ConfigError, before anything is, for a file whose lock somebody holds.
    """
    old = [folder / name for name in dict.fromkeys([names[-1], *names, *others])]
    for file in old:
        _check_not_locked(file, file)
    for name in names:
        _sync(stage / name)
    (folder / names[-1]).unlink(missing_ok=True)
    for file in old:
        if file.name not in names:
            file.unlink(missing_ok=True)
    for name in names:
        os.replace(stage / name, folder / name)
    _sync_folder(folder)


def _check_not_locked(target: Path, path: str | os.PathLike[str]) -> None:
    """Raise ConfigError if somebody holds the lock of what is to be replaced, as `LockedFile` of the core does."""
    if (writer := _core._writer_of(os.fspath(target))) is not None:
        raise ConfigError(os.fspath(path), "output file", "a file that nobody is writing", writer)


def _sync(path: Path) -> None:
    file = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        os.fsync(file)
    finally:
        os.close(file)


def _sync_folder(folder: Path) -> None:
    file = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(file)
    finally:
        os.close(file)


def _hold(folder: str) -> int:
    """Lock a folder, which says that its process lives."""
    file = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC)
    with suppress(OSError):  # where there are no locks, nothing is removed either
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    return file


@contextmanager
def locked_folder(folder: Path, expected: str = "one writer at a time", by: str | None = None) -> Iterator[None]:
    """Make a folder whose files belong together, and keep others who do so out of it. Raises ConfigError.

    The lock is that of the file `by` in it, which is made; without one, the folder's own.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if by is None:
            file = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        else:
            file = os.open(folder / by, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    except OSError as error:
        raise ConfigError(os.fspath(folder), "folder", "one that can be written", str(error.strerror)) from error
    try:
        lock(file, folder, "folder", expected)
        yield
    finally:
        os.close(file)  # and with it the lock


@contextmanager
def opened(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """A regular file to read. Folders, devices and pipes, which may never end, are refused. Raises ConfigError."""
    source = os.fspath(path)
    _check_name(path)
    try:
        # Not waiting for somebody to write to a pipe.
        file = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError as error:
        raise ConfigError(source, "file", "a readable file", str(error.strerror)) from error
    if not stat.S_ISREG(mode := os.fstat(file).st_mode):
        os.close(file)
        found = os.strerror(errno.EISDIR) if stat.S_ISDIR(mode) else "a pipe or device"
        raise ConfigError(source, "file", "a readable file", found)
    for noted in _noted.lists:
        noted.append(source)
    with open(file, "rb") as reading:
        yield reading


def read_bytes(path: str | os.PathLike[str], most: int) -> bytes:
    """What a regular file holds, of at most so many bytes. Raises ConfigError."""
    source = os.fspath(path)
    with opened(path) as file:
        size = os.fstat(file.fileno()).st_size
        try:
            data = b"" if size > most else file.read(most + 1)
        except OSError as error:
            raise ConfigError(source, "file", "a readable file", str(error.strerror)) from error
    if max(size, len(data)) > most:
        raise ConfigError(source, "file", f"at most {most} bytes", f"{max(size, len(data))} or more")
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
            # The kernel does not tell of processes in other containers or on other machines, nor of one just gone.
            found = _core._writer_of(f"/proc/self/fd/{file}") or "one that another process is writing"
        raise ConfigError(os.fspath(path), element, expected, found) from error
