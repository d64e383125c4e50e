"""The whole state of a training run in one file, written whole and renamed."""

from __future__ import annotations

import io
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.running_mean_std import RunningMeanStd
from stable_baselines3.common.vec_env import VecNormalize

from crossgait.errors import ConfigError
from crossgait.files import read_bytes, written_whole
from crossgait.train.folder import CHECKPOINT

VERSION = 1
MOST_BYTES = 1 << 30


def save(folder: Path, model: PPO, normalise: VecNormalize, state: dict[str, Any]) -> None:
    """Write policy, optimiser, normalisation, random states and `state`: plain values and arrays alone.

    Of environments there is what their terms keep: a rollout begins new episodes by its own seed.
    """
    document = {
        "version": VERSION,
        "policy": model.policy.state_dict(),
        "optimiser": model.policy.optimizer.state_dict(),
        "steps": model.num_timesteps,
        "updates": model._n_updates,
        "observation": _statistics(normalise.obs_rms) if normalise.norm_obs else None,
        "return": _statistics(normalise.ret_rms),
        "random": {"torch": torch.get_rng_state(), "numpy": _numpy_state(), "python": random.getstate()},
        "state": _converted(state, np.ndarray, torch.from_numpy),
    }
    saved = io.BytesIO()  # of a full disk torch says where in its own code it noticed
    torch.save(document, saved)
    with written_whole(folder / CHECKPOINT) as beside:
        beside.write_bytes(saved.getbuffer())


def load(folder: Path, model: PPO, normalise: VecNormalize) -> dict[str, Any]:
    """Put everything back as it was and return `state`. Raises ConfigError. Nothing in the file is executed."""
    document = read(folder)
    try:
        model.policy.load_state_dict(document["policy"])
        model.policy.optimizer.load_state_dict(document["optimiser"])
        model.num_timesteps, model._n_updates = document["steps"], document["updates"]
        if normalise.norm_obs:
            restore_statistics(normalise.obs_rms, document["observation"])  # type: ignore[arg-type]
        restore_statistics(normalise.ret_rms, document["return"])
        states = document["random"]
        torch.set_rng_state(states["torch"])
        kind, keys, *rest = states["numpy"]
        np.random.set_state((kind, keys.numpy().astype(np.uint32), *rest))  # noqa: NPY002  what PPO shuffles by
        version, words, gauss = states["python"]
        random.setstate((version, tuple(words), gauss))
        state: dict[str, Any] = _converted(document["state"], torch.Tensor, torch.Tensor.numpy)
        _check_state(state)
    except Exception as error:  # of zip files, pickles, shapes
        raise _not_ours(folder, error) from error
    return state


def _check_state(state: dict[str, Any]) -> None:
    """Raise what is wrong with counters and times."""
    for name in ("rollout", "evaluated"):
        if not isinstance(state[name], int) or state[name] < -1:
            raise ValueError(f"{name} {state[name]!r}")
    for name, seconds in state["spent"].items():
        if not isinstance(seconds, float) or not seconds >= 0:
            raise ValueError(f"spent.{name} {seconds!r}")
    best = state["best"]
    if best is not None and not isinstance(best["score"], float):
        raise ValueError(f"best.score {best['score']!r}")
    if not isinstance(state.get("terms", {}), (dict, type(None))):
        raise ValueError("terms")


def _converted(value: Any, kind: type, into: Callable[[Any], Any]) -> Any:
    """Plain values with those of `kind` as something else."""
    if isinstance(value, kind):
        return into(value)
    if isinstance(value, dict):
        return {key: _converted(item, kind, into) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return type(value)(_converted(item, kind, into) for item in value)
    return value


def read(folder: Path) -> dict[str, Any]:
    """All that a checkpoint holds, by name. Raises ConfigError. Nothing in the file is executed."""
    saved = io.BytesIO(read_bytes(folder / CHECKPOINT, MOST_BYTES))
    try:
        document: dict[str, Any] = torch.load(saved, map_location="cpu", weights_only=True)
        if document["version"] != VERSION:
            raise ValueError(f"version {document['version']}")
    except Exception as error:  # of zip files, pickles
        raise _not_ours(folder, error) from error
    return document


def _not_ours(folder: Path, error: Exception) -> ConfigError:
    return ConfigError(str(folder / CHECKPOINT), "file", "a checkpoint of this configuration", str(error))


def _numpy_state() -> tuple[Any, ...]:
    kind, keys, *rest = np.random.get_state()  # noqa: NPY002
    return (kind, torch.from_numpy(np.asarray(keys).astype(np.int64)), *rest)


def _statistics(of: Any) -> dict[str, Any]:
    return {"mean": torch.as_tensor(of.mean), "var": torch.as_tensor(of.var), "count": float(of.count)}


def restore_statistics(of: RunningMeanStd, saved: dict[str, Any]) -> None:
    """Put a mean and its like back."""
    of.mean, of.var, of.count = saved["mean"].numpy(), saved["var"].numpy(), saved["count"]
