"""Keywords of environments, with their types, for those who complete and check: nothing here runs."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, TypedDict

from crossgait._core import Robot
from crossgait.envs.configuration import ConfigLike
from crossgait.inputs import EngineLike, TerrainLike
from crossgait.terms import Terms


class EnvironmentKeys(TypedDict, total=False):
    """Keys of an environment beside engine and terrain, as `crossgait.EnvironmentConfig` takes them."""

    preset: str | None
    robot: str | os.PathLike[str] | Robot | None
    terrain_seed: int | None
    friction: float | None
    contact: Mapping[str, Any] | None
    servos: Mapping[str, Any] | None
    action: str | None
    joints: Mapping[str, Any] | None
    gait: str | None
    parameters: Mapping[str, float | str] | None
    adapt: Sequence[str] | None
    ranges: Mapping[str, Sequence[float]] | None
    delta_scales: Mapping[str, float] | None
    residual_scale: float | None
    heading_hold: bool | None
    command: Mapping[str, float] | None
    observation: Sequence[Any] | None
    reward: Mapping[str, float] | None
    physics_dt: float | None
    control_dt: float | None
    policy_dt: float | None
    episode_seconds: float | None
    settle_seconds: float | None
    tilt_limit_deg: float | None
    terminations: Sequence[str] | None
    randomisation: Mapping[str, Sequence[float]] | None


class VectorKeywords(EnvironmentKeys, total=False):
    """Keywords of `crossgait.envs.QuadrupedVectorEnv` that wrappers for learners hand on."""

    config: ConfigLike
    engine: EngineLike | None
    terrain: TerrainLike | None
    terms: Terms | None
    workers: int | None
    max_episode_steps: int | None
    render_mode: str | None
    width: int
    height: int
    camera: Mapping[str, Any] | None
