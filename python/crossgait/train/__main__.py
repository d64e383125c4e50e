"""The command `python -m crossgait.train`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from crossgait.commands import INTERRUPTED, exit_code, say
from crossgait.errors import ConfigError
from crossgait.extras import needed_for
from crossgait.files import check_outputs, noting_reads
from crossgait.sweep.cluster import RayCluster
from crossgait.sweep.pool import ProcessPool
from crossgait.train.plan import Plan, presets

if TYPE_CHECKING:
    from crossgait.train.remote_envs import Workers
    from crossgait.train.trainer import Trained

DESCRIPTION = """\
Train a policy with PPO (Stable-Baselines3) in one engine or several, and evaluate it in all of them. Every rollout
ends in a checkpoint: stop it, kill it, and --resume goes on as if it had never been stopped.

Defaults: see --print-config. All keys: docs/training-file.md.
"""

EXAMPLES = """\
examples:
  python -m crossgait.train --preset adaptive --out runs/adaptive
  python -m crossgait.train --preset adaptive --set "engines={mujoco: 1, bullet: 1}" --out runs/mixed
  python -m crossgait.train config.yaml --seed 1 --steps 3000000 --out runs/mine-1
  python -m crossgait.train --resume --out runs/mine-1
  python -m crossgait.train --preset hierarchical --out runs/h      # planner, residuals under it, both together
  python -m crossgait.train.compare_policies runs/mine-1/best.safetensors zero
  python -m crossgait.viewing.play runs/mine-1/best.safetensors --video walk.mp4
"""


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m crossgait.train",
        description=DESCRIPTION,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("config", metavar="CONFIG.yaml", nargs="?")
    parser.add_argument("--preset", metavar="NAME", help=", ".join(presets()))
    parser.add_argument("--out", metavar="FOLDER", help="of the run (default: runs/NAME, of the preset or file)")
    parser.add_argument("--resume", action="store_true", help="go on with the run in FOLDER; --steps may be larger")
    parser.add_argument("--set", metavar="KEY=VALUE", action="append", default=[], help="over the file's; KEY.KEY too")
    parser.add_argument("--seed", metavar="N", type=int)
    parser.add_argument("--steps", metavar="N", type=int, help="policy steps of all environments together")
    parser.add_argument("--processes", metavar="N", type=int, help="that collect rollouts, where the file says `block`")
    parser.add_argument("--ray", metavar="ADDRESS", help="collect them on this Ray cluster: HOST:PORT, or auto")
    parser.add_argument("--print-config", action="store_true", help="print all keys with their values, and end")
    parser.add_argument("--progress", action=argparse.BooleanOptionalAction, help="default: on a terminal")
    return parser


def _changes(options: argparse.Namespace) -> list[str]:
    changes = list(options.set)
    for key in ("seed", "steps"):
        if getattr(options, key) is not None:
            changes.append(f"{key}={getattr(options, key)}")
    return changes


def _resumed(options: argparse.Namespace) -> tuple[Plan, Path]:
    if options.config or options.preset or options.set or options.seed is not None or not options.out:
        raise ConfigError("train", "--resume", "--out FOLDER, and at most --steps", "another option")
    folder = Path(options.out)
    if not (folder / "config.yaml").exists():
        raise ConfigError(str(folder), "folder", "one of a run", "no config.yaml")
    return Plan.load(folder / "config.yaml", _changes(options)), folder


def _begun(options: argparse.Namespace) -> tuple[Plan, Path]:
    if bool(options.config) == bool(options.preset):
        raise ConfigError("train", "arguments", "either CONFIG.yaml or --preset NAME", "both or none")
    changes = _changes(options)
    plan = Plan.preset(options.preset, changes) if options.preset else Plan.load(options.config, changes)
    name = options.preset or Path(options.config).stem
    return plan, Path(options.out or f"runs/{name}")


def _run(options: argparse.Namespace) -> int:
    with noting_reads() as read:
        plan, folder = _resumed(options) if options.resume else _begun(options)
    if options.print_config:
        print(plan.to_yaml(), end="")
        return 0
    with needed_for("runs of training", "train"):
        from crossgait.train import card
        from crossgait.train import folder as folders

    if not options.resume:  # which goes on with its own files
        check_outputs([("--out", folder / name) for name in folders.WRITTEN], [("CONFIG.yaml", options.config), *read])

    with folders.locked(folder):
        folders.begin(folder, plan, folders.command_line(), resume=options.resume)
        try:
            trained = _trained(plan, folder, options)
        except KeyboardInterrupt:
            say(f"interrupted: python -m crossgait.train --resume --out {folder} goes on", error=True)
            return INTERRUPTED
        print(card.write(plan, folder, trained), end="")
    return 0


def _workers(options: argparse.Namespace) -> Workers | None:
    """Who collects rollouts; None: as the trainer does by itself. Raises ConfigError."""
    if options.ray is None and options.processes is None:
        return None
    if options.processes is not None and options.processes < 1:
        raise ConfigError("train", "--processes", "at least 1", str(options.processes))
    if options.ray is not None:
        return partial(RayCluster, options.ray, options.processes)
    return partial(ProcessPool, options.processes)


def _trained(plan: Plan, folder: Path, options: argparse.Namespace) -> list[Trained]:
    with needed_for("runs of training", "train"):
        from crossgait.train import hierarchy
        from crossgait.train.trainer import Trainer

    settings = {"resume": options.resume, "progress": options.progress, "workers": _workers(options)}
    if plan.parts:
        return hierarchy.train(plan, folder, **settings)
    trainer = Trainer(plan, folder, **settings)
    trainer.run()
    return [trainer.trained]


def main(arguments: Sequence[str] | None = None) -> int:
    """Do it; returns the exit code."""
    options = _parser().parse_args(arguments)
    return exit_code("crossgait.train", lambda: _run(options))


if __name__ == "__main__":
    sys.exit(main())
