"""A run's folder: one writer at a time, and all that says how to make it again."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import AbstractContextManager
from importlib import metadata
from pathlib import Path
from typing import Any

from crossgait import _core
from crossgait.errors import ConfigError
from crossgait.files import from_root, locked_folder, read_bytes, written_whole
from crossgait.train.plan import Plan

CONFIG, COMMANDS, ENVIRONMENT, _LOCK = "config.yaml", "commands.jsonl", "environment.yaml", ".lock"
CHECKPOINT, PROGRESS, EVALUATIONS, CARD = "checkpoint.pt", "progress.csv", "evaluations.csv", "card.md"
BEST, LAST = "best", "last"  #: names of policies, without extension
ENDINGS = (".safetensors", ".yaml")  #: of a policy, whole or hierarchical
MOST_COMMANDS = 1 << 20  #: bytes
#: What a trainer writes in its folder.
OF_TRAINER = (
    *(CHECKPOINT, PROGRESS, EVALUATIONS),
    *(f"{name}{ending}" for name in (BEST, LAST) for ending in ENDINGS),
)
#: What a run writes in its folder.
WRITTEN = (CONFIG, COMMANDS, ENVIRONMENT, _LOCK, CARD, *OF_TRAINER)
_PACKAGES = ("torch", "stable_baselines3", "gymnasium", "numpy")


def locked(folder: Path) -> AbstractContextManager[None]:
    """Make the folder and keep other runs out of it. Raises ConfigError."""
    return locked_folder(folder, "one run at a time", _LOCK)


def begin(folder: Path, plan: Plan, arguments: Sequence[str], *, resume: bool) -> None:
    """Write what is run, and by what.

    Raises ConfigError for a folder that holds anything, unless a run goes on in it, and for links and pipes in the
    place of its files.
    """
    there = [each for each in sorted(folder.iterdir()) if not each.name.startswith(".")]
    if there and not resume:
        found = "a run" if (folder / CONFIG).exists() else f"{there[0].name}, {len(there)} in all"
        raise ConfigError(str(folder), "folder", "an empty one, or --resume", found)
    for each in there:
        if each.is_symlink() or not (each.is_file() or each.is_dir()):
            raise ConfigError(str(folder), each.name, "a file of the run's own", "a link, a pipe or a device")
    describe(folder, plan, anew=True)  # of a run that is to be longer, too
    commands = folder / COMMANDS
    before = read_bytes(commands, MOST_COMMANDS) if commands.exists() else b""
    whole = before[: before.rfind(b"\n") + 1]  # without what a full disk, or a stop, left of a line
    with written_whole(commands) as beside:
        beside.write_bytes(whole + json.dumps(_command(plan, arguments)).encode() + b"\n")


def describe(folder: Path, plan: Plan, *, anew: bool = False) -> None:
    """Write what is trained, and in what its policy is evaluated, beside the policy: `anew`, or where nobody has.

    By them a run is gone on with, and its policy judged. Raises ConfigError.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in ((CONFIG, plan.to_yaml()), (ENVIRONMENT, plan.evaluated.to_yaml())):
        if anew or not (folder / name).exists():
            with written_whole(folder / name) as beside:
                beside.write_text(text)


def _command(plan: Plan, arguments: Sequence[str]) -> dict[str, Any]:
    return {
        "command": list(arguments),
        "folder": os.path.normpath(from_root(".")),
        "begun": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
        "seed": plan["seed"],
        "versions": {"crossgait": _core.version(), "python": platform.python_version()}
        | {name: metadata.version(name) for name in _PACKAGES},
        "engines": {engine.name: engine.version for engine in _core.engines() if engine.available},
        "processors": len(os.sched_getaffinity(0)),
        "git": _git(),
    }


def commands_of(folder: Path) -> list[dict[str, Any]]:
    """What was run in the folder, in order. Raises ConfigError."""
    file = folder / COMMANDS
    found = []
    for number, line in enumerate(read_bytes(file, MOST_COMMANDS).splitlines(), 1):
        try:
            said = json.loads(line)
        except ValueError:
            said = None
        if not isinstance(said, dict) or not said.keys() >= {"command", "git", "processors", "versions"}:
            raise ConfigError(str(file), f"line {number}", "a command that was run here", "something else")
        found.append(said)
    return found


def _git() -> dict[str, Any] | None:
    """Of the folder that the run was begun in; None if it is not under Git."""
    try:
        commit = _run_git("rev-parse", "HEAD")
        here, staged = _run_git("diff-files", "--name-only"), _run_git("diff-index", "--cached", "--name-only", "HEAD")
    except (OSError, subprocess.SubprocessError):
        return None
    return {"commit": commit, "changed": sorted({*here.splitlines(), *staged.splitlines()})}


def _run_git(*arguments: str) -> str:
    # A repository's own configuration may name programs: one that sees what has changed, hooks, and filters, through
    # which `status` has files looked at whose times have changed.
    own = ["-c", "core.fsmonitor=false", "-c", "core.hooksPath=/dev/null"]
    done = subprocess.run(
        ["git", "--no-optional-locks", *own, *arguments], capture_output=True, text=True, timeout=20, check=True
    )
    return done.stdout.rstrip()


def command_line() -> list[str]:
    """As it was given."""
    return [sys.executable, *sys.orig_argv[1:]]
