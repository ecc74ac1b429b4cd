"""Scenes for tests: bodies that walk, bodies that are to walk, and where Blender itself says their bones are."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import bpy
import numpy as np

from morph_retarget.blender import actions, retarget, rig
from morph_retarget.blender.actions import Writer
from morph_retarget.blender.retarget import Options, Outcome, Source
from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.skeleton import Pose
from tools import armatures, gait
from tools.figure import CHIBI, Bone, Build, blender, humanoid, moved, vrm

FPS = 30
STEP = gait.CYCLE
"""Duration of the usual clip [s]: one cycle of the walk."""
COUNT = 34
"""Frames of the usual clip."""
FRAMES = range(1, COUNT + 1)
SHOWN = FRAMES[::3]
"""Frames at which it is enough to look."""
SPROUT = {"height": 1.1, "proportions": CHIBI, "build": Build(spine=4, fingers=2, root=True, arms_down=40.0)}
"""A body unlike the one that walks: small, big-headed, arms lowered, with a root bone."""
NASTY = 'Bob\'s "rig" [1] 😀\\x'

_LIMBS = (("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot"))
SEGMENTS = [("hips", "head"), *((s + a, s + b) for s in ("left", "right") for a, b in _LIMBS)]
ARMS = [(a, b) for a, b in SEGMENTS if "Arm" in a]


def empty(fps: float = FPS) -> bpy.types.Scene:
    """Close what is open and return a scene without objects."""
    bpy.ops.wm.read_homefile(filepath=str(_home()))
    scene = bpy.context.scene
    scene.render.fps = fps
    return scene


@cache
def _home() -> Path:
    """Return Blender's own empty file, saved by this version: it is read in half the time of what Blender brings."""
    bpy.ops.wm.read_homefile(use_empty=True)
    return save(Path(bpy.app.tempdir, "home.blend"))


def save(path: Path) -> Path:
    """Save the open file under ``path`` and return it."""
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


def link(path: Path, name: str) -> bpy.types.Object:
    """Link an object of another file into the scene."""
    with bpy.data.libraries.load(str(path), link=True) as (_, wanted):
        wanted.objects = [name]
    (ob,) = wanted.objects
    bpy.context.scene.collection.objects.link(ob)
    bpy.context.view_layer.update()
    return ob


def matrix(turn: Sequence[float] = (0, 0, 0), scale: object = 1.0, place: Sequence[float] = (0, 0, 0)) -> Array:
    """Return an object matrix, shape (4, 4), from a rotation vector [deg], a scale and a location."""
    out = np.eye(4)
    out[:3, :3] = quat.to_matrix(quat.from_rotation_vector(np.radians(turn))) * np.asarray(scale)
    out[:3, 3] = place
    return out


def stand(ob: bpy.types.Object, place: Array, parent: bpy.types.Object | None = None) -> None:
    """Put an object somewhere in the world, on a parent if there is one."""
    ob.parent = parent
    bpy.context.view_layer.update()
    ob.matrix_world = place.T.tolist()
    bpy.context.view_layer.update()


def select(*obs: bpy.types.Object) -> None:
    """Select some objects and no others, in Object mode; the last one becomes the active one."""
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    for other in bpy.context.view_layer.objects:
        other.select_set(other in obs)
    bpy.context.view_layer.objects.active = obs[-1] if obs else None


def empty_object(name: str = "Empty") -> bpy.types.Object:
    """Return a new object without data."""
    ob = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(ob)
    return ob


def figure(
    name: str,
    *,
    seed: int | None = None,
    names: Callable[[str], str] = vrm,
    place: Array | None = None,
    extra: Iterable[Bone] = (),
    **options: object,
) -> bpy.types.Object:
    """Return an armature that stands at the world's origin and looks along -Y, wherever its object is.

    Args:
        name: Of the object.
        seed: Gives bones random rolls.
        names: Canonical joint to bone name.
        place: Matrix of the object; its bones are moved back by it.
        extra: Further bones.
        options: Of `humanoid`.
    """
    bones = [*humanoid(names=names, **options), *extra]
    if place is not None:
        bones = moved(bones, np.linalg.inv(place))
    ob = armatures.build(name, bones, None if seed is None else np.random.default_rng(seed))
    if place is not None:
        stand(ob, place)
    return ob


def walker(
    name: str = "Walker",
    *,
    seconds: float = STEP,
    fps: float = FPS,
    action: str = "Walk",
    wave: tuple[float, float] | None = None,
    **options: object,
) -> bpy.types.Object:
    """Return an armature that walks along -Y of the world from frame 1 on; options are those of `figure`."""
    ob = figure(name, **options)
    walk(ob, gait.walk(seconds, fps, options.get("height", 1.75), wave), action, options.get("names", vrm))
    return ob


