"""Makes `sample_blends/`: a clip and a character of our own, small enough to be committed.

Run it with the Python of an environment that has Blender: ``.venv/blender-4.5/bin/python -m tools.make_samples``. The
oldest Blender that is supported writes the files, so that all others can read them.
"""

from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

from morph_retarget.blender import rig
from morph_retarget.blender.io.save import Outbox

from . import armatures, bodies, gait
from .figure import CHIBI, Bone, Build, blender, humanoid, spaced

SAMPLES = Path(__file__).resolve().parent.parent / "sample_blends"
FPS = 30
FRAMES = 181


def main() -> None:
    """Write all samples."""
    SAMPLES.mkdir(exist_ok=True)
    with Outbox() as outbox:
        for path, make in (("walk_and_wave.bvh", _clip), ("sprout.blend", _sprout)):
            outbox.rigs(SAMPLES / path, [make()])
    print(*sorted(p.name for p in SAMPLES.iterdir()), sep="\n")


def _clip() -> bpy.types.Object:
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
    return ob


def _renamed(bone: Bone) -> Bone:
    return replace(bone, name=spaced(bone.name), parent=bone.parent and spaced(bone.parent))


def _sprout() -> bpy.types.Object:
    """Return a small figure with a big head, a tail, fingers and twist bones, arms lowered, bones rolled at random."""
    _empty("Sprout")
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


def _empty(name: str) -> None:
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = rig.scene_of()
    scene.name = name
    scene.render.fps, scene.frame_start, scene.frame_end = FPS, 1, FRAMES


if __name__ == "__main__":
    main()
