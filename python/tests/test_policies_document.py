"""The examples of docs/python-policies.md run as they stand."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

DOCUMENT = Path(__file__).parents[2] / "docs" / "python-policies.md"
BLOCKS = re.findall(r"```python\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: str(block.count("\n")))
def test_blocks_run(block, tmp_path, monkeypatch):
    for library in ("stable_baselines3", "torch", "onnxruntime"):
        if library in block or (library == "onnxruntime" and "onnx" in block):
            pytest.importorskip(library)
    monkeypatch.chdir(tmp_path)
    exec(compile(block, str(DOCUMENT), "exec"), {"__name__": "document"})
