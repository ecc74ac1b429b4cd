"""The cast: armatures that play generalized actions, and how each action binds to each. Run-time state.

What is found here is kept by Blender's session-wide number of the object and dropped on load, undo and redo, when a
definition or a rig is edited, and when another action is assigned.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import bpy
import numpy as np

from ...core import play
from ...core.character.character import Character
from ...core.errors import MorphError, MotionError
from ...core.locomotion.moving import Moving
from ...core.morph.bind import Binding, GeneralizedAction, bind
from ...core.morph.bodies import Bodies
from ...core.morph.channels import TargetKind
from ...core.play import Part
from ...core.solve.limits import JointLimits
from ...core.solve.settings import DEFAULT, SolverSettings
from .. import actions, collect, joint_limits
from ..locomotion import standing
from ..properties import BY_USER, of_rig
from ..rig import Rig, armature_of, pose_of
from . import definitions, keys, stretching
from .properties import of_action
from .values import MORPHRETARGET_PG_values

problems: dict[int, str] = {}
"""Why an armature does not play its action, by session-wide number."""


@dataclass(frozen=True, eq=False)
class Member:
    """One armature as it plays one action."""

    rig: Rig
    action: bpy.types.Action
    definition: GeneralizedAction
    character: Character
    """What the armature is."""
    binding: Binding
    """How its bodies are posed."""
    solver: SolverSettings = DEFAULT
    limits: JointLimits | None = None
    """Of its joints."""
    fixed: frozenset[int] = frozenset()
    """Bones that cannot move off their parents when others stretch."""
    gait: Moving | None = None
    """How it stands, if it goes over the ground: its gait has the same goals wherever it goes. None if it does not."""

    @property
    def bodies(self) -> Bodies:
        """Its bodies."""
        return self.binding.bodies

    @cached_property
    def names(self) -> dict[str, int]:
        """Names of the channels, and which ones they are."""
        return {channel.name: i for i, channel in enumerate(self.definition.channels)}

    @cached_property
    def external(self) -> dict[int, str]:
        """Channels that have external targets, and their names."""
        channels = self.definition.channels
        return {i: c.name for i, c in enumerate(channels) if c.has_target and c.target is TargetKind.EXTERNAL}

    @cached_property
    def part(self) -> Part:
        """What plays."""
        return self._part(self.binding)

    @cached_property
    def free(self) -> Part:
        """The same without what has targets, for others that follow this one's bodies."""
        return self._part(self.binding.untargeted())

    def _part(self, binding: Binding) -> Part:
        lower = () if self.gait is None else self.gait.wanted
        return play.prepare(self.character, binding, self.solver, self.limits, self.fixed, lower)

    @property
    def root(self) -> int:
        """The body that carries all others."""
        return play.root_of(self.bodies)

    @property
    def plays(self) -> bool:
        """Whether anything poses it."""
        return self.gait is not None or len(self.binding.entries) > 0

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the user should know of the armature itself."""
        return (*self.rig.warnings, *stretching.told(self.rig, self.part.pose.stiff))


_analysed: dict[int, tuple[Rig, Character, Bodies]] = {}
_rests: dict[int, tuple[object, object]] = {}
"""What these were found from."""
_members: dict[int, tuple[tuple[object, ...], Member]] = {}
_limits: dict[int, bytes] = {}
"""What limited the joints of each member."""


def action_of(ob: bpy.types.Object) -> bpy.types.Action | None:
    """Return the generalized action that an armature plays: its own, else the topmost in its NLA strips."""
    if ob.type != "ARMATURE" or ob.animation_data is None:
        return None
    own = ob.animation_data.action
    if own is not None:
        return own if definitions.is_generalized(own) else None
    tracks = [track for track in ob.animation_data.nla_tracks if not track.mute]
    strips = [strip.action for track in reversed(tracks) for strip in track.strips if not strip.mute]
    return next((action for action in strips if definitions.is_generalized(action)), None)


def performers(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Return the armatures of a scene that play a generalized action."""
    return [ob for ob in scene.objects if ob.type == "ARMATURE" and action_of(ob) is not None]


def playing(scene: bpy.types.Scene, action: bpy.types.Action) -> list[bpy.types.Object]:
    """Return the armatures of a scene that play ``action``."""
    return [ob for ob in performers(scene) if action_of(ob) == action]


def analysed(ob: bpy.types.Object) -> tuple[Rig, Character, Bodies]:
    """Return what an armature is; found once and kept.

    Raises:
        MorphError: It cannot be analysed.
    """
    known = _analysed.get(ob.session_uid)
    if known is None:
        own, character = collect.target_of(ob)
        known = keep(ob, own, character, Bodies.of(character))
    return known


