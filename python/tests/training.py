"""Runs small enough for tests."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

#: Two rollouts to an evaluation, four in all; some episodes end within a rollout.
SMALL: dict[str, Any] = {
    "environment": {
        "terrain": "rough",
        "policy_dt": 0.02,
        "episode_seconds": 0.5,
        "settle_seconds": 0.02,
        "adapt": ["step_length", "cycle_time"],
        "reward": {"forward_velocity": 1, "termination": -1},
    },
    "randomisation": {"terrain_seed": [0, 20], "friction": [0.8, 1.2]},
    "environments": 4,
    "algorithm": {"n_steps": 40, "batch_size": 80, "n_epochs": 2, "learning_rate": [0.001, 0]},
    "network": {"hidden": [16]},
    "evaluation": {"engines": ["mujoco"], "episodes": 1, "final_episodes": 2, "every": 320},
    "steps": 640,
}
#: Columns of progress.csv that are of the clock.
TIMES = ("seconds", "steps_per_second", "share.physics", "share.learner", "share.python")


def small(**changes: Any) -> dict[str, Any]:
    """A copy of SMALL with other values."""
    copy: dict[str, Any] = json.loads(json.dumps(SMALL))
    return copy | changes


def command(arguments: list[str], folder: Path) -> subprocess.Popen[str]:
    """A command of Python, begun."""
    environment = {**os.environ, "MPLBACKEND": "Agg", "PYTHONWARNINGS": "error"}
    return subprocess.Popen(
        [sys.executable, *arguments],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def done(arguments: list[str], folder: Path, code: int = 0) -> tuple[str, str]:
    """What a command prints, which has to end with `code`."""
    process = command(arguments, folder)
    try:
        out, err = process.communicate(timeout=900)
    finally:
        process.kill()
    assert process.returncode == code, err
    return out, err
