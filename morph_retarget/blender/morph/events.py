"""Events: pose markers of a generalized action, told to whoever wants to know while frames are shown.

A sound, a footstep or a game's signal hangs on a marker of the action (Action editor > Marker > Add Marker, with
Show Pose Markers on). Every callable in `callbacks` is called with the character object, the name of the event and
its frame in the action, once for each character::

    from morph_retarget.blender.morph import events

    events.callbacks.append(lambda character, name, frame: print(character.name, name, frame))

An event happens when the frame that is shown comes within half a frame of its marker, and the frame that was shown
before did not. So it happens once in playing over it frame by frame, and in jumping or scrubbing onto it, however often
the same frame is shown; playback that leaves out frames, or a jump across the marker, leaves it out too.
"""

from collections.abc import Callable, Iterable

import bpy

from ..properties import of_rig
from . import cast

Callback = Callable[[bpy.types.Object, str, int], None]

callbacks: list[Callback] = []
"""Called as ``callback(character, name, frame)`` for every event."""

NEAR = 0.5
"""An event happens less than this before its marker, or up to this after [frames]."""

_before: dict[int, tuple[int, float]] = {}
"""Action, by its session-wide number, and its frame that each character has shown last."""


def markers_of(action: bpy.types.Action) -> list[tuple[str, int]]:
    """Return the events of an action: names and frames, in order of time."""
    return sorted(((marker.name, marker.frame) for marker in action.pose_markers), key=lambda m: (m[1], m[0]))


def show_frame(scene: bpy.types.Scene, among: Iterable[bpy.types.Object] | None = None) -> None:
    """Tell of the events at the frame that a scene shows now; ``among`` as for `cast.performers`."""
    if not callbacks:
        _before.clear()
        return
    happened: list[tuple[bpy.types.Object, str, int]] = []
    for ob in cast.performers(scene, among):
        action = cast.action_of(ob)
        if action is None or of_rig(ob).muted:
            continue
        frame = _frame_in(ob, action, scene.frame_current_final)
        last = _before.pop(ob.session_uid, None)
        if frame is None:
            continue
        _before[ob.session_uid] = (action.session_uid, frame)
        before = last[1] if last is not None and last[0] == action.session_uid else None
        for name, at in markers_of(action):
            if _near(frame, at) and not (before is not None and _near(before, at)):
                happened.append((ob, name, at))
    for ob, name, at in happened:
        for callback in tuple(callbacks):
            callback(ob, name, at)


def forget() -> None:
    """Drop what was shown last; for when a file is loaded, and for undo and redo."""
    _before.clear()


def _near(frame: float, marker: int) -> bool:
    return marker - NEAR < frame <= marker + NEAR


def _frame_in(ob: bpy.types.Object, action: bpy.types.Action, frame: float) -> float | None:
    """Return the frame of an action that a character plays at a frame of the scene, None between its strips."""
    data = ob.animation_data
    if data is None or data.action == action:
        return frame
    for strip in [s for track in data.nla_tracks if not track.mute for s in track.strips]:
        if strip.action == action and not strip.mute and strip.frame_start <= frame <= strip.frame_end:
            length = max(strip.action_frame_end - strip.action_frame_start, 1e-6)
            passed = (frame - strip.frame_start) / max(strip.scale, 1e-6)
            passed = passed if passed <= length else passed % length
            return strip.action_frame_end - passed if strip.use_reverse else strip.action_frame_start + passed
    return None
