"""Sample scenes of locomotion: who goes where, at what speed and on what, with a light and a camera.

Blender has to know the extension's properties for this: register it first.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from morph_retarget.blender import rig
from morph_retarget.blender.locomotion import going
from morph_retarget.blender.locomotion.properties import Source
from morph_retarget.blender.properties import of_rig

from . import stage
from .figure import Point

SPEEDS: Mapping[int, float] = {
    1: 0.0, 20: 0.0, 45: 0.9, 105: 0.9, 125: 2.5, 170: 2.5, 195: 4.4, 235: 4.4, 255: 6.4, 295: 6.4, 340: 0.0,
}  # fmt: skip
"""Speed of the hound by frame [m/s]."""
GAITS: Mapping[str, int] = {"Stand": 1, "Walk": 45, "Trot": 125, "Canter": 195, "Gallop": 255, "Slow Down": 295}
"""Markers by name."""
STEP = (0.28, 0.08)
"""Depth and height of a stair's step [m]."""
STEPS = 9


@dataclass(frozen=True)
class Sample:
    """A scene of one character that goes."""

    creature: str
    """Name of a sample character."""
    frames: int
    """The last one; the first is 1."""
    furnish: Callable[[bpy.types.Object], None]
    """Makes the scene around the character."""


def furnish(sample: Sample, ob: bpy.types.Object) -> None:
    """Let a character go as a sample says, in the open scene.

    Args:
        sample: What to make.
        ob: The sample's character, alone in the scene.
    """
    scene = rig.scene_of()
    scene.frame_end = sample.frames
    bpy.ops.morph_retarget.add_locomotion(character=ob.name)
    sample.furnish(ob)
    scene.frame_set(1)


# --- the scenes ---


def _biped(ob: bpy.types.Object) -> None:
    """Walk in curves."""
    checkers("Floor", *lattice((-3.0, 3.0), (-8.0, 1.0), 0.5))
    path = _path([(0.0, 0.0, 0.0), (-0.9, -2.0, 0.0), (0.8, -4.4, 0.0), (-0.4, -6.9, 0.0)])
    _go(ob, source=Source.PATH.value, path=path, speed=1.3)
    light_and_camera((5.4, -10.6, 2.6), (-0.2, -3.6, 0.6))


def _hound(ob: bpy.types.Object) -> None:
    """Stand, walk, trot, canter, gallop and stop; the camera goes along."""
    checkers("Floor", *lattice((-2.0, 2.0), (-37.0, 3.0), 0.5))
    own = of_rig(ob).gait
    for frame, speed in SPEEDS.items():
        own.speed = speed
        ob.keyframe_insert(going.curve_path("speed"), frame=frame, group="Locomotion")
    for name, frame in GAITS.items():
        rig.scene_of().timeline_markers.new(name, frame=frame)
    light_and_camera((4.6, 0.0, 1.0), (0.0, 0.0, 0.45))
    follow = rig.scene_of().camera.constraints.new("COPY_LOCATION")
    follow.target, follow.subtarget = ob, "Hips"
    follow.use_x, follow.use_z, follow.use_offset = False, False, True


def _beetle(ob: bpy.types.Object) -> None:
    """Cross rough hills."""
    vertices, shape = lattice((-1.2, 1.2), (-3.8, 0.8), 0.1)
    vertices[:, 2] = _noise(vertices[:, 0], vertices[:, 1])
    _go(ob, ground=checkers("Hill", vertices, shape), speed=0.45, turn_rate=-0.03)
    light_and_camera((3.2, -4.6, 1.8), (0.0, -1.45, 0.0))


def _snake(ob: bpy.types.Object) -> None:
    """Wind along a path."""
    checkers("Floor", *lattice((-2.0, 2.0), (-4.5, 1.5), 0.25))
    path = _path([(0.0, 0.0, 0.0), (0.4, -1.0, 0.0), (-0.5, -2.3, 0.0), (0.2, -3.8, 0.0)])
    _go(ob, source=Source.PATH.value, path=path, speed=0.6)
    light_and_camera((2.6, -5.4, 2.0), (0.0, -1.6, 0.0))


