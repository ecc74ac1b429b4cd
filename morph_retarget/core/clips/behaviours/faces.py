"""Faces: shape keys and custom properties that are given weights by their names (Feng 2013 §6.5).

What a face can do differs from character to character, so a command names what the character calls it: a smile, a
blink, an action unit. Several show at once.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from ...arrays import Array
from ..commands import parameters
from ..commands.command import Command, Value, Verb
from ..commands.parameters import Parameter, told
from . import timing
from .behaviour import Behaviour, Scene

FACE = Behaviour(
    "face",
    "Show something on the face: a shape key, or a custom property of the head or the armature",
    {
        "key": Parameter("", "Name of the shape key or the property"),
        "amount": Parameter(1.0, "Its value", "", -10.0, 10.0),
        "fade": Parameter(0.25, "Time in which it comes and goes", "s", 0.0, 60.0),
    },
)


def weights(scene: Scene, commands: Sequence[Command]) -> tuple[Mapping[str, Array], list[str]]:
    """Return the values of all that is shown, each shape (n,), and warnings.

    Args:
        scene: When.
        commands: All that the character is told.
    """
    out: dict[str, Array] = {}
    fades: dict[str, float] = {}
    warnings: list[str] = []
    for command in sorted((own for own in commands if own.model == FACE.name), key=lambda own: own.time):
        values, problems = parameters.read(command, FACE.parameters)
        warnings += problems
        key = str(values.get("key", ""))
        if command.verb is Verb.START and not key:
            warnings.append(told(command, "it has no key: name a shape key or a property"))
            continue
        for name in [key] if key else list(out):
            if command.verb is Verb.START or name in out:
                fades[name] = 0.0 if command.verb is Verb.RESET else _number(values, "fade", fades.get(name))
                amount = _number(values, "amount", None) if command.verb is Verb.START else 0.0
                before = out.get(name, np.zeros(len(scene.times)))
                rise = timing.risen(scene.times, command.time, fades[name])
                out[name] = before + rise * (amount - before)
    return out, warnings


def _number(values: Mapping[str, Value], name: str, before: float | None) -> float:
    """Return a number of a command, where it has none what held before, else what is usual."""
    value = values.get(name, FACE.parameters[name].default if before is None else before)
    assert isinstance(value, int | float), "parameters have been read"
    return float(value)
