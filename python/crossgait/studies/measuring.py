"""Engines themselves: speed, accuracy, and what every one is held to."""

from __future__ import annotations

from collections.abc import Sequence

from crossgait import _core
from crossgait.arguments import checking_arguments
from crossgait.inputs import EngineLike, EnginesLike, as_engine, as_names
from crossgait.progress import Progress
from crossgait.studies.choices import ProgressShown, all_engines
from crossgait.studies.results import Bench, Conformance


@checking_arguments
def bench(
    *,
    engines: EnginesLike | None = None,
    sections: str | Sequence[str] = (),
    quick: bool = False,
    progress: Progress | bool | None = None,
) -> Bench:
    """Measure speed and accuracy of the engines; `sections` of speed, accuracy, analytic, feet, or all."""
    names = all_engines(engines, "bench")
    with ProgressShown(progress) as told:
        document, text = _core._bench(names, as_names(sections, "bench", "sections"), quick, told)
    return Bench(document, text)


@checking_arguments
def conformance(
    engine: EngineLike, *, only: str | Sequence[str] = (), progress: Progress | bool | None = None
) -> Conformance:
    """Check an engine against what every engine is held to; `only` some checks, by name, or all."""
    name, checks = as_engine(engine, "conformance"), as_names(only, "conformance", "only")
    with ProgressShown(progress) as told:
        document, text = _core._conformance(name, checks, told)
    return Conformance(document, text)
