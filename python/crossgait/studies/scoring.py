"""How well policies do what they are asked, each in each engine."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from crossgait import _core
from crossgait.arguments import checking_arguments
from crossgait.errors import ConfigError
from crossgait.importing.checkpoint import as_policy_file, is_checkpoint
from crossgait.inputs import (
    EngineLike,
    EnginesLike,
    EnvironmentLike,
    PolicyLike,
    as_engine,
    as_policies,
    environment_for,
)
from crossgait.notes import tell_notes
from crossgait.progress import Progress
from crossgait.studies.choices import ProgressShown, all_engines, worker_count
from crossgait.studies.diagnosing import file_of
from crossgait.studies.results import Matrix, Scores

#: The engine of all policies, or of each by its name in tables.
HomesLike = EngineLike | Mapping[str, EngineLike]


_MOST_STARTS = 1_000


@checking_arguments
def score(
    policies: PolicyLike | Sequence[PolicyLike],
    environment: EnvironmentLike | None = None,
    *,
    engines: EnginesLike | None = None,
    agent: str | os.PathLike[str] | None = None,
    trained_in: HomesLike | None = None,
    starts: int = 6,
    seconds: float = 6,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress | bool | None = None,
) -> Scores:
    """Walk policies straight ahead, turning and standing, in every engine (docs/diagnosis.md).

    Args:
        policies: one or several: folders, names, files or a `Policy`; with `environment` also what a training writes:
            checkpoints of rsl_rl, TorchScript, ONNX.
        environment: that they act in; each policy's own by default.
        engines: all that are available by default.
        agent: the agent.yaml of checkpoints of rsl_rl; by default the one beside each, or in `params` there.
        trained_in: the engine that they were trained in, which results repeat; by default what the training or the
            environment of a policy says that was not imported.
        starts: of every command, 2 or more: other headings and tilts.
        seconds: simulated length of a walk, 1.5 or more, of which the first second does not count.
        seed: of the starts.
        workers: as `verdict`.
        progress: as `walk`.

    Raises:
        ConfigError: for an environment that does not command joints, or a policy of other sizes

    """
    given = (policies, environment, engines, agent, trained_in, starts, seconds, seed, workers, progress)
    return Scores(*_scored("score", False, *given))


@checking_arguments
def matrix(
    policies: PolicyLike | Sequence[PolicyLike],
    environment: EnvironmentLike | None = None,
    *,
    engines: EnginesLike | None = None,
    agent: str | os.PathLike[str] | None = None,
    trained_in: HomesLike | None = None,
    starts: int = 6,
    seconds: float = 6,
    seed: int = 0,
    workers: int | None = None,
    progress: Progress | bool | None = None,
) -> Matrix:
    """Score policies in every engine, and average over those that were trained in one. Arguments as `score`."""
    given = (policies, environment, engines, agent, trained_in, starts, seconds, seed, workers, progress)
    return Matrix(*_scored("matrix", True, *given))


def _scored(
    study: str,
    as_matrix: bool,
    policies: Any,
    environment: Any,
    engines: Any,
    agent: Any,
    trained_in: Any,
    starts: int,
    seconds: float,
    seed: int,
    workers: int | None,
    progress: Any,
) -> tuple[Any, str]:
    if starts > _MOST_STARTS:
        raise ConfigError(study, "starts", f"2 to {_MOST_STARTS}", str(starts))
    if not 1.5 <= seconds <= 1000:
        raise ConfigError(study, "seconds", "1.5 to 1000 s", repr(seconds))
    chosen = as_policies(policies, study)
    names = [_name_of(policy, chosen) for policy in chosen]
    homes = _homes(trained_in, names, study)
    with ProgressShown(progress) as told, ExitStack() as files:
        rows = []
        for policy, name in zip(chosen, names, strict=True):
            config = environment_for(environment, policy, source=study)
            tell_notes(config)
            if config.action != "joints":
                raise ConfigError(study, "action", "joints: what a score asks for is commanded to them", config.action)
            if is_checkpoint(policy):
                file = files.enter_context(as_policy_file(policy, config, agent))
            else:
                file = files.enter_context(file_of(policy, study))
            foreign = environment is not None or _core._is_imported(file)
            rows.append((name, homes.get(name, "" if foreign else config.engine), config, file))
        return _core._score(
            rows, all_engines(engines, study), starts, seconds, seed, worker_count(workers), as_matrix, told
        )


def _name_of(policy: PolicyLike, policies: list[Any]) -> str:
    """A folder's or a file's own name, or all that was given where two have the same."""
    names = [Path(p if isinstance(p, (str, os.PathLike)) else p.name) for p in policies]
    own = names[policies.index(policy)]
    return own.name if [name.name for name in names].count(own.name) == 1 else os.fspath(own)


def _homes(trained_in: Any, names: list[str], study: str) -> dict[str, str]:
    if trained_in is None:
        return {}
    if not isinstance(trained_in, Mapping):
        return dict.fromkeys(names, as_engine(trained_in, study))
    unknown = [name for name in trained_in if name not in names]
    if unknown:
        raise ConfigError(study, "trained_in", f"names of policies: {', '.join(names)}", repr(unknown[0]))
    return {name: as_engine(engine, study) for name, engine in trained_in.items()}