def walk(ob: bpy.types.Object, made: gait.Walk, action: str, names: Callable[[str], str] = vrm) -> bpy.types.Action:
    """Return a walk as a new action of a figure, which then plays it."""
    own = rig.read(ob)
    joints = {names(joint): joint for joint in _JOINTS}
    standing = replace(
        own.skeleton,
        names=tuple(joints.get(name, name) for name in own.skeleton.names),
        rest_positions=own.placement.points(own.skeleton.rest_positions),
        rest_rotations=quat.identity(len(own.skeleton)),
        rest_tails=own.placement.points(own.skeleton.rest_tails),
    )
    in_world, back = gait.pose(standing, made), own.placement.inverse()
    turns = quat.multiply(back.turns(in_world.rotations), own.skeleton.rest_rotations)
    return armatures.key(ob, own.skeleton, Pose(turns, back.points(in_world.positions)), action)


_JOINTS = [bone.name for bone in humanoid(build=Build(fingers=5, twists=3, root=True))]


def sprout(name: str = "Sprout", **options: object) -> bpy.types.Object:
    """Return a body unlike the one that walks, with names in Blender's manner and bones rolled at random."""
    return figure(name, seed=7, names=blender, **(SPROUT | options))


# --- what Blender makes of it ---


def evaluated(ob: bpy.types.Object, bones: Iterable[str], frames: Iterable[float]) -> Array:
    """Return the world matrices of bones as Blender evaluates them, shape (frame, bone, 4, 4)."""
    scene, place = bpy.context.scene, {name: i for i, name in enumerate(ob.pose.bones.keys())}
    wanted = [place[bone] for bone in bones]
    found = np.empty(16 * len(place), dtype=np.float32)
    out: list[Array] = []
    for frame in frames:
        whole = int(np.floor(frame))
        scene.frame_set(whole, subframe=float(frame) - whole)
        seen = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
        seen.pose.bones.foreach_get("matrix", found)
        matrices = found.astype(np.float64).reshape(-1, 4, 4).transpose(0, 2, 1)
        out.append(np.array(seen.matrix_world) @ matrices[wanted])
    return np.array(out)


def heads(ob: bpy.types.Object, bones: Iterable[str], frames: Iterable[float]) -> Array:
    """Return the places of bones in the world as Blender evaluates them, shape (frame, bone, 3)."""
    return evaluated(ob, bones, frames)[..., :3, 3]


def ends(ob: bpy.types.Object, bones: Iterable[str], frames: Iterable[float]) -> Array:
    """Return the places of both ends of bones in the world as Blender evaluates them, shape (frame, 2 bones, 3)."""
    bones = list(bones)
    found = evaluated(ob, bones, frames)
    lengths = np.array([ob.data.bones[bone].length for bone in bones])
    tails = found[..., :3, 3] + found[..., :3, 1] * lengths[:, None]
    return np.concatenate([found[..., :3, 3], tails], axis=1)


def directions(
    ob: bpy.types.Object,
    frames: Iterable[float],
    names: Callable[[str], str] = vrm,
    segments: Sequence[tuple[str, str]] = SEGMENTS,
) -> Array:
    """Return the directions of a body's segments in the world, shape (frame, segment, 3)."""
    ends = heads(ob, [names(joint) for segment in segments for joint in segment], frames)
    return quat.unit(ends[:, 1::2] - ends[:, ::2])


def angle(a: Array, b: Array) -> float:
    """Return the largest angle between unit vectors that should be one [deg]."""
    return float(np.degrees(2.0 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=-1) / 2.0, 0.0, 1.0))).max())


def difference(a: Array, b: Array) -> float:
    """Return the largest difference between numbers that should be one."""
    return float(np.abs(a - b).max())


def apart(a: Array, b: Array) -> float:
    """Return the largest distance between points that should be one."""
    return float(np.linalg.norm(np.subtract(a, b), axis=-1).max())


def shape(found: Array) -> Array:
    """Return what is known of directions without knowing which way a body faces: their cosines with each other."""
    up = np.broadcast_to([0.0, 0.0, 1.0], (*found.shape[:-2], 1, 3))
    return found @ np.concatenate([found, up], axis=-2).swapaxes(-1, -2)


def over_action(ob: bpy.types.Object, count: int) -> Array:
    """Return frames spread evenly over what an object plays, both ends included."""
    first, last = ob.animation_data.action.frame_range
    return np.linspace(first, last, count)


