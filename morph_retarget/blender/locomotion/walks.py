"""Characters on their way: how each goes at the moment, live and when it is baked. Run-time state.

A gait is prepared for the whole of its course, and prepared anew when something is edited that the course comes from.
It depends on nothing that was shown before.
"""

import itertools
from collections.abc import Container, Generator, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np

from ...core.arrays import Array
from ...core.errors import MorphError
from ...core.layering import Layer
from .. import actions
from ..morph import cast, keys
from ..morph.member import Member
from ..properties import of_rig
from ..sampling import STEPS_PER_YIELD, set_frame
from . import going, standing
from .going import Clock, Going, Stepped
from .guides import Asked, Guide, guide_of
from .walk import Walk

_numbers = itertools.count()


@dataclass(frozen=True, eq=False)
class _Known:
    """How a character goes, and what that was found from."""

    walk: Walk
    """Standing still where it cannot be known live how it goes."""
    problem: str
    """Why not."""
    member: Member
    state: tuple[object, ...]
    """What is looked at anew with each frame: range and rate of the scene, what moves the object, what guides ask."""
    told: tuple[object, ...]
    """All else that it depends on."""
    number: int = field(default_factory=lambda: next(_numbers))
    """Tells it from all others."""


_known: dict[tuple[int, int], _Known] = {}
"""By the session-wide numbers of the character and the scene."""
_edited: set[tuple[int, int]] = set()
"""Those of which something has been edited since."""
problems: dict[int, str] = {}
"""Why a character does not go live."""


def forget() -> None:
    """Drop all that is known; it is found anew when it is next needed."""
    _known.clear()
    _edited.clear()
    problems.clear()


def edited(obs: Iterable[bpy.types.Object]) -> None:
    """Let characters follow an edit of what their course comes from."""
    uids = {ob.session_uid for ob in obs}
    _edited.update(key for key in _known if key[0] in uids)


def watches(ob: bpy.types.Object, changed: Container[object]) -> bool:
    """Return whether something that has changed may be what the course of a character comes from."""
    own = of_rig(ob).gait
    if not own.enabled:
        return False
    found: list[object] = [cast.action_of(ob), ob]
    guide = guide_of(own.source)
    if guide is not None:
        found += guide.watched(ob)
    for other in (own.path, own.ground):
        if other is not None:
            found += [other, other.data]
    if own.foot_path is not None:
        found += [own.foot_path, actions.assigned(own.foot_path)[0]]
    above = ob.parent
    while above is not None:
        found += [above, above.animation_data.action if above.animation_data is not None else None]
        above = above.parent
    return any(block in changed for block in found if block is not None)


# --- live ---


@dataclass(frozen=True, eq=False)
class ToldWalk:
    """How a character goes at one frame: enough to see whether that has changed."""

    known: _Known
    frame: float
    weight: float
    place: tuple[tuple[float, ...], ...]
    """The matrix of its object, row by row, where that counts."""

    @property
    def key(self) -> tuple[object, ...]:
        """Equal for the same layer."""
        return self.known.number, self.frame, self.weight, self.place

    @property
    def layer(self) -> Layer:
        """A batch of one frame."""
        objects = np.array(self.place, dtype=np.float64)[None] if self.place else None
        return self.known.walk.layer_at(self.frame, self.weight, objects)


def told(member: Member, ob: bpy.types.Object, scene: bpy.types.Scene, graph: bpy.types.Depsgraph) -> ToldWalk | None:
    """Return how a character goes at the present frame, None if it does not.

    Args:
        member: The character.
        ob: Its object, original or evaluated, that has the settings of the moment.
        scene: Gives the frame.
        graph: Gives what it goes along and on, and where it is.
    """
    if member.gait is None:
        return None
    known = _now(member, scene, graph)
    weight = 0.0 if known.problem else of_rig(ob).gait.weight
    place: tuple[tuple[float, ...], ...] = ()
    if known.walk.is_carried:
        rows: Any = member.rig.object.evaluated_get(graph).matrix_world
        place = tuple([tuple(row) for row in rows])
    return ToldWalk(known, scene.frame_current_final, weight, place)


