"""Contact sheets: a motion as a row of pictures over time, several characters below each other."""

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector
from PIL import Image, ImageDraw

from morph_retarget.blender.io.quiet import quiet

TILE = (200, 260)
BACKGROUND = (38, 40, 44)


@dataclass(frozen=True, eq=False)
class Row:
    """One character over time."""

    title: str
    armature: bpy.types.Object
    frames: Sequence[float]


def contact_sheet(
    path: Path,
    rows: Sequence[Row],
    view: tuple[float, float] = (-35.0, 12.0),
    tile: tuple[int, int] = TILE,
) -> None:
    """Render each character at each frame and write one picture.

    Args:
        path: PNG to write.
        rows: What to draw, with as many frames each.
        view: Turn about the vertical from the front, and height of the view [deg].
        tile: Width and height of one picture [px].
    """
    scene = bpy.context.scene
    camera = _camera(scene)
    engine(scene)
    scene.render.resolution_x, scene.render.resolution_y = tile
    label = 24
    columns = max(len(row.frames) for row in rows)
    sheet = Image.new("RGB", (tile[0] * columns, (tile[1] + label) * len(rows)), BACKGROUND)
    draw = ImageDraw.Draw(sheet)
    hidden = {ob: ob.hide_render for ob in scene.objects}
    with tempfile.TemporaryDirectory() as folder:
        for row, shown in enumerate(rows):
            armature = shown.armature
            own = {armature, *armature.children_recursive}
            for ob in scene.objects:
                ob.hide_render = ob.type == "MESH" and ob not in own and not ob.get("floor")
            size = _height(armature)
            for column, frame in enumerate(shown.frames):
                scene.frame_set(int(np.floor(frame)), subframe=frame - np.floor(frame))
                _aim(camera, armature, size, view, tile)
                picture = Path(folder, "tile.png")
                scene.render.filepath = str(picture)
                with quiet(errors=True):
                    bpy.ops.render.render(write_still=True)
                with Image.open(picture) as image:
                    sheet.paste(image.convert("RGB"), (column * tile[0], row * (tile[1] + label) + label))
                draw.text(
                    (column * tile[0] + 6, row * (tile[1] + label) + 6),
                    shown.title if column == 0 else f"{frame:g}",
                    fill=(220, 220, 220),
                )
    for ob, value in hidden.items():
        ob.hide_render = value
    bpy.data.objects.remove(camera)
    sheet.save(path)


def engine(scene: bpy.types.Scene) -> None:
    """Choose Workbench where it works, else Cycles, which needs no graphics driver."""
    scene.render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Standard"
    scene.render.film_transparent = False
    if scene.world is None:
        scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.06, 0.065, 0.075)
    if not _workbench_works():
        scene.render.engine = "CYCLES"
        scene.cycles.samples = 8
        scene.cycles.use_denoising = False
        scene.world.color = (0.8, 0.8, 0.8)
        return
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.display.shading.light = "STUDIO"
    scene.display.shading.color_type = "MATERIAL"
    scene.display.shading.show_shadows = True
    scene.display.shading.show_cavity = True
    scene.display.shading.background_type = "WORLD"


_PROBE = """
import bpy
bpy.ops.wm.read_factory_settings()
bpy.context.scene.render.engine = "BLENDER_WORKBENCH"
bpy.context.scene.render.resolution_x = bpy.context.scene.render.resolution_y = 8
bpy.ops.render.render()
"""


@cache
def _workbench_works() -> bool:
    """Return whether this machine has the graphics for Workbench; tried in a process of its own, since it may crash."""
    return subprocess.run([sys.executable, "-c", _PROBE], capture_output=True, check=False, timeout=120).returncode == 0


def _camera(scene: bpy.types.Scene) -> bpy.types.Object:
    camera = bpy.data.objects.new("Sheet Camera", bpy.data.cameras.new("Sheet Camera"))
    camera.data.type = "ORTHO"
    camera.data.clip_end = 1e5
    scene.collection.objects.link(camera)
    scene.camera = camera
    return camera


def _points(armature: bpy.types.Object) -> np.ndarray:
    """Return the corners of what is seen: the boxes around the meshes, or the bones."""
    meshes = [ob for ob in armature.children_recursive if ob.type == "MESH" and ob.visible_get()]
    graph = bpy.context.evaluated_depsgraph_get()
    boxes = [ob.evaluated_get(graph) for ob in meshes]
    corners = [ob.matrix_world @ Vector(c) for ob in boxes for c in ob.bound_box]
    return np.array(corners or [armature.matrix_world @ bone.head for bone in armature.pose.bones])


def _height(armature: bpy.types.Object) -> float:
    rest = [armature.matrix_world @ bone.head_local for bone in armature.data.bones if bone.parent]
    rest += [armature.matrix_world @ bone.tail_local for bone in armature.data.bones if bone.parent]
    return float(np.ptp(np.array(rest), axis=0).max())


def _aim(
    camera: bpy.types.Object, armature: bpy.types.Object, size: float, view: tuple[float, float], tile: tuple[int, int]
) -> None:
    points = _points(armature)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = Vector(0.5 * (low + high))
    turn, rise = np.radians(view)
    away = Vector((np.sin(turn) * np.cos(rise), -np.cos(turn) * np.cos(rise), np.sin(rise)))
    camera.location = middle + away * size * 10.0
    camera.rotation_euler = (-away).to_track_quat("-Z", "Y").to_euler()
    camera.data.ortho_scale = 1.35 * size * max(tile) / tile[1]
    camera.data.clip_start = 0.01 * size


def floor(size: float, height: float = 0.0) -> bpy.types.Object:
    """Return a checkered floor to judge sliding feet by."""
    steps, cell = 24, 0.25 * size
    vertices, faces, tints = [], [], []
    for i in range(-steps, steps):
        for j in range(-steps, steps):
            first = len(vertices)
            vertices += [((i + a) * cell, (j + b) * cell, height) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
            faces.append(tuple(range(first, first + 4)))
            tints.append((i + j) % 2)
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata(vertices, [], faces)
    for tint in (0.16, 0.24):
        material = bpy.data.materials.new("Floor")
        material.diffuse_color = (tint, tint, tint * 1.1, 1.0)
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", tints)
    ob = bpy.data.objects.new("Floor", mesh)
    ob["floor"] = True
    bpy.context.scene.collection.objects.link(ob)
    return ob
