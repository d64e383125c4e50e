"""The commands of `crossgait` as functions: the same results, as objects."""

from __future__ import annotations

from crossgait.studies.choices import Subject
from crossgait.studies.diagnosing import diagnose
from crossgait.studies.episodes import course, rollout, transfer, tune
from crossgait.studies.judging import verdict
from crossgait.studies.measuring import bench, conformance
from crossgait.studies.result import Result
from crossgait.studies.results import (
    Bench,
    CompareResult,
    Conformance,
    CourseResult,
    Diagnosis,
    Matrix,
    Rollout,
    Scores,
    Transfer,
    Tuning,
    Verdict,
    WalkResult,
)
from crossgait.studies.scoring import matrix, score
from crossgait.studies.walks import compare, walk

__all__ = [
    "Bench",
    "CompareResult",
    "Conformance",
    "CourseResult",
    "Diagnosis",
    "Matrix",
    "Result",
    "Rollout",
    "Scores",
    "Subject",
    "Transfer",
    "Tuning",
    "Verdict",
    "WalkResult",
    "bench",
    "compare",
    "conformance",
    "course",
    "diagnose",
    "matrix",
    "rollout",
    "score",
    "transfer",
    "tune",
    "verdict",
    "walk",
]
