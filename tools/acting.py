"""Generalized actions from descriptions: channels with keys become Actions, and characters play them.

Blender has to know the extension's properties for this: register it first.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np

from morph_retarget.blender import actions
from morph_retarget.blender.morph import analyses, cast, choice, definitions, keys, own_values
from morph_retarget.blender.morph.properties import of_action
from morph_retarget.blender.properties import of_rig
from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.morph import branch
from morph_retarget.core.morph.branch import Branch
from morph_retarget.core.morph.channels import Channel, TargetKind

Vector = tuple[float, float, float]
_BEZIER, _AUTO_CLAMPED = 2, 4


@dataclass(frozen=True)
class Track:
    """A channel and its keys, by frame."""

    channel: Channel
    position: Mapping[int, Vector] = field(default_factory=dict[int, Vector])
    """Generalized positions."""
    turn: Mapping[int, Vector] = field(default_factory=dict[int, Vector])
    """Generalized rotations as rotation vectors [deg]: forward, to the left side and to look left are positive."""
    weight: Mapping[int, float] = field(default_factory=dict[int, float])
    deforms: Mapping[str, Mapping[int, float]] = field(default_factory=dict[str, Mapping[int, float]])
    """Scalar curves by the name of the deform."""


@dataclass(frozen=True)
class Act:
    """A generalized action as data."""

    name: str
    frames: int
    """Its last one; the first is 1."""
    tracks: Sequence[Track]
    """The first to select a body owns it, unless a later one has a higher priority."""
    events: Mapping[str, int] = field(default_factory=dict[str, int])
    """Pose markers by name."""
    movement: str = ""
    """Acts of one movement are branches of it."""
    branch: Branch = field(default_factory=Branch)
    cyclic: bool = False


def write(act: Act) -> bpy.types.Action:
    """Return a description as a new action of the open file."""
    action = bpy.data.actions.new(act.name)
    action.use_fake_user = True
    action.use_frame_range, action.use_cyclic = True, act.cyclic
    action.frame_start, action.frame_end = 1.0, float(act.frames)
    bag = keys.bag_of(action)
    for track in act.tracks:
        definitions.add(action, track.channel)
        for path, frames, values in _curves(track):
            for i, column in enumerate(values.T):
                _write_curve(bag, path, i, track.channel.name, frames, column, act.cyclic)
    own = of_action(action)
    own.movement, own.leg_count = act.movement, -1 if act.branch.leg_count is None else act.branch.leg_count
    for name in ("upright_spine", "has_graspers", "has_feet", "has_mouth", "has_tail", "has_wings"):
        setattr(own, name, getattr(act.branch, name).value)
    for name, frame in act.events.items():
        action.pose_markers.new(name).frame = frame
    return action


def _curves(track: Track) -> list[tuple[str, Array, Array]]:
    """Return the data path, frames and values, shape (key, n), of what a track keys."""
    name = track.channel.name
    out: list[tuple[str, Array, Array]] = []
    if track.position:
        out.append((keys.path(name, "position"), *_keyed(track.position)))
    if track.turn:
        frames, turns = _keyed(track.turn)
        rotations = quat.continuous(quat.from_rotation_vector(np.radians(turns)))
        out.append((keys.path(name, "rotation"), frames, rotations))
    if track.weight:
        out.append((keys.path(name, "weight"), *_keyed(track.weight)))
    out += [(keys.deform_path(name, deform), *_keyed(curve)) for deform, curve in track.deforms.items()]
    return out


def _keyed(found: Mapping[int, float] | Mapping[int, Vector]) -> tuple[Array, Array]:
    frames = sorted(found)
    values = np.array([found[frame] for frame in frames], dtype=np.float64)
    return np.array(frames, dtype=np.float64), values.reshape(len(frames), -1)


def _write_curve(
    bag: bpy.types.ActionChannelbag, path: str, index: int, group: str, frames: Array, values: Array, cyclic: bool
) -> None:
    curve = bag.fcurves.new(path, index=index)
    actions.put_in_group(bag, curve, group)
    points, count = curve.keyframe_points, len(frames)
    points.add(count)
    points.foreach_set("co", np.column_stack([frames, values]).astype(np.float32).ravel())
    points.foreach_set("interpolation", np.full(count, _BEZIER, dtype=np.uint8))
    for side in ("left", "right"):
        points.foreach_set(f"handle_{side}_type", np.full(count, _AUTO_CLAMPED, dtype=np.uint8))
    if cyclic and count > 1:
        curve.modifiers.new("CYCLES")
    curve.update()


# --- characters ---


def fitting(acts: Sequence[Act], movement: str, ob: bpy.types.Object) -> Act | None:
    """Return the act of a movement that is for a character, None when none is."""
    found = sorted((act for act in acts if (act.movement or act.name) == movement), key=lambda act: act.name)
    place = branch.choose([act.branch for act in found], analyses.of(ob)[2])
    return None if place is None else found[place]


def cue(ob: bpy.types.Object, action: bpy.types.Action, act: Act) -> None:
    """Give a character a place for all that an action keys: values of its channels, and their deforms."""
    own_values.ensure(ob, action)
    for track in act.tracks:
        deforms = of_rig(ob).channels[track.channel.name].deforms
        for name in track.deforms:
            if name not in deforms:
                deforms.add().name = name


def aim(ob: bpy.types.Object, act: Act, target: bpy.types.Object, bone: str = "") -> None:
    """Set the external targets of an act on a character that has been cued."""
    for track in act.tracks:
        if track.channel.target is TargetKind.EXTERNAL:
            values = of_rig(ob).channels[track.channel.name]
            values.target, values.target_bone = target, bone


def play(
    ob: bpy.types.Object, action: bpy.types.Action, act: Act, target: bpy.types.Object | None = None, bone: str = ""
) -> None:
    """Let a character play an action, with its external targets set, in the variant nearest to its targets."""
    cast.add(ob, action)
    cue(ob, action, act)
    if target is not None:
        aim(ob, act, target, bone)
    cast.forget(ob)
    member = cast.member(ob)
    of_rig(ob).variant = 0
    if len(member.part.binding.variants) > 1 and any(track.channel.has_target for track in act.tracks):
        of_rig(ob).variant = choice.nearest_variant(member, ob, bpy.context.evaluated_depsgraph_get())
