"""The armatures of the scene in the window, kept from one event to the next.

Handlers run at each frame and each edit, and a scene may have ten thousand objects of which two are armatures: to look
at all of them each time would slow down everybody who has the extension switched on.
"""

import bpy

_kept: dict[int, list[bpy.types.Object]] = {}


def armatures(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Return the armatures of a scene, for handlers, which `notice` what Blender tells them."""
    found = _kept.get(scene.session_uid)
    if found is None or not _are_alive(found):
        found = [ob for ob in scene.objects if ob.type == "ARMATURE"]
        if scene == bpy.context.scene:  # of what is done to other scenes, Blender does not tell
            _kept[scene.session_uid] = found
    return found


def notice(graph: bpy.types.Depsgraph | None) -> None:
    """Look for armatures anew if objects may have come or gone, which Blender tells as an update of a collection."""
    if graph is None or graph.id_type_updated("COLLECTION"):
        forget()


def forget() -> None:
    """Drop what is kept: undo and loading replace all objects."""
    _kept.clear()


def _are_alive(found: list[bpy.types.Object]) -> bool:
    try:
        return all(ob.type == "ARMATURE" for ob in found)
    except ReferenceError:  # one was removed, and Blender has not told of it yet
        return False
