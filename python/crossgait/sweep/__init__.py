"""Sweeps: grids of runs on all cores or a cluster, as rows that are never lost nor made twice (docs/sweeps.md).

>>> from crossgait.sweep import Study
>>> len(Study.load("study.yaml").runs())  # doctest: +SKIP
240
"""

from __future__ import annotations

from crossgait.sweep.cluster import RayCluster
from crossgait.sweep.executors import Executor, Outcome
from crossgait.sweep.pool import ProcessPool
from crossgait.sweep.rows import RowFile, load, write_sorted
from crossgait.sweep.runner import Summary, sweep
from crossgait.sweep.runs import Run, Subject, row_of
from crossgait.sweep.study import Study

__all__ = [
    "Executor",
    "Outcome",
    "ProcessPool",
    "RayCluster",
    "RowFile",
    "Run",
    "Study",
    "Subject",
    "Summary",
    "load",
    "row_of",
    "sweep",
    "write_sorted",
]
