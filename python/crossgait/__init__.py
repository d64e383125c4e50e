"""One quadruped stack over several physics engines, and a verdict on what depends on the engine.

>>> import crossgait
>>> crossgait.walk("trot", engine="bullet", seconds=2).mean_speed_mps > 0.2
True
"""

from __future__ import annotations

from crossgait import interpreter as _interpreter  # noqa: F401 # isort: skip  before the core, which it may refuse
from crossgait import _core
from crossgait._core import (
    Batch,
    Contact,
    Controller,
    Engine,
    EnvironmentConfig,
    FootContact,
    FunctionPolicy,
    GaitGenerator,
    Leg,
    Robot,
    Snapshot,
    StartRanges,
    State,
    Terrain,
    Walk,
    World,
    available_engines,
    body_poses,
    derived_seed,
    engines,
    gait_parameters,
    gaits,
    legs,
    models_dir,
    policy_names,
    robots,
    version,
)
from crossgait.consent import trust
from crossgait.errors import ConfigError
from crossgait.importing import Imported, import_policy
from crossgait.notes import Note
from crossgait.policies import Policy
from crossgait.serving import serve_engine
from crossgait.signatures import tell_signatures
from crossgait.studies import (
    Bench,
    CompareResult,
    Conformance,
    CourseResult,
    Diagnosis,
    Matrix,
    Result,
    Rollout,
    Scores,
    Transfer,
    Tuning,
    Verdict,
    WalkResult,
    bench,
    compare,
    conformance,
    course,
    diagnose,
    matrix,
    rollout,
    score,
    transfer,
    tune,
    verdict,
    walk,
)
from crossgait.terms import Terms, with_terms
from crossgait.traces import Trace

__version__ = version()
tell_signatures(_core)

__all__ = [
    "Batch",
    "Bench",
    "CompareResult",
    "ConfigError",
    "Conformance",
    "Contact",
    "Controller",
    "CourseResult",
    "Diagnosis",
    "Engine",
    "EnvironmentConfig",
    "FootContact",
    "FunctionPolicy",
    "GaitGenerator",
    "Imported",
    "Leg",
    "Matrix",
    "Note",
    "Policy",
    "Result",
    "Robot",
    "Rollout",
    "Scores",
    "Snapshot",
    "StartRanges",
    "State",
    "Terms",
    "Terrain",
    "Trace",
    "Transfer",
    "Tuning",
    "Verdict",
    "Walk",
    "WalkResult",
    "World",
    "__version__",
    "available_engines",
    "bench",
    "body_poses",
    "compare",
    "conformance",
    "course",
    "derived_seed",
    "diagnose",
    "engines",
    "gait_parameters",
    "gaits",
    "import_policy",
    "legs",
    "matrix",
    "models_dir",
    "policy_names",
    "robots",
    "rollout",
    "score",
    "serve_engine",
    "transfer",
    "trust",
    "tune",
    "verdict",
    "walk",
    "with_terms",
]

#: Parts of the package that are imported by their names.
_PARTS = ("envs", "policies", "rl_games", "rsl_rl", "sb3", "sweep", "terms", "train", "viewing")


def __dir__() -> list[str]:
    """List what there is to use, without what the package is made of."""
    return sorted([*__all__, *_PARTS, *(name for name in globals() if name.startswith("__"))])
