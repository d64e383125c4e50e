"""What environments say of themselves."""

from __future__ import annotations

from crossgait._core import EnvironmentConfig


def described(environment: object, config: EnvironmentConfig, count: int | None = None) -> str:
    """`<JointControlVectorEnv: 64 x serial_quadruped in mujoco, policy steps of 20 ms>`; no count: a single one."""
    robot = config.robot if count is None else f"{count} x {config.robot}"
    step = f"policy steps of {1e3 * config.policy_dt:g} ms"
    return f"<{type(environment).__name__}: {robot} in {config.engine}, {step}>"