def known(ob: bpy.types.Object, scene: bpy.types.Scene) -> Walk | None:
    """Return how a character was found to go when it was last shown, None before that."""
    found = _known.get((ob.session_uid, scene.session_uid))
    return None if found is None or found.problem else found.walk


def _now(member: Member, scene: bpy.types.Scene, graph: bpy.types.Depsgraph) -> _Known:
    ob, render = member.rig.object, scene.render
    key, data = (ob.session_uid, scene.session_uid), ob.animation_data
    animated = (0, 0) if data is None else (len(data.drivers), len(data.nla_tracks))
    guide = guide_of(of_rig(ob).gait.source)
    told = () if guide is None else guide.told(ob)
    rate = render.fps, render.fps_base
    state = (scene.frame_start, scene.frame_end, *rate, *animated, len(ob.constraints), told)
    known = _known.get(key)
    same = known is not None and known.member is member and known.state == state
    if known is not None and same and key not in _edited:
        return known
    found = _found(member, scene, graph, state, known if same else None)
    _edited.discard(key)
    _known[key] = found
    problems.pop(ob.session_uid, None)
    if found.problem:
        problems[ob.session_uid] = found.problem
    return found


def _found(
    member: Member, scene: bpy.types.Scene, graph: bpy.types.Depsgraph, state: tuple[object, ...], before: _Known | None
) -> _Known:
    """Return how a character goes; what was known before, if nothing has changed."""
    ob, curves = member.rig.object, keys.curves(member.action)
    clock = Clock.of(scene, curves)
    try:
        own = going.read(ob, member.character, curves, clock, graph)
        told, make = _asked(member, own, graph)
        if before is not None and before.told == told:
            return before
        return _Known(make(), "", member, state, told)
    except MorphError as error:
        assert member.gait is not None, "only those that go are asked for"
        return _Known(Walk(member.gait, standing.STAYS, clock), str(error), member, state, ())


def _asked(member: Member, own: Going, graph: bpy.types.Depsgraph, targets: Mapping[str, Array] | None = None) -> Asked:
    """Return what the way of a character depends on, and what makes it of that.

    Args:
        member: The character.
        own: Where it goes.
        graph: Gives what it is told about.
        targets: Where that is at the frames of the clock, each shape (frame, 3), where frames were stepped through.

    Raises:
        MotionError: A target can be known by stepping alone.
    """
    guide = guide_of(own.source)
    if guide is not None:
        return guide.ask(member, own, graph, targets)
    ob, character, root = member.rig.object, member.character, member.root
    settings, movement = of_rig(ob).gait.settings(), of_rig(ob).gait.chosen_movement()
    told = (own.key, settings, tuple(settings.of_group.items()), movement)
    return told, lambda: Walk.of(character, root, own, settings, movement)


# --- many frames at once ---


def over(member: Member, scene: bpy.types.Scene, graph: bpy.types.Depsgraph, frames: Array) -> Layer | None:
    """Return what a character's action is laid over at frames of its scene, as it is live; None if it does not go."""
    if member.gait is None:
        return None
    known = _now(member, scene, graph)
    return layer(member, known.walk, frames, 0.0 if known.problem else None)


def layer_now(member: Member, ob: bpy.types.Object, graph: bpy.types.Depsgraph) -> Layer | None:
    """Return what a character's action is laid over at the frame of a scene that is evaluated; see `told`."""
    assert graph.scene is not None, "what is evaluated has a scene"
    found = told(member, ob, graph.scene, graph)
    return None if found is None else found.layer


def number(member: Member, scene: bpy.types.Scene, graph: bpy.types.Depsgraph) -> int | None:
    """Return what tells how a character goes from all other ways, None if it does not."""
    return None if member.gait is None else _now(member, scene, graph).number


def layer(
    member: Member, walk: Walk, frames: Array, weight: float | None = None, objects: Array | None = None
) -> Layer:
    """Return what the action of a character is laid over at frames of its scene.

    Args:
        member: The character.
        walk: How it goes.
        frames: Shape (frame,).
        weight: How much its gait counts, as it is keyed when None.
        objects: Where its object is in the world at the frames, shape (frame, 4, 4), if keys do not tell.
    """
    ob, curves = member.rig.object, keys.curves(member.action)
    shares: Array | float = 0.0 if weight is None else weight
    if weight is None:
        shares = going.values_over(of_rig(ob).gait, "weight", curves, walk.clock.in_action(frames))
    if walk.is_carried and objects is None:
        objects = going.places(ob, frames)
    return walk.layer(frames, shares, objects)


