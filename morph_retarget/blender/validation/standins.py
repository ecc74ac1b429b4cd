"""Stand-ins for external targets that a character's file does not give: something to reach for, within reach."""

import bpy

from ...core.morph.within_reach import within_reach
from .. import rig
from ..morph import cast, own_values, stage
from ..morph.member import Member
from ..properties import of_rig

NAME = "Within Reach"


def give(member: Member) -> bool:
    """Give the channels of a character that lack an external target one; return whether any did."""
    ob, lacking = member.rig.object, own_values.missing(member.rig.object, member.definition)
    if not lacking:
        return False
    made = bpy.data.objects.new(NAME, None)
    rig.scene_of().collection.objects.link(made)
    local = member.character.local_to_character.inverse().points(within_reach(member.bodies))
    made.location = stage.to_world(ob, local).tolist()
    for i in lacking:
        item = of_rig(ob).channels[member.definition.channels[i].name]
        item.target, item.target_bone = made, ""
    view = bpy.context.view_layer
    assert view is not None, "there is a scene while a file is open"
    view.update()
    cast.forget(ob)
    return True
