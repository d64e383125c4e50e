"""Training: PPO of Stable-Baselines3 on the native environments, by one YAML (docs/training.md).

    python -m crossgait.train --preset adaptive --out runs/adaptive

>>> from crossgait.train import Plan
>>> Plan.preset("adaptive").engines
[('mujoco', 16)]
"""

from __future__ import annotations

from crossgait.train.plan import Plan, Stage, presets

__all__ = ["Plan", "Stage", "presets"]
