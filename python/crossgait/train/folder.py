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
from crossgait.files import locked_folder, written_whole
from crossgait.train.plan import Plan

CONFIG, COMMANDS, ENVIRONMENT, _LOCK = "config.yaml", "commands.jsonl", "environment.yaml", ".lock"
#: What a run writes in its folder.
WRITTEN = (
    *(CONFIG, COMMANDS, ENVIRONMENT, _LOCK, "checkpoint.pt", "progress.csv", "evaluations.csv", "card.md"),
    *(f"{name}{ending}" for name in ("best", "last") for ending in (".safetensors", ".yaml")),
)
_PACKAGES = ("torch", "stable_baselines3", "gymnasium", "numpy")


def locked(folder: Path) -> AbstractContextManager[None]:
    """Make the folder and keep other runs out of it. Raises ConfigError."""
    return locked_folder(folder, "one run at a time", _LOCK)


def begin(folder: Path, plan: Plan, arguments: Sequence[str], *, resume: bool) -> None:
    """Write what is run, and by what. Raises ConfigError for a folder that has a run, unless it goes on."""
    if not resume and (folder / CONFIG).exists():
        raise ConfigError(str(folder), "folder", "an empty one, or --resume", "a run")
    for name, text in ((CONFIG, plan.to_yaml()), (ENVIRONMENT, plan.evaluated.to_yaml())):
        with written_whole(folder / name) as beside:
            beside.write_text(text)
    with (folder / COMMANDS).open("a") as file:
        file.write(json.dumps(_command(plan, arguments)) + "\n")


def _command(plan: Plan, arguments: Sequence[str]) -> dict[str, Any]:
    return {
        "command": list(arguments),
        "folder": os.getcwd(),
        "begun": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
        "seed": plan["seed"],
        "versions": {"crossgait": _core.version(), "python": platform.python_version()}
        | {name: metadata.version(name) for name in _PACKAGES},
        "engines": {engine.name: engine.version for engine in _core.engines() if engine.available},
        "processors": len(os.sched_getaffinity(0)),
        "git": _git(),
    }


def _git() -> dict[str, Any] | None:
    """Of the folder that the run was begun in; None if it is not under Git."""
    try:
        commit = _run_git("rev-parse", "HEAD")
        changed = _run_git("status", "--porcelain", "--untracked-files=no")
    except (OSError, subprocess.SubprocessError):
        return None
    return {"commit": commit, "changed": changed.splitlines()}


def _run_git(*arguments: str) -> str:
    # A repository's own configuration may name a program that git runs to see what has changed.
    done = subprocess.run(
        ["git", "-c", "core.fsmonitor=false", *arguments], capture_output=True, text=True, timeout=20, check=True
    )
    return done.stdout.rstrip()


def command_line() -> list[str]:
    """As it was given."""
    return [sys.executable, *sys.orig_argv[1:]]