def _spider(ob: bpy.types.Object) -> None:
    """Climb a stair."""
    _go(ob, ground=_stair(), speed=0.5)
    light_and_camera((5.2, -3.6, 1.8), (0.0, -1.55, 0.35))


WALKS: Mapping[str, Sample] = {
    "walk_biped": Sample("biped", 181, _biped),
    "gaits_hound": Sample("hound", 381, _hound),
    "hill_beetle": Sample("beetle", 181, _beetle),
    "crawl_snake": Sample("snake", 181, _snake),
    "stair_spider": Sample("spider", 181, _spider),
}
"""All of them by the names of their files."""


def _go(ob: bpy.types.Object, **settings: object) -> None:
    for name, value in settings.items():
        setattr(of_rig(ob).gait, name, value)


def light_and_camera(place: Point, target: Point) -> None:
    """Let the scene be rendered from a place, toward a target [m]."""
    x, y, z = np.array(target) - np.array(place)
    down, turn = float(np.arctan2(np.hypot(x, y), -z)), float(np.arctan2(-x, y))
    stage.light_and_camera(place, (down, 0.0, turn))


# --- what they go on and along ---


def _path(points: Sequence[Point]) -> bpy.types.Object:
    """Return a smooth curve through points."""
    curve = bpy.data.curves.new("Path", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("BEZIER")
    spline.bezier_points.add(len(points) - 1)
    for corner, place in zip(spline.bezier_points, points, strict=True):
        corner.co, corner.handle_left_type, corner.handle_right_type = place, "AUTO", "AUTO"
    return added(curve)


def lattice(x: tuple[float, float], y: tuple[float, float], cell: float) -> tuple[np.ndarray, tuple[int, int]]:
    """Return points ``cell`` [m] apart on the ground, shape (point, 3), and how many lie along X and along Y."""
    across, along = (np.linspace(*ends, round((ends[1] - ends[0]) / cell) + 1) for ends in (x, y))
    places = np.stack(np.meshgrid(across, along, [0.0], indexing="ij"), axis=-1)
    return places.reshape(-1, 3), (len(across), len(along))


def checkers(name: str, vertices: np.ndarray, shape: tuple[int, int]) -> bpy.types.Object:
    """Return a mesh of faces in two tints between points that lie in rows, as `lattice` gives them."""
    columns, rows = shape
    corners = [(i, j) for i in range(columns - 1) for j in range(rows - 1)]
    faces = [(i * rows + j, (i + 1) * rows + j, (i + 1) * rows + j + 1, i * rows + j + 1) for i, j in corners]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], faces)
    for tint in (0.2, 0.27):
        material = bpy.data.materials.new(name)
        material.diffuse_color = (tint, 1.05 * tint, 0.95 * tint, 1.0)
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", np.array([(i + j) % 2 for i, j in corners], dtype=np.int32))
    return added(mesh)


def _stair() -> bpy.types.Object:
    """Return steps that rise along -Y, level before and after them."""
    depth, height = STEP
    profile = [(1.5, 0.0)]
    for i in range(STEPS):
        y = -0.7 - i * depth
        profile += [(y, i * height), (y, (i + 1) * height)]
    profile.append((profile[-1][0] - 1.5, STEPS * height))
    vertices = np.array([(x, y, z) for x in np.linspace(-0.9, 0.9, 7) for y, z in profile[::-1]])
    return checkers("Stair", vertices, (7, len(profile)))


def _noise(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return heights of rough hills [m]: waves of all directions and lengths, level around the origin."""
    rng = np.random.default_rng(5)
    out = np.zeros_like(x)
    for length, height in ((1.1, 0.045), (0.7, 0.03), (0.45, 0.015)):
        for angle, phase in rng.uniform(0.0, 2.0 * np.pi, (3, 2)):
            way = x * np.cos(angle) + y * np.sin(angle)
            out += height * np.sin(2.0 * np.pi / length * way + phase) / np.sqrt(3.0)
    away = np.clip(np.hypot(x, y) / 0.6, 0.0, 1.0)
    return out * away**2 * (3.0 - 2.0 * away)


def added(data: bpy.types.ID) -> bpy.types.Object:
    """Return a new object of the open scene that has some data and its name."""
    ob = bpy.data.objects.new(data.name, data)
    rig.scene_of().collection.objects.link(ob)
    return ob
