"""Training by workers: the same bits with 1, 2 and 3 of them and after losses, and what a rollout takes.

    python python/benchmarks/train_workers.py [--ray] [--curriculum] [--rollouts 6] [--json FILE]

Each run trains the same plan in a folder of its own. Runs with a loss lose a process in every second rollout, or the
second node of a cluster on this machine in the second, while blocks are under way. Fails if policies differ in a bit.
With `--curriculum` commands and friction follow a curriculum, whose state travels with the blocks.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import signal
import statistics
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from crossgait import Batch, terms
from crossgait.sweep import ProcessPool, RayCluster
from crossgait.train import Plan
from crossgait.train.folder import locked
from crossgait.train.remote_envs import RemoteEnvs
from crossgait.train.trainer import Trainer

NODE = {"num_cpus": 1, "object_store_memory": 80 * 2**20, "include_dashboard": False}


class Faster:
    """A curriculum of faster commands on ground that gets slippery, and the event that asks for it."""

    def __init__(self) -> None:
        self.speed = 0.1

    def __call__(self, env: Batch, indices: np.ndarray) -> None:
        """Episodes are over."""
        self.speed = min(0.5, self.speed + 0.01 * float((env.base_position[indices, 0] > 0.05).sum()))
        env.set_parameters({"friction": 0.9 - self.speed}, indices.tolist())

    def command(self, env: Batch, indices: np.ndarray) -> None:
        """Episodes begin."""
        env.set_commands([self.speed, 0, 0], indices.tolist())

    def state(self) -> float:
        """Kept from rollout to rollout."""
        return self.speed

    def restore(self, state: float) -> None:
        """Go on from it."""
        self.speed = state


def with_curriculum(plan: Plan) -> Plan:
    """The same with it."""
    faster = Faster()
    events = {"command": terms.EventTerm(faster.command)}
    return plan.with_terms(terms.Terms(events=events, curriculum={"faster": terms.CurriculumTerm(faster)}))


def plan(rollouts: int) -> Plan:
    """Joints on flat ground, 24 environments in six blocks."""
    steps = 24 * 100 * rollouts
    changes = [
        *("environments=24", "block=4", f"steps={steps}", "algorithm.n_steps=100", "algorithm.batch_size=600"),
        *("algorithm.n_epochs=2", "evaluation.episodes=1", f"evaluation.every={10 * steps}"),
        *("evaluation.engines=mujoco", "curriculum=[]", "environment.terrain=flat", "environment.episode_seconds=1"),
    ]
    return Plan.preset("joints", changes)


def run(plan: Plan, rollouts: int, workers: Any, lose: Callable[[RemoteEnvs], None] | None = None) -> dict[str, Any]:
    """Train, and say what came of it: the policy's hash, and the wall time of each rollout's collection, s."""
    with tempfile.TemporaryDirectory() as folder, locked(Path(folder)):
        trainer = Trainer(plan, Path(folder), resume=False, progress=False, workers=workers)
        envs = trainer.envs
        assert isinstance(envs, RemoteEnvs)
        collect, wait, seconds, due = envs.collect, envs._workers.wait, list[float](), list[int]()

        def waited(patience: float) -> list[Any]:
            outcomes = wait(patience)
            if lose is not None and outcomes and len(seconds) in due:
                due.remove(len(seconds))
                lose(envs)  # while the other blocks of this rollout are under way
            return outcomes

        def measured(*arguments: Any) -> None:
            begin = time.perf_counter()
            collect(*arguments)
            seconds.append(time.perf_counter() - begin)

        due += range(1, rollouts, 2)
        envs._workers.wait = waited  # type: ignore[method-assign]
        envs.collect = measured  # type: ignore[method-assign]
        trainer.run()
        policy = (Path(folder) / "last.safetensors").read_bytes()
    said = {"policy": hashlib.sha256(policy).hexdigest(), "seconds": seconds, "lost": envs.lost}
    return said | {"kept": hashlib.sha256(repr(envs.kept()).encode()).hexdigest()}


def lose_process(envs: RemoteEnvs) -> None:
    """Kill -9 of the first process of a pool."""
    pool = envs._workers
    assert isinstance(pool, ProcessPool)
    os.kill(pool._all[0].process.pid, signal.SIGKILL)


@contextmanager
def two_nodes() -> Any:
    """A Ray cluster of two nodes on this machine."""
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    import ray
    from ray.cluster_utils import Cluster

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        cluster = Cluster(initialize_head=True, head_node_args=NODE)
        cluster.add_node(**NODE)
        cluster.wait_for_nodes()
        try:
            yield cluster
        finally:
            ray.shutdown()
            cluster.shutdown()


def lose_node(cluster: Any, _: RemoteEnvs) -> None:
    """End the second node at once, if it is there."""
    for node in list(cluster.worker_nodes):
        cluster.remove_node(node, allow_graceful=False)


def main() -> int:
    """Measure, and compare bits."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rollouts", type=int, default=6)
    parser.add_argument("--ray", action="store_true", help="also on two nodes of a Ray cluster on this machine")
    parser.add_argument("--curriculum", action="store_true", help="with terms that keep something between rollouts")
    parser.add_argument("--json", metavar="FILE")
    options = parser.parse_args()
    made = with_curriculum(plan(options.rollouts)) if options.curriculum else plan(options.rollouts)
    done: dict[str, dict[str, Any]] = {}

    def measure(name: str, workers: Any, lose: Callable[[RemoteEnvs], None] | None = None) -> None:
        said = done[name] = run(made, options.rollouts, workers, lose)
        later = said["seconds"][1:]  # the first starts processes
        print(
            f"{name}: {statistics.median(later):.2f} s a rollout ({min(later):.2f} to {max(later):.2f}), "
            f"{said['lost']} blocks made again, policy {said['policy'][:12]}",
            flush=True,
        )

    for count in (1, 2, 3):
        measure(f"{count} processes", partial(ProcessPool, count))
    measure("2 processes, one killed in every second rollout", partial(ProcessPool, 2), lose_process)
    if options.ray:
        with two_nodes() as cluster:
            measure("2 nodes of Ray", partial(RayCluster, cluster.address, None))
            measure(
                "2 nodes of Ray, one lost in the second rollout",
                partial(RayCluster, cluster.address, None),
                partial(lose_node, cluster),
            )
    if options.json:
        Path(options.json).write_text(json.dumps(done, indent=2) + "\n")
    policies = {(said["policy"], said["kept"]) for said in done.values()}
    lost = [said["lost"] for name, said in done.items() if "second" in name]
    if len(policies) > 1 or 0 in lost:
        print("FAILED: " + ("policies differ" if len(policies) > 1 else "nothing was lost"))
        return 1
    print(f"the same policy, to the bit, of {len(done)} runs")
    return 0


if __name__ == "__main__":
    sys.exit(main())
