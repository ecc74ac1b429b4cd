"""Behaviours: what a character does with its eyes, head and hands while a motion plays (Feng 2013 §6.2, table 1).

Motion models make poses out of clips; behaviours change the poses of the very body that shows them, so they aim at
what is really there. Each is told what to do by the same commands, and all of them are functions of time alone.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ...arrays import Array
from ...errors import listed
from ..commands import parameters
from ..commands.command import Command, Value, Verb
from ..commands.parameters import Parameter, Parameters, told
from ..track import Track

TARGET = Parameter("", "Name of what it is about: an object, or a place that the commands name")
PLACE = Parameter((0.0, 0.0, 0.0), "Where that is, instead of a name, on the ground where the character sets out", "m")
AIMED: Parameters = {"target": TARGET, "place": PLACE}
"""The parameters of all behaviours that are about something."""


@dataclass(frozen=True)
class Behaviour:
    """What can be said about one behaviour."""

    name: str
    """By which commands address it."""
    description: str
    """For people; a sentence without its full stop."""
    parameters: Parameters

    @property
    def is_aimed(self) -> bool:
        """Whether it makes no sense without a target."""
        return "target" in self.parameters


@dataclass(frozen=True, eq=False)
class Scene:
    """When a character is seen, and what is around it; the ground frame in which it sets out."""

    times: Array
    """Of the frames, one after the other from the first of the clip [s], shape (n,)."""
    targets: Mapping[str, Track] = field(default_factory=dict[str, Track])
    """By the names that commands use."""
    floors: Array | None = None
    """How high the ground is [m], shape (n,); 0 when None."""

    @property
    def floor(self) -> Array:
        """How high the ground is [m], shape (n,)."""
        return np.zeros(len(self.times)) if self.floors is None else self.floors

    def track(self, values: Mapping[str, Value]) -> Track:
        """Return where that is over time which parameters are about."""
        name, place = values.get("target", ""), values.get("place")
        if isinstance(name, str) and name in self.targets:
            return self.targets[name]
        assert isinstance(place, tuple), "commands without a target are dropped as they are read"
        return Track.at_place(np.array([*place, 0.0][:3], dtype=np.float64))


@dataclass(frozen=True)
class Cue:
    """A change of what a behaviour does."""

    at: float
    """[s]."""
    values: Mapping[str, Value] | None = field(hash=False)
    """Its parameters from here on, those that have been told; None where it stops."""
    command: Command
    """Where it comes from."""

    @property
    def sudden(self) -> bool:
        """Whether it takes no time."""
        return self.command.verb is Verb.RESET

    def number(self, name: str, known: Parameters) -> float:
        """Return a number among its parameters, the default where it was not told."""
        value = (self.values or {}).get(name, known[name].default)
        assert isinstance(value, int | float), "parameters have been read"
        return float(value)

    def text(self, name: str, known: Parameters) -> str:
        """Return a word among its parameters, the default where it was not told."""
        value = (self.values or {}).get(name, known[name].default)
        assert isinstance(value, str), "parameters have been read"
        return value


def cues_of(behaviour: Behaviour, commands: Sequence[Command], scene: Scene) -> tuple[tuple[Cue, ...], list[str]]:
    """Return what commands make of a behaviour, in the order of time, and warnings about those that make no sense.

    Starting what runs already changes it: what the command does not tell stays as it was. Stopping or resetting what
    does not run changes nothing.
    """
    cues: list[Cue] = []
    warnings: list[str] = []
    now: dict[str, Value] | None = None
    for command in sorted((c for c in commands if c.model == behaviour.name), key=lambda c: c.time):
        values, problems = parameters.read(command, behaviour.parameters)
        warnings += problems
        if command.verb is Verb.START:
            kept = {} if now is None else now
            if "target" in values or "place" in values:
                kept = {name: value for name, value in kept.items() if name not in AIMED}
            told_now = kept | values
            problem = _aimless(behaviour, told_now, scene)
            if problem:
                warnings.append(told(command, problem))
                continue
            now = told_now
        elif now is None:
            continue
        else:
            now = None
        cues.append(Cue(command.time, now, command))
    return tuple(cues), warnings


def _aimless(behaviour: Behaviour, values: Mapping[str, Value], scene: Scene) -> str:
    """Return what is wrong with what a behaviour is about, nothing where all is well."""
    if not behaviour.is_aimed or "place" in values:
        return ""
    name = values.get("target", "")
    if not name:
        return "it has no target: give target or place"
    if name not in scene.targets:
        known = f"choose one of {listed(scene.targets)}" if scene.targets else "there are none"
        return f"there is no target {name!r}: {known}"
    return ""
