"""States, wrenches, Jacobians and parameters of environments and worlds, in every engine."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import crossgait
from crossgait import ConfigError, EnvironmentConfig, Robot, World, _core

CONFIG = EnvironmentConfig(action="joints", robot="serial_quadruped", settle_seconds=0.1, episode_seconds=1)


def free_in_mujoco(robot: Robot) -> mujoco.MjModel:
    """The robot's URDF with a free base and all of its bodies."""
    text = Path(crossgait.models_dir(), "robots", robot.source, "robot.urdf").read_text()
    free = (
        '<link name="nowhere"/><joint name="free" type="floating">'
        f'<parent link="nowhere"/><child link="{robot.bodies[0]}"/></joint></robot>'
    )
    return mujoco.MjModel.from_xml_string(text.replace("</robot>", free))


def vector(engine: str, environments: int = 3, **keys: Any) -> tuple[_core.VectorEnvironment, _core.Batch]:
    core = _core.VectorEnvironment(CONFIG, environments, engine=engine, **keys)
    core.reset(1)
    return core, core.batch()


def actions(core: _core.VectorEnvironment, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-1, 1, (core.size, len(core.action_layout)))


def test_arrays_are_the_states_of_single_environments_and_no_copies(engine: str) -> None:
    core, batch = vector(engine)
    core.step(actions(core))
    for i in range(core.size):
        state = core.environment(i).state
        assert np.array_equal(batch.qpos[i], state.qpos)
        assert np.array_equal(batch.qvel[i], state.qvel)
        assert np.array_equal(batch.base_position[i], state.p_WB)
        assert np.array_equal(batch.base_quaternion[i], state.q_WB)
        assert np.array_equal(batch.joint_velocities[i], state.qd)
        assert np.array_equal(batch.base_angular_velocity[i], state.w_WB)
        assert np.array_equal(batch.foot_forces[i], [foot.force for foot in core.environment(i).foot_contacts])
    assert np.shares_memory(batch.joint_positions, batch.qpos)
    assert batch.qpos is batch.qpos
    with pytest.raises(ValueError, match="read-only"):
        batch.qpos[0] = 0
    kept, address = batch.qpos.copy(), batch.qpos.ctypes.data
    core.step(actions(core))
    assert batch.qpos.ctypes.data == address
    assert not np.array_equal(batch.qpos, kept)
    assert batch.joint_names == crossgait.Robot.load("serial_quadruped").joints


def test_every_array_is_documented_finite_and_of_its_shape(engine: str) -> None:
    core, batch = vector(engine)
    for name, unit, help_text in _core.environment_arrays():
        array = getattr(batch, name)
        assert array.shape[0] == core.size, name
        assert np.isfinite(array).all(), name
        assert unit
        assert help_text
    assert batch.foot_contacts.dtype == np.bool_
    level = np.zeros((core.size, batch.qpos.shape[1]))
    level[:, 2], level[:, 3] = 1, 1
    batch.set_state(level, np.zeros(batch.qvel.shape[1]))
    assert np.allclose(batch.projected_gravity, [0, 0, -1], atol=1e-12)  # rounding of a turn by nothing
    assert not batch.body_linear_velocities.any()


def test_an_array_before_the_first_reset_is_an_error() -> None:
    batch = _core.VectorEnvironment(CONFIG, 2).batch()
    with pytest.raises(ConfigError, match="a reset before it"):
        _ = batch.qpos


def test_the_same_state_and_actions_give_the_same_bits(engine: str) -> None:
    core, batch = vector(engine, 2)
    core.step(actions(core))
    chosen = core.environment(0).state
    batch.set_state(chosen.qpos, chosen.qvel)  # one row for both
    same = np.repeat(actions(core)[:1], 2, axis=0)
    for _ in range(5):
        core.step(same)
        assert np.array_equal(batch.qpos[0], batch.qpos[1])
        assert np.array_equal(batch.qvel[0], batch.qvel[1])


