"""Actions as arrays: slots, channelbags and F-curves, read and written in bulk."""

from collections.abc import Container, Iterable

import bpy
import numpy as np
from numpy.typing import NDArray

from ..core.arrays import Array
from .rig import pose_of

CurveMap = dict[tuple[str, int], bpy.types.FCurve]
Owner = bpy.types.Object | bpy.types.Key
"""What plays an action."""

_CONSTANT, _LINEAR, _BEZIER = 0, 1, 2
_ALIGNED = 3
"""Of handles."""


def assigned(ob: Owner) -> tuple[bpy.types.Action | None, bpy.types.ActionSlot | None]:
    """Return the action and slot that an object plays, None for either that is missing."""
    data = ob.animation_data
    return (data.action, data.action_slot) if data else (None, None)


def fitting_slot(action: bpy.types.Action, ob: bpy.types.Object) -> bpy.types.ActionSlot | None:
    """Return the slot of ``action`` that suits an object: its own name, else the first for objects."""
    slots = [slot for slot in action.slots if slot.target_id_type in {"OBJECT", "UNSPECIFIED"}]
    return next((slot for slot in slots if slot.name_display == ob.name), slots[0] if slots else None)


def curves(action: bpy.types.Action, slot: bpy.types.ActionSlot) -> CurveMap:
    """Return the F-curves of one slot that act, by path and index; the first layer that animates a property counts."""
    out: CurveMap = {}
    for layer in action.layers:
        for strip in layer.strips:
            assert isinstance(strip, bpy.types.ActionKeyframeStrip), "Blender has no other kind of strip yet"
            bag = strip.channelbag(slot)
            for curve in bag.fcurves if bag else ():
                if not curve.mute:
                    out.setdefault((curve.data_path, curve.array_index), curve)
    return out


_BONE, _END = 'pose.bones["', '"].'


def escape_names(action: bpy.types.Action) -> None:
    """Mend paths in which bone names hold bare quotes and backslashes, as Blender's FBX importer leaves them."""
    for slot in action.slots:
        for (path, _), curve in curves(action, slot).items():
            name, _, prop = path.removeprefix(_BONE).rpartition(_END)
            escaped = bpy.utils.escape_identifier(name)
            if path.startswith(_BONE) and bpy.utils.escape_identifier(bpy.utils.unescape_identifier(name)) != name:
                curve.data_path = f"{_BONE}{escaped}{_END}{prop}"


def frame_range(found: Iterable[bpy.types.FCurve]) -> tuple[float, float] | None:
    """Return the first and last keyed frame of some curves, None when there are no keys."""
    ranges = [
        (curve.range()[0], curve.range()[1])
        for curve in found
        if len(curve.keyframe_points) or len(curve.sampled_points)
    ]
    return (min(r[0] for r in ranges), max(r[1] for r in ranges)) if ranges else None


def sample(curve: bpy.types.FCurve, frames: Array) -> Array:
    """Return a curve's values at ``frames``, shape (frame,).

    Keys that lie on the frames are copied; constant and linear curves are interpolated in bulk; anything else is
    evaluated by Blender.
    """
    points = curve.keyframe_points
    count = len(points)
    if count == 0 or len(curve.modifiers) > 0:
        return _evaluated(curve, frames)
    keys = np.empty(count * 2, dtype=np.float32)
    points.foreach_get("co", keys)
    times, values = keys[::2].astype(np.float64), keys[1::2].astype(np.float64)
    if count == len(frames) and np.array_equal(times, frames):
        return values
    place = np.clip(np.searchsorted(times, frames), 0, count - 1)
    if np.array_equal(times[place], frames):
        return values[place]
    kinds = np.empty(count, dtype=np.uint8)
    points.foreach_get("interpolation", kinds)
    inside = frames[0] >= times[0] and frames[-1] <= times[-1]
    if (kinds[:-1] == _LINEAR).all() and (inside or curve.extrapolation == "CONSTANT"):
        return np.interp(frames, times, values)
    return _evaluated(curve, frames)


def _evaluated(curve: bpy.types.FCurve, frames: Array) -> Array:
    return np.array([curve.evaluate(frame) for frame in frames.tolist()])


def sample_vector(found: CurveMap, path: str, frames: Array, defaults: Array) -> Array | None:
    """Return a vector property at ``frames``, shape (frame, n), None when nothing animates it.

    Args:
        found: Curves by path and index.
        path: Data path of the property.
        frames: Frames.
        defaults: Values of components that are not animated.
    """
    parts = [found.get((path, i)) for i in range(len(defaults))]
    if not any(parts):
        return None
    columns = [sample(c, frames) if c else np.full(len(frames), d) for c, d in zip(parts, defaults, strict=True)]
    return np.column_stack(columns)


