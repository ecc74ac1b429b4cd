"""Nodding, shaking and tilting the head (Feng 2013 §6.2): turns about the head's own axes, over whatever it does."""

from collections.abc import Callable, Sequence

import numpy as np

from ... import quat
from ...arrays import Array
from ...locomotion.moving import eased
from ..commands.parameters import Parameter, Parameters
from . import timing
from .actor import Actor
from .behaviour import Behaviour, Cue, Scene
from .posture import Posture


def _repeated(amplitude: float, speed: float) -> Parameters:
    return {
        "repeats": Parameter(2.0, "How often", "", 1.0, 50.0),
        "amplitude": Parameter(amplitude, "How far the head turns", "deg", 0.0, 60.0),
        "speed": Parameter(speed, "How often in a second", "1/s", 0.1, 6.0),
    }


NOD = Behaviour("nod", "Nod with the head", _repeated(14.0, 1.6))
SHAKE = Behaviour("shake", "Shake the head", _repeated(16.0, 1.6))
TILT = Behaviour(
    "tilt",
    "Tilt the head to a side until it is stopped",
    {
        "amplitude": Parameter(15.0, "How far to the left, and to the right below 0", "deg", -45.0, 45.0),
        "speed": Parameter(60.0, "How fast at most", "deg/s", 5.0, 360.0),
    },
)
NECK = 0.4
"""Share of a turn that the neck takes."""
WEARS = 0.85
"""Each repeat is smaller than the one before by this factor."""
BREAKS_OFF = 0.25
"""How long a head takes to come back when it is stopped in the middle [s]."""
LEFT, UP, FORWARD = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([0.0, -1.0, 0.0])


def perform(
    actor: Actor, scene: Scene, posture: Posture, nods: Sequence[Cue], shakes: Sequence[Cue], tilts: Sequence[Cue]
) -> Posture:
    """Return a posture whose head nods, shakes and is tilted."""
    if actor.head is None:
        return posture
    for angles, axis in (
        (nod_angles(scene.times, nods), LEFT),
        (shake_angles(scene.times, shakes), UP),
        (tilt_angles(scene.times, tilts), -FORWARD),
    ):
        if angles.any():
            posture = _turned(actor, posture, angles, axis)
    return posture


def nod_angles(times: Array, cues: Sequence[Cue]) -> Array:
    """Return how far a head is nodded down over time [rad], shape (n,)."""
    return _runs(times, cues, NOD.parameters, lambda phase: np.sin(np.pi * phase) ** 2)


def shake_angles(times: Array, cues: Sequence[Cue]) -> Array:
    """Return how far a head is shaken to the left over time [rad], shape (n,)."""
    return _runs(times, cues, SHAKE.parameters, lambda phase: np.sin(2.0 * np.pi * phase))


def tilt_angles(times: Array, cues: Sequence[Cue]) -> Array:
    """Return how far a head is tilted to the left over time [rad], shape (n,)."""
    out = np.zeros(len(times))
    for cue in cues:
        to = 0.0 if cue.values is None else np.radians(cue.number("amplitude", TILT.parameters))
        speed = np.radians(cue.number("speed", TILT.parameters))
        far = abs(to - float(np.interp(cue.at, times, out)))
        out = out + timing.risen(times, cue.at, 0.0 if cue.sudden else timing.BELL * far / speed) * (to - out)
    return out


def _runs(times: Array, cues: Sequence[Cue], known: Parameters, shape: Callable[[Array], Array]) -> Array:
    """Return the sum of all that heads do over and over, each until the next cue breaks it off [rad], shape (n,)."""
    out = np.zeros(len(times))
    for i, cue in enumerate(cues):
        if cue.values is None:
            continue
        repeats, speed = round(cue.number("repeats", known)), cue.number("speed", known)
        phase = np.clip((times - cue.at) * speed, 0.0, repeats)
        # The first half comes and the last half goes softly, so that it starts and ends at rest.
        soft = eased(2.0 * phase) * eased(2.0 * (repeats - phase))
        own = np.radians(cue.number("amplitude", known)) * WEARS ** np.floor(phase) * soft * shape(phase)
        if i + 1 < len(cues):
            after = cues[i + 1]
            own = own * (1.0 - timing.risen(times, after.at, 0.0 if after.sudden else BREAKS_OFF))
        out = out + own
    return out


def _turned(actor: Actor, posture: Posture, angles: Array, axis: Array) -> Posture:
    """Return a posture whose head and neck have turned about an axis of the head, shapes (n,) and (3,)."""
    assert actor.head is not None, "only what has a head nods"
    about = posture.seen(actor.head, quat.rotate(quat.between(FORWARD, actor.forward), axis))
    joints = [*actor.neck, actor.head]
    shares = [*np.linspace(0.0, NECK, len(joints))[1:].tolist(), 1.0]
    return posture.turned(
        actor.tree,
        {joint: quat.from_axis_angle(about, share * angles) for joint, share in zip(joints, shares, strict=True)},
    )
