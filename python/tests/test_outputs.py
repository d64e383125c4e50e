"""What commands and results write is nothing that was read, and each a file of its own."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

import crossgait
from crossgait.errors import ConfigError
from crossgait.files import check_outputs, noting_reads, read_bytes
from crossgait.sweep import __main__ as sweeping
from crossgait.train import __main__ as training
from crossgait.train import compare_policies

STUDY = "engines: [{engine}]\nwalks: [{{terrain: ground.csv, seconds: 0.1, settle: 0.1}}]\n"


def same(path: Path) -> Path:
    return path


def by_a_link(path: Path) -> Path:
    link = path.with_name("link")
    link.symlink_to(path.name)
    return link


def by_a_hard_link(path: Path) -> Path:
    link = path.with_name("hard")
    os.link(path, link)
    return link


def by_another_way(path: Path) -> Path:
    return path.parent / "." / ".." / path.parent.name / path.name


NAMES = [same, by_a_link, by_a_hard_link, by_another_way]


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.mark.parametrize("name", NAMES)
def test_outputs_are_told_from_inputs_by_what_they_are(name: Callable[[Path], Path], tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("old")
    with pytest.raises(ConfigError, match="--json: expected a file that is not read"):
        check_outputs([("--json", name(file))], [("FILE", file)])
    check_outputs([("--json", "-"), ("--sorted", None), ("a", "/dev/null"), ("b", "/dev/null")], [("FILE", "-")])


def test_outputs_are_told_from_each_other(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="--sorted: expected a file of its own"):
        check_outputs([("--json", tmp_path / "new"), ("--sorted", tmp_path / "." / "new")])


def test_what_the_core_reads_is_noted(tmp_path: Path) -> None:
    ground = tmp_path / "ground.csv"
    ground.write_text("0,0\n0,0\n")
    with noting_reads() as read:
        crossgait.Terrain(f"{ground}:size_x=2,size_y=2")
    assert str(ground) in [os.fspath(path) for _, path in read if path is not None]


def test_what_is_read_is_noted_by_all_that_are_open(tmp_path: Path) -> None:
    files = [tmp_path / name for name in ("inner", "outer")]
    for file in files:
        file.write_text("x")
    with noting_reads() as outer:
        with noting_reads() as inner:
            read_bytes(files[0], 10)
        read_bytes(files[1], 10)
    assert [path for _, path in inner] == [str(files[0])]
    assert [path for _, path in outer] == [str(file) for file in files]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("what", ["study.yaml", "study.jsonl", "ground.csv"])
@pytest.mark.parametrize("option", ["--json", "--sorted"])
def test_a_sweep_keeps_its_inputs(
    option: str, what: str, name: Callable[[Path], Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = tmp_path / "study.yaml"
    study.write_text(STUDY.format(engine=crossgait.available_engines()[0]))
    (tmp_path / "ground.csv").write_text("0,0\n0,0\n")
    (tmp_path / "study.jsonl").write_text("")
    output = name(tmp_path / what)
    before = contents(tmp_path)
    assert sweeping.main([str(study), option, str(output)]) == 2
    assert f"{option}: expected a file that is not read" in capsys.readouterr().err
    assert contents(tmp_path) == before


def test_a_sweep_writes_each_output_by_itself(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study = tmp_path / "study.yaml"
    study.write_text(f"engines: [{crossgait.available_engines()[0]}]\nwalks: [{{seconds: 0.1}}]\n")
    new = str(tmp_path / "new")
    assert sweeping.main([str(study), "--json", new, "--sorted", new]) == 2
    assert "a file of its own" in capsys.readouterr().err
    assert sweeping.main([str(study), "--runs", str(study)]) == 2
    assert study.read_text().startswith("engines")


def test_a_comparison_keeps_its_policies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    environment = tmp_path / "environment.yaml"
    environment.write_text("{}\n")
    for argument in (["zero", "--environment", str(environment)],):
        assert compare_policies.main([*argument, "--json", str(environment)]) == 2
        assert "--json: expected a file that is not read" in capsys.readouterr().err
    assert environment.read_text() == "{}\n"


def test_a_training_keeps_its_environment(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("stable_baselines3")
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "environment.yaml").write_text("friction: 0.5\n")
    plan = tmp_path / "plan.yaml"
    plan.write_text(f"environment: {folder / 'environment.yaml'}\n")
    code = training.main([str(plan), "--out", str(folder)])
    said = capsys.readouterr().err
    assert (code, "--out: expected a file that is not read" in said) == (2, True), said
    assert (folder / "environment.yaml").read_text() == "friction: 0.5\n"
    assert not (folder / "config.yaml").exists()


def test_a_result_is_not_saved_over_what_it_is_of(tmp_path: Path) -> None:
    ground = tmp_path / "ground.csv"
    ground.write_text("0,0,0\n0,0,0\n0,0,0\n")
    walked = crossgait.walk("trot", terrain=f"{ground}:size_x=4,size_y=4", seconds=0.1)
    with pytest.raises(ConfigError, match=r"which is .* of what was read"):
        walked.save(ground)
    assert ground.read_text().startswith("0,0,0")
    walked.save(tmp_path / "walk.json")
