"""Where the targets of commands are over all frames of a scene, without stepping through them where keys tell."""

import bpy
import numpy as np

from ...core import play
from ...core.arrays import Array
from ...core.errors import MotionError
from .. import actions, rig, sampling, terrain, ways
from ..locomotion import walks
from ..morph import cast, stage, targets
from ..properties import of_rig
from . import orders
from .parameters import Target

SPACING = 1.0 / 16.0
"""Between points of a surface, as a share of its size."""
MOST_POINTS = 4000
"""Of a surface; coarser ones are taken of what has more."""


def reason_to_step(ob: bpy.types.Object, target: Target) -> str:
    """Return why only stepping through frames can tell a character where its target is, empty where keys tell."""
    other, bone = target
    if not targets.moves(other, bone):
        return ""
    if not ways.readable(other):
        return "more than keys moves it"
    if not bone:
        return ""
    if _performs(other):
        return "it follows the character itself" if ob in behind(other) else ""
    return next(iter(sampling.reasons_to_step(rig.read(other), _curves(other))), "")


def places(ob: bpy.types.Object, target: Target, frames: Array, graph: bpy.types.Depsgraph) -> Array:
    """Return where a target is in the world [m], shape (frame, 3), or (1, 3) for one that stands still.

    Args:
        ob: Whose target it is.
        target: The object, and maybe its bone.
        frames: Of the scene, shape (frame,).
        graph: Where the target is evaluated.

    Raises:
        MotionError: Only stepping through the frames can tell.
    """
    other, bone = target
    if not targets.moves(other, bone):
        return stage.place_of(other, bone, graph)[None]
    reason = reason_to_step(ob, target)
    if reason:
        raise MotionError(f"target {other.name!r}: {reason}, so it is followed when {ob.name!r} is baked")
    if not bone:
        return ways.world(other, frames)[:, :3, 3]
    local = _performed(other, bone, frames, graph) if _performs(other) else _posed(other, bone, frames)
    matrices = ways.world(other, frames)
    return (matrices[:, :3, :3] @ local[..., None])[..., 0] + matrices[:, :3, 3]


def behind(ob: bpy.types.Object) -> set[bpy.types.Object]:
    """Return all characters whose bones a character follows, and those that they follow."""
    found: set[bpy.types.Object] = set()
    waiting = [ob]
    while waiting:
        now = waiting.pop()
        for other, bone in orders.targets_of(now).values() if of_rig(now).directing.enabled else ():
            if bone and other not in found and _performs(other):
                found.add(other)
                waiting.append(other)
    return found


def _performs(ob: bpy.types.Object) -> bool:
    return cast.action_of(ob) is not None and not of_rig(ob).muted


def _performed(ob: bpy.types.Object, bone: str, frames: Array, graph: bpy.types.Depsgraph) -> Array:
    """Return where a bone of a character is in its object's space, its own targets left aside, shape (frame, 3)."""
    member, scene = cast.member(ob), graph.scene
    assert scene is not None, "what is evaluated has a scene"
    layer = walks.over(member, scene, graph, frames)
    if ob.session_uid in walks.problems:
        raise MotionError(walks.problems[ob.session_uid])
    played = play.evaluate(member.free, stage.values_over(member, ob, frames), {}, layer)
    body = member.rig.skeleton.index.get(bone)
    if body is None:
        raise MotionError(f"bone {bone!r} of {ob.name!r} is a control: choose one of the bones that move its mesh")
    return member.character.local_to_character.inverse().points(played.pose.positions[:, body])


def _posed(ob: bpy.types.Object, bone: str, frames: Array) -> Array:
    """Return where a bone is in its object's space as the keys of an ordinary action pose it, shape (frame, 3)."""
    own, found = rig.read(ob), _curves(ob)
    pose, _ = sampling.bones_from_curves(own, found, frames)
    return pose.positions[:, own.skeleton.index[bone]]


def _curves(ob: bpy.types.Object) -> actions.CurveMap:
    action, slot = actions.assigned(ob)
    return actions.curves(action, slot) if action is not None and slot is not None else {}


# --- surfaces ---


def surface_of(ob: bpy.types.Object, frame: float, graph: bpy.types.Depsgraph) -> Array | None:
    """Return points of a mesh as seen from its origin, along the world's axes [m], shape (point, 3); None for no mesh.

    Args:
        ob: The object.
        frame: At which it is seen if keys move it; else it is seen as it is.
        graph: Where it is evaluated.
    """
    if ob.type != "MESH":
        return None
    seen = np.array(ob.evaluated_get(graph).matrix_world, dtype=np.float64)
    matrix = ways.world(ob, np.array([frame]))[0] if ways.keyed(ob) else seen
    corners, triangles = terrain.surface_of(ob, graph, matrix)
    return spread(corners[triangles]) - matrix[:3, 3] if len(triangles) else None


def spread(triangles: Array) -> Array:
    """Return points spread evenly over triangles, their corners among them, shape (triangle, 3, 3) to (point, 3)."""
    edges = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=-1).max(axis=1)
    step = max(SPACING * float(np.linalg.norm(np.ptp(triangles.reshape(-1, 3), axis=0))), 1e-9)
    # A triangle with its edges in n parts has about n * n / 2 points.
    parts = np.maximum(np.ceil(edges / step), 1.0)
    if (parts * parts).sum() > 2.0 * MOST_POINTS:
        parts = np.maximum(np.floor(parts * np.sqrt(2.0 * MOST_POINTS / (parts * parts).sum())), 1.0)
    out: list[Array] = []
    for count in np.unique(parts).astype(int).tolist():
        i, j = np.array([(i, j) for i in range(count + 1) for j in range(count + 1 - i)]).T / count
        shares = np.stack([i, j, 1.0 - i - j], axis=-1)
        out.append((shares @ triangles[parts == count]).reshape(-1, 3))
    return np.unique(np.concatenate(out).round(7), axis=0)
