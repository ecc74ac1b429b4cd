"""What users set in the window and files keep: a group on scenes, one on objects and one on actions."""

import bpy
from bpy.props import PointerProperty

from . import rig_properties, scene_properties
from .declaring import OVERRIDABLE
from .directing import properties as directing
from .locomotion import properties as locomotion
from .morph import jiggle_properties, solver_properties, values
from .morph import properties as morph
from .rig_properties import MORPHRETARGET_PG_rig
from .scene_properties import MORPHRETARGET_PG_scene


def of_scene(scene: bpy.types.Scene) -> MORPHRETARGET_PG_scene:
    """Return a scene's settings."""
    return scene.morph_retarget  # type: ignore[attr-defined]


def of_rig(ob: bpy.types.Object) -> MORPHRETARGET_PG_rig:
    """Return what is known about an armature."""
    return ob.morph_retarget  # type: ignore[attr-defined]


CLASSES = (
    *values.CLASSES,
    *jiggle_properties.CLASSES,
    *solver_properties.CLASSES,
    *locomotion.CLASSES,
    *directing.CLASSES,
    *morph.CLASSES,
    *rig_properties.CLASSES,
    *scene_properties.CLASSES,
)


def attach() -> None:
    """Put the groups on scenes, objects and actions."""
    morph.attach()
    rig = PointerProperty(type=MORPHRETARGET_PG_rig, name="Morph Retarget", override=OVERRIDABLE)
    scene = PointerProperty(type=MORPHRETARGET_PG_scene, name="Morph Retarget")
    bpy.types.Object.morph_retarget = rig  # type: ignore[attr-defined]
    bpy.types.Scene.morph_retarget = scene  # type: ignore[attr-defined]


def detach() -> None:
    """Take them off again."""
    del bpy.types.Scene.morph_retarget  # type: ignore[attr-defined]
    del bpy.types.Object.morph_retarget  # type: ignore[attr-defined]
    morph.detach()