# --- baking ---


def taken(member: Member, scene: bpy.types.Scene, frames: Array, rate: float) -> Generator[float, None, "Taken | None"]:
    """Find how a character goes at frames of its scene in steps; yields the share done.

    Frames are stepped through only where nothing else tells how it goes.

    Args:
        member: The character.
        scene: Its frame is put back after stepping.
        frames: Shape (frame,).
        rate: Frames of the action for each frame of the scene, counted from the first one.

    Returns:
        None if it does not go.

    Raises:
        MotionError: It cannot go where it shall.
    """
    if member.gait is None:
        return None
    ob, curves = member.rig.object, keys.curves(member.action)
    clock = Clock.of(scene, curves, float(frames[0]), rate, float(frames[-1]))
    guide = guide_of(of_rig(ob).gait.source)
    if not going.reasons_to_step(ob) and not (guide is not None and guide.reasons_to_step(ob)):
        graph = bpy.context.evaluated_depsgraph_get()
        own = going.read(ob, member.character, curves, clock, graph)
        return Taken(member, _asked(member, own, graph)[1]())
    every = np.union1d(clock.frames, frames)
    stepped, weights, targets = yield from _stepped(ob, scene, every, guide)
    whole = np.searchsorted(every, clock.frames)
    at_whole, graph = Stepped(stepped.moves[whole], stepped.matrices[whole]), bpy.context.evaluated_depsgraph_get()
    own = going.read(ob, member.character, curves, clock, graph, at_whole)
    walk = _asked(member, own, graph, {name: places[whole] for name, places in targets.items()})[1]()
    return Taken(member, walk, every, weights, stepped.matrices)


@dataclass(frozen=True, eq=False)
class Taken:
    """How a character goes, for baking."""

    member: Member
    walk: Walk
    frames: Array | None = None
    """Frames that were stepped through, shape (n,)."""
    weights: Array | None = None
    """How much its gait counts at these, shape (n,)."""
    matrices: Array | None = None
    """Where its object is in the world, shape (n, 4, 4)."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the user should know."""
        return self.walk.gait.warnings

    def layer(self, frames: Array) -> Layer:
        """Return what its action is laid over at frames of the scene; of stepped ones, the nearest count."""
        if self.frames is None or self.weights is None or self.matrices is None:
            return layer(self.member, self.walk, frames)
        near = np.clip(np.searchsorted(self.frames, frames - 1e-6), 0, len(self.frames) - 1)
        return self.walk.layer(frames, self.weights[near], self.matrices[near] if self.walk.is_carried else None)


def _stepped(
    ob: bpy.types.Object, scene: bpy.types.Scene, frames: Array, guide: Guide | None
) -> Generator[float, None, tuple[Stepped, Array, Mapping[str, Array]]]:
    """Read each frame as Blender evaluates it; yields the share done.

    Returns:
        How it goes, how much that counts, and where the targets are of one that a guide leads.
    """
    before = scene.frame_current_final
    moves, weights = np.empty((len(frames), len(going.MOVES))), np.empty(len(frames))
    matrices, places = np.empty((len(frames), 4, 4)), list[Mapping[str, Array]]()
    try:
        for i, frame in enumerate(frames.tolist()):
            set_frame(scene, frame)
            graph = bpy.context.evaluated_depsgraph_get()
            seen = ob.evaluated_get(graph)
            if guide is not None:
                places.append(guide.places_now(ob, graph))
            own = of_rig(seen).gait
            moves[i] = [getattr(own, name) for name in going.MOVES]
            weights[i], matrices[i] = own.weight, np.array(seen.matrix_world, dtype=np.float64)
            if i % STEPS_PER_YIELD == 0:
                yield i / len(frames)
    finally:
        set_frame(scene, before)
    targets = {name: np.stack([now[name] for now in places]) for name in (places[0] if places else ())}
    return Stepped(moves, matrices), weights, targets