def seconds_of(ob: bpy.types.Object) -> float:
    """Return how long an object's action lasts at the scene's frame rate [s]."""
    render = bpy.context.scene.render
    first, last = ob.animation_data.action.frame_range
    return (last - first) * render.fps_base / render.fps


def only_armature() -> bpy.types.Object:
    """Return the armature of the open file."""
    (ob,) = [ob for ob in bpy.data.objects if ob.type == "ARMATURE"]
    return ob


def curves_of(ob: bpy.types.Object) -> dict[tuple[str, int], bpy.types.FCurve]:
    """Return the F-curves that an object plays, by path and index."""
    return actions.curves(*actions.assigned(ob))


def keys_of(action: bpy.types.Action) -> dict[tuple[str, str, int], tuple[bytes, ...]]:
    """Return all that can be seen of an action's keys, by slot, path and index."""
    out: dict[tuple[str, str, int], tuple[bytes, ...]] = {}
    for slot in action.slots:
        for (path, index), curve in actions.curves(action, slot).items():
            out[slot.identifier, path, index] = tuple(_values(curve.keyframe_points, *kind) for kind in _OF_KEYS)
    return out


_OF_KEYS = (
    ("co", 2, np.float32),
    ("handle_left", 2, np.float32),
    ("handle_right", 2, np.float32),
    ("handle_left_type", 1, np.uint8),
    ("handle_right_type", 1, np.uint8),
    ("interpolation", 1, np.uint8),
    ("easing", 1, np.uint8),
)


def _values(points: bpy.types.FCurveKeyframePoints, name: str, width: int, kind: type) -> bytes:
    values = np.empty(len(points) * width, dtype=kind)
    points.foreach_get(name, values)
    return values.tobytes()


# --- the steps of a retarget ---


def source_of(ob: bpy.types.Object, frames: tuple[int, int] | None = None) -> Source:
    """Return what an armature plays as a source."""
    action, slot = actions.assigned(ob)
    return retarget.run(retarget.read_source(rig.read(ob), action, slot, bpy.context.scene, frames=frames))


def give(source: Source, target: bpy.types.Object, options: Options | None = None) -> Outcome:
    """Retarget a source onto an armature."""
    own = rig.read(target)
    return retarget.retarget(source, own, retarget.character_of(own), options or Options(), bpy.context.scene)


def key(ob: bpy.types.Object, name: str, channels: dict[str, Array], first: int = 1) -> bpy.types.Action:
    """Return a new action that keys properties on every frame, values of shape (frame, n); the object plays it."""
    writer = Writer(name, ob)
    for path, values in channels.items():
        writer.write(path, np.asarray(values, dtype=float), np.arange(first, first + len(values), dtype=float), "Keys")
    actions.assign(ob, writer.action, writer.slot)
    return writer.action


def played(ob: bpy.types.Object, bones: Iterable[str] | None = None) -> Array:
    """Return the places of the body's bones in the world, at both ends, over the usual clip, shape (frame, end, 3)."""
    return ends(ob, bones or [bone.name for bone in ob.pose.bones if bone.name != "Root"], SHOWN)


def played_plainly(source: Source, options: Options | None = None) -> Array:
    """Return the same of the small body when nothing about it is odd."""
    ob = sprout("Plain")
    give(source, ob, options)
    return played(ob)


def close_up(point: Sequence[float], width: float, pixels: int = 4, samples: int = 1) -> None:
    """Let Cycles look along -X at a point of the world, with nothing behind what is there.

    Args:
        point: What is in the middle [m].
        width: Of the picture [m].
        pixels: Of its sides.
        samples: Of each pixel.
    """
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.data.type, camera.data.ortho_scale = "ORTHO", width
    camera.location, camera.rotation_euler = (point[0] + 3.0, point[1], point[2]), (np.pi / 2.0, 0.0, np.pi / 2.0)
    scene.camera, render = camera, scene.render
    render.engine, scene.cycles.samples, render.film_transparent = "CYCLES", samples, True
    render.resolution_x = render.resolution_y = pixels
    render.image_settings.color_mode = "RGBA"


def covered(frame: int, folder: Path, name: str) -> Array:
    """Render one frame and return how far each pixel is covered, 0 to 1, shape (pixel,)."""
    scene = bpy.context.scene
    scene.frame_start = scene.frame_end = frame
    scene.render.filepath = str(folder / f"{name}.png")
    bpy.ops.render.render(animation=True)
    image = bpy.data.images.load(next(map(str, folder.glob(f"{name}.png*"))))
    return np.array(image.pixels[:])[3::4]