def test_saved_then_set_then_restored_continues_bit_for_bit(engine: str) -> None:
    core, batch = vector(engine)
    core.step(actions(core))
    saved = [core.environment(i).save() for i in range(core.size)]
    expected = [core.step(actions(core, seed))[0] for seed in (1, 2)]
    lifted = batch.qpos.copy()
    lifted[:, 2] += 0.3
    batch.set_state(qpos=lifted)
    batch.set_parameters({"mass": "x1.2"})
    core.step(actions(core, 3))
    for i in range(core.size):
        core.environment(i).restore(saved[i])
    for seed, observations in zip((1, 2), expected, strict=True):
        assert np.array_equal(core.step(actions(core, seed))[0], observations)


def test_only_chosen_environments_are_set_and_no_way_counts_as_made(engine: str) -> None:
    core, batch = vector(engine)
    before = batch.qpos.copy()
    moved = before[[1]]
    moved[0, :3] += [5, 2, 0.2]
    batch.set_state(moved, indices=[1])
    assert np.array_equal(batch.qpos[[0, 2]], before[[0, 2]])
    assert np.allclose(batch.qpos[1], moved[0], atol=1e-12)  # the engine keeps another point of the base: rounding
    core.step(actions(core))
    assert abs(core.info(1)["distance"]) < 0.5


def test_states_that_are_none_are_refused(engine: str) -> None:
    core, batch = vector(engine)
    with pytest.raises(ConfigError, match="qpos"):
        batch.set_state(np.zeros((2, 19)))
    with pytest.raises(ConfigError, match="unit quaternion"):
        batch.set_state(np.zeros(batch.qpos.shape[1]))
    with pytest.raises(ConfigError, match="indices"):
        batch.set_state(batch.qpos[:1], indices=[7])
    assert core.size == 3


@pytest.mark.parametrize("body", ["base", "leg"])
def test_a_wrench_moves_the_robot_as_its_generalised_forces_do(engine: str, body: str) -> None:
    robot = Robot.load("serial_quadruped")
    name = robot.bodies[0 if body == "base" else 3]
    world = World(robot, engine=engine, gravity=(0, 0, 0))
    state = world.state
    state.p_WB = np.array([0, 0, 2.0])
    world.reset(state)
    force, torque, point = np.array([3.0, -2, 4]), np.array([0.2, -0.1, 0.3]), np.array([0.02, 0.01, -0.03])
    mass = world.mass_matrix()
    expected = world.physics_dt * world.jacobian(name, point).T @ np.concatenate([force, torque])
    targets = robot.home[robot.servo_indices]
    world.apply_wrench(name, force, torque, point)
    world.step(targets)
    # From rest M v = h J^T (f, t), momenta of 0.004. Dry friction in joints is solved to 1e-8; the conformance check
    # `wrench` is of a robot without, to rounding.
    momenta = mass @ world.state.qvel
    assert np.allclose(momenta, expected, rtol=0, atol=1e-9 if world.engine != "physx" else 1e-5)
    before = world.state.qvel
    world.step(targets)  # without it
    assert np.linalg.norm(world.state.qvel[:3] - before[:3]) < 0.1 * np.linalg.norm(before[:3])


