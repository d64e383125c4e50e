from __future__ import annotations

import copy
import gc
import threading

import numpy as np
import pytest
from conftest import epsilon

import crossgait
from crossgait import ConfigError, Robot, Terrain, World


def home_targets(robot: Robot) -> np.ndarray:
    return robot.home[robot.servo_indices]


def test_free_fall_follows_the_parabola(scara: Robot, engine: str) -> None:
    world = World(scara, engine=engine)
    state = world.state
    state.p_WB = np.array([0, 0, 10.0])
    world.reset(state)
    seconds = 0.5
    assert world.step(home_targets(scara), round(seconds / world.physics_dt)) == "ok"
    # Semi-implicit Euler falls g h t / 2 further than the parabola; the base's origin is not the centre of mass,
    # about which servos that settle move it by less than a millimetre.
    expected = 10 - 9.81 * seconds * (seconds + world.physics_dt) / 2
    assert world.state.p_WB[2] == pytest.approx(expected, abs=1e-3)
    assert world.state.time == pytest.approx(seconds)


def test_standing_feet_carry_the_weight(scara: Robot, engine: str) -> None:
    world = World(scara, engine=engine)
    world.step(home_targets(scara), 2000)
    lift = sum(contact.force[2] for contact in world.contacts)
    assert lift == pytest.approx(9.81 * scara.mass_kg, rel=0.02)  # it still sways a little after 2 s
    assert [foot.touching for foot in world.foot_contacts] == [True] * 4
    assert all(contact.leg in range(4) for contact in world.contacts)


def test_a_step_changes_no_state_that_was_handed_out(scara: Robot) -> None:
    world = World(scara)
    before = world.state
    kept = (before.p_WB.copy(), before.q.copy(), before.time)
    q = before.q
    world.step(home_targets(scara), 100)
    assert np.array_equal(before.p_WB, kept[0])
    assert np.array_equal(q, kept[1])
    assert before.time == kept[2]
    assert not np.array_equal(world.state.q, kept[1])


def test_what_a_world_hands_out_outlives_it(scara: Robot) -> None:
    world = World(scara, Terrain("rough", seed=2))
    world.step(home_targets(scara), 300)
    state, contacts, torques, mass = world.state, world.contacts, world.torques, world.mass_matrix()
    copies = (state.q.copy(), [c.force.copy() for c in contacts], torques.copy(), mass.copy())
    del world
    gc.collect()
    assert np.array_equal(state.q, copies[0])
    assert all(np.array_equal(c.force, f) for c, f in zip(contacts, copies[1], strict=True))
    assert np.array_equal(torques, copies[2])
    assert np.array_equal(mass, copies[3])


def test_a_snapshot_continues_bit_for_bit(scara: Robot, engine: str) -> None:
    world = World(scara, Terrain("rough", seed=1), engine)
    rng = np.random.default_rng(0)
    targets = home_targets(scara) + rng.uniform(-0.1, 0.1, (20, len(scara.servos)))
    for row in targets[:10]:
        world.step(row, 5)
    saved = world.save()
    for row in targets[10:]:
        world.step(row, 5)
    first = world.state
    world.restore(saved)
    for row in targets[10:]:
        world.step(row, 5)
    assert np.array_equal(first.q, world.state.q)
    assert np.array_equal(first.p_WB, world.state.p_WB)


def test_float32_and_lists_are_targets_too(scara: Robot) -> None:
    a, b = World(scara), World(scara)
    exact = home_targets(scara).astype(np.float32)
    a.step(exact, 10)
    b.step([float(x) for x in exact], 10)
    assert np.array_equal(a.state.q, b.state.q)


@pytest.mark.parametrize("wrong", [[0.0], [np.nan] * 12, [0.0] * 40])
def test_wrong_targets_change_nothing(scara: Robot, wrong: list[float]) -> None:
    world = World(scara)
    before = world.state
    with pytest.raises(ConfigError, match="targets"):
        world.step(wrong)
    assert np.array_equal(world.state.q, before.q)
    assert world.state.time == before.time


def test_a_push_moves_the_robot_by_its_momentum(scara: Robot, engine: str) -> None:
    world = World(scara, engine=engine, gravity=np.zeros(3))
    state = world.state
    state.p_WB = np.array([0, 0, 5.0])
    world.reset(state)
    impulse = 0.1
    world.push([0, impulse, 0])
    world.step(home_targets(scara), 1000)
    # Of the whole; legs that swing back on their servos move the base's own velocity by some per cent.
    assert world.state.p_WB[1] == pytest.approx(impulse / scara.mass_kg, rel=0.1)


def test_worlds_on_two_threads_are_the_same_as_one_after_the_other(scara: Robot) -> None:
    def walk(results: list[np.ndarray]) -> None:
        world = World(scara, Terrain("rough", seed=5))
        world.step(home_targets(scara), 1500)
        results.append(world.state.q)

    alone: list[np.ndarray] = []
    walk(alone)
    together: list[np.ndarray] = []
    threads = [threading.Thread(target=walk, args=(together,)) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(together) == 2
    assert all(np.array_equal(alone[0], q) for q in together)


def test_body_poses_agree_with_the_engine(scara: Robot, engine: str) -> None:
    world = World(scara, Terrain("rough", seed=1), engine)
    world.step(home_targets(scara) + 0.1, 200)
    for body, pose in enumerate(crossgait.body_poses(scara, world.state)):
        # Rounding of twenty transforms, of joints that are so exact.
        assert np.allclose(pose, world.body_pose(body), atol=1e-9 + 20 * epsilon(engine))


def test_a_world_is_not_copied(scara: Robot) -> None:
    with pytest.raises(TypeError):
        copy.deepcopy(World(scara))


def test_unknown_engines_are_named(scara: Robot) -> None:
    with pytest.raises(ConfigError) as caught:
        World(scara, engine="mujocko")
    assert "mujocko" in caught.value.found
    assert crossgait.available_engines()[0] in caught.value.expected


def test_a_state_is_a_value(scara: Robot) -> None:
    state = World(scara).state
    other = copy.copy(state)
    other.q = other.q + 1
    assert not np.array_equal(state.q, other.q)
    with pytest.raises(ConfigError, match="q"):
        state.q = np.zeros(100)
