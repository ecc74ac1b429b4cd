"""From what is set in the window to what a retarget takes: plain data, gathered before any work."""

from collections.abc import Generator
from dataclasses import replace

import bpy

from ..core.character.character import Character
from ..core.errors import MotionError, RigError, listed
from ..core.ground import Ground
from . import actions, retarget, rig, sampling, terrain
from .contacts import Contact
from .properties import of_rig, of_scene
from .retarget import Options, Source
from .rig import Rig

Clips = list[tuple[bpy.types.Action, bpy.types.ActionSlot]]


def target_of(ob: bpy.types.Object) -> tuple[Rig, Character]:
    """Return an armature and what it is, with the user's corrections.

    Raises:
        RigError: It cannot be read.
        MappingError: A correction names a bone that is gone.
    """
    own = rig.read(ob)
    return own, retarget.character_of(own, of_rig(ob).overrides())


def options_of(scene: bpy.types.Scene, target: bpy.types.Object) -> Options:
    """Return what is chosen in the panel, with the target's own controls and jiggles.

    Raises:
        RigError: Only selected bones are to be moved, and none is selected.
    """
    only = frozenset(rig.selected_bones(target)) if of_scene(scene).selected_only else frozenset[str]()
    chosen = of_scene(scene).options()
    settings = replace(chosen.settings, also=of_rig(target).further())
    jiggles = of_rig(target).jiggles.settings() if of_scene(scene).jiggles else None
    return replace(
        chosen,
        settings=settings,
        controls=of_rig(target).controls(),
        reaches=of_rig(target).reaches(),
        only=only,
        jiggles=jiggles,
    )


def source_of(
    ob: bpy.types.Object, action: bpy.types.Action, slot: bpy.types.ActionSlot, scene: bpy.types.Scene
) -> Generator[float, None, Source]:
    """Sample a source's action in steps; yields the share done and returns the `Source`.

    Raises:
        MotionError: The action has no keys, or moves none of the rig's bones.
    """
    frames = of_scene(scene).options().frames
    return (yield from retarget.read_source(rig.read(ob), action, slot, scene, of_rig(ob).overrides(), frames))


def actions_of(ob: bpy.types.Object, name: str = "", every: bool = False) -> Clips:
    """Return the actions of a source that are meant: a named one, all that move it, or the one that it plays.

    Raises:
        MotionError: There is none.
    """
    fitting = actions.of_armature(ob)
    if name:
        fitting = [pair for pair in fitting if pair[0].name == name]
        if not fitting:
            names = listed([action.name for action, _ in actions.of_armature(ob)])
            raise MotionError(f"armature {ob.name!r} has no action {name!r}: choose one of {names or 'none'}")
        return fitting
    if every:
        if not fitting:
            raise MotionError(f"no action moves armature {ob.name!r}: import a clip, or choose another source")
        return fitting
    action, slot = actions.assigned(ob)
    if action is None:
        raise MotionError(f"armature {ob.name!r} plays no action: assign one to it, or use All Actions")
    slot = slot or actions.fitting_slot(action, ob)
    if slot is None:
        raise MotionError(f"action {action.name!r} has no slot for {ob.name!r}: choose one in the Action editor")
    return [(action, slot)]


def contacts_of(ob: bpy.types.Object, action: bpy.types.Action) -> list[Contact] | None:
    """Return the user's own contacts for an action of a source, None where the feet are to be watched instead."""
    settings = of_rig(ob)
    if settings.contacts_action != action.name or not settings.contacts:
        return None
    return [Contact(item.name, item.start, item.end) for item in settings.contacts]


def ground_of(scene: bpy.types.Scene, character: Character) -> Ground | None:
    """Return the terrain under a target, None for a flat floor."""
    chosen = of_scene(scene).ground
    return None if chosen is None else terrain.ground_of(chosen, character)


def armature(name: str, role: str) -> bpy.types.Object:
    """Return an armature object by its name.

    Raises:
        RigError: There is none.
    """
    found = bpy.data.objects.get(name)
    if found is None or found.type != "ARMATURE":
        names = listed([ob.name for ob in bpy.data.objects if ob.type == "ARMATURE"])
        raise RigError(f"there is no armature {name!r} for the {role}: choose one of {names or 'none'}")
    return found


def chosen(name: str, ob: bpy.types.Object | None, role: str) -> bpy.types.Object:
    """Return the armature called ``name``, or the one chosen in the panel.

    Raises:
        RigError: There is none.
    """
    if name:
        return armature(name, role)
    if ob is None:
        raise RigError(f"no {role} is chosen: set it in the panel, or give its name")
    return ob


def needs_steps(ob: bpy.types.Object, action: bpy.types.Action, slot: bpy.types.ActionSlot) -> bool:
    """Return whether an action can only be sampled by stepping through frames."""
    return bool(sampling.reasons_to_step(rig.read(ob), actions.curves(action, slot)))
