"""Showing generalized actions while frames change and while anything is edited.

What is shown depends on the values and targets of the moment alone. A character is posed anew only when these have
changed, and before Blender evaluates a frame rather than after where what it will show can be guessed. An animator's
own hand on a bone of the active channel is taken for its new pose: it is generalized, and all other bodies and
characters follow (Hecker 2008 §3.2.1).
"""

import contextlib
from collections.abc import Container, Iterable, Set

import bpy

from ...core import play
from ...core.errors import MorphError
from ...core.play import Played
from ..locomotion import walks
from ..locomotion.walks import ToldWalk
from ..properties import of_rig
from . import (
    analyses,
    autokey,
    cast,
    deforms,
    generalize,
    jiggles,
    keys,
    on_controls,
    pose,
    remap,
    replay,
    specialized,
    stage,
)
from .generalize import Held
from .member import Member
from .pose import Setting, Singles
from .replay import Frame, Sight
from .shown import Shown
from .stage import ToldTargets, ToldValues

_shown: dict[int, Shown] = {}
_driven: dict[int, Set[str]] = {}
"""Bones of each character that were posed last; they go back to rest when nothing poses them any more."""
_foreseen: dict[int, Sight] = {}
"""What characters were made to show before Blender evaluates the frame that it changes to."""
_busy: list[bool] = []


def shown(ob: bpy.types.Object) -> Shown | None:
    """Return what a character shows, None when it has not been shown yet."""
    return _shown.get(ob.session_uid)


def foresee(scene: bpy.types.Scene, among: Iterable[bpy.types.Object] | None = None) -> None:
    """Put characters in the pose that they showed last at a frame, before Blender evaluates what it changes to.

    A pose that is written then is evaluated with all else; one that is written afterwards has the armature evaluated
    for a second time. It is a guess, which `show_frame` puts right if values or targets are other than they were.
    ``among`` as for `cast.performers`, here and below.
    """
    if _busy:
        return
    _foreseen.clear()
    now = replay.moment(scene)
    for ob in cast.performers(scene, among):
        guess = replay.last(ob.session_uid, now)
        if guess is not None and not (of_rig(ob).muted or of_rig(ob).live_source):
            _put(ob, guess.frame, guess.frame.played, guess.frame.setting)
            _foreseen[ob.session_uid] = guess


def show_frame(
    scene: bpy.types.Scene,
    graph: bpy.types.Depsgraph | None = None,
    among: Iterable[bpy.types.Object] | None = None,
) -> None:
    """Put all characters of a scene in the pose of its present frame."""
    if _busy:
        return
    graph = graph or bpy.context.evaluated_depsgraph_get()
    _show(cast.performers(scene, among), scene, graph, anew=True)


def update(scene: bpy.types.Scene, graph: bpy.types.Depsgraph, among: Iterable[bpy.types.Object] | None = None) -> None:
    """Let all characters follow an edit: of a value, a curve, a target, or the pose of a bone."""
    if _busy:
        return
    found = cast.performers(scene, among)
    if not found:
        return
    changed = {change.id.original for change in graph.updates if change.id is not None}
    for ob in found:
        _drop_edited(ob, changed)
    walks.edited(ob for ob in found if walks.watches(ob, changed))
    edited = {block for block in changed if isinstance(block, bpy.types.Action)}
    if edited:
        _follow_curves(found, edited)
        jiggles.curves_edited(found)
    held = generalize.posed_by_hand(scene, graph, _shown)
    if held is not None:
        autokey.hold(held, show_frame)
        generalize.give(held)
    _show(found, scene, graph, anew=False, held=held)


def _follow_curves(found: list[bpy.types.Object], edited: Container[object]) -> None:
    """Put right what Blender has just keyed by number, and generalize specialized curves that were reshaped."""
    layer = bpy.context.view_layer
    active = layer.objects.active if layer is not None else None
    done: set[bpy.types.Action] = set()
    for ob in sorted(found, key=lambda ob: ob != active):  # numbers are those of the object that was keyed
        action = cast.action_of(ob)
        if action is not None and action in edited and action not in done and not keys.by_name(action, ob):
            done.add(action)
    for action in {action for ob in found if (action := cast.action_of(ob)) is not None}:
        for empty in specialized.stand_ins(action):
            own = empty.animation_data.action if empty.animation_data else None
            if own in edited or action in edited:
                with contextlib.suppress(MorphError):  # `telling.tell` tells of it
                    specialized.follow(empty)


def forget(ob: bpy.types.Object | None = None) -> None:
    """Drop what is shown; it is made anew when it is next needed."""
    if ob is None:
        _shown.clear()
        _foreseen.clear()
        _driven.clear()
        replay.forget()
        autokey.forget()
        jiggles.forget()
        walks.forget()
        specialized.forget()
        on_controls.forget()
    else:
        _shown.pop(ob.session_uid, None)
        _foreseen.pop(ob.session_uid, None)
        replay.forget(ob.session_uid)


def release(ob: bpy.types.Object) -> None:
    """Put the bones that a character's action has posed back to rest."""
    pose.rest(ob, _driven.pop(ob.session_uid, set()))
    forget(ob)


def definition_changed(action: bpy.types.ID) -> None:
    """Let the characters of an action follow a change of its definitions, with Blender's next update."""
    cast.forget()
    for scene in bpy.data.scenes:
        for ob in cast.performers(scene):
            if cast.action_of(ob) == action:
                character_changed(ob)


