"""What `crossgait walk --json` writes, as attributes that type checkers and editors know."""

from __future__ import annotations

from typing import Any


class WalkNumbers:
    """Keys of a walk's document, with their types; docs/statistics.md says what each means."""

    engine: str
    engine_version: str
    terrain: str
    gait: str
    contact: dict[str, Any]
    not_of_law: list[str]
    outcome: str
    outcome_at_s: float | None
    simulated_seconds: float
    distance_m: float
    lateral_m: float
    path_m: float
    yaw_rad: float
    fell: bool
    fell_at_s: float | None
    collapsed: bool
    left_terrain: bool
    loop_violated: bool
    diverged: bool
    mean_speed_mps: float
    final_position_m: list[float]
    rms_roll_deg: float
    rms_pitch_deg: float
    duty_factor: dict[str, float]
    swing_contact_ratio: float | None
    swing_contact_ratio_inner: float | None
    slip_per_path: float | None
    heading_error_deg: float | None
    slip_m: float
    cost_of_transport: float | None
    ik_clamped: int
    limit_factor: float
    max_penetration_m: float
    max_loop_gap_m: float
    physics_steps: int
    wall_seconds: float
    provenance: dict[str, Any]
