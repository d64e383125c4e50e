"""A world of Drake's MultibodyPlant in discrete time: bodies, joints, loops as ball constraints, states there and back.

What touches and how, a subclass says: `drake.py` and `drake_tamsi.py` points, `drake_hydroelastic.py` surfaces.
Couplings that are not linear are refused; limits of joints and dry friction in them are left out and not declared.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from typing import Any

import numpy as np

from crossgait.extras import needed_for
from crossgait.serving import Array, EngineContact, EngineState, ServedWorld, rotated, serve_engine

with needed_for("worlds in Drake", "drake"):
    from pydrake.common.eigen_geometry import Quaternion
    from pydrake.geometry import AddContactMaterial, CollisionFilterDeclaration, GeometrySet, ProximityProperties
    from pydrake.math import RigidTransform, RotationMatrix
    from pydrake.multibody.math import SpatialForce
    from pydrake.multibody.plant import (
        AddMultibodyPlant,
        CoulombFriction,
        ExternallyAppliedSpatialForce,
        MultibodyPlantConfig,
    )
    from pydrake.multibody.tree import FixedOffsetFrame, RevoluteJoint, SpatialInertia, UnitInertia
    from pydrake.systems.framework import DiagramBuilder


class DrakeWorld:
    """A world of one robot."""

    contact_model = "point"  #: as Drake names it
    approximation = "sap"  #: of contact in discrete time, as Drake names it, which says the solver as well

    def __init__(self, world: ServedWorld) -> None:
        self._world, self._robot = world, world.robot
        self._centre = np.array(self._robot["bodies"][0]["inertia"]["p_BC"])
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(
            time_step=world.physics_dt,
            use_sampled_output_ports=False,  # contacts are asked of the step that begins
            contact_model=self.contact_model,
            discrete_contact_approximation=self.approximation,
        )
        self._plant, scene = AddMultibodyPlant(config, builder)
        self._plant.mutable_gravity_field().set_gravity_vector(world.gravity)
        self._bodies: list[Any] = []
        self._joints: list[Any] = []
        for index, body in enumerate(self._robot["bodies"]):
            self._add_body(index, body)
        shapes = [shape for body in self._bodies for shape in self._plant.GetCollisionGeometriesForBody(body)]
        # Shapes of one robot never collide with each other.
        scene.collision_filter_manager().Apply(CollisionFilterDeclaration().ExcludeWithin(GeometrySet(shapes)))
        self._add_ground()
        self._add_constraints()
        self._plant.Finalize()
        self._diagram = builder.Build()
        self._context = self._diagram.CreateDefaultContext()
        self._of_plant = self._plant.GetMyMutableContextFromRoot(self._context)
        self._next = self._diagram.AllocateDiscreteVariables()
        self._body_of = {body.index(): i for i, body in enumerate(self._bodies)}
        # Drake orders joints by its own tree.
        self._q = [joint.position_start() for joint in self._joints]
        self._v = [joint.velocity_start() for joint in self._joints]
        self._found: list[EngineContact] = []

    def _in_body(self, index: int, pose: Array) -> RigidTransform:
        """Of a body's own frame; the base's is at its centre of mass here, which is what then moves straight."""
        shift = self._centre if index == 0 else np.zeros(3)
        return RigidTransform(RotationMatrix(pose[:3, :3]), pose[:3, 3] - shift)

    def _add_body(self, index: int, body: Mapping[str, Any]) -> None:
        mass, I_C = body["inertia"]["mass"], np.array(body["inertia"]["I_C"])
        p_BC = np.zeros(3) if index == 0 else np.array(body["inertia"]["p_BC"])
        about_centre = UnitInertia(*np.diag(I_C) / mass, I_C[0, 1] / mass, I_C[0, 2] / mass, I_C[1, 2] / mass)
        added = self._plant.AddRigidBody(
            f"{index}", SpatialInertia.MakeFromCentralInertia(mass, p_BC, about_centre * mass)
        )
        self._bodies.append(added)
        if index > 0:
            parent = self._bodies[body["parent"]]
            X_PB = self._in_body(body["parent"], np.array(body["X_PB"]))
            frame = self._plant.AddFrame(FixedOffsetFrame(f"at {index}", parent.body_frame(), X_PB))
            axis = np.array(body["joint"]["axis"])
            joint = self._plant.AddJoint(RevoluteJoint(f"{index}", frame, added.body_frame(), axis))
            actuator = self._plant.AddJointActuator(f"{index}", joint)
            actuator.set_default_rotor_inertia(body["joint"]["armature"])
            actuator.set_default_gear_ratio(1.0)
            self._joints.append(joint)
        for number, shape in enumerate(body["shapes"]):
            self._add_shape(index, f"{index}.{number}", shape)

    def _add_shape(self, index: int, name: str, shape: Mapping[str, Any]) -> None:
        """Register what of a body may touch, by `_register`."""
        raise NotImplementedError

    def _add_ground(self) -> None:
        """Register the ground, by `_register_ground`."""
        raise NotImplementedError

    def _contacts_of_this_step(self) -> list[EngineContact]:
        """Return what touches where the step begins, with its forces."""
        raise NotImplementedError

    def _properties(self) -> ProximityProperties:
        properties, mu = ProximityProperties(), self._world.contact["friction"]
        AddContactMaterial(properties=properties, friction=CoulombFriction(mu, mu))
        return properties

    def _register(self, index: int, name: str, pose: Array, shape: Any, properties: ProximityProperties) -> Any:
        X_BG = self._in_body(index, pose)
        return self._plant.RegisterCollisionGeometry(self._bodies[index], X_BG, shape, name, properties)

    def _register_ground(self, shape: Any, properties: ProximityProperties) -> None:
        self._plant.RegisterCollisionGeometry(self._plant.world_body(), RigidTransform(), shape, "ground", properties)

    def _leg_of(self, index: int, kind: str, place: Array) -> int:
        for leg, model in enumerate(self._robot["legs"] or []):
            if model["foot_body"] == index and kind == "sphere" and np.allclose(place, model["p_BF"], atol=1e-9):
                return leg
        return -1

    def _add_constraints(self) -> None:
        for loop in self._robot["loops"]:
            a, b = loop["body_a"], loop["body_b"]
            points = (np.array(loop[key]) - (self._centre if i == 0 else 0) for key, i in (("p_AP", a), ("p_BP", b)))
            self._plant.AddBallConstraint(self._bodies[a], next(points), self._bodies[b], next(points))
        for coupling in self._robot["couplings"]:
            constant, slope, *higher = coupling["coefficients"]
            if any(higher):
                raise ValueError("Drake's couplings are linear")
            follower, leader = self._joints[coupling["follower"]], self._joints[coupling["leader"]]
            self._plant.AddCouplerConstraint(follower, leader, slope, constant)

    def reset(self, state: EngineState) -> None:
        """Put the robot into a state."""
        self._context.SetTime(0)
        base, still = self._bodies[0], self._world.fixed_base
        turn = state.q_WB / np.linalg.norm(state.q_WB)
        X_WC = RigidTransform(RotationMatrix(Quaternion(wxyz=turn)), state.p_WB + rotated(state.q_WB, self._centre))
        floating = self._plant.GetJointByName(base.name())
        floating.Unlock(self._of_plant)
        self._plant.SetFreeBodyPose(self._of_plant, base, X_WC)
        positions = self._plant.GetPositions(self._of_plant)
        positions[:4] = state.q_WB  # as they are: a rotation matrix on the way would round them
        positions[self._q] = state.q
        v_WC = state.v_WB + np.cross(state.w_WB, rotated(state.q_WB, self._centre))
        velocities = np.zeros(6 + len(self._v))
        if not still:
            velocities[:6] = *state.w_WB, *v_WC
        velocities[self._v] = state.qd
        self._plant.SetPositions(self._of_plant, positions)
        self._plant.SetVelocities(self._of_plant, velocities)
        if still:
            floating.Lock(self._of_plant)
        self._found = []

    def step(self, torques: Array, force: Array, torque: Array) -> None:
        """Make one step."""
        if torques.size:
            self._plant.get_actuation_input_port().FixValue(self._of_plant, torques)
        pull = ExternallyAppliedSpatialForce()
        pull.body_index = self._bodies[0].index()
        pull.p_BoBq_B = np.zeros(3)
        pull.F_Bq_W = SpatialForce(torque, force)
        self._plant.get_applied_spatial_force_input_port().FixValue(self._of_plant, [pull])
        self._found = self._contacts_of_this_step()
        self._diagram.CalcForcedDiscreteVariableUpdate(self._context, self._next)
        self._context.SetDiscreteState(self._next)
        if not self._world.fixed_base:  # Drake turns a quaternion on by its derivative, and leaves its length
            positions = self._plant.GetPositions(self._of_plant)
            positions[:4] /= np.linalg.norm(positions[:4])
            self._plant.SetPositions(self._of_plant, positions)

    def state(self) -> EngineState:
        """Return the state."""
        q, v = self._plant.GetPositions(self._of_plant), self._plant.GetVelocities(self._of_plant)
        arm = rotated(q[:4], self._centre)
        return EngineState(q[4:7] - arm, q[:4], v[3:6] - np.cross(v[:3], arm), v[:3], q[self._q], v[self._v])

    def contacts(self) -> list[EngineContact]:
        """Return the contacts of the step that was made."""
        return self._found

    def _slip_at(self, body: int, place: Array, normal: Array) -> float:
        """Return how fast a body's point slides along the ground, m/s."""
        V = self._plant.EvalBodySpatialVelocityInWorld(self._of_plant, self._bodies[body])
        X = self._plant.EvalBodyPoseInWorld(self._of_plant, self._bodies[body])
        velocity: Array = V.translational() + np.cross(V.rotational(), place - X.translation())
        return float(np.linalg.norm(velocity - (velocity @ normal) * normal))

    def mass_matrix(self) -> Array:
        """Return the joint-space inertia of [v_WB, w_WB, qd]."""
        M = self._plant.CalcMassMatrix(self._of_plant)
        order = [3, 4, 5, 0, 1, 2, *self._v]
        M = M[np.ix_(order, order)]
        shift = np.eye(len(M))  # v_WC = v_WB + w x arm
        x, y, z = rotated(self._plant.GetPositions(self._of_plant)[:4], self._centre)
        shift[:3, 3:6] = -np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        first = 6 if self._world.fixed_base else 0
        whole: Array = shift.T @ M @ shift
        return whole[first:, first:]

    def body_pose(self, body: int) -> tuple[Array, Array]:
        """Return position and quaternion of a body as Drake has them."""
        X = self._plant.EvalBodyPoseInWorld(self._of_plant, self._bodies[body])
        q = X.rotation().ToQuaternion().wxyz()
        return X.translation() - (rotated(q, self._centre) if body == 0 else 0), q

    def body_inertia(self, body: int) -> tuple[float, Array, Array]:
        """Return mass, centre of mass and inertia about it as Drake holds them."""
        M = self._bodies[body].default_spatial_inertia()
        central = M.Shift(M.get_com())
        shift = self._centre if body == 0 else np.zeros(3)
        return M.get_mass(), M.get_com() + shift, central.CalcRotationalInertia().CopyToFullMatrix3()


def serve_drake(engine: type[DrakeWorld], mode: str, law: str, **laws: str) -> None:
    """Serve worlds of Drake's: `law` is that of contact, `laws` has those of loops and couplings."""
    serve_engine(
        engine,
        library="Drake",
        version=version("drake"),
        mode=mode,
        laws={"contact": law, "contact_family": "compliant", **laws},
        capabilities={"exact_field_query": True},
    )


#: Laws of what SAP solves beside contact.
CONSTRAINTS = {"loops": "drake_ball", "couplings": "drake_coupler"}
