"""The robot of `against_all.py`, of a Go2's size: as MJCF, as URDF, and as an environment of Crossgait."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

PHYSICS_DT, SUBSTEPS, EPISODE = 0.002, 10, 400  # s; physics steps in a policy step; policy steps
KP, KD, EFFORT, SCALE = 25.0, 0.5, 23.7, 0.25
FRICTION, ARMATURE, JOINT_FRICTION = 0.8, 0.01, 0.2
HOME = np.tile([0.0, 0.8, -1.5], 4)
HEIGHT = 0.32  # m, of the base at the start
LEGS = ("FL", "FR", "RL", "RR")
COMMAND = (0.5, 0.0, 0.0)  # m/s, m/s, rad/s

# Of each leg: link, joint's axis, range, mass, centre of mass (y: outwards), principal inertia.
LINKS = (
    ("hip", "1 0 0", (-1.05, 1.05), 0.68, (0, 0, 0), (0.0005, 0.0009, 0.0006)),
    ("thigh", "0 1 0", (-1.5, 3.4), 1.15, (0, -0.02, -0.03), (0.006, 0.0056, 0.0012)),
    ("calf", "0 1 0", (-2.72, -0.84), 0.24, (0.005, 0, -0.14), (0.0030, 0.0030, 0.00004)),
)
TRUNK_MASS, TRUNK_INERTIA = 6.9, (0.025, 0.098, 0.107)
FOOT_RADIUS, SHIN = 0.022, 0.213  # m
SERVOS = tuple(f"{leg}_{link[0]}" for leg in LEGS for link in LINKS)


def sides(leg: str) -> tuple[int, int]:
    """Where a leg is: 1 in front, 1 on the left."""
    return (1 if leg[0] == "F" else -1), (1 if leg[1] == "L" else -1)


def places(leg: str) -> tuple[tuple[float, float, float], ...]:
    """Of a leg's joints, each in the link before."""
    front, left = sides(leg)
    return (front * 0.1934, left * 0.0465, 0), (0, left * 0.0955, 0), (0, 0, -SHIN)


def words(numbers: Any) -> str:
    """Numbers with spaces between."""
    return " ".join(f"{number:g}" for number in numbers)


def leg_as_mjcf(leg: str) -> str:
    """Hip, thigh, calf, and a sphere that touches."""
    left = sides(leg)[1]
    inner = f'<geom name="{leg}" type="sphere" size="{FOOT_RADIUS}" pos="0 0 {-SHIN}" class="foot"/>'
    for (name, axis, limits, mass, (x, y, z), inertia), place in reversed(list(zip(LINKS, places(leg), strict=True))):
        inner = f"""<body name="{leg}_{name}" pos="{words(place)}">
        <joint name="{leg}_{name}" axis="{axis}" range="{words(limits)}"/>
        <inertial pos="{words((x, left * y, z))}" mass="{mass}" diaginertia="{words(inertia)}"/>{inner}</body>"""
    return inner


def mjcf() -> str:
    """The robot and the ground as MJCF."""
    servos = "".join(
        f'<position joint="{name}" kp="{KP}" kv="{KD}" forcerange="{-EFFORT} {EFFORT}"/>' for name in SERVOS
    )
    contact = f'condim="3" friction="{FRICTION} 0 0" solref="0.02 1" solimp="0.9 0.95 0.001 0.5 2"'
    return f"""<mujoco model="small_quadruped">
  <compiler angle="radian"/>
  <option timestep="{PHYSICS_DT}" cone="elliptic" solver="Newton" integrator="Euler" impratio="10" jacobian="dense"
   tolerance="1e-16"/>
  <default>
    <joint armature="{ARMATURE}" frictionloss="{JOINT_FRICTION}" solreffriction="0.005 1"
     solimpfriction="0.95 0.99 0.001 0.5 2"/>
    <default class="foot"><geom contype="1" conaffinity="0" {contact}/></default>
  </default>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1" contype="0" conaffinity="1" {contact}/>
    <body name="trunk" pos="0 0 {HEIGHT}">
      <freejoint/>
      <inertial pos="0 0 0" mass="{TRUNK_MASS}" diaginertia="{words(TRUNK_INERTIA)}"/>
      {"".join(map(leg_as_mjcf, LEGS))}
    </body>
  </worldbody>
  <actuator>{servos}</actuator>
  <keyframe><key name="home" qpos="0 0 {HEIGHT} 1 0 0 0 {words(HOME)}"/></keyframe>
</mujoco>
"""


def link_as_urdf(name: str, mass: float, centre: Any, inertia: Any, foot: bool = False) -> str:
    """A link; that of a shin with its foot."""
    ixx, iyy, izz = inertia
    shape = f'<collision><origin xyz="0 0 {-SHIN}"/><geometry><sphere radius="{FOOT_RADIUS}"/></geometry></collision>'
    return f"""<link name="{name}"><inertial><origin xyz="{words(centre)}"/><mass value="{mass}"/>
      <inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial>{shape if foot else ""}</link>"""


def urdf() -> str:
    """The robot as URDF, which has no armature."""
    parts = [link_as_urdf("trunk", TRUNK_MASS, (0, 0, 0), TRUNK_INERTIA)]
    for leg in LEGS:
        parent, left = "trunk", sides(leg)[1]
        for (name, axis, (low, high), mass, (x, y, z), inertia), place in zip(LINKS, places(leg), strict=True):
            link = f"{leg}_{name}"
            parts.append(link_as_urdf(f"{link}_link", mass, (x, left * y, z), inertia, name == "calf"))
            parts.append(
                f"""<joint name="{link}" type="revolute"><parent link="{parent}"/><child link="{link}_link"/>
      <origin xyz="{words(place)}"/><axis xyz="{axis}"/>
      <limit lower="{low}" upper="{high}" effort="{EFFORT}" velocity="100"/></joint>"""
            )
            parent = f"{link}_link"
    return f'<robot name="small_quadruped">{"".join(parts)}</robot>'


def actions_of(count: int, steps: int = EPISODE) -> np.ndarray:
    """Targets that lift feet in pairs, each environment at its own time: steps x environments x 12, in [-1, 1]."""
    time_of = np.arange(steps)[:, None] * PHYSICS_DT * SUBSTEPS
    phase = 2 * np.pi * (2 * time_of + np.linspace(0, 1, count, endpoint=False)[None])
    lift = np.stack([np.maximum(0, np.sin(phase + offset)) for offset in (0, np.pi, np.pi, 0)], axis=-1)
    actions = np.zeros((steps, count, 12))
    actions[..., 1::3], actions[..., 2::3] = 0.8 * lift, -1.6 * lift
    return np.clip(actions, -1, 1)


def crossgait_config(robot: Path, engine: str) -> dict[str, Any]:
    """The same in Crossgait's words."""
    return {
        "action": "joints",
        "robot": str(robot),
        "engine": engine,
        "physics_dt": PHYSICS_DT,
        "control_dt": PHYSICS_DT,
        "policy_dt": PHYSICS_DT * SUBSTEPS,
        "episode_seconds": EPISODE * PHYSICS_DT * SUBSTEPS,
        "settle_seconds": 0.0,
        "joints": {"scale": SCALE, "limit": 1},
        "command": {"vx": COMMAND[0]},
        "observation": [
            *("base_linear_velocity_local", "base_angular_velocity_local", "gravity", "joint_offsets"),
            *("joint_velocities", "last_action", "command"),
        ],
        "reward": {
            **{"velocity_tracking": 1, "yaw_rate_tracking": 0.5, "flat_orientation_l2": -1},
            **{"action_rate_l2": -0.01},
        },
    }
