"""Acting: the recipes of the starter library on a character that stands."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from .. import quat
from ..arrays import Array
from ..clips.character_model import RATE, CharacterModel
from ..clips.clip import ClipPrimitive
from ..clips.frames import Frames
from ..clips.motions.annotations import NO_SIDE, Annotations, Phase
from ..clips.motions.base_motion import BaseMotion
from ..clips.travel import Travel
from ..locomotion.footless.floating import Floating
from ..locomotion.moving import Moving, eased
from ..morph import branch
from ..morph.bind import Binding, bind
from ..morph.bodies import Bodies
from ..morph.channels import Values
from .cycles import phase_of
from .performing import STILL, bare, moving_on, performed
from .recipes.recipe import Recipe
from .recipes.shelf import recipes
from .stances import actor
from .takes import Take

FADE = 6.0
"""An action comes and goes within so many frames: the body stands on its feet as its gait has it, not as at rest."""
SIZE = 1.9
"""Recipes were made for bodies of this size [m]; larger ones are slower, as pendulums are …"""
TEMPO = 0.5, 2.0
"""… within these factors of time."""
SIDES = {1: "left", -1: "right", 0: NO_SIDE}
AHEAD = 0.7
"""How far a jump ahead leads [body heights]."""


def motions_of(model: CharacterModel, kinds: Sequence[str]) -> Iterator[BaseMotion]:
    """Yield all motions of some kinds that the body can do.

    Raises:
        RigError: The solver cannot pose it.
    """
    bodies, standing = actor(model), moving_on(model, STILL)
    for kind in kinds:
        found = [recipe for recipe in recipes() if recipe.kind == kind]
        place = branch.choose([recipe.branch for recipe in found], bodies)
        if place is None:
            continue
        for motion in _played(model, bodies, standing, found[place]):
            yield motion
            if kind == "jump":
                yield _ahead(motion, AHEAD * model.character.frame.height)


def _played(model: CharacterModel, bodies: Bodies, standing: Moving, recipe: Recipe) -> Iterator[BaseMotion]:
    """Yield a recipe, once for each side on which it can be played; nothing where what is crucial is not there."""
    done = set[str]()
    first = bind(recipe.action, bodies)
    for variant in range(max(len(first.variants), 1)):
        binding = bind(recipe.action, bodies, variant) if variant else first
        crucial = _crucial(binding, recipe)
        if recipe.crucial and not crucial:
            return
        side = SIDES[int(bodies.sides[crucial[0]])] if first.variants and crucial else NO_SIDE
        if side in done:
            continue
        done.add(side)
        times, frames, scale = _times(bodies, standing, recipe)
        name = " ".join(word for word in (recipe.kind, side) if word)
        values = _values(recipe, frames)
        if len(model.feet):
            take = Take(name, standing, STILL, times, recipe.cycle, values=values, anchored=recipe.anchored)
            clip = performed(model, [take], binding)[0]
        else:
            clip = _added(performed(model, [Take(name, standing, STILL, times)])[0], bare(model, binding, values))
        known = Annotations(
            recipe.kind,
            cycle=recipe.cycle,
            phase=Phase.LOOP if recipe.cycle else Phase.WHOLE,
            strokes=recipe.strokes_at(scale),
            side=side,
            parts=_parts(model, crucial),
        )
        yield BaseMotion(name, clip, known)


def _added(standing: ClipPrimitive, own: Frames) -> ClipPrimitive:
    """Return a clip of a body without feet with an action's own movement on top.

    What lies winds in its own way where it stands, and what hovers bobs: an action is for straight bodies.
    """
    data = standing.data
    away = quat.multiply(quat.conjugate(own.rotations[:1]), own.rotations)
    rotations = quat.normalize(quat.multiply(data.rotations, away))
    shifted = data.translations + own.translations - own.translations[:1]
    return replace(standing, data=replace(data, rotations=rotations, translations=shifted))


def _crucial(binding: Binding, recipe: Recipe) -> list[int]:
    """Return the bodies that a recipe's crucial channels pose, in the order in which these are named."""
    places = [[channel.name for channel in recipe.channels].index(name) for name in recipe.crucial]
    return [
        entry.body
        for place in places
        for entry in binding.entries
        if entry.channel == place and (entry.position or entry.rotation)
    ]


def _times(bodies: Bodies, standing: Moving, recipe: Recipe) -> tuple[Array, Array, float]:
    """Return when a recipe is played [s], at which of its frames, and how much longer it takes than it was made."""
    scale = float(np.clip(np.sqrt(bodies.size / SIZE), *TEMPO))
    count = max(round((recipe.frames - 1) * scale), 2)
    if not recipe.cycle:
        frames = np.linspace(1.0, float(recipe.frames), count + 1)
        return np.zeros(count + 1), frames, count / (recipe.frames - 1)
    lasts = count / RATE
    if isinstance(standing, Floating):
        # What hovers rises and sinks all the time: a cycle has to hold whole ones of that.
        beats = float(phase_of(standing, np.array([lasts]))[0])
        lasts *= max(round(beats), 1) / beats
        count = max(round(lasts * RATE), 2)
    share = np.arange(count) / count
    return lasts * share, 1.0 + (recipe.frames - 1) * share, count / (recipe.frames - 1)


def _values(recipe: Recipe, frames: Array) -> Values:
    """Return the values of a recipe's channels, which come and go softly where it is no cycle."""
    values = recipe.values(frames)
    if recipe.cycle:
        return values
    fade = eased((frames - 1.0) / FADE) * eased((recipe.frames - frames) / FADE)
    return replace(values, weights=values.weights * fade[:, None])


def _parts(model: CharacterModel, crucial: Sequence[int]) -> tuple[str, ...]:
    """Return the parts of the body in which some joints are; none for all."""
    own = [name for name in model.parts if name in {"trunk", "head", "tail"} or " " in name]
    return tuple(name for name in own if model.parts[name][list(crucial)].any())


def _ahead(jump: BaseMotion, distance: float) -> BaseMotion:
    """Return a jump on the spot as one that leads ahead [m]: the body flies evenly."""
    strokes, clip = jump.annotations.strokes, jump.clip
    assert strokes is not None, "jumps have times"
    frames = np.arange(clip.length)
    share = np.clip((frames - strokes.stroke_start) / (strokes.stroke_end - strokes.stroke_start), 0.0, 1.0)
    way = Travel(np.column_stack([np.zeros_like(share), -distance * share]), np.zeros_like(share))
    speed = distance * RATE / (clip.length - 1.0)
    known = replace(jump.annotations, speed=speed, parameters={"distance": distance})
    return BaseMotion(f"{jump.name} ahead", replace(clip, name=f"{jump.name} ahead", way=way), known)
