"""Consent to code that files bring along: pickles, TorchScript and xacro run what is in them."""

from __future__ import annotations

import os

from crossgait import _core


def trust(folder: str | os.PathLike[str]) -> None:
    """Let files in `folder` and below it run code, in this process and those that it begins.

    What lies below the current folder and is yours may do so anyhow (SECURITY.md); everything else raises a ConfigError
    that names the file. As `--trust FOLDER` of the program and the environment variable CROSSGAIT_TRUST.

    Raises:
        ConfigError: if there is no such folder

    """
    _core.trust_folder(os.fspath(folder), "crossgait.trust")
    os.environ[_core.TRUST_VARIABLE] = _core.trusted_folders()  # which the core cannot change for Python


def require_consent(file: str | os.PathLike[str], runs: str) -> None:
    """Say that a file runs code. Raises ConfigError unless it may. `runs` says what does: "pickle loads it"."""
    _core.require_consent(os.fspath(file), runs)
