"""Retargeting with progress, cancel and one step of undo."""

from collections.abc import Generator
from typing import Any

import bpy
from bpy.props import BoolProperty, StringProperty

from .. import collect, laying, live, retarget
from ..collect import Clips
from ..properties import of_rig, of_scene
from ..retarget import Outcome
from .manners import Status, pair_poll, scene_in
from .stepping import Stepping

_latest: dict[int, tuple[int, dict[str, Any]]] = {}
"""What each target's last retarget made, and its report, by session-wide numbers."""


def latest(target: bpy.types.Object) -> dict[str, Any] | None:
    """Return the report of a target's last retarget, None where there was none or it has been undone."""
    made, report = _latest.get(target.session_uid, (0, None))
    return report if any(action.session_uid == made for action in bpy.data.actions) else None


def steps(
    scene: bpy.types.Scene, source: bpy.types.Object, target: bpy.types.Object, clips: Clips
) -> Generator[float, None, list[Outcome]]:
    """Retarget clips one after another in steps; yields the share done and returns the outcomes.

    When it fails or is closed before its end, the actions that it has made are removed and the target plays what it
    played before.

    Raises:
        MorphError: See `retarget.retarget`.
    """
    retarget.check_target(target)
    options = collect.options_of(scene, target)
    own, character = collect.target_of(target)
    ground = collect.ground_of(scene, character)
    done: list[Outcome] = []
    with laying.undone_if_it_fails(target, done):
        for i, (action, slot) in enumerate(clips):
            sampling = collect.source_of(source, action, slot, scene)
            clip = yield from retarget.within(i / len(clips), (i + 0.5) / len(clips), sampling)
            given = collect.contacts_of(source, action)
            work = retarget.in_steps(clip, own, character, options, scene, given, ground)
            done.append((yield from retarget.within((i + 0.5) / len(clips), (i + 1) / len(clips), work)))
            yield (i + 1) / len(clips)
    return done


class MORPHRETARGET_OT_retarget(Stepping, bpy.types.Operator):
    bl_idname = "morph_retarget.retarget"
    bl_label = "Retarget"
    bl_description = "Give the target the source's motion as a new action; its old action is kept as it is"
    bl_options = {"REGISTER", "UNDO"}
    doing = "Retargeting"

    source: StringProperty(name="Source", description="Armature object; the panel's source when empty")
    target: StringProperty(name="Target", description="Armature object; the panel's target when empty")
    action: StringProperty(name="Action", description="Action of the source; the one that it plays when empty")
    all_actions: BoolProperty(name="All Actions", description="Retarget every action that moves the source")

    _target: bpy.types.Object

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return pair_poll(cls, context)

    def start(self, context: bpy.types.Context) -> Generator[float, None, list[Outcome]]:
        scene = scene_in(context)
        settings = of_scene(scene)
        source = collect.chosen(self.source, settings.source, "source")
        self._target = collect.chosen(self.target, settings.target, "target")
        self.all_actions = self.all_actions or (settings.all_actions and not self.action)
        clips = collect.actions_of(source, self.action, self.all_actions)
        self.source, self.target = source.name, self._target.name
        self.action = "" if self.all_actions else clips[0][0].name
        return steps(scene, source, self._target, clips)

    def finish(self, _: bpy.types.Context, outcomes: list[Outcome]) -> Status:
        target = self._target
        if of_rig(target).live_source is not None:
            live.stop(target, clear=False)
        for warning in dict.fromkeys(w for outcome in outcomes for w in outcome.warnings):
            self.report({"WARNING"}, warning)
        last = outcomes[-1]
        _latest[target.session_uid] = last.action.session_uid, last.report
        made = f"{len(outcomes)} actions" if len(outcomes) > 1 else f"action {last.action.name!r}"
        self.report({"INFO"}, f"Made {made} with {last.report['joints_mapped']} bones")
        return {"FINISHED"}


CLASSES = (MORPHRETARGET_OT_retarget,)