def paths_in_strips(ob: bpy.types.Object) -> set[str]:
    """Return the data paths that the NLA strips of an object animate."""
    data = ob.animation_data
    strips = [strip for track in data.nla_tracks for strip in track.strips] if data else []
    return {
        path
        for strip in strips
        if strip.action is not None and strip.action_slot is not None
        for path, _ in curves(strip.action, strip.action_slot)
    }


class Filler:
    """Fills a slot of an action that a `Writer` has made, curve by curve in bulk."""

    def __init__(self, action: bpy.types.Action, slot: bpy.types.ActionSlot) -> None:
        self.action, self.slot = action, slot
        strip = action.layers[0].strips[0]
        assert isinstance(strip, bpy.types.ActionKeyframeStrip), "a strip of this type was asked for"
        bag = strip.channelbag(slot, ensure=True)
        assert bag is not None, "it was to be made"
        self._bag = bag
        self._groups: dict[str, bpy.types.ActionGroup] = {}

    def write(self, path: str, values: Array, frames: Array, group: str) -> None:
        """Key a vector property on every frame, linear in between.

        Args:
            path: Data path of the property.
            values: Shape (frame, n).
            frames: Shape (frame,).
            group: Name of the channel group.
        """
        count = len(frames)
        keys = np.empty((count, 2), dtype=np.float32)
        keys[:, 0] = frames
        linear = np.full(count, _LINEAR, dtype=np.uint8)
        for i in range(values.shape[1]):
            keys[:, 1] = values[:, i]
            curve = self._bag.fcurves.new(path, index=i)
            curve.group = self._group(group)
            curve.keyframe_points.add(count)
            curve.keyframe_points.foreach_set("co", keys.ravel())
            curve.keyframe_points.foreach_set("interpolation", linear)
            curve.update()

    def draw(self, path: str, index: int, frames: Array, values: Array, slopes: Array, group: str) -> None:
        """Key one component of a property with smooth curves in between, whose handles an animator can pull.

        Args:
            path: Data path of the property.
            index: Place of the component.
            frames: Of the keys, shape (key,).
            values: There, shape (key,).
            slopes: By how much the curve rises there in a frame, shape (key,).
            group: Name of the channel group.
        """
        curve = self._bag.fcurves.new(path, index=index)
        curve.group = self._group(group)
        curve.keyframe_points.add(len(frames))
        curve.keyframe_points.foreach_set("co", pairs(frames, values))
        kinds = np.full(len(frames), _BEZIER, dtype=np.uint8)
        curve.keyframe_points.foreach_set("interpolation", kinds)
        # Handles a third of the way to the next key make it a cubic in time.
        third = np.diff(frames) / 3.0
        for name, away in (
            ("left", -np.concatenate([third[:1], third])),
            ("right", np.concatenate([third, third[-1:]])),
        ):
            curve.keyframe_points.foreach_set(f"handle_{name}_type", np.full(len(frames), _ALIGNED, dtype=np.uint8))
            curve.keyframe_points.foreach_set(f"handle_{name}", pairs(frames + away, values + away * slopes))
        curve.update()

    def copy(self, curve: bpy.types.FCurve) -> None:
        """Take over a curve as it is: keys, handles, modifiers; samples become keys."""
        own = self._bag.fcurves.new(curve.data_path, index=curve.array_index)
        if curve.group:
            own.group = self._group(curve.group.name)
        own.extrapolation = curve.extrapolation
        count = len(curve.keyframe_points)
        own.keyframe_points.add(count)
        for name, width, kind in _KEY_PROPERTIES:
            values = np.empty(count * width, dtype=kind)
            curve.keyframe_points.foreach_get(name, values)
            own.keyframe_points.foreach_set(name, values)
        if len(curve.sampled_points):
            self._take_samples(curve, own)
        for modifier in curve.modifiers:
            copy_modifier(modifier, own)
        own.update()

    def _take_samples(self, curve: bpy.types.FCurve, own: bpy.types.FCurve) -> None:
        count = len(curve.sampled_points)
        values = np.empty(count * 2, dtype=np.float32)
        curve.sampled_points.foreach_get("co", values)
        own.keyframe_points.add(count)
        own.keyframe_points.foreach_set("co", values)
        own.keyframe_points.foreach_set("interpolation", np.full(count, _LINEAR, dtype=np.uint8))

    def remove(self, paths: Container[str]) -> None:
        """Take the curves of some properties out again."""
        for curve in [curve for curve in self._bag.fcurves if curve.data_path in paths]:
            self._bag.fcurves.remove(curve)
        self._groups.clear()  # Blender removes those that are empty

    def limit(self, first: float, last: float) -> None:
        """Make the action last from ``first`` to ``last`` where some of its keys lie outside."""
        start, end = self.action.frame_range
        if start < first - 1e-3 or end > last + 1e-3:
            self.action.use_frame_range = True
            self.action.frame_start, self.action.frame_end = first, last

    def _group(self, name: str) -> bpy.types.ActionGroup:
        if name not in self._groups:
            self._groups[name] = self._bag.groups.get(name) or self._bag.groups.new(name)
        return self._groups[name]


