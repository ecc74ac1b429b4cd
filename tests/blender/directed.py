"""Characters that do what they are told, for tests."""

import bpy

from morph_retarget.blender.directing.properties import MORPHRETARGET_PG_directing
from morph_retarget.blender.properties import of_rig
from tests.blender import acts


def biped() -> bpy.types.Object:
    """Return a creature that is the active object and does what it is told, without any commands yet."""
    made = acts.creature("biped")
    bpy.context.view_layer.objects.active = made
    assert bpy.ops.morph_retarget.direct(character=made.name) == {"FINISHED"}
    return made


def own(ob: bpy.types.Object) -> MORPHRETARGET_PG_directing:
    """Return what a character is told to do."""
    return of_rig(ob).directing
