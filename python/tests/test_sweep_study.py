"""What a study's file spans, and what is wrong with it."""

from __future__ import annotations

from pathlib import Path

import pytest
from sweep_studies import SHORT, study

import crossgait
from crossgait import ConfigError, _core
from crossgait.sweep import Study, row_of

pytest.importorskip("yaml")
ENGINES = crossgait.available_engines()


def test_a_grid_is_the_product_of_its_lists(tmp_path: Path) -> None:
    runs = study(
        tmp_path,
        """
starts: [0, 7]
seeds: [1, 2, 3]
walks:
  - gait: [trot, walk]
    command: [[0.2, 0, 0], [0.3, 0, 0.1], null]
    parameters: {step_height: [0.02, 0.03], cycle_time: 0.5}
  - terrain: [rough, "rough:amplitude=.01"]
    terminations: [[fell], [fell, collapsed]]
    command: [0.2, 0, 0]
""",
    ).runs()
    assert len(runs) == (2 * 3 * 2 + 2 * 2) * 3 * 2 * len(ENGINES)
    assert len({run.hash for run in runs}) == len(runs)
    assert [run.start for run in runs[:4]] == [0, 7, 0, 7]


def test_the_documents_study_is_one(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs/sweeps.md").read_text()
    text = page.split("```yaml\n")[1].split("```")[0].replace("[mujoco, bullet]", f"[{ENGINES[0]}]")
    text = text.replace("trained.safetensors", "random")  # nobody has trained it
    (tmp_path / "environment.yaml").write_text("{policy_dt: .02}")
    assert len(study(tmp_path, text).runs()) == (2 * 2 * 2 * 2 + 2 * 2) * 12


def test_runs_that_are_said_twice_are_one(tmp_path: Path) -> None:
    text = "engines: [ENGINE]\nwalks:\n  - {gait: trot}\n  - {gait: [trot, trot], terrain: flat}\n".replace(
        "ENGINE", ENGINES[0]
    )
    assert len(study(tmp_path, text).runs()) == 1


def test_a_study_with_every_default_is_the_same_study(tmp_path: Path) -> None:
    text = (
        "starts: 2\nvariations: all\nwalks: [{}]\npolicies: [{set: {terrain: [flat, rough], episode_seconds: 1e0}}]\n"
    )
    first = study(tmp_path, text)
    stated = study(tmp_path, first.to_yaml())
    assert stated.document == first.document
    assert [run.hash for run in stated.runs()] == [run.hash for run in first.runs()]
    assert set(first.document["walks"][0]) >= {
        "robot",
        "terrain",
        "gait",
        "command",
        "parameters",
        "seconds",
        "terminations",
    }


def test_policies_are_run_in_environments_with_changes(tmp_path: Path) -> None:
    (tmp_path / "env.yaml").write_text("{policy_dt: .02, terrain: rough}")
    runs = study(
        tmp_path,
        """
engines: [ENGINE]
policies:
  - environment: env.yaml
    set: {friction: [0.4, 0.6], episode_seconds: 0.2, adapt: [[step_length], [step_length, step_height]]}
    policy: [zero, random]
""".replace("ENGINE", ENGINES[0]),
    ).runs()
    assert len(runs) == 8
    assert '"result":{' in row_of(runs[0])
    assert "terrain: 'rough'" in runs[0].subject.environment


def test_policies_environments_and_engines_go_by_name(tmp_path: Path) -> None:
    folder = Path(crossgait.models_dir()) / "policies/serial_joints"

    def made(block: str) -> tuple[str, str]:
        (run,) = study(
            tmp_path, f"engines: '{ENGINES[0]}'\npolicies: [{{{block}, set: {{episode_seconds: 0.2}}}}]\n"
        ).runs()
        return run.hash, run.subject.environment

    hashed, environment = made("policy: serial_joints")
    assert "serial_quadruped" in environment  # its own
    file, beside = folder / "serial_joints.safetensors", folder / "environment.yaml"
    for block in (
        f"policy: '{folder}'",
        f"policy: '{file}'",
        f"policy: '{file}', environment: '{beside}'",
        "policy: serial_joints, environment: serial_joints",
    ):
        assert made(block) == (hashed, environment)
    assert made("policy: zero, environment: serial_joints")[1] == environment
    assert "terrain: 'rough'" in made("policy: zero, environment: {terrain: rough}")[1]
    assert "scara_quadruped" in made("policy: zero")[1]
    (tmp_path / "alone.safetensors").write_bytes(file.read_bytes())
    with pytest.raises(ConfigError, match=r"policies\[0\], .*safetensors: environment: expected environment=, or"):
        made("policy: alone.safetensors")
    two = ENGINES[:2]
    assert study(tmp_path, f"engines: '{', '.join(two)}'\nwalks: [{{}}]\n").document["engines"] == two


def test_files_are_found_from_the_studys_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    heights = "0,0,0,0\n" * 4
    (tmp_path / "ground.csv").write_text(heights)
    text = "engines: [ENGINE]\nwalks: [{terrain: 'ground.csv', seconds: 0.1}]\n".replace("ENGINE", ENGINES[0])
    path = tmp_path / "study.yaml"
    path.write_text(text)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    (run,) = Study.load(path).runs()
    moved = tmp_path / "moved"
    moved.mkdir()
    for name in ("study.yaml", "ground.csv"):
        (tmp_path / name).rename(moved / name)
    (again,) = Study.load(moved / "study.yaml").runs()
    assert again.hash == run.hash  # a file counts by its contents
    (moved / "ground.csv").write_text(heights.replace("0,0\n", "0,.01\n"))
    (other,) = Study.load(moved / "study.yaml").runs()
    assert other.hash != run.hash


def test_variations_that_do_not_concern_an_engine_are_left_out(tmp_path: Path, engine: str) -> None:
    text = f"engines: [{engine}]\nvariations: all\nwalks: [{{physics_dt: 0.002, control_dt: 0.002}}]\n"
    names = [run.variation for run in study(tmp_path, text).runs()]
    assert names[:3] == _core._variations()[:3] == ["as asked", "half the time step", "a quarter of the time step"]
    sweeps = any(e.name == engine and "sweeps" in e.laws["contact"] for e in _core.engines())
    assert ("a tenth of the sweeps" in names) == sweeps
    soft = any(e.name == engine and e.laws["contact"] == "mujoco" for e in _core.engines())
    assert ("ten times the impratio" in names) == soft
    assert ("twice the error reduction" in names) == (engine in ("bullet", "dart"))


@pytest.mark.parametrize(
    ("text", "element", "expected"),
    [
        ("", "study", "walks"),
        ("[1]", "study", "keys"),
        ("walks: [{gait: trot}]\nseed: 3", "seed", "one of the keys engines"),
        ("walks: [{gate: trot}]", "walks[0].gate", "one of the keys robot"),
        ("walks: [{seconds: long}]", "walks[0].seconds", "finite number"),
        ("walks: [{seconds: [1, .nan]}]", "walks[0].seconds[1]", "finite number"),
        ("walks: [{seconds: []}]", "walks[0].seconds", "list"),
        ("walks: [{compensation: 1}]", "walks[0].compensation", "true or false"),
        ("walks: [{command: [1, 2]}]", "walks[0].command", "yaw rate"),
        ("walks: [{parameters: {step_height: [true]}}]", "walks[0].parameters.step_height[0]", "number"),
        ("walks: [{parameters: [3]}]", "walks[0].parameters[0]", "keys"),
        ("walks: {gait: trot}", "walks", "list of blocks"),
        ("walks: [{gait: trott}]", "walks[0], ", "trot"),
        ("walks: [{terrain: lava}]", "walks[0], ", "flat"),
        ("walks: [{robot: nobody}]", "walks[0], ", "scara_quadruped"),
        ("walks: [{parameters: {step_hight: 1}}]", "walks[0], ", ""),
        ("walks: [{}]\nengines: [ode]", "engines", ENGINES[0]),
        ("walks: [{}]\nvariations: some", "variations", "as asked"),
        ("walks: [{}]\nstarts: 0", "starts", "how many"),
        ("walks: [{}]\nstarts: [-1]", "starts[0]", "whole number"),
        ("walks: [{}]\nseeds: 1.5", "seeds", "whole number"),
        ("walks: [{}]\nstart_ranges: {heading: 1}", "start_ranges.heading", "one of"),
        ("walks: [{}]\nstart_ranges: {heading_rad: null}", "start_ranges.heading_rad", "finite"),
        ("walks: [{}]\nstart_ranges: {push_mps: -1}", "start_ranges.push_mps", "not negative"),
        ("policies: [{policy: nowhere.yaml}]", "policies[0].policy", "policy's file"),
        ("policies: [{environment: nowhere.yaml}]", "policies[0], ", ""),
        ("policies: [{set: {frction: 1}}]", "policies[0], ", ""),
        ("walks: [{gait: trot, gait: walk}]", "line 1", "YAML"),
        ("walks: [", "line 1", "YAML"),
        ("walks: !!python/object:os.system [{}]", "line 1", "YAML"),
    ],
)
def test_what_is_wrong_with_a_study_is_said(tmp_path: Path, text: str, element: str, expected: str) -> None:
    with pytest.raises(ConfigError) as caught:
        study(tmp_path, text).runs()
    error = caught.value
    assert error.source == str(tmp_path / "study.yaml")
    assert error.element.startswith(element)
    assert expected in error.expected
    assert error.found


def test_a_missing_study_is_said(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="readable"):
        Study.load(tmp_path / "none.yaml")


def test_numbers_are_those_of_yaml_1_2(tmp_path: Path) -> None:
    text = SHORT.format(engine=ENGINES[0]).replace("0.2\n", "2e-1\n")
    hashes = [run.hash for run in study(tmp_path, text).runs()]
    assert hashes == [run.hash for run in study(tmp_path, SHORT.format(engine=ENGINES[0])).runs()]


def test_a_grid_is_counted_before_it_is_made(tmp_path: Path) -> None:
    counted = study(
        tmp_path, "starts: 3\nseeds: [0, 1]\nwalks: [{gait: [trot, walk], parameters: {step_height: [0.02, 0.03]}}]"
    )
    assert counted.count() == len(counted.runs())
    wide = ", ".join(f"{0.02 + 1e-6 * i}" for i in range(1000))
    for text in (
        "starts: 1000000000000\nwalks: [{}]",
        "starts: 1000\nseeds: [0, 1]\nwalks: [{seconds: 2000}, {seconds: 1000}]",
        f"walks: [{{parameters: {{step_height: [{wide}], step_length: [{wide}], body_height: [{wide}]}}}}]",
        f"policies: [{{set: {{friction: [{wide}], physics_dt: [{wide}], seconds: [{wide}]}}}}]",
    ):
        if "starts: 1000\n" in text:
            assert study(tmp_path, text).count() == 4000 * len(crossgait.available_engines())
            continue
        with pytest.raises(ConfigError, match="at most 1000000 runs"):
            study(tmp_path, text)
