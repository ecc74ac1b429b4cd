"""What armatures keep of the actions that they play: places for the values of channels, and targets of their own."""

import bpy

from ...core.morph.bind import GeneralizedAction
from ...core.morph.channels import TargetKind
from ..properties import of_rig
from . import keys
from .properties import of_action
from .values import MORPHRETARGET_PG_values


def ensure(ob: bpy.types.Object, action: bpy.types.Action) -> None:
    """Give an armature a place for the values of each channel, and for those of the deforms that are keyed."""
    own = of_rig(ob).channels
    for item in of_action(action).channels:
        if item.name and item.name not in own:  # one that is just being made has no name yet
            own.add().name = item.name
        for deform in keys.deforms_of(action, item.name):
            if deform not in own[item.name].deforms:
                own[item.name].deforms.add().name = deform


def missing(ob: bpy.types.Object, definition: GeneralizedAction) -> set[int]:
    """Return the channels whose external target is not there on an armature."""
    items = of_rig(ob).channels
    external = [c.has_target and c.target is TargetKind.EXTERNAL for c in definition.channels]
    return {i for i, c in enumerate(definition.channels) if external[i] and not has_target(items[c.name])}


def has_target(values: MORPHRETARGET_PG_values) -> bool:
    """Return whether a channel has an external target that exists."""
    target = values.target
    if target is None or target.name not in bpy.data.objects:
        return False
    if not values.target_bone:
        return True
    return target.type == "ARMATURE" and target.pose is not None and values.target_bone in target.pose.bones


def keep_overrides() -> None:
    """Let what is overridden on armatures be saved.

    Blender 5.2 compares an override with its original in the library when a file is saved, and writes what it cannot
    read again where the original has none of our data at all. So the originals get some, for this session.
    """
    for ob in bpy.data.objects:
        override = ob.override_library
        if override is not None and ob.type == "ARMATURE" and isinstance(override.reference, bpy.types.Object):
            original = of_rig(override.reference)
            original.variant = original.variant