class Writer(Filler):
    """A new action with one slot, filled curve by curve in bulk."""

    def __init__(self, name: str, owner: Owner) -> None:
        action = bpy.data.actions.new(name)
        action.layers.new("Layer").strips.new(type="KEYFRAME")
        kind = "KEY" if isinstance(owner, bpy.types.Key) else "OBJECT"
        super().__init__(action, action.slots.new(id_type=kind, name=owner.name))

    def discard(self) -> None:
        """Remove the unfinished action."""
        bpy.data.actions.remove(self.action)


def pairs(frames: Array, values: Array) -> NDArray[np.float32]:
    """Return frames and values as Blender takes keys and handles, one after the other, shape (2 key,)."""
    return np.stack([frames, values], axis=-1).astype(np.float32).ravel()


def put_in_group(bag: bpy.types.ActionChannelbag, curve: bpy.types.FCurve, name: str) -> None:
    """Show a curve in a group of the channel list, made if there is none."""
    if curve.group is None or curve.group.name != name:
        curve.group = bag.groups.get(name) or bag.groups.new(name)


def copy_modifier(modifier: bpy.types.FModifier, curve: bpy.types.FCurve) -> None:
    """Give a curve a modifier like another one, setting by setting."""
    if modifier.type == "CYCLES" and len(curve.keyframe_points) < 2:
        return  # Blender has nothing to repeat
    own = curve.modifiers.new(modifier.type)
    for prop in modifier.bl_rna.properties:
        if prop.type == "COLLECTION" and prop.identifier == "control_points":
            for point in modifier.control_points:  # type: ignore[attr-defined]
                added = own.control_points.add(point.frame)  # type: ignore[attr-defined]
                added.min, added.max = point.min, point.max
        elif not prop.is_readonly and prop.type not in {"POINTER", "COLLECTION"}:
            setattr(own, prop.identifier, getattr(modifier, prop.identifier))


_KEY_PROPERTIES = (
    ("co", 2, np.float32),
    ("handle_left_type", 1, np.uint8),
    ("handle_right_type", 1, np.uint8),
    ("handle_left", 2, np.float32),
    ("handle_right", 2, np.float32),
    ("interpolation", 1, np.uint8),
    ("easing", 1, np.uint8),
)


def assign(ob: Owner, action: bpy.types.Action | None, slot: bpy.types.ActionSlot | None) -> None:
    """Make an object play a slot of an action; the slot is always set, since Blender's own choice may be none."""
    data = ob.animation_data or ob.animation_data_create()
    assert data is not None, "objects and shape keys can be animated"
    data.action = action
    if action is not None:
        data.action_slot = slot


def play(ob: Owner, action: bpy.types.Action, slot: bpy.types.ActionSlot) -> None:
    """Make an object play a slot of an action in full, whatever strips lie below it."""
    assign(ob, action, slot)
    data = ob.animation_data
    assert data is not None, "it was just assigned an action"
    data.action_influence, data.action_blend_type = 1.0, "REPLACE"


def of_armature(ob: bpy.types.Object) -> list[tuple[bpy.types.Action, bpy.types.ActionSlot]]:
    """Return all actions of the file, with a slot each, that move a bone of an armature."""
    prefixes = tuple(bone.path_from_id() for bone in pose_of(ob).bones)
    out: list[tuple[bpy.types.Action, bpy.types.ActionSlot]] = []
    for action in bpy.data.actions:
        slot = fitting_slot(action, ob)
        if slot is not None and any(path.rpartition(".")[0] in prefixes for path, _ in curves(action, slot)):
            out.append((action, slot))
    return out
