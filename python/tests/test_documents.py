"""Examples and the code of the documents run as they stand."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import nbclient
import nbformat
import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "python/examples").glob("*.py"))
BLOCKS = [
    pytest.param(block, id=f"{page.stem}-{number}")
    for page in [*sorted((ROOT / "docs").glob("python*.md")), ROOT / "docs/training.md"]
    for number, block in enumerate(re.findall(r"^```python\n(.*?)^```", page.read_text(), re.DOTALL | re.MULTILINE))
]


def run(arguments: list[str], folder: Path) -> str:
    environment = {**os.environ, "MPLBACKEND": "Agg", "PYTHONWARNINGS": "error"}
    done = subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, timeout=900
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_examples_run(example: Path, tmp_path: Path) -> None:
    assert run([str(example)], tmp_path)


def test_the_notebook_runs(tmp_path: Path) -> None:
    notebook = nbformat.read(ROOT / "python/examples/verdict.ipynb", as_version=4)
    done = nbclient.NotebookClient(notebook, timeout=900, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output for cell in done.cells if cell.cell_type == "code" for output in cell.outputs]
    assert all(output.output_type != "error" for output in shown)
    assert any("text/html" in output.get("data", {}) for output in shown)  # the verdict shows itself
    assert any("image/png" in output.get("data", {}) for output in shown)


@pytest.mark.parametrize("block", BLOCKS)
def test_blocks_of_documents_run(block: str, tmp_path: Path) -> None:
    (tmp_path / "block.py").write_text(block)
    run(["block.py"], tmp_path)
