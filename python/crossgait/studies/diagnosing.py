"""Why a policy does not do here what it was trained for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from crossgait import _core
from crossgait.arguments import checking_arguments
from crossgait.errors import ConfigError
from crossgait.inputs import (
    EngineLike,
    EnvironmentLike,
    PolicyLike,
    PolicyObject,
    as_engine,
    as_names,
    as_policy,
    environment_for,
)
from crossgait.notes import tell_notes
from crossgait.progress import Progress
from crossgait.studies.choices import ProgressShown, worker_count
from crossgait.studies.results import Diagnosis


@checking_arguments
def diagnose(
    policy: PolicyLike,
    environment: EnvironmentLike | None = None,
    *,
    unstated: str | Sequence[str] | None = None,
    home_engine: EngineLike | None = None,
    search: bool = True,
    seed: int = 0,
    workers: int | None = None,
    minutes: float = 3,
    progress: Progress | bool | None = None,
) -> Diagnosis:
    """Find what of a policy's environment keeps it from doing what it is asked (docs/diagnosis.md).

    Args:
        policy: a folder that `import_policy` made, a name of `crossgait.policy_names()`, a file, or a `Policy`.
        environment: the policy's own by default.
        unstated: fields that nobody said, beside those that the import listed in the folder.
        home_engine: the engine that it was trained in, which tells the physics from the policy.
        search: otherwise it is only seen whether it does what it is asked.
        seed: of the starts.
        workers: as `verdict`.
        minutes: after which no further changes of two fields are tried; 0: no limit.
        progress: as `walk`.

    Raises:
        ConfigError: for an environment that does not command joints, or a policy of other sizes

    """
    config = environment_for(environment, policy, source="diagnose")
    tell_notes(config)
    home = None if home_engine is None else as_engine(home_engine, "diagnose")
    fields = as_names(unstated or (), "diagnose", "unstated")
    with ProgressShown(progress) as told, file_of(policy, "diagnose") as file:
        (document, text), found = _core._diagnose(
            config, file, fields, home, search, worker_count(workers), seed, minutes, told
        )
    return Diagnosis(document, text, found)


@contextmanager
def file_of(policy: PolicyLike, study: str) -> Iterator[str]:
    """What names the policy: its layout is relabelled, which takes a file; a network in memory becomes one."""
    chosen = as_policy(policy, study)
    if isinstance(chosen, str):
        yield chosen
    elif isinstance(policy, PolicyObject):
        with TemporaryDirectory(prefix="crossgait-") as folder:
            file = Path(folder) / f"{Path(policy.name).stem}.safetensors"
            policy.save(file)
            yield str(file)
    else:
        raise ConfigError(study, "policy", "a name, a file or a Policy", type(policy).__name__)