def character_changed(ob: bpy.types.ID) -> None:
    """Let a character follow a change of its own settings, with Blender's next update."""
    assert isinstance(ob, bpy.types.Object), "settings of characters are on objects"
    cast.forget(ob)
    forget(ob)
    action = cast.action_of(ob)
    if action is not None:
        remap.catch_up(action)
    ob.update_tag(refresh={"OBJECT"})


def gait_changed(ob: bpy.types.ID) -> None:
    """Let a character follow a change of how it goes, with Blender's next update."""
    assert isinstance(ob, bpy.types.Object), "settings of characters are on objects"
    try:
        anew = cast.is_stepping_anew(ob)
    except MorphError:
        anew = True  # it is told when the character is shown
    if anew:
        cast.forget(ob)
        forget(ob)
    course_changed(ob)


def course_changed(ob: bpy.types.ID) -> None:
    """Let a character follow a change of where it goes, with Blender's next update."""
    assert isinstance(ob, bpy.types.Object), "settings of characters are on objects"
    walks.edited([ob])
    jiggles.curves_edited([ob])
    ob.update_tag(refresh={"OBJECT"})


def _drop_edited(ob: bpy.types.Object, changed: Container[object]) -> None:
    """Forget what a rig was found to be if its bones have been edited; a new pose counts as an update as well."""
    bones = ob.data in changed
    if not (bones or ob in changed):
        return
    if analyses.is_edited(ob, bones):
        cast.forget(ob, rig=True)
        forget(ob)
    elif cast.is_limited_anew(ob):
        cast.forget(ob)
        forget(ob)


def _show(
    found: list[bpy.types.Object],
    scene: bpy.types.Scene,
    graph: bpy.types.Depsgraph,
    anew: bool,
    held: Held | None = None,
) -> None:
    _busy.append(True)
    try:
        for ob in found:
            if of_rig(ob).muted:
                continue
            try:
                _show_one(ob, scene, graph, anew, held)
            except MorphError as error:
                cast.problems[ob.session_uid] = str(error)
                forget(ob)
            else:
                cast.problems.pop(ob.session_uid, None)
    finally:
        _busy.clear()
        _foreseen.clear()


def _show_one(
    ob: bpy.types.Object, scene: bpy.types.Scene, graph: bpy.types.Depsgraph, anew: bool, held: Held | None
) -> None:
    member = cast.member(ob)
    # While something is edited, the evaluated copy may be older than what was just written.
    source = ob if held is not None else ob.evaluated_get(graph)
    values, targets = stage.told_values(member, source), stage.told_targets(member, ob, graph)
    walk = walks.told(member, source, scene, graph)
    told = (values.key, targets.key, None if walk is None else walk.key)
    guess = _foreseen.pop(ob.session_uid, None)
    if guess is not None:
        if _is_right(guess, member, told, source, graph):
            _shown[ob.session_uid].state = guess.state
            return
        replay.expect_nothing(ob.session_uid)
    inputs = (*told, pose.modes(ob))
    before = _shown.get(ob.session_uid)
    if before is not None and before.member is member and before.inputs == inputs and not anew:
        return
    frame = replay.frame(member, inputs, targets, lambda: _played(member, values, targets, walk))
    played = jiggles.shown(member, frame.played, scene, graph, values, targets, anew)
    hands_off = held.bones if held is not None and held.ob == ob else ()
    if played is frame.played and not hands_off:
        state = _put(ob, frame, played, frame.setting)
        replay.remember(replay.moment(scene), Sight(frame, pose.basis(ob), state))
    else:
        _put(ob, frame, played, on_controls.setting_of(member, played, hands_off))


def _played(member: Member, values: ToldValues, targets: ToldTargets, walk: ToldWalk | None) -> Played:
    return play.evaluate(member.part, values.values, targets.places, None if walk is None else walk.layer)


def _put(ob: bpy.types.Object, frame: Frame, played: Played, setting: Setting) -> dict[str, Singles]:
    """Let a character show a frame, and return what its bones' properties are now.

    Args:
        ob: The character.
        frame: The frame.
        played: The same, maybe with jiggles.
        setting: What to write of it.
    """
    state = pose.show(ob, setting)
    pose.rest(ob, _driven.get(ob.session_uid, frozenset()) - setting.bones)
    _driven[ob.session_uid] = setting.bones
    controls = on_controls.of(frame.member)
    if controls is not None:
        controls.switch()
    given = deforms.show(frame.member, played)
    _shown[ob.session_uid] = Shown(frame.member, frame.told, frame.targets, played, state, given)
    return state


def _is_right(
    guess: Sight, member: Member, told: tuple[object, ...], seen: bpy.types.Object, graph: bpy.types.Depsgraph
) -> bool:
    """Return whether a character was made to show what it is told, and Blender has evaluated it like that.

    Args:
        guess: What it was made to show.
        member: The character.
        told: Keys of values, targets and the way.
        seen: The evaluated character, where keys and drivers of bones may have had their way.
        graph: What has evaluated it.
    """
    return (
        guess.frame.member is member
        and guess.frame.told[: len(told)] == told
        and jiggles.is_still(member)
        and pose.basis(seen) == guess.basis
        and deforms.holds(_shown[member.rig.uid].deforms, graph)
    )
