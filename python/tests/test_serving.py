"""Engines that Python files serve: they run by name, and what they do wrong names the file and the line."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import crossgait

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "engines" / "hard_contact.py"

FALLING = """
import crossgait, numpy as np

class Falling:
    def __init__(self, world):
        self.h, self.g = world.physics_dt, world.gravity
        {refusal}
    def reset(self, state):
        self.now = state
    def step(self, torques, force, torque):
        {fault}
        v = self.now.v_WB + self.h * self.g
        self.now = self.now._replace(p_WB=self.now.p_WB + self.h * v, v_WB=v)
    def state(self):
        return self.now
    {method}

crossgait.serve_engine(Falling, library="Falling", laws={{"contact": "none"}})
"""


@pytest.fixture
def served(tmp_path, monkeypatch):
    """Write a file that serves and return its name as an engine."""
    monkeypatch.setenv("CROSSGAIT_PYTHON", sys.executable)
    monkeypatch.setenv("CROSSGAIT_TRUST", str(tmp_path))

    def write(fault="pass", refusal="pass", method="pass"):
        file = tmp_path / f"engine{len(list(tmp_path.iterdir()))}.py"
        file.write_text(FALLING.format(fault=fault, refusal=refusal, method=method))
        return f"python:{file}"

    return write


HANG = "if self.now.v_WB[2] < -0.5: import time; open(__file__ + '.hangs', 'w'); time.sleep(1000)"
WAITS = {
    "world": "crossgait.World('serial_quadruped', engine=engine).step([0.0] * 12, 10**6)",
    "walk": "crossgait.walk('trot', robot='serial_quadruped', engine=engine, seconds=60)",
    "environments": """
from crossgait import _core
import numpy as np
envs = _core.VectorEnvironment(_core.EnvironmentConfig.parse("{robot: serial_quadruped}"), 4, engine=engine, workers=2)
envs.reset(1)
while True:
    envs.step(np.zeros((4, len(envs.action_layout))))
""",
}


@pytest.mark.parametrize("what", WAITS)
def test_an_engine_that_hangs_can_be_interrupted(served, what, monkeypatch):
    monkeypatch.setenv("CROSSGAIT_ENGINE_TIMEOUT", "3600")
    program = f"""
import os, signal, threading, time, crossgait
signal.signal(signal.SIGINT, signal.default_int_handler)  # also where a shell has it ignored
engine, begin = {served(fault=HANG)!r}, []

def interrupt():
    while not os.path.exists(engine.removeprefix("python:") + ".hangs"):
        time.sleep(0.01)
    begin.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=interrupt, daemon=True).start()
try:
    {WAITS[what].strip().replace(chr(10), chr(10) + "    ")}
except KeyboardInterrupt:
    print(time.monotonic() - begin[0])
print(crossgait.walk("trot", seconds=.1).outcome, time.monotonic() - begin[0])
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300, check=False)
    assert len(done.stderr.splitlines()) == 1, done.stderr  # that the file runs
    seconds, outcome, next_one = done.stdout.split()
    assert float(seconds) < 20  # 1 s on an idle machine
    assert float(next_one) < 40
    assert outcome == "walked"


def test_a_class_of_three_methods_is_an_engine(served):
    world = crossgait.World("serial_quadruped", engine=served())
    z, h = world.state.p_WB[2], world.physics_dt
    assert world.step(world.state.q[:12], 10) == "ok"
    assert world.state.p_WB[2] - z == pytest.approx(-9.81 * h * h * 10 * 11 / 2, abs=1e-12)
    saved = world.save()
    before = world.state
    world.step([0.0] * 12)
    world.restore(saved)
    assert (world.state.qpos == before.qpos).all()
    assert world.mass_matrix().shape == (18, 18)  # the description's, where the engine says none


@pytest.mark.parametrize(
    ("fault", "says"),
    [
        (
            {"fault": "raise ValueError('no such thing')"},
            "step: expected an answer, found ValueError: no such",
        ),
        (
            {"fault": "self.now = self.now._replace(q=np.zeros(3))"},
            "q: expected 12 numbers, found an array of shape (3,)",
        ),
        (
            {"refusal": "raise ValueError('no quadrupeds')"},
            "the making of a world: expected an answer, found ValueError",
        ),
        ({"method": "def contacts(self): return [(0, 0, 1)]"}, "step: expected an answer, found ValueError"),
        ({"fault": "import sys; sys.exit('gone')"}, "found that it ended with exit code 1, after 'gone'"),
    ],
)
def test_what_goes_wrong_names_file_and_line(served, fault, says):
    engine = served(**fault)
    with pytest.raises(crossgait.ConfigError) as raised:
        crossgait.World("serial_quadruped", engine=engine).step([0.0] * 12)
    assert says in str(raised.value)
    assert raised.value.source == engine.removeprefix("python:")


def test_nan_is_a_divergence(served):
    world = crossgait.World(
        "serial_quadruped", engine=served("self.now = self.now._replace(p_WB=self.now.p_WB * np.nan)")
    )
    assert world.step([0.0] * 12) == "diverged"


@pytest.mark.parametrize(
    ("command", "of"),
    [
        ("walk --robot serial_quadruped --engine {} --seconds 60", "60500 steps of this walk"),
        ("verdict --robot serial_quadruped --engines mujoco,{} --seconds 5 --starts 12", "66000 steps of its starts"),
        (
            "rollout --robot serial_quadruped --engine {} --episode-seconds 30 --episodes 2",
            "61000 steps of these episodes",
        ),
        ("score serial_joints --engines {} --seconds 9.5 --starts 2", "77600 steps of the walks of serial_joints"),
    ],
)
def test_what_is_long_in_it_says_so_before_it_begins(served, command, of):
    slow = served("import time; time.sleep(.01)")
    arguments = [sys.executable, "-m", "crossgait", *command.format(slow).split()]
    with subprocess.Popen(arguments, stderr=subprocess.PIPE, text=True) as running:
        notes = [running.stderr.readline(), running.stderr.readline()]  # of consent, and this
        running.kill()
    assert re.search(rf"takes [\d.]+ ms a step: about [\d.]+ (min|h) for the {of}", notes[1])


def test_by_hand_it_says_what_it_is(served):
    done = subprocess.run(
        [sys.executable, served().removeprefix("python:")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert "crossgait conformance --engine python:engine0.py" in done.stderr


def test_the_example_stands_and_is_the_same_twice(monkeypatch):
    monkeypatch.setenv("CROSSGAIT_PYTHON", sys.executable)
    monkeypatch.setenv("CROSSGAIT_TRUST", str(EXAMPLE.parent))
    ends = []
    for _ in range(2):
        world = crossgait.World("serial_quadruped", engine=f"python:{EXAMPLE}")
        home = [world.state.q[i] for i in range(12)]
        world.step(home, 150)
        assert all(foot.touching for foot in world.foot_contacts)
        ends.append(world.state.qpos.tobytes())
    assert ends[0] == ends[1]
