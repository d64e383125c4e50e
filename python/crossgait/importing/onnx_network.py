"""A network as ONNX, with the names of what goes in and out."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class OnnxNetwork:
    """An ONNX file's bytes, and which of its inputs and outputs are what."""

    model: bytes
    observation: str
    action: str
    memory: dict[str, str]  #: outputs that are inputs of the next step, by input
