"""docs/training.md and training-file.md: commands run, keys are all there, and what is trained beats the gait alone."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
import training

from crossgait.policies.environment import environment_of
from crossgait.sweep.strict_yaml import parse_yaml
from crossgait.train import Plan, presets
from crossgait.train.compare_policies import compare_policies
from crossgait.train.keys import TABLE

DOCUMENTS = Path(__file__).parents[2] / "docs"
PAGE = (DOCUMENTS / "training.md").read_text() + (DOCUMENTS / "training-file.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)


def first_column(heading: str) -> list[str]:
    section = PAGE.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    return [
        name for cell in re.findall(r"^\| (`.*?) \|", section, re.MULTILINE) for name in re.findall(r"`(.*?)`", cell)
    ]


@pytest.mark.long
def test_the_first_run_walks_half_as_fast_again_as_the_gait_alone(tmp_path: Path) -> None:
    """About half a minute of training on an idle machine, from a fixed seed; judged on ground that it has not seen."""
    (tmp_path / "first.yaml").write_text(blocks("yaml")[0])
    (commands,) = blocks("console")
    for line in commands.splitlines():
        program, *arguments = shlex.split(line)
        assert program == "python"
        training.done(arguments, tmp_path)
    assert (tmp_path / "first.mp4").stat().st_size > 1000
    best = str(tmp_path / "runs/first/best.safetensors")
    told = compare_policies([best, "zero"], environment_of([best], None), engines=["mujoco"], episodes=4, seed=77)
    learned, zero = (cell["all"] for cell in told["cells"])
    assert learned["mean_speed_mps"]["mean"] > 1.5 * zero["mean_speed_mps"]["mean"]
    assert learned["outcomes"]["fell"] == 0


@pytest.mark.long
def test_a_reward_of_ones_own_does_what_it_is_for(tmp_path: Path) -> None:
    """Half a minute each on an idle machine: feet that are charged for gliding glide less, at the same speed."""
    said = {}
    for weight in ("0", "-1.5"):
        example = DOCUMENTS.parent / "examples/11_train_your_reward.py"
        out, _ = training.done([str(example), "7200", weight], tmp_path)
        (row,) = (line for line in out.splitlines() if line.startswith(f"glide{weight}/best.safetensors"))
        said[weight] = [float(number) for number in row.split()[1:]]
        assert "policy best.safetensors on rough, 4 s: mujoco and bullet" in out
    (*_, speed, slip), (*_, speed_without, slip_without) = said["-1.5"], said["0"]
    assert slip < 0.9 * slip_without  # 0.68 and 0.79 of it with two seeds
    assert speed > 0.9 * speed_without  # 0.98 and 1.02


@pytest.mark.parametrize("block", blocks("yaml")[1:])
def test_parts_of_files_are_read(block: str) -> None:
    Plan.parse(training.small() | parse_yaml(block, "training.md"), "training.md")


def test_all_keys_and_presets_are_told() -> None:
    assert first_column("Keys") == list(TABLE)
    assert first_column("Presets") == presets()
    evaluation = TABLE["evaluation"]
    assert isinstance(evaluation, dict)
    (block,) = (b for b in blocks("yaml")[1:] if b.startswith("evaluation"))
    assert list(parse_yaml(block, "training.md")["evaluation"]) == list(evaluation)
