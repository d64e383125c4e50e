"""One quadruped stack over several physics engines, and a verdict on what depends on the engine.

>>> import crossgait
>>> crossgait.walk("trot", engine="bullet", seconds=2).mean_speed_mps > 0.2
True
"""

from __future__ import annotations

from crossgait._core import (
    Behaviour,
    Contact,
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
from crossgait.errors import ConfigError
from crossgait.policies import Policy
from crossgait.results import (
    Bench,
    CompareResult,
    Conformance,
    CourseResult,
    Result,
    Rollout,
    Transfer,
    Tuning,
    Verdict,
    Verdicts,
    WalkResult,
)
from crossgait.studies import bench, compare, conformance, course, rollout, transfer, tune, verdict, verdicts, walk
from crossgait.traces import Trace

__version__ = version()

__all__ = [
    "Behaviour",
    "Bench",
    "CompareResult",
    "ConfigError",
    "Conformance",
    "Contact",
    "CourseResult",
    "Engine",
    "EnvironmentConfig",
    "FootContact",
    "FunctionPolicy",
    "GaitGenerator",
    "Leg",
    "Policy",
    "Result",
    "Robot",
    "Rollout",
    "Snapshot",
    "StartRanges",
    "State",
    "Terrain",
    "Trace",
    "Transfer",
    "Tuning",
    "Verdict",
    "Verdicts",
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
    "engines",
    "gait_parameters",
    "gaits",
    "legs",
    "models_dir",
    "policy_names",
    "robots",
    "rollout",
    "transfer",
    "tune",
    "verdict",
    "verdicts",
    "walk",
]
