"""Examples and the code of the documents run as they stand."""

from __future__ import annotations

import importlib.util
import os
import re
import shutil
import subprocess
import sys
from importlib.metadata import metadata
from pathlib import Path

import nbclient
import nbformat
import numpy as np
import pytest
from sweep_studies import SHORT, study_file

import crossgait
from crossgait.policies import MlpNetwork, Policy, PolicyInterface

ROOT = Path(__file__).parents[2]
PROGRAM = str(Path(sys.executable).with_name("crossgait"))
EXTRAS = metadata("crossgait").get_all("Provides-Extra") or []
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
TRAINING = [ROOT / "docs/training.md", ROOT / "docs/training-file.md"]  # in test_training_document.py
PAGES = [
    *(ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "models/README.md"),
    *sorted((ROOT / "docs").rglob("*.md")),
]


def blocks(language: str) -> list[tuple[Path, str]]:
    """(page, text) of every block in that language."""
    found = rf"^```{language}\n(.*?)^```"
    return [(page, text) for page in PAGES for text in re.findall(found, page.read_text(), re.DOTALL | re.MULTILINE)]


def parameters(language: str) -> list[object]:
    found = blocks(language)
    return [
        pytest.param(page, text, id=f"{page.stem}-{sum(p == page for p, _ in found[:number])}")
        for number, (page, text) in enumerate(found)
    ]


def run(arguments: list[str], folder: Path) -> str:
    environment = {**os.environ, "MPLBACKEND": "Agg", "PYTHONWARNINGS": "error"}
    done = subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, timeout=900
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


# Those that take ten seconds and more; the first two are run in C++ all the same.
LONG_EXAMPLES = {"03_verdict", "07_your_controller", "09_train_a_policy", "11_train_your_reward"}


@pytest.mark.parametrize(
    "example",
    [
        pytest.param(path, id=path.stem, marks=[pytest.mark.long] if path.stem in LONG_EXAMPLES else [])
        for path in EXAMPLES
    ],
)
def test_examples_run(example: Path, tmp_path: Path) -> None:
    assert run([str(example)], tmp_path)


@pytest.mark.long
def test_the_notebook_runs(tmp_path: Path) -> None:
    notebook = nbformat.read(ROOT / "examples/03_verdict.ipynb", as_version=4)
    done = nbclient.NotebookClient(notebook, timeout=900, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output for cell in done.cells if cell.cell_type == "code" for output in cell.outputs]
    assert all(output.output_type != "error" for output in shown)
    assert any("text/html" in output.get("data", {}) for output in shown)  # the verdict shows itself
    assert any("image/png" in output.get("data", {}) for output in shown)


# Verdicts that are explained, and films drawn without a graphics card.
SLOW_CALLS = ("explain=True", "to_video(")

# Uses the function that docs/policies.md defines.
EXPORT = """
import torch
from crossgait import EnvironmentConfig, _core

environment = _core.Environment(EnvironmentConfig.load("environment.yaml"))
layouts = [[(name, unit) for name, unit, *_ in layout]
           for layout in (environment.observation_layout, environment.action_layout)]
seen, acts = map(len, layouts)
model = torch.nn.Sequential(torch.nn.Linear(seen, 8), torch.nn.Tanh(), torch.nn.Linear(8, acts))
export("exported.safetensors", model, "tanh", layouts, environment.config.policy_dt, numpy.zeros(seen, numpy.float32),
       numpy.ones(seen, numpy.float32), 10.0, numpy.random.default_rng(1).normal(size=(4, seen)).astype(numpy.float32))
"""


@pytest.mark.parametrize(("page", "block"), parameters("python"))
def test_blocks_of_documents_run(page: Path, block: str, tmp_path: Path) -> None:
    if any(call in block for call in SLOW_CALLS) and not os.environ.get("CROSSGAIT_LONG_TESTS"):
        pytest.skip("takes minutes: `scripts/quality/nightly documents`")
    if "crossgait.rsl_rl" in block:
        pytest.importorskip("rsl_rl")  # nightly has it
    write_environment(tmp_path / "environment.yaml")
    if page.stem == "sweeps":
        study_file(tmp_path, SHORT.format(engine=crossgait.available_engines()[0]))
    (tmp_path / "block.py").write_text(block)
    run(["block.py"], tmp_path)
    if "def export(" in block:  # the bundle that a program of one's own writes is one that Crossgait runs
        (tmp_path / "block.py").write_text(block + EXPORT)
        run(["block.py"], tmp_path)
        options = ["--config", "environment.yaml", "--episodes", "1", "--episode-seconds", ".1"]
        subprocess.run([PROGRAM, "rollout", "--policy", "exported.safetensors", *options], cwd=tmp_path, check=True)


def write_environment(path: Path, *options: str) -> None:
    """An environment, every default written out."""
    path.write_text(
        subprocess.run([PROGRAM, "env", "--yaml", *options], capture_output=True, text=True, check=True).stdout
    )


def write_policy(path: Path, environment: Path) -> None:
    config = crossgait.EnvironmentConfig.load(str(environment))
    interface = PolicyInterface(config)
    rows, columns = len(interface.action_layout), len(interface.observation_layout)
    Policy.from_network(MlpNetwork([(np.zeros((rows, columns)), np.zeros(rows))]), config).save(path)


