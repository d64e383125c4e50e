"""A robot and its ground as a model of the `mujoco` package, for `rendering` to draw.

Whoever draws takes `mujoco` from here: the way to a graphics context is chosen before it is imported.
"""

from __future__ import annotations

import os
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait import _core


def has_display() -> bool:
    """Whether a window can be opened."""
    return sys.platform != "linux" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


if not has_display():
    os.environ.setdefault("MUJOCO_GL", "egl")
try:
    import mujoco as mujoco
except ImportError as error:
    raise ImportError("crossgait.viewing.rendering needs mujoco: pip install crossgait[render]") from error

Frame = npt.NDArray[np.uint8]

#: Side of the floor's squares and distance of the terrain's lines, m.
SQUARE = 0.1
_STICK = 0.03  #: radius of a link that has no shape, in the robot's reach
_PLAIN = (0.75, 0.75, 0.78, 1.0)
_GEOM_TYPES = {
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
    "mesh": mujoco.mjtGeom.mjGEOM_MESH,
    "hull": mujoco.mjtGeom.mjGEOM_MESH,
}
# Colours of heights from the lowest to the highest: red, green, blue.
_LOWEST, _HIGHEST = np.array([58, 82, 74]), np.array([226, 214, 178])
_LARGEST_TEXTURE = 4096
_SUNSHINE = np.array([-0.4, 0.3, -1.0])


def reach_of(robot: _core.Robot) -> float:
    """Distance from the base's origin to that of the body farthest from it, in the home pose, m."""
    home = _core.State()
    home.q = robot.home
    return max(0.1, *(float(np.linalg.norm(pose[:3, 3])) for pose in _core.body_poses(robot, home)))


def scene_of(robot: _core.Robot, terrain: _core.Terrain, width: int, height: int) -> mujoco.MjModel:
    """Make the model: every body of the robot is moved by hand, the last one is the sun. Frames are width x height."""
    spec = mujoco.MjSpec()
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
    spec.visual.quality.shadowsize = 2048
    # In extents. Shadows speckle the floor in a tighter clip.
    spec.stat.extent = 8 * reach_of(robot)
    spec.visual.map.znear, spec.visual.map.zfar, spec.visual.map.shadowclip = 0.01, 9, 1.1
    spec.visual.headlight.ambient = [0.35, 0.35, 0.35]
    spec.visual.headlight.diffuse = [0.3, 0.3, 0.3]
    spec.visual.headlight.specular = [0.05, 0.05, 0.05]
    spec.visual.rgba.haze = [0.80, 0.87, 0.93, 1]
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.42, 0.60, 0.80],
        rgb2=[0.80, 0.87, 0.93],
        width=256,
        height=1536,
    )
    picture = _add_ground(spec, terrain)
    _add_robot(spec, robot)
    _add_sun(spec, reach_of(robot))
    model = spec.compile()
    if picture is not None:
        start = model.tex_adr[model.texture("ground").id]
        model.tex_data[start : start + picture.size] = picture.ravel()
    return model


def _add_sun(spec: mujoco.MjSpec, reach: float) -> None:
    """A light that casts shadows. It goes with the base: shadows are drawn about it alone."""
    sun = spec.worldbody.add_body(name="sun", mocap=True)
    sun.add_light(
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=-8 * reach * _SUNSHINE,
        dir=_SUNSHINE,
        diffuse=[0.75, 0.73, 0.68],
        specular=[0.2, 0.2, 0.2],
        castshadow=True,
    )


def _add_ground(spec: mujoco.MjSpec, terrain: _core.Terrain) -> Frame | None:
    """Returns the picture that the texture "ground" is to show."""
    if terrain.heights is None or terrain.size is None:
        _add_floor(spec)
        return None
    return _add_height_field(spec, terrain.heights, terrain.size)


def _add_floor(spec: mujoco.MjSpec) -> None:
    spec.add_texture(
        name="floor",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=[0.63, 0.66, 0.69],
        rgb2=[0.54, 0.57, 0.60],
        width=256,
        height=256,
    )
    # Two squares along each side of the texture.
    repeats = 1 / (2 * SQUARE)
    floor = spec.add_material(name="floor", texuniform=True, texrepeat=[repeats, repeats])
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "floor"
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], material="floor")


def _add_height_field(spec: mujoco.MjSpec, heights: npt.NDArray[np.float32], size: tuple[float, float]) -> Frame:
    low, high = float(heights.min()), float(heights.max())
    rows, columns = heights.shape
    picture = _coloured(heights, size)
    spec.add_texture(
        name="ground",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,  # until it is painted
        width=picture.shape[1],
        height=picture.shape[0],
        nchannel=3,
    )
    ground = spec.add_material(name="ground", specular=0.1)
    ground.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "ground"
    spec.add_hfield(
        name="ground",
        nrow=rows,
        ncol=columns,
        size=[size[0] / 2, size[1] / 2, max(high - low, 1e-6), 0.05],
        userdata=(heights - low).flatten(),
    )
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_HFIELD, hfieldname="ground", material="ground", pos=[0, 0, low])
    return picture


