"""The MuJoCo model of a world as it is told to an engine: what backends/mujoco/model_xml.h says of MJCF holds here too.

Bodies have no shapes: contacts are given to MuJoCo point by point. A geom of each body, of the body's own number (the
ground's is 0), says only whose they are.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from crossgait.extras import needed_for
from crossgait.serving import MOST_CONTACTS, Array, ServedWorld

with needed_for("worlds in MuJoCo Warp", "mujoco-warp"):
    import mujoco


def body_origin(world: ServedWorld, body: int) -> Array:
    """Return where MuJoCo's body begins in the description's, m: the base at its centre of mass."""
    return np.array(world.robot["bodies"][0]["inertia"]["p_BC"]) if body == 0 else np.zeros(3)


def softness(told: Mapping[str, float]) -> tuple[list[float], list[float]]:
    """Return solref and solimp."""
    impedance = ("min", "max", "width", "midpoint", "power")
    return [told["time_constant"], told["damping_ratio"]], [told[f"impedance_{key}"] for key in impedance]


def row_capacity(world: ServedWorld) -> int:
    """Return how many rows of constraints there can be at once."""
    dims = int(world.contact["condim"])
    of_contact = dims if world.contact["cone"] == "elliptic" else 2 * (dims - 1)
    loops, couplings = len(world.robot["loops"]), len(world.robot["couplings"])
    return of_contact * MOST_CONTACTS + 3 * loops + couplings + 2 * world.joint_count


def model_of(world: ServedWorld) -> mujoco.MjModel:
    """Compile the model: Euler's method, Newton's solver, dense Jacobians. Damping and servos come as torques.

    Bodies are named "body0", "body1", joints "joint0" and so on, in the description's order.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.compiler.autolimits = False
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    _set_options(spec.option, world)
    _add_geom(spec.worldbody, world)
    bodies: list[Any] = []
    for index in range(len(world.robot["bodies"])):
        bodies.append(_add_body(spec, world, index, bodies))
    _add_equalities(spec, world)
    model = spec.compile()
    # MuJoCo takes one anchor of a loop and finds the other at joint angles of zero; ours are both known.
    for row, loop in enumerate(world.robot["loops"]):
        a, b = loop["body_a"], loop["body_b"]
        model.eq_data[row, :3] = np.array(loop["p_AP"]) - body_origin(world, a)
        model.eq_data[row, 3:6] = np.array(loop["p_BP"]) - body_origin(world, b)
    return model


def _set_options(option: Any, world: ServedWorld) -> None:
    option.timestep, option.gravity = world.physics_dt, world.gravity
    option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    elliptic, pyramidal = mujoco.mjtCone.mjCONE_ELLIPTIC, mujoco.mjtCone.mjCONE_PYRAMIDAL
    option.cone = elliptic if world.contact["cone"] == "elliptic" else pyramidal
    option.impratio = world.contact["impratio"]
    option.iterations, option.tolerance = world.solver["iterations"], world.solver["tolerance"]


def _add_geom(body: Any, world: ServedWorld) -> None:
    # How many rows a contact may have MuJoCo Warp takes from the geoms.
    condim = int(world.contact["condim"])
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[1e-3, 0, 0], contype=0, conaffinity=0, condim=condim)


def _add_body(spec: Any, world: ServedWorld, index: int, bodies: list[Any]) -> Any:
    told = world.robot["bodies"][index]
    inertia, X_PB = told["inertia"], np.array(told["X_PB"])
    parent, place, quaternion = spec.worldbody, np.zeros(3), np.array([1.0, 0, 0, 0])  # a reset sets the base's own
    if index > 0:
        parent, place = bodies[told["parent"]], X_PB[:3, 3] - body_origin(world, told["parent"])
        mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(X_PB[:3, :3]).reshape(-1))
    I_C = np.array(inertia["I_C"])
    body = parent.add_body(
        name=f"body{index}",
        pos=place,
        quat=quaternion,
        mass=inertia["mass"],
        ipos=np.array(inertia["p_BC"]) - body_origin(world, index),
        fullinertia=[*np.diag(I_C), I_C[0, 1], I_C[0, 2], I_C[1, 2]],
        explicitinertial=True,
    )
    _add_geom(body, world)
    if index > 0:
        _add_joint(body, world, index - 1, told["joint"])
    elif not world.fixed_base:
        body.add_freejoint()
    return body


def _add_joint(body: Any, world: ServedWorld, index: int, told: Mapping[str, Any]) -> None:
    joint = body.add_joint(name=f"joint{index}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=told["axis"])
    joint.armature, joint.frictionloss = told["armature"], told["friction"]
    joint.solref_friction, joint.solimp_friction = softness(world.robot["friction_softness"])
    joint.limited, joint.range = bool(told["limited"]), [told["lower"], told["upper"]]
    joint.solref_limit, joint.solimp_limit = softness(told["limit_softness"])


def _add_equalities(spec: Any, world: ServedWorld) -> None:
    for loop in world.robot["loops"]:
        row = spec.add_equality(type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_BODY)
        row.name1, row.name2 = f"body{loop['body_a']}", f"body{loop['body_b']}"
        row.solref, row.solimp = softness(world.robot["loop_softness"])
    for coupling in world.robot["couplings"]:
        row = spec.add_equality(type=mujoco.mjtEq.mjEQ_JOINT)
        row.name1, row.name2 = f"joint{coupling['follower']}", f"joint{coupling['leader']}"
        row.data[:5] = coupling["coefficients"]
        row.solref, row.solimp = softness(coupling["softness"])
