"""A world of Newton's in float32: its model, its contacts filled in point by point, states there and back.

What of a step a solver does, a subclass says; `newton.py` and `newton_kamino.py` are two.
"""

from __future__ import annotations

from collections.abc import Iterable
from importlib.metadata import version
from typing import Any

import numpy as np

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

with needed_for("worlds in Newton", "newton"):
    import newton
    import warp as wp

__all__ = ["NewtonWorld", "newton", "serve_solver"]


class NewtonWorld:
    """A robot on any ground; contacts are Crossgait's points."""

    holds_friction = False  #: whether the solver has dry friction in joints
    fixed_is_kinematic = False  #: whether a fixed base is a body that the solver does not move, not one on a joint

    def __init__(self, world: ServedWorld) -> None:
        self._world, self._robot = world, world.robot
        self._centre = np.array(self._robot["bodies"][0]["inertia"]["p_BC"])
        with wp.ScopedDevice("cpu"):
            self._model = self._build()
            self._solver = self._make_solver()
            self._contacts = newton.Contacts(MOST_CONTACTS, 0)
            self._now, self._next = self._model.state(), self._model.state()
            self._control = self._model.control()
            self._observed = self._solver.observables(
                [newton.solvers.SolverBase.ObservableKind.CONTACT_F], contacts=self._contacts
            )
        starts, of_speeds = self._model.joint_q_start.numpy(), self._model.joint_qd_start.numpy()
        self._q, self._v = starts[self._hinges], of_speeds[self._hinges]
        self._points: list[ContactPoint] = []
        self._slips: list[float] = []

    def _make_solver(self) -> Any:
        """Return the solver of `self._model`."""
        raise NotImplementedError

    def _register(self, builder: Any) -> None:
        """Have the builder know what only this solver does."""

    def _build(self) -> Any:
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
        self._register(builder)
        self._ground = builder.add_shape_plane(cfg=self._surface())
        self._bodies: list[int] = []
        self._shapes: list[int] = []
        joints: list[int] = []
        for index in range(len(self._robot["bodies"])):
            joints.append(self._add_body(builder, index))
        self._hinges = joints[1:]
        builder.add_articulation(joints)
        self._add_constraints(builder)
        model = builder.finalize(device="cpu")
        model.set_gravity(self._world.gravity)
        model.rigid_contact_max = MOST_CONTACTS
        return model

    def _surface(self) -> Any:
        friction = self._world.contact["friction"]
        return newton.ModelBuilder.ShapeConfig(
            density=0, mu=friction, restitution=0, mu_torsional=0, mu_rolling=0, margin=0, gap=0
        )

    def _origin(self, body: int) -> Array:
        """Return where Newton's body begins in the description's, m: the base at its centre of mass."""
        return self._centre if body == 0 else np.zeros(3)

    def _add_body(self, builder: Any, index: int) -> int:
        told = self._robot["bodies"][index]
        inertia = told["inertia"]
        body = builder.add_link(
            mass=inertia["mass"],
            com=wp.vec3(*(np.array(inertia["p_BC"]) - self._origin(index))),
            inertia=wp.mat33(np.array(inertia["I_C"])),
            lock_inertia=True,
            is_kinematic=index == 0 and self._world.fixed_base and self.fixed_is_kinematic,
        )
        self._bodies.append(body)
        # A shape says whose a contact is, and how rough; it is never looked for.
        self._shapes.append(builder.add_shape_sphere(body, radius=1e-3, cfg=self._surface()))
        if index == 0:
            still = self._world.fixed_base and not self.fixed_is_kinematic
            root: int = builder.add_joint_fixed(-1, body) if still else builder.add_joint_free(body)
            return root
        joint = told["joint"]
        limits = (joint["lower"], joint["upper"]) if joint["limited"] else (-np.inf, np.inf)
        hinge: int = builder.add_joint_revolute(
            self._bodies[told["parent"]],
            body,
            parent_xform=self._placed(told["parent"], np.array(told["X_PB"])),
            axis=wp.vec3(*joint["axis"]),
            armature=joint["armature"],
            friction=joint["friction"] if self.holds_friction else 0.0,
            limit_lower=limits[0],
            limit_upper=limits[1],
            target_ke=0.0,
            target_kd=0.0,
            damping=0.0,
            effort_limit=np.inf,
            velocity_limit=np.inf,
            actuator_mode=newton.JointTargetMode.EFFORT,
        )
        return hinge

    def _placed(self, body: int, pose: Array) -> Any:
        return wp.transform(wp.vec3(*(pose[:3, 3] - self._origin(body))), wp.quat_from_matrix(wp.mat33(pose[:3, :3])))

    def _add_constraints(self, builder: Any) -> None:
        for loop in self._robot["loops"]:
            a, b = loop["body_a"], loop["body_b"]
            at = (wp.vec3(*(np.array(loop[key]) - self._origin(i))) for key, i in (("p_AP", a), ("p_BP", b)))
            first, second = (wp.transform(place, wp.quat_identity()) for place in at)
            builder.add_joint_ball(
                self._bodies[a],
                self._bodies[b],
                parent_xform=first,
                child_xform=second,
                actuator_mode=newton.JointTargetMode.NONE,
            )
        for coupling in self._robot["couplings"]:
            constant, slope, *higher = coupling["coefficients"]
            if any(higher):
                raise ValueError("Newton's couplings are linear")
            follower, leader = self._hinges[coupling["follower"]], self._hinges[coupling["leader"]]
            builder.set_joint_mimic(follower, leader, coeffs=(constant, slope))

    def reset(self, state: EngineState) -> None:
        """Put the robot into a state."""
        q, qd = self._now.joint_q.numpy(), self._now.joint_qd.numpy()
        q[:], qd[:] = self._model.joint_q.numpy(), 0
        arm = rotated(state.q_WB, self._centre)
        pose = np.concatenate((state.p_WB + arm, state.q_WB[[1, 2, 3, 0]]))
        if self._world.fixed_base and not self.fixed_is_kinematic:
            self._model.joint_X_p.numpy()[0] = pose
            self._solver.notify_model_changed(newton.ModelFlags.JOINT_PROPERTIES)
        else:
            q[:7] = pose
            if not self._world.fixed_base:
                qd[:6] = *(state.v_WB + np.cross(state.w_WB, arm)), *state.w_WB
        q[self._q], qd[self._v] = state.q, state.qd
        newton.eval_fk(self._model, self._now.joint_q, self._now.joint_qd, self._now)
        self._forget()
        self._points = []

    def _forget(self) -> None:
        """Have the solver forget all that was but the state."""
        self._solver.reset(self._now)

    def step(self, torques: Array, force: Array, torque: Array) -> None:
        """Make one step."""
        self._control.joint_f.numpy()[self._v] = torques
        wrenches = self._now.body_f.numpy()
        wrenches[:] = 0
        wrenches[0] = *force, *torque
        self._find_contacts()
        self._solver.step(
            self._now, self._next, self._control, self._contacts, self._world.physics_dt, observables=self._observed
        )
        self._now, self._next = self._next, self._now

    def _find_contacts(self) -> None:
        c = self._contacts
        c.clear()
        self._points = self._world.equations().points
        c.rigid_contact_count.numpy()[0] = len(self._points)
        of_ground, of_robot, normals = (
            a.numpy() for a in (c.rigid_contact_point0, c.rigid_contact_point1, c.rigid_contact_normal)
        )
        c.rigid_contact_shape0.numpy()[:] = self._ground
        owners, poses = c.rigid_contact_shape1.numpy(), self._now.body_q.numpy().astype(float)
        velocity = self._world.equations().velocity
        first = 6 if self._world.fixed_base else 0
        self._slips = []
        for i, point in enumerate(self._points):
            half = 0.5 * point.distance * point.normal
            pose = poses[self._bodies[point.body]]
            back = np.array([pose[6], *-pose[3:6]])
            owners[i], normals[i] = self._shapes[point.body], point.normal
            of_ground[i], of_robot[i] = point.p_WP - half, rotated(back, point.p_WP + half - pose[:3])
            speed = point.jacobian[:, first:] @ velocity[first:]
            self._slips.append(float(np.linalg.norm(speed - (speed @ point.normal) * point.normal)))

    def _arrays(self) -> list[Array]:
        """Return what a step hangs on; solvers are told to remember nothing."""
        now = self._now
        return [
            a.numpy().reshape(-1) for a in (now.joint_q, now.joint_qd, now.body_q, now.body_qd, self._model.joint_X_p)
        ]

    def save(self) -> Array:
        """Return the numbers that the next step hangs on."""
        return np.concatenate(self._arrays(), dtype=float)

    def restore(self, numbers: Array) -> None:
        """Put back what `save` returned, of this or another world."""
        arrays = self._arrays()
        for array, part in zip(arrays, np.split(numbers, np.cumsum([a.size for a in arrays])[:-1]), strict=True):
            array[:] = part
        self._solver.notify_model_changed(newton.ModelFlags.JOINT_PROPERTIES)
        self._forget()
        self._points = []

    def contacts(self) -> list[EngineContact]:
        """Return the contacts of the step that was made."""
        forces = -self._observed.contact_f.numpy()[:, :3].astype(float)  # Newton's are on the ground
        return [
            EngineContact(*point[:5], force, slip)
            for point, force, slip in zip(self._points, forces, self._slips, strict=False)
            if point.distance <= 0 or force @ point.normal > 0
        ]

    def state(self) -> EngineState:
        """Return the state."""
        pose, joints = self._now.body_q.numpy()[0].astype(float), self._now.joint_q.numpy()[self._q].astype(float)
        twist, speeds = self._now.body_qd.numpy()[0].astype(float), self._now.joint_qd.numpy()[self._v].astype(float)
        q = pose[[6, 3, 4, 5]]
        arm = rotated(q, self._centre)
        if self._world.fixed_base:
            twist = np.zeros(6)
        return EngineState(pose[:3] - arm, q, twist[:3] - np.cross(twist[3:], arm), twist[3:], joints, speeds)

    def body_pose(self, body: int) -> tuple[Array, Array]:
        """Return position and quaternion of a body as Newton has them."""
        pose = self._now.body_q.numpy()[self._bodies[body]].astype(float)
        q = pose[[6, 3, 4, 5]]
        return pose[:3] - rotated(q, self._origin(body)), q

    def body_inertia(self, body: int) -> tuple[float, Array, Array]:
        """Return mass, centre of mass and inertia about it as Newton holds them."""
        m, at = self._model, self._bodies[body]
        mass, centre, inertia = (a.numpy()[at].astype(float) for a in (m.body_mass, m.body_com, m.body_inertia))
        return float(mass), centre + self._origin(body), inertia

    def joint_limits(self) -> tuple[Array, Array]:
        """Return the lower and upper angles that Newton holds, rad; infinite where there are none."""
        m = self._model
        lower, upper = (a.numpy()[self._v].astype(float) for a in (m.joint_limit_lower, m.joint_limit_upper))
        return lower, upper


def serve_solver(engine: type[NewtonWorld], mode: str, law: str, holds: Iterable[str]) -> None:
    """Serve a solver's worlds: `law` is that of contacts, loops and limits, and of what `holds` names besides."""
    wp.config.log_level = wp.LOG_WARNING
    serve_engine(
        engine,
        library="Newton",
        version=version("newton"),
        mode=mode,
        contact_margin=1e-3,
        own_dynamics=True,
        laws={part: law for part in ("contact", "loops", "joint_limits", *holds)} | {"contact_family": "rigid"},
        capabilities={"exact_field_query": True, "precision": "float32"},
    )
