"""Why a policy does not do here what it was trained for."""

from __future__ import annotations

import os

from crossgait import _core
from crossgait._core import EnvironmentConfig
from crossgait.progress import Progress
from crossgait.studies.choices import ProgressShown, environment_or_default, worker_count
from crossgait.studies.results import Diagnosis


def diagnose(
    policy: str | os.PathLike[str],
    environment: EnvironmentConfig | None = None,
    *,
    unstated: list[str] | None = None,
    home_engine: str | None = None,
    search: bool = True,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress | bool | None = None,
) -> Diagnosis:
    """Find what of a policy's environment keeps it from doing what it is asked (docs/diagnosis.md).

    Args:
        policy: a folder that `import_policy` made, a name of `crossgait.policy_names()`, or a file.
        environment: the folder's by default.
        unstated: fields that nobody said, beside those that the import listed in the folder.
        home_engine: the engine that it was trained in, which tells the physics from the policy.
        search: otherwise it is only seen whether it does what it is asked.
        seed: of the starts.
        workers: as `verdict`.
        progress: as `walk`.

    Raises:
        ConfigError: for an environment that does not command joints, or a policy of other sizes

    """
    file = os.fspath(policy)
    config = environment_or_default(environment, file)
    with ProgressShown(progress) as told:
        (document, text), found = _core._diagnose(
            config, file, list(unstated or []), home_engine, search, worker_count(workers), seed, told
        )
    return Diagnosis(document, text, found)