def _coloured(heights: npt.NDArray[np.float32], size: tuple[float, float]) -> Frame:
    """A picture of the field from above, the largest y first: colours by height, and darker lines every `SQUARE`."""
    rows, columns = (min(_LARGEST_TEXTURE, max(512, round(length / SQUARE * 25))) for length in (size[1], size[0]))
    y, x = np.linspace(0, heights.shape[0] - 1, rows), np.linspace(0, heights.shape[1] - 1, columns)
    share = (heights - heights.min()) / max(float(np.ptp(heights)), 1e-9)
    shade = (255 * share).astype(np.uint8)[np.rint(y).astype(int)][:, np.rint(x).astype(int)]
    shades = _LOWEST + np.linspace(0, 1, 256)[:, None] * (_HIGHEST - _LOWEST)
    colours: Frame = np.stack((shades, 0.82 * shades)).astype(np.uint8)
    lines = _is_line(size[1], rows)[:, None] | _is_line(size[0], columns)
    picture: Frame = colours[lines.astype(np.uint8), shade][::-1]
    return picture


def _is_line(length: float, pixels: int) -> npt.NDArray[np.bool_]:
    """Which pixels of a row or column over `length` m, centred on the origin, are on a line."""
    place = np.linspace(-length / 2, length / 2, pixels)
    return np.abs(place - SQUARE * np.rint(place / SQUARE)) < max(0.003, length / pixels)


def _add_robot(spec: mujoco.MjSpec, robot: _core.Robot) -> None:
    bodies = [spec.worldbody.add_body(name=f"body {i}", mocap=True) for i in range(len(robot.bodies))]
    balls = set(range(len(bodies)))  # of which nothing but balls is drawn, or nothing
    meshes: dict[tuple[str, tuple[float, ...]], str | None] = {}
    unseen, dropped = set(range(len(bodies))), set[int]()
    for shape in robot.visuals:
        mesh = None
        if shape["type"] == "mesh":
            key = (shape["mesh"], tuple(shape["scale"]))
            if key not in meshes:
                # Of a file that is not there the robot's warnings tell.
                meshes[key] = _add_mesh(spec, f"mesh {len(meshes)}", *key) if shape["mesh"] else None
            mesh = meshes[key]
            if mesh is None:
                dropped.add(shape["body"])
                continue
        _add_shape(bodies[shape["body"]], shape, mesh, shape["rgba"])
        unseen.discard(shape["body"])
        balls.discard(shape["body"])
    bare = unseen | dropped
    for i, shape in enumerate(robot.collisions):
        if shape["body"] in bare:
            mesh = _add_hull(spec, f"hull {i}", shape["vertices"]) if shape["type"] == "hull" else None
            _add_shape(bodies[shape["body"]], shape, mesh, None)
            if shape["type"] != "sphere":
                balls.discard(shape["body"])
    if balls:
        home = _core.State()
        home.q = robot.home
        poses = _core.body_poses(robot, home)
        for body in balls:
            _add_sticks(bodies[body], robot, body, poses)


def _add_sticks(drawn: mujoco.MjsBody, robot: _core.Robot, body: int, poses: list[npt.NDArray[np.float64]]) -> None:
    """Along a link that would not be seen: from its origin to the bodies that hang on it, and to its own balls."""
    to_body = np.linalg.inv(poses[body])
    ends = [(to_body @ poses[i])[:3, 3] for i, parent in enumerate(robot.parents) if parent == body]
    ends += [shape["pose"][:3, 3] for shape in robot.collisions if shape["body"] == body]
    for end in ends:
        length = float(np.linalg.norm(end))
        if length > 0:
            size = [_STICK * reach_of(robot), 0, 0]
            drawn.add_geom(
                type=mujoco.mjtGeom.mjGEOM_CAPSULE,
                fromto=[0, 0, 0, *end],
                size=size,
                rgba=_PLAIN,
                contype=0,
                conaffinity=0,
            )


def _add_shape(
    body: mujoco.MjsBody, shape: dict[str, Any], mesh: str | None, rgba: npt.NDArray[np.float64] | None
) -> None:
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, shape["pose"][:3, :3].flatten())
    geom = body.add_geom(
        type=_GEOM_TYPES[shape["type"]],
        pos=shape["pose"][:3, 3],
        quat=quaternion,
        rgba=_PLAIN if rgba is None else rgba,
        contype=0,
        conaffinity=0,
    )
    if mesh is not None:
        geom.meshname = mesh
    else:
        geom.size = shape["size"]


def _add_mesh(spec: mujoco.MjSpec, name: str, file: str, scale: tuple[float, ...]) -> str | None:
    """Its name, or None, with a warning, if the file cannot be read. The core reads COLLADA, which MuJoCo does not."""
    settings: dict[str, Any] = {
        "scale": scale,
        "inertia": mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    }  # needs no volume
    probe = mujoco.MjSpec()
    try:
        if Path(file).suffix.lower() == ".dae":
            vertices, triangles = _core.read_mesh(file)
            settings |= {"uservert": vertices.flatten(), "userface": triangles.flatten()}
        else:
            settings["file"] = str(Path(file).absolute())
        probe.add_mesh(name=name, **settings)
        probe.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, contype=0, conaffinity=0)
        probe.compile()
    except ValueError as error:
        words = str(error).splitlines()[0]
        warnings.warn(f"{file} cannot be drawn ({words}); collision shapes stand in for it", stacklevel=2)
        return None
    spec.add_mesh(name=name, **settings)
    return name


def _add_hull(spec: mujoco.MjSpec, name: str, vertices: npt.NDArray[np.float64]) -> str:
    """A mesh of points alone is drawn by their convex hull."""
    spec.add_mesh(name=name, uservert=vertices.flatten(), inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX)
    return name
