"""MuJoCo Warp on the processor: MuJoCo's law in float32, by the code that steps many worlds on a graphics card.

`pip install 'crossgait[mujoco-warp]'`. Crossgait's points of contact go in as MuJoCo Warp's contacts, so that ground
and shapes are those of every engine; all else of a step is MuJoCo Warp's.
"""

from __future__ import annotations

from importlib.metadata import version

import numpy as np

from crossgait.engines._mujoco_model import body_origin, model_of, row_capacity
from crossgait.extras import needed_for
from crossgait.serving import (
    MOST_CONTACTS,
    Array,
    ContactPoint,
    EngineContact,
    EngineState,
    ServedWorld,
    rotated,
    serve_engine,
)

with needed_for("worlds in MuJoCo Warp", "mujoco-warp"):
    import mujoco
    import mujoco_warp as mjw
    import warp as wp

LEAST_FRICTION = 1e-5  #: MuJoCo's, mjMINMU
CONSTRAINT = 1  #: ContactType.CONSTRAINT of MuJoCo Warp: the solver is to see it


class MujocoWarp:
    """A world of one robot on any ground."""

    def __init__(self, world: ServedWorld) -> None:
        self._world, self._centre = world, body_origin(world, 0)
        self._cpu = model = model_of(world)
        bodies = range(len(world.robot["bodies"]))
        self._bodies = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, f"body{i}") for i in bodies]
        # MuJoCo orders joints depth first, the description leg by leg.
        names = (f"joint{i}" for i in range(world.joint_count))
        self._joints = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in names]
        self._q, self._v = model.jnt_qposadr[self._joints], model.jnt_dofadr[self._joints]
        with wp.ScopedDevice("cpu"):
            self._model = mjw.put_model(model)
            self._data = mjw.make_data(model, nconmax=MOST_CONTACTS, njmax=row_capacity(world))
        self._model.opt.run_collision_detection = False  # contacts are ours to fill in
        d = self._data
        # On the processor these are the arrays themselves, of the one world that there is.
        self._qpos, self._qvel, self._warm = (a.numpy()[0] for a in (d.qpos, d.qvel, d.qacc_warmstart))
        self._applied, self._wrenches = d.qfrc_applied.numpy()[0], d.xfrc_applied.numpy()[0]
        self._place, self._turn = self._model.body_pos.numpy()[0], self._model.body_quat.numpy()[0]
        self._force, self._speed = d.efc.force.numpy()[0], d.efc.vel.numpy()[0]
        self._rows_of = d.contact.efc_address.numpy()
        self._clear()

    def _clear(self) -> None:
        """Forget what was, and fill in what all contacts have in common, which MuJoCo Warp forgets with them."""
        mjw.reset_data(self._model, self._data)
        self._points: list[ContactPoint] = []
        contact, told = self._data.contact, self._world.contact
        twists, rolls = told["condim"] >= 4, told["condim"] >= 6
        friction = (told["friction"], told["torsional_friction"] * twists, told["rolling_friction"] * rolls)
        slide, twist, roll = np.maximum(friction, LEAST_FRICTION)
        self._dim, self._friction = int(told["condim"]), float(slide)
        contact.friction.numpy()[:] = (slide, slide, twist, roll, roll)
        contact.dim.numpy()[:] = self._dim
        contact.solref.numpy()[:], contact.solimp.numpy()[:] = told["solref"], told["solimp"]
        contact.type.numpy()[:] = CONSTRAINT
        for unused in (contact.flex, contact.elem, contact.vert):
            unused.numpy()[:] = -1

    def reset(self, state: EngineState) -> None:
        """Put the robot into a state."""
        self._clear()
        arm = rotated(state.q_WB, self._centre)
        if self._world.fixed_base:
            base = self._bodies[0]
            self._place[base], self._turn[base] = state.p_WB + arm, state.q_WB
        else:
            back = state.q_WB * [1, -1, -1, -1]
            self._qpos[:3], self._qpos[3:7] = state.p_WB + arm, state.q_WB
            self._qvel[:3] = state.v_WB + np.cross(state.w_WB, arm)
            self._qvel[3:6] = rotated(back, state.w_WB)  # of a free joint it is in the body's frame
        self._qpos[self._q], self._qvel[self._v] = state.q, state.qd

    def step(self, torques: Array, force: Array, torque: Array) -> None:
        """Make one step."""
        self._applied[self._v] = torques
        self._wrenches[self._bodies[0]] = *force, *torque
        self._points = self._world.equations().points
        contact = self._data.contact
        self._data.nacon.numpy()[0] = len(self._points)
        frames, pairs = contact.frame.numpy(), contact.geom.numpy()
        distances, places = contact.dist.numpy(), contact.pos.numpy()
        self._rows_of[:] = -1
        for i, point in enumerate(self._points):
            frames[i], pairs[i] = _frame(point.normal), (0, self._bodies[point.body])
            distances[i], places[i] = point.distance, point.p_WP
        mjw.step(self._model, self._data)

    def state(self) -> EngineState:
        """Return the state."""
        qpos, qvel = self._qpos.astype(float), self._qvel.astype(float)
        joints = qpos[self._q], qvel[self._v]
        if self._world.fixed_base:
            base, still = self._bodies[0], np.zeros(3)
            q = self._turn[base].astype(float)
            return EngineState(self._place[base] - rotated(q, self._centre), q, still, still, *joints)
        q = qpos[3:7]
        arm, w = rotated(q, self._centre), rotated(q, qvel[3:6])
        return EngineState(qpos[:3] - arm, q, qvel[:3] - np.cross(w, arm), w, *joints)

    def contacts(self) -> list[EngineContact]:
        """Return the contacts of the step that was made."""
        return [self._contact(i, point) for i, point in enumerate(self._points) if self._rows_of[i, 0] >= 0]

    def _contact(self, index: int, point: ContactPoint) -> EngineContact:
        rows, contact = self._rows_of[index], self._data.contact
        frame, mu = contact.frame.numpy()[index].astype(float), self._friction
        if self._world.contact["cone"] == "elliptic":
            force, slip = self._force[rows[:3]], self._speed[rows[1:3]]
        else:  # each direction of friction has two edges: the normal plus and minus its coefficient times the tangent
            edges, speeds = self._force[rows[: 2 * (self._dim - 1)]], self._speed[rows[:4]]
            force = np.array([edges.sum(), mu * (edges[0] - edges[1]), mu * (edges[2] - edges[3])])
            slip = np.array([speeds[0] - speeds[1], speeds[2] - speeds[3]]) / (2 * mu)
        return EngineContact(*point[:5], frame.T @ force, float(np.hypot(*slip)))

    def save(self) -> Array:
        """Return what a step hangs on beside the state.

        The solver begins with the last acceleration, and loops take what motion makes of them from the step before.
        """
        return np.concatenate([array.reshape(-1) for array in self._kept()], dtype=float)

    def _kept(self) -> list[Array]:
        d, base = self._data, self._bodies[0]
        motion = (a.numpy()[0] for a in (d.cvel, d.cdof_dot, d.subtree_linvel, d.subtree_com, d.cdof))
        return [self._qpos, self._qvel, self._warm, self._place[base], self._turn[base], *motion]

    def restore(self, numbers: Array) -> None:
        """Put back what `save` returned, of this or another world."""
        self._clear()
        kept = self._kept()
        for array, part in zip(kept, np.split(numbers, np.cumsum([a.size for a in kept])[:-1]), strict=True):
            array[:] = part.reshape(array.shape)

    def body_pose(self, body: int) -> tuple[Array, Array]:
        """Return position and quaternion of a body as MuJoCo Warp has them."""
        mjw.kinematics(self._model, self._data)
        place, turn = (a.numpy()[0, self._bodies[body]].astype(float) for a in (self._data.xpos, self._data.xquat))
        return place - rotated(turn, body_origin(self._world, body)), turn

    def mass_matrix(self) -> Array:
        """Return the joint-space inertia of [v_WB, w_WB, qd], without the base where it is fixed."""
        for part in (mjw.kinematics, mjw.com_pos, mjw.crb):
            part(self._model, self._data)
        nv, first = self._cpu.nv, self._cpu.nv - self._world.joint_count
        # Columns: MuJoCo's velocities per unit of ours.
        ours = np.zeros((nv, nv))
        if first:
            q = self._qpos[3:7].astype(float)
            turn = np.column_stack([rotated(q, axis) for axis in np.eye(3)])
            ours[:3, :3], ours[3:6, 3:6] = np.eye(3), turn.T
            ours[:3, 3:6] = np.cross(np.eye(3), rotated(q, self._centre)).T  # columns w x arm
        ours[self._v, first + np.arange(self._world.joint_count)] = 1
        M = np.zeros((nv, nv))
        column, unit = wp.zeros((1, nv), dtype=float, device="cpu"), wp.zeros((1, nv), dtype=float, device="cpu")
        for i in range(nv):
            unit.numpy()[:] = np.arange(nv) == i
            mjw.mul_m(self._model, self._data, column, unit)
            M[:, i] = column.numpy()[0]
        whole: Array = ours.T @ M @ ours
        return whole

    def body_inertia(self, body: int) -> tuple[float, Array, Array]:
        """Return mass, centre of mass and inertia about it as MuJoCo Warp holds them."""
        m, at = self._model, self._bodies[body]
        mass, place, turn, moments = (
            a.numpy()[0, at].astype(float) for a in (m.body_mass, m.body_ipos, m.body_iquat, m.body_inertia)
        )
        axes = np.column_stack([rotated(turn, axis) for axis in np.eye(3)])
        return float(mass), place + body_origin(self._world, body), (axes * moments) @ axes.T

    def joint_friction(self) -> Array:
        """Return the dry friction that MuJoCo Warp holds, N m."""
        friction: Array = self._model.dof_frictionloss.numpy()[0][self._v].astype(float)
        return friction

    def joint_limits(self) -> tuple[Array, Array]:
        """Return lower and upper angles, rad; infinite where there are none."""
        lower, upper = self._model.jnt_range.numpy()[0][self._joints].astype(float).T
        limited = self._cpu.jnt_limited[self._joints] != 0
        return np.where(limited, lower, -np.inf), np.where(limited, upper, np.inf)


def _frame(normal: Array) -> Array:
    """Return a contact's frame, normal and tangents as rows, as MuJoCo completes it (mju_makeFrame)."""
    beside = np.array([0.0, 1.0, 0.0] if abs(normal[1]) < 0.5 else [0.0, 0.0, 1.0])
    tangent = beside - (beside @ normal) * normal
    tangent /= np.linalg.norm(tangent)
    return np.array([normal, tangent, np.cross(normal, tangent)])


if __name__ == "__main__":
    wp.config.log_level = wp.LOG_WARNING
    serve_engine(
        MujocoWarp,
        library="MuJoCo Warp",
        version=version("mujoco-warp"),
        mode="soft contact, elliptic cones, Newton, in float32",
        contact_margin=0.0,
        own_dynamics=True,
        laws={
            "contact": "mujoco",
            "loops": "mujoco with velocity bias",
            "joint_friction": "mujoco",
            "joint_limits": "mujoco",
            "couplings": "mujoco",
            "contact_family": "compliant",
        },
        capabilities={
            "soft_contact": True,
            "soft_friction": True,
            "turning_friction": True,
            "pyramidal_cone": True,
            "exact_field_query": True,
            "precision": "float32",
        },
    )
