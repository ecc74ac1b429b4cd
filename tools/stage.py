"""A stage for generalized actions: characters apart from each other, fruit within their reach, two to shake hands."""

from collections.abc import Mapping

import bpy
import numpy as np

from morph_retarget.blender import rig
from morph_retarget.blender.morph import analyses, stage
from morph_retarget.core.morph.context import select
from morph_retarget.core.morph.within_reach import within_reach

from . import acting, acts, flesh
from .figure import Point
from .flesh import Lump

FIRST_ACT = "Eat Fruit"
FRUIT = 0.02
"""Radius of a fruit as a share of its character's size."""
PLACES: Mapping[str, tuple[float, float, float]] = {
    "Biped": (-2.55, 0.6, 90.0),
    "Asura": (-1.55, 0.6, -90.0),
    "Lopside": (0.5, 0.9, 0.0),
    "Sprout": (2.0, 0.7, -10.0),
    "Snake": (-1.9, -1.5, 30.0),
    "Hound": (-0.45, -1.0, 25.0),
    "Beetle": (0.8, -1.3, 10.0),
    "Spider": (1.75, -1.6, -10.0),
    "Bird": (2.6, -0.7, -20.0),
}
"""Place on the ground [m] and turn to the left [deg] of each character; the first two face each other."""
PARTNERS = (("Biped", "Asura"), ("Asura", "Biped"))


def furnish(characters: Mapping[str, bpy.types.Object]) -> None:
    """Place characters, give each its fruit and let them play; the other actions are ready to be chosen.

    Args:
        characters: By name.
    """
    for name, ob in characters.items():
        x, y, turn = PLACES[name]
        ob.location, ob.rotation_euler = (x, y, 0.0), (0.0, 0.0, float(np.radians(turn)))
    light_and_camera((0.1, -10.4, 3.2), (1.32, 0.0, 0.01))
    bpy.context.view_layer.update()
    fruits = {name: fruit(ob, f"Fruit of {name}") for name, ob in characters.items()}
    made = {act.name: acting.write(act) for act in acts.ACTS}
    for name, ob in characters.items():
        for act in acts.ACTS:
            acting.cue(ob, made[act.name], act)
            acting.aim(ob, act, fruits[name])
    for name, partner in PARTNERS:
        meet(characters[name], characters[partner])
    first = acts.named(FIRST_ACT)
    for name, ob in characters.items():
        acting.play(ob, made[FIRST_ACT], first, fruits[name])
    scene = rig.scene_of()
    scene.frame_start, scene.frame_end = 1, first.frames
    scene.frame_set(1)


def meet(ob: bpy.types.Object, partner: bpy.types.Object) -> None:
    """Let a character shake the right hand of another one, the outermost if that has several."""
    act = acts.named("Shake Hands")
    shake = next(track.channel for track in act.tracks if track.channel.name == "Shake")
    bodies = analyses.of(partner)[2]
    found = select(shake.context, bodies)
    acting.aim(ob, act, partner, bodies.names[found[0]])


def fruit(ob: bpy.types.Object, name: str = "Fruit") -> bpy.types.Object:
    """Return a new fruit that a character can reach with each of its graspers."""
    _, character, bodies = analyses.of(ob)
    made = bpy.data.objects.new(name, fruit_mesh(name, FRUIT * bodies.size))
    rig.scene_of().collection.objects.link(made)
    local = character.local_to_character.inverse().points(within_reach(bodies))
    made.location = stage.to_world(ob, local).tolist()
    bpy.context.view_layer.update()
    return made


def fruit_mesh(name: str, radius: float) -> bpy.types.Mesh:
    """Return a red ball of some radius [m]."""
    round_lump = Lump((0.0, 0.0, -0.1 * radius), (0.0, 0.0, 0.1 * radius), (radius, radius), sides=12)
    vertices, faces = flesh.mesh(round_lump)
    data = bpy.data.meshes.new(name)
    data.from_pydata(vertices.tolist(), [], faces)
    data.polygons.foreach_set("use_smooth", np.ones(len(data.polygons), dtype=bool))
    material = bpy.data.materials.get("Fruit") or bpy.data.materials.new("Fruit")
    material.diffuse_color = (0.85, 0.05, 0.04, 1.0)
    data.materials.append(material)
    return data


def light_and_camera(place: Point, rotation: Point) -> None:
    """Let the scene be rendered as it is.

    Args:
        place: Of the camera [m].
        rotation: Of the camera, as Blender's Euler angles [rad].
    """
    scene = rig.scene_of()
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.rotation_euler = (0.7, 0.2, 0.4)
    sun.data.energy = 3.0
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = place, rotation
    for ob in (sun, camera):
        scene.collection.objects.link(ob)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("World")
    scene.world.color = (0.3, 0.3, 0.32)
