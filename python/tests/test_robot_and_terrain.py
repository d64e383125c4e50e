from __future__ import annotations

import gc
import pickle
import shutil
from pathlib import Path

import numpy as np
import pytest

import crossgait
from crossgait import ConfigError, EnvironmentConfig, Robot, Terrain, _core


@pytest.mark.parametrize("name", crossgait.robots())
def test_bundled_robots(name: str) -> None:
    robot = Robot.load(name)
    assert robot.name == name
    assert robot.mass_kg > 0
    assert [robot.joints[i] for i in robot.servo_indices] == robot.servos
    assert robot.home.shape == (len(robot.joints),)
    assert {shape["body"] for shape in robot.visuals} <= set(range(len(robot.bodies)))
    assert robot.collisions


def test_a_urdf_is_inferred_and_its_yaml_infers_nothing(tmp_path: Path) -> None:
    folder = Path(crossgait.models_dir()) / "robots" / "serial_quadruped"
    urdf = next(folder.glob("*.urdf"))
    bare = tmp_path / urdf.name
    bare.write_text(urdf.read_text())
    robot = Robot.load(bare)
    assert robot.inferred
    assert all(what and value and reason for what, value, reason in robot.inferred)
    (tmp_path / "robot.yaml").write_text(robot.to_yaml())
    stated = Robot.load(tmp_path / "robot.yaml")
    assert stated.inferred == []
    assert np.allclose(stated.home, robot.home, atol=1e-15)  # a file's last digit


def xacro_of(urdf: Path, folder: Path) -> Path:
    """The robot as a xacro with an argument, whose legs are in a file of the package `walker`."""
    pytest.importorskip("xacro")
    begin = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="serial_quadruped">'
    trunk, legs = urdf.read_text().split('<joint name="FL_abduction"')
    trunk = trunk.replace('<robot name="serial_quadruped">', begin + '<xacro:arg name="mass" default="5.2"/>')
    (folder / "walker").mkdir()
    (folder / "walker" / "legs.xacro").write_text(f'{begin}<joint name="FL_abduction"{legs}')
    file = folder / "robot.urdf.xacro"
    file.write_text(
        trunk.replace('<mass value="5.2"/>', '<mass value="${float($(arg mass)) * 1}"/>')
        + '<xacro:include filename="$(find walker)/legs.xacro"/></robot>'
    )
    return file


def test_a_xacro_is_expanded(tmp_path: Path) -> None:
    urdf = next((Path(crossgait.models_dir()) / "robots" / "serial_quadruped").glob("*.urdf"))
    file = xacro_of(urdf, tmp_path)
    shutil.copy(urdf, tmp_path / "robot.urdf")
    plain = Robot.load(tmp_path / "robot.urdf")
    robot = Robot.load(file)
    assert robot.mass_kg == pytest.approx(plain.mass_kg, rel=1e-15)
    assert robot.joints == plain.joints
    assert np.array_equal(robot.home, plain.home)
    (tmp_path / "heavy.yaml").write_text("xacro: robot.urdf.xacro\nxacro_args: {mass: 7.2}\n")
    heavy = Robot.load(tmp_path / "heavy.yaml")
    assert heavy.mass_kg == pytest.approx(plain.mass_kg + 2, rel=1e-15)
    assert "xacro_args: {'mass': '7.2'}" in heavy.to_yaml().replace('"', "'")
    file.write_text(file.read_text().replace("$(arg mass)", "$(arg mess)"))
    with pytest.raises(ConfigError) as caught:
        Robot.load(file)
    assert caught.value.source == str(file)
    assert "mess" in caught.value.found


def test_no_file_runs_code_without_consent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CROSSGAIT_TRUST")
    file = tmp_path / "robot.xacro"
    file.write_text("<robot/>")
    with pytest.raises(ConfigError, match="outside the current folder"):
        Robot.load(file)
    with pytest.raises(ConfigError, match="expected a folder"):
        crossgait.trust(file)


def test_a_missing_robot_says_what_there_is() -> None:
    with pytest.raises(ConfigError) as caught:
        Robot.load("dog")
    assert "scara_quadruped" in caught.value.expected
    assert str(caught.value) == (
        f"{caught.value.source}: {caught.value.element}: expected {caught.value.expected}, found {caught.value.found}"
    )
    assert isinstance(caught.value, ValueError)


def test_the_plane_has_no_heights() -> None:
    flat = Terrain()
    assert flat.heights is None
    assert flat.size is None
    assert np.array_equal(flat.height(np.array([0.0, 5.0]), np.array([1.0, -2.0])), [0, 0])


def test_heights_are_a_view_that_keeps_the_terrain() -> None:
    heights = Terrain("rough", seed=3).heights
    gc.collect()
    assert heights is not None
    again = Terrain("rough", seed=3).heights
    assert again is not None
    assert np.array_equal(heights, again)
    assert not heights.flags.writeable
    other = Terrain("rough", seed=4).heights
    assert other is not None
    assert not np.array_equal(heights, other)


def test_a_terrain_of_an_array() -> None:
    heights = np.zeros((3, 5), dtype=np.float32)
    heights[:, 4] = 0.5  # rises towards +x
    terrain = Terrain.from_heights(heights, size_x=4, size_y=2)
    assert terrain.size == (4, 2)
    x = np.array([-2.0, 1.0, 1.5, 2.0])
    assert np.allclose(terrain.height(x, np.zeros(4)), [0, 0, 0.25, 0.5])
    kept = terrain.heights
    assert kept is not None
    assert np.array_equal(kept, heights)
    heights[0, 0] = 9
    assert kept[0, 0] == 0


def test_bad_terrains_are_refused() -> None:
    with pytest.raises(ConfigError, match="roug"):
        Terrain("roug")
    with pytest.raises(ConfigError):
        Terrain.from_heights(np.full((2, 2), np.nan, dtype=np.float32), size_x=1, size_y=1)
    with pytest.raises(ConfigError):
        Terrain.from_heights(np.zeros((2, 2), dtype=np.float32), size_x=-1, size_y=1)
    with pytest.raises(ConfigError, match="as many"):
        Terrain().height(np.zeros(2), np.zeros(3))


def test_names_of_files_do_nothing_to_a_terminal(tmp_path: Path) -> None:
    file = tmp_path / "ev\x1b[31mIL\n.csv"
    file.write_text("0,0\n0,.001\n")
    shown = repr(crossgait.Terrain(str(file)))
    assert "\\x1b[31mIL\\n" in shown
    assert shown.isprintable()


def test_a_robot_is_pickled_by_its_file_and_refused_once_that_changes(tmp_path: Path) -> None:
    robot = Robot.load("serial_quadruped")
    assert pickle.loads(pickle.dumps(robot)).to_yaml() == robot.to_yaml()
    for name in ("robot.urdf", "robot.yaml"):
        shutil.copy(Path(crossgait.models_dir(), "robots/serial_quadruped", name), tmp_path / name)
    kept = pickle.dumps(Robot.load(tmp_path / "robot.yaml"))
    urdf = tmp_path / "robot.urdf"
    urdf.write_text(urdf.read_text().replace('<mass value="5.2"/>', '<mass value="5.3"/>'))
    with pytest.raises(ConfigError, match="its file has changed"):
        pickle.loads(kept)
    changed = _core.Environment(EnvironmentConfig(action="joints", servos={"kp": 7.5})).robot
    with pytest.raises(ConfigError, match="an environment has set servos"):
        pickle.dumps(changed)
