"""Things in the open file that no operation means: whatever is done, they stay as they are."""

import hashlib
from collections.abc import Iterator

import bpy
import numpy as np

from morph_retarget.blender import actions
from morph_retarget.blender.properties import of_rig
from tools import armatures
from tools.figure import humanoid

NAME = "Bystander"
_PROPERTIES = ("location", "rotation_quaternion", "rotation_euler", "scale")


def add() -> None:
    """Add them to the open file."""
    ob = armatures.build(NAME, humanoid(1.6))
    rng = np.random.default_rng(5)
    for bone in ob.pose.bones:
        bone.rotation_quaternion = rng.normal(size=4)
        bone.location = rng.normal(size=3)
    ob.location, ob["mine"] = (5.0, 1.0, 0.5), "kept"
    of_rig(ob).bends_spine = True
    box = bpy.data.objects.new(f"{NAME} Box", bpy.data.meshes.new(NAME))
    box.data.from_pydata(rng.normal(size=(8, 3)).tolist(), [], [(0, 1, 2), (3, 4, 5)])
    bpy.context.scene.collection.objects.link(box)
    writer = actions.Writer(NAME, box)
    writer.write("location", rng.normal(size=(20, 3)), np.arange(1.0, 21.0), "Way")
    actions.assign(box, writer.action, writer.slot)
    bpy.data.texts.new(NAME).write("Nobody touches this.")
    bpy.context.scene["mine"] = 42
    bpy.context.view_layer.objects.active = None


def fingerprint() -> str:
    """Return what changes when any of them does; says what is missing."""
    digest = hashlib.sha256()
    for part in _parts():
        digest.update(part)
    return digest.hexdigest()


def _parts() -> Iterator[bytes]:
    ob, box = bpy.data.objects.get(NAME), bpy.data.objects.get(f"{NAME} Box")
    text, action = bpy.data.texts.get(NAME), bpy.data.actions.get(NAME)
    if ob is None or box is None or text is None or action is None:
        raise LookupError("a bystander is gone")
    yield f"{ob['mine']} {bpy.context.scene['mine']} {of_rig(ob).bends_spine} {text.as_string()}".encode()
    yield f"{ob.animation_data} {box.animation_data.action.name} {ob.users_collection}".encode()
    yield np.array(ob.matrix_basis).tobytes()
    for name in _PROPERTIES:
        values = np.empty(len(ob.pose.bones) * (4 if "quaternion" in name else 3), dtype=np.float32)
        ob.pose.bones.foreach_get(name, values)
        yield values.tobytes()
    heads = np.empty(len(ob.data.bones) * 3, dtype=np.float32)
    ob.data.bones.foreach_get("head_local", heads)
    yield heads.tobytes()
    places = np.empty(len(box.data.vertices) * 3, dtype=np.float32)
    box.data.vertices.foreach_get("co", places)
    yield places.tobytes()
    slot = box.animation_data.action_slot
    for curve in actions.curves(action, slot).values():
        keys = np.empty(len(curve.keyframe_points) * 2, dtype=np.float32)
        curve.keyframe_points.foreach_get("co", keys)
        yield keys.tobytes()