@pytest.mark.parametrize(("page", "block"), [p for p in parameters("yaml") if p.values[0] not in TRAINING])
def test_descriptions_in_documents_are_read(page: Path, block: str, tmp_path: Path) -> None:
    """Environments and policies by a run of one step, studies by their grid."""
    urdf = (ROOT / "models/robots/serial_quadruped/robot.urdf").read_text()
    for ours, theirs in [("_abduction", "_hip_joint"), ("_hip_pitch", "_thigh_joint"), ("_knee", "_calf_joint")]:
        urdf = urdf.replace(ours, theirs)
    (tmp_path / "go1.urdf").write_text(urdf)
    file = tmp_path / "block.yaml"
    step = [PROGRAM, "rollout", "--episodes", "1", "--episode-seconds", "0.1"]
    if page.stem == "sweeps":
        write_environment(tmp_path / "environment.yaml")
        write_policy(tmp_path / "trained.safetensors", tmp_path / "environment.yaml")
        file.write_text(block)
        command = [sys.executable, "-m", "crossgait.sweep", str(file), "--dry-run"]
    elif block.startswith("kind:"):
        file.write_text(re.sub(r"\w+\.safetensors", "zero", block))  # bundles in descriptions: the core's own tests
        command = [*step, "--observe", "terrain", "--policy", str(file)]
    else:
        joints = "FL_knee" in block and "robot:" not in block  # of the robot with serial legs
        file.write_text(("robot: serial_quadruped\n" if joints else "") + block)
        command = [*step, "--policy", "zero", "--config", str(file)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr


def prepare(folder: Path) -> None:
    """What the pages take for granted."""
    write_environment(folder / "env.yaml")
    write_environment(folder / "environment.yaml")
    write_policy(folder / "policy.safetensors", folder / "env.yaml")
    write_policy(folder / "trained.safetensors", folder / "environment.yaml")
    shutil.copy(ROOT / "models/robots/serial_quadruped/robot.urdf", folder / "my.urdf")
    (folder / "study.yaml").write_text(blocks("yaml")[[page.stem for page, _ in blocks("yaml")].index("sweeps")][1])
    shutil.copy(ROOT / "examples/engines/hard_contact.py", folder)
    for name in ("benchmarks", "experiments"):
        (folder / name).symlink_to(ROOT / name)


# Engines of the package, and the libraries without which there are none.
SERVED = {"python:drake": "pydrake", "python:mujoco_warp": "mujoco_warp", "python:newton": "newton"}

# Commands of a second or two, whatever their options.
QUICK = {"walk", "compare", "demo", "engines", "ik", "gait", "workspace", "robots", "env", "rerun", "terrain"}


def commands(page: Path) -> list[str]:
    lines = [line for of, text in blocks("sh") if of == page for line in text.splitlines()]
    return [line for line in lines if line.strip() and not line.startswith("#")]


@pytest.mark.parametrize(
    "page", [page for page in PAGES if commands(page) and page not in TRAINING], ids=lambda page: page.stem
)
def test_commands_of_documents_run(page: Path, tmp_path: Path) -> None:
    """Runs a page's commands in one folder, one by one: minutes, so at night (`scripts/quality/nightly documents`).

    By day the lines are looked at without running what takes longer than a second or two.
    """
    prepare(tmp_path)
    path = f"{Path(PROGRAM).parent}{os.pathsep}{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    for line in commands(page):
        program = line.split()[0]
        if program.startswith(("scripts/", ".ci/", "build/")):
            assert (ROOT / program).is_file() or program.startswith("build/"), line
        elif program == "pip":
            for extra in re.findall(r"\[([a-z,0-9]+)\]", line):
                assert set(extra.split(",")) <= set(EXTRAS), line
        elif program in {"cmake", "ray"}:
            continue  # change the machine; the build and tests of sweeps call both
        elif "hours" not in line.partition("#")[2]:
            assert program in {"crossgait", "python"}, line
            if "@" in line and not set(re.findall(r"mujoco@[0-9.]+", line)) <= set(crossgait.available_engines()):
                continue  # a release that is not installed here
            if "physx" in line and "physx" not in crossgait.available_engines():
                continue  # its library is installed by who wants it
            if any(name in line and importlib.util.find_spec(library) is None for name, library in SERVED.items()):
                continue  # likewise
            if not os.environ.get("CROSSGAIT_LONG_TESTS") and line.split()[1] not in QUICK:
                continue
            done = subprocess.run(
                ["bash", "-c", line],
                cwd=tmp_path,
                env={**os.environ, "PATH": path},
                capture_output=True,
                text=True,
                timeout=3600,
            )
            assert done.returncode == 0, f"{line}\n{done.stderr}"


def test_every_block_says_what_it_is() -> None:
    """No block escapes the tests above: none by indentation, none without a language."""
    for page in PAGES:
        if page.stem == "nightly":
            continue  # written by a program: what other programs said
        text = page.read_text()
        languages = re.findall(r"^ *```(\S*)", text, re.MULTILINE)
        assert set(languages[::2]) <= {"sh", "cpp", "python", "yaml", "text", "console", "diff"}, page
        outside = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
        assert not re.search(r"\n\n    \S", outside), page
