"""Engines that come with the package and run in processes of their own: each where its library is installed."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import crossgait

ROOT = Path(__file__).resolve().parents[2]
LIBRARIES = {
    "drake": "pydrake",
    "drake_hydroelastic": "pydrake",
    "drake_tamsi": "pydrake",
    "mujoco_warp": "mujoco_warp",
    "newton": "newton",
    "newton_kamino": "newton",
}
EXTRAS = {"pydrake": "drake", "mujoco_warp": "mujoco-warp", "newton": "newton"}


def is_missing(name):
    return importlib.util.find_spec(LIBRARIES[name]) is None


def marked(*names):
    return [
        pytest.param(
            f"python:{name}",
            id=name,
            marks=pytest.mark.skipif(is_missing(name), reason=f"{LIBRARIES[name]} is not installed"),
        )
        for name in names
    ]


@pytest.fixture(autouse=True)
def _this_python(monkeypatch):
    monkeypatch.setenv("CROSSGAIT_PYTHON", sys.executable)
    monkeypatch.setenv("CROSSGAIT_ENGINE_TIMEOUT", "600")  # Warp compiles what it has not compiled before


def stand(world, steps, robot="serial_quadruped"):
    home = [world.state.q[i] for i in crossgait.Robot.load(robot).servo_indices]
    assert world.step(home, steps) == "ok"


@pytest.mark.parametrize("engine", marked(*LIBRARIES))
def test_it_stands_and_goes_on_to_the_same_bits(engine):
    world = crossgait.World("serial_quadruped", engine=engine)
    stand(world, 40)
    feet = world.foot_contacts
    assert all(foot.touching for foot in feet)
    assert sum(contact.force[2] for contact in world.contacts) > 0.2 * 9.81 * 5  # it falls into its servos yet
    saved = world.save()
    stand(world, 10)
    goes_on = world.state.qpos.tobytes()
    world.restore(saved)
    stand(world, 10)
    assert world.state.qpos.tobytes() == goes_on
    world.reset()  # with contacts to forget
    stand(world, 40)
    assert world.save().state.qpos.tobytes() == saved.state.qpos.tobytes()


@pytest.mark.parametrize("engine", marked("drake", "drake_hydroelastic", "mujoco_warp", "newton"))
def test_robots_with_loops_go_on_to_the_same_bits(engine):
    world = crossgait.World("scara_quadruped", engine=engine)
    stand(world, 20, "scara_quadruped")
    saved = world.save()
    stand(world, 5, "scara_quadruped")
    goes_on = world.state.qpos.tobytes()
    world.restore(saved)
    stand(world, 5, "scara_quadruped")
    assert world.state.qpos.tobytes() == goes_on


@pytest.mark.parametrize("engine", marked("mujoco_warp", "newton", "newton_kamino"))
def test_it_holds_the_robots_inertia_and_poses(engine):
    world = crossgait.World("scara_quadruped", engine=engine)
    by_hand = crossgait.World("scara_quadruped", engine=crossgait.available_engines()[0])
    for body in range(len(world.state.q) + 1):
        assert world.body_pose(body) == pytest.approx(by_hand.body_pose(body), abs=1e-5)
    M = by_hand.mass_matrix()
    assert abs(world.mass_matrix() - M).max() < 1e-5 * abs(M).max()


@pytest.mark.parametrize("engine", marked("mujoco_warp"))
@pytest.mark.parametrize("terrain", ["flat", "rough"])
def test_mujoco_warp_follows_mujoco(engine, terrain):
    if "mujoco" not in crossgait.available_engines():
        pytest.skip("without MuJoCo among the engines there is nothing to hold it against")
    worlds = [crossgait.World("serial_quadruped", terrain, engine=name) for name in ("mujoco", engine)]
    for _ in range(4):
        for world in worlds:
            stand(world, 25)
        here, there = (world.state for world in worlds)
        # Rounding of 100 steps in float32; forces that differ by a thousandth move it a hundred times as far.
        assert np.abs(here.qpos - there.qpos).max() < 1e-5


@pytest.mark.parametrize("engine", marked("newton_kamino"))
def test_kamino_refuses_coupled_joints(engine, tmp_path):
    text = (ROOT / "models/robots/serial_quadruped/robot.urdf").read_text()
    knee = text.index("</joint>", text.index('<joint name="FL_knee"'))
    robot = tmp_path / "robot.urdf"
    robot.write_text(f'{text[:knee]}<mimic joint="FL_hip_pitch" multiplier="-2"/>{text[knee:]}')
    with pytest.raises(crossgait.ConfigError, match="Kamino has no coupled joints"):
        crossgait.World(crossgait.Robot.load(robot), engine=engine)


@pytest.mark.parametrize("engine", marked("drake_tamsi"))
def test_tamsi_refuses_loops(engine):
    with pytest.raises(crossgait.ConfigError, match="TAMSI has no loops"):
        crossgait.World("scara_quadruped", engine=engine)


@pytest.mark.parametrize("engine", marked("drake", "drake_tamsi"))
def test_point_contact_refuses_fields(engine):
    with pytest.raises(crossgait.ConfigError, match="takes the plane alone"):
        crossgait.World("serial_quadruped", "rough", engine=engine)


def load_of_sphere(radius, depth, modulus=1e7):
    """N, on a compliant sphere whose pressure grows from its surface to the modulus at its centre, in rigid ground."""
    c = radius - depth
    return 2 * np.pi * modulus * ((radius**2 - c**2) / 2 - (radius**3 - c**3) / (3 * radius))


@pytest.mark.parametrize("engine", marked("drake_hydroelastic"))
@pytest.mark.parametrize("terrain", ["flat", "slope:angle=0,size_x=2,size_y=2,cell=0.05"])
def test_hydroelastic_feet_sink_by_their_pressure(engine, terrain):
    world = crossgait.World("serial_quadruped", terrain, engine=engine)
    stand(world, 600)
    shapes = crossgait.Robot.load("serial_quadruped").collisions
    radius = next(shape["size"][0] for shape in shapes if shape["type"] == "sphere")
    feet = world.contacts
    assert len(feet) == 4
    for foot in feet:
        # Feet are polyhedra, whose surface is 4 % of this depth inside the sphere's: of a depth's square 8 %.
        assert foot.force[2] == pytest.approx(load_of_sphere(radius, -foot.distance), rel=0.12)
        assert foot.normal == pytest.approx([0, 0, 1], abs=1e-12)


@pytest.mark.parametrize("engine", marked("drake_hydroelastic"))
def test_hydroelastic_feet_stand_on_a_slope(engine):
    world = crossgait.World("serial_quadruped", "slope:angle=5,heading=30,size_x=2,size_y=2,cell=0.05", engine=engine)
    stand(world, 200)
    away = np.radians(30)
    uphill = np.sin(np.radians(5)) * np.array([np.cos(away), np.sin(away)])
    on_the_slope = [foot for foot in world.contacts if np.hypot(*foot.p_WP[:2]) > 0.1]
    assert len(on_the_slope) >= 3  # one may be light
    for foot in on_the_slope:
        assert np.abs(foot.normal[:2]) == pytest.approx(np.abs(uphill), abs=1e-6)


@pytest.mark.parametrize("name", LIBRARIES)
def test_a_missing_library_says_how_it_is_installed(name):
    library = LIBRARIES[name]
    program = f"import runpy, sys; sys.modules['{library}'] = None; runpy.run_module('crossgait.engines.{name}')"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert re.search(rf"need {library}[.\w]*: pip install 'crossgait\[{EXTRAS[library]}\]'", done.stderr)
