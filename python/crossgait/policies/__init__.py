"""Policies: by name, of a file, and of what Stable-Baselines3, PyTorch and exporters of ONNX make."""

from __future__ import annotations

from crossgait._core import MlpNetwork, PolicyBundle, PolicyInterface
from crossgait.policies.policy import Policy, interface_of

__all__ = ["MlpNetwork", "Policy", "PolicyBundle", "PolicyInterface", "interface_of"]
