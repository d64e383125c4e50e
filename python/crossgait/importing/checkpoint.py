"""A training's network for an environment that is there already: `python -m crossgait.importing.checkpoint`."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from crossgait.commands import exit_code
from crossgait.errors import ConfigError
from crossgait.importing.network import write_network
from crossgait.importing.stated import of_yaml
from crossgait.inputs import InterfaceLike
from crossgait.policies.policy import interface_of

_ENDINGS = (".pt", ".pth", ".onnx")
_AGENTS = ("agent.yaml", "params/agent.yaml")


def is_checkpoint(policy: object) -> bool:
    """Whether a policy is a file of another framework's: FILE.pt, FILE.pth or FILE.onnx."""
    return isinstance(policy, (str, os.PathLike)) and Path(policy).suffix.lower() in _ENDINGS


@contextmanager
def as_policy_file(
    checkpoint: str | os.PathLike[str], environment: InterfaceLike, agent: str | os.PathLike[str] | None = None
) -> Iterator[str]:
    """The checkpoint's network as a file that the core reads, there until the end of the context.

    Args:
        checkpoint: of rsl_rl, TorchScript or ONNX
        environment: what it acts in
        agent: agent.yaml of a checkpoint of rsl_rl; by default the one beside it, or in the folder `params` there

    Raises:
        ConfigError: for a file that is none of these, or whose network does not fit

    """
    with TemporaryDirectory(prefix="crossgait-") as folder:
        stated = _agent_of(checkpoint, agent)
        yield _written(os.fspath(checkpoint), environment, stated, folder)


def _agent_of(checkpoint: str | os.PathLike[str], agent: str | os.PathLike[str] | None) -> str | None:
    """The agent.yaml that is given, or found."""
    beside = [Path(checkpoint).parent / name for name in _AGENTS]
    stated = agent if agent is not None else next((file for file in beside if file.exists()), None)
    return None if stated is None else os.fspath(stated)


def _written(checkpoint: str, environment: InterfaceLike, agent: str | None, folder: str) -> str:
    within = Path(folder) / Path(checkpoint).stem
    within.mkdir()
    read = None if agent is None else of_yaml(agent)
    return write_network(checkpoint, interface_of(environment), within, read)


def _parts_of(error: ConfigError | ImportError, checkpoint: str) -> dict[str, str]:
    if isinstance(error, ImportError):
        error = ConfigError(checkpoint, "network", "a Python that has what reads it", str(error))
    return {"source": error.source, "element": error.element, "expected": error.expected, "found": error.found}


def _run() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("checkpoint")
    parser.add_argument("--env", required=True)
    parser.add_argument("--agent")
    parser.add_argument("--out", required=True)
    given = parser.parse_args()
    try:
        agent = _agent_of(given.checkpoint, given.agent)
        written = _written(given.checkpoint, given.env, agent, given.out)
        answer: dict[str, object] = {"policy": written, "agent": agent}
    except (ConfigError, ImportError) as error:
        answer = {"error": _parts_of(error, given.checkpoint)}
    print(json.dumps(answer))
    return 0


if __name__ == "__main__":
    sys.exit(exit_code("crossgait score", _run))