def keep(ob: bpy.types.Object, own: Rig, character: Character, bodies: Bodies) -> tuple[Rig, Character, Bodies]:
    """Keep what an armature is, until it is edited."""
    _rests[ob.session_uid] = _corrections(ob), _bones_of(ob)
    known = _analysed[ob.session_uid] = (own, character, bodies)
    return known


def is_edited(ob: bpy.types.Object, bones: bool = True) -> bool:
    """Return whether the user's corrections, and the bones, of an analysed armature have changed since."""
    known = _rests.get(ob.session_uid)
    return known is not None and (known[0] != _corrections(ob) or (bones and known[1] != _bones_of(ob)))


def is_limited_anew(ob: bpy.types.Object) -> bool:
    """Return whether the joint limits of a member have been edited since."""
    known = _limits.get(ob.session_uid)
    return known is not None and known != _limits_of(ob)


def _limits_of(ob: bpy.types.Object) -> bytes:
    return joint_limits.state(ob) if of_rig(ob).use_joint_limits else b""


def _corrections(ob: bpy.types.Object) -> tuple[object, ...]:
    own = of_rig(ob)
    return own.up, own.forward, [(joint.name, joint.bone) for joint in own.joints if joint.by in BY_USER]


def _bones_of(ob: bpy.types.Object) -> tuple[object, ...]:
    bones = armature_of(ob).bones
    parts: list[object] = [[(bone.name, bone.parent and bone.parent.name) for bone in bones]]
    for name, width, kind in (("matrix_local", 16, np.float32), ("tail_local", 3, np.float32)):
        values = np.empty(width * len(bones), dtype=kind)
        bones.foreach_get(name, values)
        parts.append(values.tobytes())
    for name in ("use_deform", "use_inherit_rotation", "use_connect"):
        flags = np.empty(len(bones), dtype=np.bool_)
        bones.foreach_get(name, flags)
        parts.append(flags.tobytes())
    return tuple(parts)


def member(ob: bpy.types.Object, action: bpy.types.Action | None = None) -> Member:
    """Return how an armature plays its action, or another one.

    Raises:
        MorphError: The armature cannot be analysed, or the action cannot be read.
    """
    action = action or action_of(ob)
    assert action is not None, "only performers are asked for"
    own = of_rig(ob)
    solving = own.bends_spine, own.allows_stretch, own.avoids_collisions, own.keeps_above_ground, own.use_joint_limits
    state = (action.session_uid, len(of_action(action).channels), own.variant, solving, own.gait.enabled)
    known = _members.get(ob.session_uid)
    if known is not None and known[0] == state:
        return known[1]
    rig, character, bodies = analysed(ob)
    ensure_values(ob, action)
    definition, unknown = definitions.read_known(action)
    binding = bind(definition, bodies, own.variant, missing(ob, definition))
    if unknown:
        binding = replace(
            binding,
            entries=tuple(entry for entry in binding.entries if entry.channel not in unknown),
            selected=tuple(() if i in unknown else bodies for i, bodies in enumerate(binding.selected)),
            problems=(*unknown.values(), *binding.problems),
        )
    solver = replace(
        own.solver.settings(rig.skeleton.index),
        bends_spine=own.bends_spine,
        allows_stretch=own.allows_stretch,
        avoids_collisions=own.avoids_collisions,
        keeps_above_ground=own.keeps_above_ground,
    )
    limits = joint_limits.read(ob, rig) if own.use_joint_limits else None
    fixed = stretching.connected(rig) if own.allows_stretch else frozenset[int]()
    gait = standing.of(character, play.root_of(bodies), own.gait) if own.gait.enabled else None
    found = Member(rig, action, definition, character, binding, solver, limits, fixed, gait)
    _members[ob.session_uid] = (state, found)
    _limits[ob.session_uid] = _limits_of(ob)
    return found


def is_stepping_anew(ob: bpy.types.Object) -> bool:
    """Return whether the gait of a member has other goals since its settings were edited, or is on or off.

    Raises:
        MorphError: It cannot go as it is set.
    """
    known = _members.get(ob.session_uid)
    if known is None:
        return False
    before, own = known[1].gait, of_rig(ob).gait
    if before is None or not own.enabled:
        return (before is not None) != own.enabled
    return standing.of(known[1].character, known[1].root, own).wanted != before.wanted


