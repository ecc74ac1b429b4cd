"""The solver in the viewport: what goals asked of the pose that is shown, and the particles and constraints behind it.

It is the pose that was solved for the character last; nothing is solved for drawing.
"""

from itertools import combinations

import bpy
import numpy as np

from ...core.arrays import Array
from ...core.solve.workings import Workings, workings_of
from ..morph import perform, query, stage
from ..morph.shown import Shown
from ..properties import of_rig
from ..rig import armature_of, pose_of
from .strokes import BLENDED, FIXED, LARGE, LIMB, LOOSE, MET, MISSED, PULL, SMALL, SPINE, THICK, THIN, Color, Stroke

MARK = 0.012
"""Half the width of the marks of goals, as a share of the character's size."""

_CORNERS: Array = np.concatenate([np.eye(3), -np.eye(3)])
_OCTAHEDRON: Array = _CORNERS[[pair for pair in combinations(range(6), 2) if pair[1] - pair[0] != 3]].reshape(-1, 3)
"""Both ends of its edges, shape (24, 3)."""


def strokes(ob: bpy.types.Object) -> list[Stroke]:
    """Return what is drawn of the pose that a character shows, nothing where it shows none that was solved."""
    shown = shown_now(ob)
    if shown is None:
        return []
    member, played = shown.member, shown.played
    found = workings_of(member.part.pose, played.goals, played.pose)
    back = member.character.local_to_character.inverse()

    def to_world(points: Array) -> Array:
        return stage.to_world(ob, back.points(points.reshape(-1, 3)))

    constraints = [(found.bones, LIMB), (found.spine, SPINE), (found.pulls, PULL)]
    out = [Stroke("LINES", to_world(ends), color, THIN) for ends, color in constraints]
    out += [Stroke("LINES", to_world(marks), color, THICK) for marks, color in _marks(found, member.bodies.size)]
    out.append(Stroke("POINTS", to_world(found.joints), LIMB, SMALL))
    out.append(Stroke("POINTS", to_world(found.branches), SPINE, LARGE))
    return [stroke for stroke in (*out, *_loose(ob, shown)) if len(stroke.places)]


def shown_now(ob: bpy.types.Object) -> Shown | None:
    """Return what a character shows, None where its bones are not as they were solved for its present action."""
    shown = perform.shown(ob)
    if shown is None or of_rig(ob).muted or ob.mode == "EDIT" or armature_of(ob).pose_position == "REST":
        return None
    return shown if query.member_now(ob) is shown.member else None


def _marks(found: Workings, size: float) -> list[tuple[Array, Color]]:
    """Return lines that tell what came of goals: a mark where each wants its body, and the way that is missing."""
    off = [(found.missed, MISSED), (found.blended, BLENDED), (found.fixed, FIXED)]
    out = [(found.asked[own][:, None] + MARK * size * _OCTAHEDRON, color) for own, color in [(found.met, MET), *off]]
    return out + [(np.stack([found.asked[own], found.came[own]], axis=1), color) for own, color in off]


def _loose(ob: bpy.types.Object, shown: Shown) -> list[Stroke]:
    """Return the bones that jiggle, and their tips, which are the particles of the jiggles."""
    driven = set(shown.member.part.pose.driven)
    names = [shown.member.rig.skeleton.names[bone] for bone in shown.played.bones.tolist() if bone not in driven]
    found = [bone for name in names if (bone := pose_of(ob).bones.get(name)) is not None]
    ends = np.array([(bone.head, bone.tail) for bone in found], dtype=np.float64).reshape(-1, 2, 3)
    return [
        Stroke("LINES", stage.to_world(ob, ends.reshape(-1, 3)), LOOSE, THIN),
        Stroke("POINTS", stage.to_world(ob, ends[:, 1]), LOOSE, SMALL),
    ]
