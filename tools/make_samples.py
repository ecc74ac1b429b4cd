"""Makes `sample_blends/`: a clip, characters, actions and scenes of our own, small enough to be committed.

Run it with the Python of an environment that has Blender: ``.venv/blender-4.5/bin/python -m tools.make_samples``. The
oldest Blender that is supported writes the files, so that all others can read them. Names of files after the command,
such as ``stage.blend``, make these alone.
"""

import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import bpy
import numpy as np

from morph_retarget.blender import registration, rig
from morph_retarget.blender.io.save import Outbox

from . import acting, acts, armatures, bodies, creatures, directed, gait, stage, tries, walks
from .bodies import Color
from .figure import CHIBI, Bone, Build, blender, humanoid, spaced
from .flesh import Paint

SAMPLES = Path(__file__).resolve().parent.parent / "sample_blends"
FPS = 30
FRAMES = 181
COLORS: dict[str, dict[Paint, Color]] = {
    "biped": {Paint.SKIN: (0.8, 0.48, 0.33), Paint.PALE: (0.1, 0.13, 0.22), Paint.CLOTH: (0.75, 0.32, 0.08)},
    "hound": {Paint.SKIN: (0.5, 0.28, 0.12), Paint.PALE: (0.8, 0.66, 0.48)},
    "spider": {Paint.SKIN: (0.3, 0.16, 0.08), Paint.PALE: (0.78, 0.5, 0.16)},
    "beetle": {Paint.SKIN: (0.62, 0.07, 0.05), Paint.PALE: (0.6, 0.45, 0.22)},
    "bird": {Paint.SKIN: (0.12, 0.32, 0.7), Paint.PALE: (0.95, 0.48, 0.05)},
    "snake": {Paint.SKIN: (0.2, 0.42, 0.1), Paint.PALE: (0.62, 0.6, 0.16)},
    "asura": {Paint.SKIN: (0.5, 0.2, 0.45), Paint.PALE: (0.85, 0.6, 0.2), Paint.CLOTH: (0.85, 0.45, 0.12)},
    "lopside": {Paint.SKIN: (0.36, 0.44, 0.34), Paint.PALE: (0.55, 0.62, 0.42)},
}
"""What each creature is painted with."""


def main(chosen: Sequence[str] = ()) -> None:
    """Write all samples, or those that are chosen by the names of their files."""
    (SAMPLES / "characters").mkdir(parents=True, exist_ok=True)
    made: dict[str, Callable[[], Sequence[bpy.types.Object]]] = {
        "walk_and_wave.bvh": _clip,
        "sprout.blend": lambda: [_sprout()],
        "actions.blend": _actions,
        "stage.blend": _stage,
    }
    for name in creatures.CREATURES:
        made[f"characters/{name}.blend"] = partial(_character, name)
    for name in walks.WALKS:
        made[f"{name}.blend"] = partial(_walk, name)
    made[f"{directed.NAME}.blend"] = _directed
    if chosen:
        made = {path: made[path] for path in chosen}
    registration.register("morph_retarget")
    try:
        with Outbox() as outbox:
            for path, make in made.items():
                rigs = make()
                if path in tries.TRIES:
                    tries.write(path)
                outbox.rigs(SAMPLES / path, rigs)
    finally:
        registration.unregister()
    print(*made, sep="\n")


def _clip() -> list[bpy.types.Object]:
    """Return a figure that walks, and waves on its way: names, proportions and axes unlike those of the characters."""
    _empty("Walk and Wave")
    bones = humanoid(1.8, build=Build(spine=2))
    ob = armatures.build("Walker", [_renamed(bone) for bone in bones])
    own = rig.read(ob).skeleton
    # The formulas know the bones by the names of joints.
    joints = {spaced(bone.name): bone.name for bone in bones}
    figure = replace(own, names=tuple(joints[name] for name in own.names))
    made = gait.walk((FRAMES - 1) / FPS, FPS, height=1.8, wave=(1.6, 4.4))
    armatures.key(ob, own, gait.pose(figure, made), "Walk and Wave")
    return [ob]


def _renamed(bone: Bone) -> Bone:
    return replace(bone, name=spaced(bone.name), parent=bone.parent and spaced(bone.parent))


def _actions() -> list[bpy.types.Object]:
    """Make the generalized actions, and nothing else."""
    _empty("Actions")
    for act in acts.ACTS:
        acting.write(act)
    return []


def _stage() -> list[bpy.types.Object]:
    """Return all characters on one stage, playing one of the actions."""
    _empty("Stage")
    cast = {"Sprout": sprout(), **{name.capitalize(): creature(name) for name in creatures.CREATURES}}
    stage.furnish(cast)
    return list(cast.values())


def _sprout() -> bpy.types.Object:
    _empty("Sprout")
    return sprout()


def sprout() -> bpy.types.Object:
    """Return a small figure with a big head, a tail, fingers and twist bones, arms lowered, bones rolled at random."""
    build = Build(spine=4, fingers=3, twists=1, root=True, arms_down=40.0)
    bones = humanoid(1.1, CHIBI, build, blender)
    hips = next(bone for bone in bones if bone.name == "Hips")
    above, start = "Hips", np.array(hips.head) + np.array([0.0, 0.06, 0.0])
    for i in range(4):
        end = start + np.array([0.0, 0.07, 0.03 * i - 0.02])
        bones.append(Bone(f"Tail.{i + 1:03}", above, tuple(map(float, start)), tuple(map(float, end))))
        above, start = bones[-1].name, end
    ob = armatures.build("Sprout", bones, np.random.default_rng(7))
    bodies.clothe(ob, (0.25, 0.55, 0.3), 0.34)
    return ob


def _character(name: str) -> list[bpy.types.Object]:
    _empty(name.capitalize())
    return [creature(name)]


def _walk(name: str) -> list[bpy.types.Object]:
    _empty(name.replace("_", " ").title())
    ob = creature(walks.WALKS[name].creature)
    walks.furnish(walks.WALKS[name], ob)
    return [ob]


def _directed() -> list[bpy.types.Object]:
    """Return a character that is directed."""
    _empty(directed.NAME.replace("_", " ").title())
    ob = creature(directed.CREATURE)
    directed.furnish(ob)
    return [ob]


def creature(name: str) -> bpy.types.Object:
    """Return a creature in its own colors, bones rolled at random."""
    parts = creatures.CREATURES[name]()
    ob = armatures.build(name.capitalize(), parts, np.random.default_rng(7))
    bodies.dress(ob, parts, COLORS[name])
    return ob


def _empty(name: str) -> None:
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = rig.scene_of()
    scene.name = name
    scene.render.fps, scene.frame_start, scene.frame_end = FPS, 1, FRAMES


if __name__ == "__main__":
    main(sys.argv[1:])
    sys.stdout.flush()
    os._exit(0)  # Blender 4.5 as a module may block its end by a thread of its own
