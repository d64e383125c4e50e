"""Sweeps on a Ray cluster of two nodes on this machine. Leave them out with: pytest -m "not ray"."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from sweep_studies import SHORT, lines, serial_rows, study

import crossgait

os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # a test tells nobody
pytest.importorskip("yaml")
ray = pytest.importorskip("ray", reason="needs Ray: pip install crossgait[ray]")

from crossgait.sweep import RayCluster, Run, Summary, row_of, sweep  # noqa: E402

pytestmark = [
    pytest.mark.ray,
    # Ray's own: sockets and processes that it leaves to the collector, and settings that it is about to change.
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::FutureWarning", "ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]
NODE = {"num_cpus": 1, "object_store_memory": 80 * 2**20, "include_dashboard": False}


@pytest.fixture
def cluster() -> Iterator[Any]:
    from ray.cluster_utils import Cluster

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        nodes = Cluster(initialize_head=True, head_node_args=NODE)
        nodes.add_node(**NODE)
        nodes.wait_for_nodes()
        yield nodes
        ray.shutdown()
        nodes.shutdown()


@pytest.mark.long
def test_a_cluster_that_loses_a_node_makes_the_rows_of_a_loop(cluster: Any, tmp_path: Path) -> None:
    runs = study(tmp_path, SHORT.format(engine=crossgait.available_engines()[0])).runs()
    second = next(iter(cluster.worker_nodes))
    seen: list[int] = []

    def lose_a_node(summary: Summary) -> None:
        seen.append(summary.workers)
        if summary.made >= 3 and second in cluster.worker_nodes:
            cluster.remove_node(second, allow_graceful=False)

    file = tmp_path / "rows.jsonl"
    summary = sweep(runs, file, lambda: RayCluster(cluster.address), listener=lose_a_node)
    assert second not in cluster.worker_nodes
    assert seen[0] == 2
    assert (summary.made, summary.failed, summary.missing) == (16, 0, 0)
    assert lines(file) == serial_rows(runs)


@pytest.mark.long
def test_a_task_that_kills_its_process_is_a_crash(cluster: Any, tmp_path: Path) -> None:
    runs = study(tmp_path, SHORT.format(engine=crossgait.available_engines()[0])).runs()[:4]

    def make(run: Run) -> str:  # not of a module, which nodes would have to find
        import os
        import signal

        if run.start == 1:
            os.kill(os.getpid(), signal.SIGKILL)
        return row_of(run)

    file = tmp_path / "rows.jsonl"
    summary = sweep(runs, file, lambda: RayCluster(cluster.address, 1, make))
    assert (summary.made, summary.failed, summary.crashes, summary.workers) == (4, 1, 2, 1)
    assert len(set(lines(file)) & set(serial_rows(runs))) == 3
