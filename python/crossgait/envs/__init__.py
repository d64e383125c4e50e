"""Gymnasium environments: importing this module registers them.

    >>> import gymnasium
    >>> import crossgait.envs
    >>> env = gymnasium.make("Crossgait/AdaptiveGait-v0", engine="bullet", terrain="rough")
    >>> envs = gymnasium.make_vec("Crossgait/JointControl-v0", num_envs=16)

Or without the import: `gymnasium.make("crossgait.envs:Crossgait/AdaptiveGait-v0")`.
"""

from __future__ import annotations

try:
    import gymnasium
except ImportError as error:
    raise ImportError("crossgait.envs needs Gymnasium: pip install crossgait[gym]") from error

from crossgait.envs.quadruped_env import AdaptiveGaitEnv, JointControlEnv, QuadrupedEnv
from crossgait.envs.quadruped_vector_env import (
    AdaptiveGaitVectorEnv,
    JointControlVectorEnv,
    QuadrupedVectorEnv,
)

__all__ = [
    "AdaptiveGaitEnv",
    "AdaptiveGaitVectorEnv",
    "JointControlEnv",
    "JointControlVectorEnv",
    "QuadrupedEnv",
    "QuadrupedVectorEnv",
]

for _name in ("AdaptiveGait", "JointControl"):
    gymnasium.register(
        id=f"Crossgait/{_name}-v0",
        entry_point=f"crossgait.envs:{_name}Env",
        vector_entry_point=f"crossgait.envs:{_name}VectorEnv",
    )