def missing(ob: bpy.types.Object, definition: GeneralizedAction) -> set[int]:
    """Return the channels whose external target is not there on an armature."""
    items = of_rig(ob).channels
    external = [c.has_target and c.target is TargetKind.EXTERNAL for c in definition.channels]
    return {i for i, c in enumerate(definition.channels) if external[i] and not has_target(items[c.name])}


def has_target(values: MORPHRETARGET_PG_values) -> bool:
    """Return whether a channel has an external target that exists."""
    target = values.target
    if target is None or target.name not in bpy.data.objects:
        return False
    if not values.target_bone:
        return True
    return target.type == "ARMATURE" and target.pose is not None and values.target_bone in target.pose.bones


def ensure_values(ob: bpy.types.Object, action: bpy.types.Action) -> None:
    """Give an armature a place for the values of each channel, and for those of the deforms that are keyed."""
    own = of_rig(ob).channels
    for item in of_action(action).channels:
        if item.name and item.name not in own:  # one that is just being made has no name yet
            own.add().name = item.name
        for deform in keys.deforms_of(action, item.name):
            if deform not in own[item.name].deforms:
                own[item.name].deforms.add().name = deform


def keep_overrides() -> None:
    """Let what is overridden on armatures be saved.

    Blender 5.2 compares an override with its original in the library when a file is saved, and writes what it cannot
    read again where the original has none of our data at all. So the originals get some, for this session.
    """
    for ob in bpy.data.objects:
        override = ob.override_library
        if override is not None and ob.type == "ARMATURE" and isinstance(override.reference, bpy.types.Object):
            original = of_rig(override.reference)
            original.variant = original.variant


def add(ob: bpy.types.Object, action: bpy.types.Action) -> None:
    """Let an armature play a generalized action, through the slot that all others share.

    Raises:
        MorphError: It cannot be analysed, or the action is linked and has no slot.
    """
    if is_edited(ob):
        forget(ob, rig=True)
    analysed(ob)
    ensure_values(ob, action)
    slot = next((slot for slot in action.slots if slot.target_id_type in {"OBJECT", "UNSPECIFIED"}), None)
    if slot is None and action.library is not None:
        raise MotionError(f"action {action.name!r} is linked from a library where nobody plays it: make it local")
    if slot is None:
        slot = action.slots.new(id_type="OBJECT", name="Characters")
    before, _ = actions.assigned(ob)
    actions.play(ob, action, slot)
    if before is not None and before.users == 0:
        before.use_fake_user = True  # what nobody plays any more must still be saved
    for bone in pose_of(ob).bones:
        bone.matrix_basis.identity()  # what an earlier action left behind
    forget(ob)


def remove(ob: bpy.types.Object) -> None:
    """Let an armature play its generalized action no more; its values are kept."""
    actions.assign(ob, None, None)
    forget(ob)


def tell(ob: bpy.types.Object) -> list[str]:
    """Return what keeps an armature from playing all of its action, in words."""
    problem = problems.get(ob.session_uid)
    if problem is not None:
        return [problem]
    try:
        own = member(ob)
        stiff = stretching.told(own.rig, own.part.pose.stiff) if own.solver.allows_stretch else []
        return [*own.binding.problems, *stiff, *_lost_limbs(ob), *_lost(ob)]
    except MorphError as error:
        return [str(error)]


def _lost_limbs(ob: bpy.types.Object) -> list[str]:
    """Return which limbs with solver settings a character has not, in words."""
    lost = of_rig(ob).solver.lost(pose_of(ob).bones)
    return [f"{name!r} has solver settings and is no bone of {ob.name!r}: remove these" for name in lost]


def _lost(ob: bpy.types.Object) -> list[str]:
    """Return which specialized curves of a character stand for channels that are gone, in words."""
    action = action_of(ob)
    known = of_action(action).channels if action is not None else {}
    mine = [other for other in bpy.data.objects if other.type == "EMPTY" and of_rig(other).stands_for == ob]
    return [
        f"{empty.name!r} shows specialized curves of {of_rig(empty).stands_for_channel!r}, which is gone: delete it"
        for empty in mine
        if of_rig(empty).stands_for_channel not in known
    ]


def forget(ob: bpy.types.Object | None = None, rig: bool = False) -> None:
    """Drop what is known about an armature, or about all; with ``rig`` what its bones were found to be as well."""
    if ob is None:
        _members.clear()
        _limits.clear()
        problems.clear()
        if rig:
            _analysed.clear()
            _rests.clear()
        return
    _members.pop(ob.session_uid, None)
    _limits.pop(ob.session_uid, None)
    problems.pop(ob.session_uid, None)
    if rig:
        _analysed.pop(ob.session_uid, None)
        _rests.pop(ob.session_uid, None)
