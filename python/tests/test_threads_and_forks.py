"""Objects that two threads want at once, that a fork inherits, or that were closed."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import crossgait
from crossgait import _core

gymnasium = pytest.importorskip("gymnasium")
ENGINES = crossgait.available_engines()


def clash(work: Callable[[], Any], other: Callable[[], Any]) -> list[str]:
    """What `other` raises while a thread works, again and again, until it was refused."""
    raised: list[str] = []
    ended = threading.Event()

    def go_on() -> None:
        while not ended.is_set():
            try:
                work()
            except RuntimeError as error:  # of both one is refused, whichever comes second
                raised.append(str(error))

    thread = threading.Thread(target=go_on)
    thread.start()
    try:
        until = time.monotonic() + 60
        while not raised and time.monotonic() < until:
            try:
                other()
            except RuntimeError as error:
                raised.append(str(error))
    finally:
        ended.set()
        thread.join()
    return raised


@pytest.mark.parametrize("engine", ENGINES)
def test_two_threads_in_one_world(engine: str) -> None:
    robot = crossgait.Robot.load("scara_quadruped")
    world = crossgait.World(robot, engine=engine)
    targets = np.zeros(len(robot.servos))
    for other in (lambda: world.step(targets, 200), lambda: world.state, lambda: world.contacts, world.save):
        raised = clash(lambda: world.step(targets, 200), other)
        assert raised
        assert "another thread is at work" in raised[0]
    assert world.step(targets) in ("ok", "diverged")  # and afterwards it is whole


def test_two_threads_in_one_environment() -> None:
    environment = _core.Environment(_core.EnvironmentConfig.parse("{episode_seconds: 1000}"))
    environment.reset(1)
    action = np.zeros(len(environment.action_layout))
    for other in (lambda: environment.step(action), lambda: environment.reset(2), lambda: environment.info):
        raised = clash(lambda: environment.step(action), other)
        assert raised
        assert "another thread is at work" in raised[0]


def test_two_threads_in_one_vector_environment() -> None:
    environments = _core.VectorEnvironment(_core.EnvironmentConfig(), 4, workers=2)
    environments.reset(1)
    view = environments.environment(0)
    actions = np.zeros((4, len(environments.action_layout)))
    for other in (lambda: environments.step(actions), lambda: environments.infos(), lambda: view.state):
        raised = clash(lambda: environments.step(actions), other)
        assert raised
        assert "another thread is at work" in raised[0]


FORK = """
import os, sys, numpy as np, crossgait
from crossgait import _core
environments = _core.VectorEnvironment(_core.EnvironmentConfig(), 4, workers=2)
environments.reset(1)
actions = np.zeros((4, len(environments.action_layout)))
environments.step(actions)
child = os.fork()
if child == 0:
    try:
        environments.step(actions)
    except RuntimeError as error:
        assert "fork" in str(error), error
        own = _core.VectorEnvironment(_core.EnvironmentConfig(), 4, workers=2)
        own.reset(1)
        del environments
        sys.exit(0)
    sys.exit(1)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
environments.step(actions)
"""


def test_a_vector_environment_says_that_it_is_in_a_fork() -> None:
    subprocess.run([sys.executable, "-W", "ignore", "-c", FORK], check=True, timeout=120)


FORKS = """
import os, threading, time, crossgait
config = crossgait.EnvironmentConfig(episode_seconds=0.04)
at_work = [True]
crossgait.rollout("zero", config, episodes=1)  # what is made once, when it is first needed

def work():
    while at_work:
        crossgait.rollout("zero", config, episodes=1)

thread = threading.Thread(target=work)
thread.start()
try:
    for _ in range(60):
        time.sleep(0.01)
        child = os.fork()
        if child == 0:
            crossgait.rollout("zero", config, episodes=1)
            os._exit(0)
        until = time.monotonic() + 20
        while (ended := os.waitpid(child, os.WNOHANG)) == (0, 0) and time.monotonic() < until:
            time.sleep(0.01)
        if ended == (0, 0):
            os.kill(child, 9)
        assert ended == (child, 0), ended
finally:
    at_work.clear()
    thread.join()
"""


def test_a_fork_works_whatever_another_thread_does() -> None:
    subprocess.run([sys.executable, "-W", "ignore", "-c", FORKS], check=True, timeout=240)


def test_a_million_environments_are_refused() -> None:
    with pytest.raises(crossgait.ConfigError, match="at most 100000"):
        _core.VectorEnvironment(_core.EnvironmentConfig(), 1_000_000)


# A child of what runs in the background would ignore the signal.
BEGIN = """
import signal, crossgait, numpy as np
from crossgait import _core
signal.signal(signal.SIGINT, signal.default_int_handler)
robot = crossgait.Robot.load("scara_quadruped")
leg = crossgait.legs(robot)["FL"]
"""
LONG = {
    "environments": "_core.VectorEnvironment(_core.EnvironmentConfig(), 100_000)",
    "steps": "crossgait.World(robot).step(np.zeros(len(robot.servos)), 10**9)",
    "inverse": "leg.inverse(np.zeros((10**7, 3)))",
    "forward": "leg.forward(np.zeros((10**7, len(leg.servos))) + leg.inverse([0.0, 0.0, -0.1])[0])",
}


@pytest.mark.parametrize("what", LONG)
def test_what_takes_long_can_be_interrupted(what: str) -> None:
    text = f"{BEGIN}print('now', flush=True)\n{LONG[what]}"
    making = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert making.stdout is not None
    assert making.stdout.readline() == "now\n"
    time.sleep(0.3)
    making.send_signal(signal.SIGINT)
    _, errors = making.communicate(timeout=60)
    assert "KeyboardInterrupt" in errors


def test_an_interrupted_world_is_whole() -> None:
    robot = crossgait.Robot.load("scara_quadruped")
    world, targets = crossgait.World(robot), np.zeros(len(robot.servos))

    def end(number: int, frame: Any) -> None:
        raise InterruptedError

    before = signal.signal(signal.SIGALRM, end)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    try:
        with pytest.raises(InterruptedError):
            world.step(targets, 10**9)
    finally:
        signal.signal(signal.SIGALRM, before)
    again = crossgait.World(robot)
    again.step(targets, round(world.state.time / world.physics_dt))
    assert (again.state.qpos == world.state.qpos).all()  # in pieces or not
    assert world.step(targets) == "ok"


def test_calls_that_nothing_interrupts_are_bounded() -> None:
    for text in ("{policy_dt: 1000, physics_dt: 1.0e-6, episode_seconds: 1000}", "{settle_seconds: 1000}"):
        with pytest.raises(crossgait.ConfigError, match="at most 100000 physics steps"):
            _core.Environment(_core.EnvironmentConfig.parse(text))
    leg = crossgait.legs(crossgait.Robot.load("scara_quadruped"))["FL"]
    with pytest.raises(crossgait.ConfigError, match="at most 1000000"):
        leg.workspace((600, 600, 600))


def test_what_was_closed_says_so() -> None:
    from crossgait.envs import AdaptiveGaitEnv, AdaptiveGaitVectorEnv

    vector, single = AdaptiveGaitVectorEnv(num_envs=2), AdaptiveGaitEnv()
    for each in (vector, single):
        each.reset(seed=1)
        action = each.action_space.sample()
        each.step(action)
        each.close()
        each.close()
        for call in (lambda each=each: each.reset(seed=1), lambda each=each, action=action: each.step(action)):
            with pytest.raises(gymnasium.error.ClosedEnvironmentError, match="was closed"):
                call()
