"""Acting: all behaviours of a character together, over the motion that it plays (Feng 2013 §6.2).

    lean -> gaze -> nod, shake, tilt -> saccades -> hands

What turns the trunk comes first, so that what the eyes look at and the hands go for is met by the body as it then
stands. Hands are brought to their places by the solver in the end, from the posture that comes out here.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Array, Indices
from ...solve.settings import DEFAULT, SolverSettings
from ..commands.command import Command
from ..commands.parameters import told
from . import faces, gaze, handling, leaning, nodding, reaching, saccades
from .actor import Actor
from .arms import arms_of
from .behaviour import Cue, Scene, cues_of
from .faces import FACE
from .hands import mouth_of
from .holding import Holding
from .posture import Posture
from .registry import BEHAVIOURS


@dataclass(frozen=True, eq=False)
class Acted:
    """What behaviours make of a motion."""

    posture: Posture
    """Turns of all bodies; places are those before hands are brought to theirs."""
    bodies: Indices
    """Hands that have goals for their places, the same at all times, shape (hand,)."""
    places: Array
    """Where they shall be [m], ground frame, shape (n, hand, 3)."""
    influence: Array
    """How far that counts, shape (n, hand)."""
    held: tuple[Holding, ...]
    """What is held, in the order of time."""
    shown: Mapping[str, Array]
    """Values of what is shown on the face, by its name, each shape (n,)."""
    warnings: tuple[str, ...]


def act(
    actor: Actor, scene: Scene, posture: Posture, commands: Sequence[Command], settings: SolverSettings = DEFAULT
) -> Acted:
    """Return a posture that does what commands to behaviours say, and goals for its hands.

    Args:
        actor: The character.
        scene: When, and what is around it: evenly spaced frames from the first one of the clip.
        posture: What the motion does at these times.
        commands: All that the character is told; those to motion models are left alone.
        settings: Of the solver that brings hands to their places.
    """
    cues: dict[str, tuple[Cue, ...]] = {}
    warnings: list[str] = []
    for name, behaviour in BEHAVIOURS.items():
        if behaviour is FACE:
            continue  # several of its commands hold at once
        cues[name], problems = cues_of(behaviour, commands, scene)
        warnings += problems
    shown, problems = faces.weights(scene, commands)
    warnings += problems
    mouth = mouth_of(actor)
    arms = {arm.hand.body: arm for arm in arms_of(actor, settings)}
    able = [arm.hand for arm in arms.values() if arm.joints]
    mouth = mouth if not any(hand.is_taking for hand in able) else None
    warnings += _unable(actor, cues, bool(able) or mouth is not None)
    if mouth is not None:  # what has no hands points with its head
        cues["gaze"] = tuple(sorted((*cues["gaze"], *cues.pop("point")), key=lambda cue: cue.at))
    reaches = [(own, cue) for own in handling.REACHING for cue in cues.get(own.name, ())]
    arrives: list[tuple[float, ...]] = []
    doing = handling.dealt(scene, posture, able, mouth, reaches)
    for own in doing:
        arm = None if own.hand is None else arms[own.hand.body]
        others = [arms[hand.body].joints[0] for hand in able if hand is not own.hand and hand.is_arm]
        posture, there = leaning.leaned(actor, scene, posture, arm, mouth, own.steps, others)
        arrives.append(there)
    posture = gaze.perform(actor, scene, posture, cues["gaze"])
    posture = nodding.perform(actor, scene, posture, cues["nod"], cues["shake"], cues["tilt"])
    posture = saccades.perform(actor, scene, posture, cues["saccade"])
    reached: list[reaching.Reached] = []
    for i, own in enumerate(doing):
        if own.hand is not None:
            posture, place = reaching.perform(arms[own.hand.body], scene, posture, own.steps)
            reached.append(place)
            arrives[i] = place.arrives
    return Acted(
        posture,
        np.array([own.hand.body for own in reached], dtype=np.intp),
        np.stack([own.place for own in reached], axis=1) if reached else np.zeros((len(posture), 0, 3)),
        np.stack([own.influence for own in reached], axis=1) if reached else np.zeros((len(posture), 0)),
        _held(doing, arrives, mouth),
        shown,
        tuple(warnings),
    )


def _unable(actor: Actor, cues: Mapping[str, Sequence[Cue]], reaches: bool) -> list[str]:
    """Return warnings about what this body cannot do."""
    lacks: dict[str, str] = {}
    if actor.head is None:
        lacks |= dict.fromkeys(("gaze", "nod", "shake", "tilt"), "the character has no head to do it with")
    if not actor.eyes:
        lacks["saccade"] = "the character has no eyes that turn"
    if not reaches:
        lacks |= {own.name: "the character has nothing to do it with" for own in handling.REACHING}
    return [told(cues[name][0].command, problem) for name, problem in lacks.items() if cues[name]]


def _held(
    doing: Sequence[handling.Handling], arrives: Sequence[tuple[float, ...]], mouth: int | None
) -> tuple[Holding, ...]:
    """Return what is in hands and mouth, in the order of time."""
    out: list[Holding] = []
    for own, there in zip(doing, arrives, strict=True):
        body = mouth if own.hand is None else own.hand.body
        for i, step in enumerate(own.steps):
            if step.behaviour is handling.GRASP and body is not None:
                end = own.steps[i + 1].at if i + 1 < len(own.steps) else np.inf
                if end > there[i]:
                    out.append(Holding(str(step.values.get("target", "")), body, there[i], end))
    return tuple(sorted(out, key=lambda held: held.start))