def test_a_jacobian_is_that_of_differences_and_of_mujoco() -> None:
    robot = Robot.load("serial_quadruped")
    world = World(robot, "flat")
    rng = np.random.default_rng(0)
    state = world.state
    turn = rng.normal(size=4)
    state.qpos = np.concatenate(
        [[0.1, -0.2, 3], turn / np.linalg.norm(turn), rng.uniform(-0.5, 0.5, len(robot.joints))]
    )
    state.qvel = rng.uniform(-1, 1, 6 + len(robot.joints))
    world.reset(state)
    model = free_in_mujoco(robot)
    data = mujoco.MjData(model)
    data.qpos[:7] = state.qpos[:7]
    order = [model.joint(name).dofadr[0] for name in robot.joints]
    data.qpos[[address + 1 for address in order]] = state.q
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    point = np.array([0.01, -0.02, 0.05])
    for body in robot.bodies:
        pose = world.body_pose(body)
        at = pose[:3, :3] @ point + pose[:3, 3]
        jacobian = np.zeros((2, 3, model.nv))
        mujoco.mj_jac(model, data, jacobian[0], jacobian[1], at, model.body(body).id)
        theirs = jacobian.reshape(6, model.nv)
        base = world.body_pose(0)[:3, :3]
        ours = world.jacobian(body, point)
        # MuJoCo's free joint turns in the base's frame; rounding of products of a metre's size.
        expected = np.hstack([theirs[:, :3], theirs[:, 3:6] @ base.T, theirs[:, order]])
        assert np.allclose(ours, expected, atol=1e-12), body
        linear, angular = world.body_velocity(body)
        moved = ours @ state.qvel
        assert np.allclose(moved[:3], linear + np.cross(angular, pose[:3, :3] @ point), atol=1e-12)
        assert np.allclose(moved[3:], angular, atol=1e-12)


def test_unchanged_parameters_change_no_bit_and_changed_ones_do(engine: str) -> None:
    steps: list[np.ndarray] = []
    for parameters in ({}, {"mass": "x1"}, {"mass": "x1.3"}, {"kp": "x0.5"}, {"friction": 0.05}):
        core, batch = vector(engine)
        core.step(actions(core))
        batch.set_parameters(parameters)
        for seed in range(1, 6):
            core.step(actions(core, seed))
        steps.append(batch.qpos.copy())
    assert np.array_equal(steps[0], steps[1])
    for changed in steps[2:]:
        assert not np.array_equal(steps[0], changed)


def test_parameters_are_of_chosen_environments_and_last_over_episodes() -> None:
    core, batch = vector("", 2)
    batch.set_parameters({"mass": np.array([1.0, 20.0])})
    batch.set_parameters({"mass": None}, indices=[1])  # as it was
    alone, of_alone = vector("", 2)
    of_alone.set_parameters({"mass": 1.0}, indices=[0])
    for one in (core, alone):
        one.reset(4)
        one.step(actions(one))
    assert np.array_equal(batch.qpos, of_alone.qpos)
    assert not np.array_equal(batch.qpos[0], batch.qpos[1])
    with pytest.raises(ConfigError, match="physics_dt"):
        batch.set_parameters({"physics_dt": 5e-4})
    with pytest.raises(ConfigError, match="quantity"):
        batch.set_parameters({"colour": 1})


def test_episodes_that_are_not_reset_stay_until_they_are() -> None:
    core, batch = vector("", 2, auto_reset="disabled")
    core.step(actions(core))
    batch.end_episodes(np.array([True, False]), np.array([False, False]))
    observations, rewards, terminated, truncated, final = core.step(actions(core))
    assert final is None
    assert terminated.tolist() == [True, False]
    assert rewards[0] == 0
    with pytest.raises(ConfigError, match="one that has ended"):
        batch.set_state(batch.qpos.copy())
    before = observations.copy()
    core.reset_some(terminated, observations)
    assert not np.array_equal(observations[0], before[0])
    assert np.array_equal(observations[1], before[1])
    assert not truncated.any()
    again = observations.copy()
    core.observe_start(terminated, again)
    assert np.array_equal(again, observations)  # nothing was set


def test_states_go_in_and_out_as_arrays() -> None:
    state = World("serial_quadruped").state
    assert np.array_equal(state.qpos, np.concatenate([state.p_WB, state.q_WB, state.q]))
    state.qvel = np.arange(6 + len(state.q))
    assert state.w_WB.tolist() == [3, 4, 5]
    with pytest.raises(ConfigError, match="numbers of the base"):
        state.qpos = np.zeros(3)


def test_the_document_lists_every_array() -> None:
    rows = "".join(f"| `{name}` | {unit} | {what} |\n" for name, unit, what in _core.environment_arrays())
    page = Path(__file__).parents[2] / "docs/python-terms.md"
    assert f"| array | unit | what |\n|---|---|---|\n{rows}" in page.read_text()
