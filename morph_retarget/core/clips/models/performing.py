"""Performing: any motion that begins, is done and is over, such as a wave, a jump or a gesture, and idling.

Base motions of a kind that lie at several places of a parameter space, as jumps of several heights, are mixed for what
a command asks for. Those of a start, a loop and a stop are played one after the other.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Flags
from ..character_model import RATE
from ..clip import Clip
from ..commands.command import Command, Value, Verb
from ..commands.parameters import Parameter, Parameters
from ..motions.annotations import Phase
from ..motions.base_motion import BaseMotion
from ..operators.additive import Additive
from ..operators.loop import Loop
from ..operators.mix import Mix
from ..operators.section import Section
from ..operators.time_shift import started_at
from ..operators.time_warp import TimeWarp
from .blend_space import BlendSpace
from .motion_model import KindModel
from .token import Token
from .transitions import crossfade

LENGTHS = ("speed", "height", "distance", "length", "width", "depth", "reach", "x", "y", "z")
"""Parameters of base motions that are lengths or speeds: they grow with the body."""
SEAM = 5.0
"""Frames on either side of the seam of a clip that is repeated and does not fit its own beginning."""
SHORTEST = 2.0
"""A motion gets to its peak, and from there to its end, in no fewer frames than this."""
FADE = 6.0
"""Frames over which one phase of a motion goes over to the next."""


@dataclass(frozen=True, eq=False)
class Performed:
    """A motion under way."""

    values: Mapping[str, Value]
    """Parameters, all of them."""
    round: float
    """Frames of one repetition."""
    begin: float
    """Where the first of them begins."""
    tree: Clip


@dataclass(frozen=True, eq=False)
class Performing(KindModel):
    """The motion model of one kind of base motions that begin, are done and are over."""

    beneath: bool = False
    """Whether all others may take its joints: idling."""

    @property
    def parameters(self) -> Parameters:
        """Speed, amplitude and repetitions; side and style where there are several; those of its base motions."""
        return self._parameters

    @cached_property
    def _parameters(self) -> Parameters:
        known = [motion.annotations for motion in self._main]
        out = {
            "tempo": Parameter(1.0, "How fast it is done, as a factor", "", 0.1, 10.0),
            "amplitude": Parameter(1.0, "How far it goes out from its first pose, as a factor", "", 0.0, 2.0),
        }
        if not self.beneath:
            often = "How often it is done; 0 for again and again"
            out["repeat"] = Parameter(0.0 if self._endless else 1.0, often, "", 0.0, 1000.0)
        sides = tuple(sorted({own.side for own in known}))
        if len(sides) > 1:
            out["side"] = Parameter(sides[-1] if "right" in sides else sides[0], "With which side", choices=sides)
        styles = tuple(sorted({own.style for own in known}))
        if len(styles) > 1:
            out["style"] = Parameter(styles[0], "How it is done", choices=styles)
        if any(own.strokes is not None for own in known):
            out["stroke"] = Parameter(0.0, "When its peak is, from its start; 0 for when it comes by itself", "s", 0.0)
        out["duration"] = Parameter(0.0, "How long it takes once; 0 for as long as it does by itself", "s", 0.0)
        for name in self._dimensions:
            values = [own.parameters.get(name, 0.0) * self._unit(name) for own in known]
            middle = sorted(values)[(len(values) - 1) // 2]
            words = f"Between {min(values):.3g} and {max(values):.3g}, as its motions are"
            out[name] = Parameter(middle, words, "m" if name in LENGTHS else "", min(values), max(values))
        return out

    def crucial(self, command: Command) -> Flags:
        """Return the joints that the motion is about; none of what all others may cover."""
        if self.beneath:
            return np.zeros(len(self.model), dtype=np.bool_)
        return self._joints(self._values(command, {}))

    def do_command(self, command: Command, frame: float, token: Token | None) -> Token | None:
        """Start the motion, do it in another way, or let it come to its end; see `MotionModel`."""
        done = None if token is None else token.state
        assert done is None or isinstance(done, Performed), "the token is its own"
        if command.verb is Verb.RESET or (command.verb is Verb.STOP and token is None):
            return None
        if token is None or done is None:
            return self._token(command, frame, self._begun(self._values(command, {}), frame))
        if command.verb is Verb.STOP:
            stopped = self._stopped(done, frame)
            return token if stopped is done else self._token(command, token.start, stopped)
        values = self._values(command, done.values)
        if values == done.values and not (done.tree.is_finite and self._goes_on(values)):
            return token
        return self._token(command, frame, self._begun(values, frame))

    def _token(self, command: Command, start: float, done: Performed) -> Token:
        crucial = np.zeros(len(self.model), dtype=np.bool_) if self.beneath else self._joints(done.values)
        return Token(self.name, command, start, done.tree, self._joints(done.values), crucial, done)

    # --- parameters ---

    @cached_property
    def _main(self) -> tuple[BaseMotion, ...]:
        """Base motions of what is repeated."""
        main = tuple(m for m in self.motions if m.annotations.phase in {Phase.LOOP, Phase.WHOLE})
        return main or self.motions

    @property
    def _endless(self) -> bool:
        """Whether it goes on until it is stopped."""
        return self.beneath or all(m.annotations.phase == Phase.LOOP or m.annotations.cycle for m in self._main)

    @property
    def _dimensions(self) -> tuple[str, ...]:
        """Parameters along which base motions differ."""
        known = [motion.annotations.parameters for motion in self._main]
        names = dict.fromkeys(name for own in known for name in own)
        return tuple(name for name in names if len({own.get(name, 0.0) for own in known}) > 1)

    def _unit(self, name: str) -> float:
        return self.scale if name in LENGTHS else 1.0

    def _values(self, command: Command, before: Mapping[str, Value]) -> dict[str, Value]:
        return {**{name: known.default for name, known in self.parameters.items()}, **before, **command.parameters}

    def _goes_on(self, values: Mapping[str, Value]) -> bool:
        return values.get("repeat", 0.0) == 0.0

    @staticmethod
    def _tempo(values: Mapping[str, Value]) -> float:
        tempo = values["tempo"]
        assert isinstance(tempo, int | float), "it is a number"
        return float(tempo)

    def _joints(self, values: Mapping[str, Value]) -> Flags:
        out = np.zeros(len(self.model), dtype=np.bool_)
        for motion in self._alike(self._main, values):
            parts = motion.annotations.parts
            out |= self.model.part(*parts) if parts else motion.clip.active
        return out

    def _alike(self, motions: tuple[BaseMotion, ...], values: Mapping[str, Value]) -> list[BaseMotion]:
        """Return base motions of the wanted side and style, all if there are none such."""
        out = list(motions)
        for name in ("side", "style"):
            if name in values:
                out = [m for m in out if getattr(m.annotations, name) in {values[name], ""}] or out
        return out

    # --- phases ---

    def _begun(self, values: Mapping[str, Value], frame: float) -> Performed:
        """Return a motion that begins at a frame."""
        main = self._timed(self._shown(self._mixed(values), values), values)
        lead = self._phase(Phase.START, values)
        begin = frame if lead is None else frame + lead.length - 1.0
        repeat = values.get("repeat", 0.0)
        assert isinstance(repeat, int | float), "it is a number"
        closing = 1.0 / self._tempo(values)
        looped = main
        if repeat != 1.0:
            looped = self._looped(main, 0 if repeat == 0.0 else max(round(repeat), 1), closing)
        tree = started_at(begin, looped)
        if lead is not None:
            tree = crossfade(started_at(frame, lead), tree, max(begin - FADE, frame), begin)
        done = Performed(values, main.length - 1.0 + closing, begin, tree)
        tail = self._phase(Phase.STOP, values)
        if tail is None or not tree.is_finite:
            return done
        return Performed(values, done.round, begin, _followed(tree, tail, tree.end))

    def _stopped(self, done: Performed, frame: float) -> Performed:
        """Return a motion that ends with the repetition that is under way."""
        tail = self._phase(Phase.STOP, done.values)
        if done.tree.is_finite and tail is None:
            rounds = max(math.ceil((frame - done.begin) / done.round), 1)
            end = min(done.begin + rounds * done.round - 1.0, done.tree.end)
            return done if end >= done.tree.end else self._cut(done, end)
        if done.tree.is_finite:
            return done
        rounds = max(math.ceil((frame - done.begin + 1.0) / done.round), 1)
        end = done.begin + rounds * done.round - 1.0
        if tail is None:
            return self._cut(done, end)
        return Performed(done.values, done.round, done.begin, _followed(done.tree, tail, end))

    @staticmethod
    def _cut(done: Performed, end: float) -> Performed:
        return Performed(done.values, done.round, done.begin, Section(done.tree.start, end, done.tree))

    def _looped(self, clip: Clip, count: int, closing: float) -> Clip:
        """Return a clip that is repeated, its ends bent toward each other if they do not fit."""
        cyclic = all(motion.annotations.cycle for motion in self._main)
        return Loop(count, clip, 0.0 if cyclic else min(SEAM, 0.4 * clip.length), closing)

    def _mixed(self, values: Mapping[str, Value]) -> Clip:
        """Return the base motion for some parameters."""
        motions = self._alike(self._main, values)
        names = self._dimensions
        if len(motions) == 1 or not names:
            return motions[0].clip
        space = BlendSpace(np.array([[m.annotations.parameters.get(n, 0.0) for n in names] for m in motions]))
        wanted = [float(v) / self._unit(n) for n in names if isinstance(v := values[n], int | float)]
        weights = space.weights(np.array(wanted))
        used = [(motion, float(w)) for motion, w in zip(motions, weights, strict=True) if w > 0.0]
        if len(used) == 1:
            return used[0][0].clip
        marks = [_marks(motion) for motion, _ in used]
        alike = len({len(own) for own in marks}) == 1 and marks[0]
        return Mix([m.clip for m, _ in used], [w for _, w in used], False, tuple(marks) if alike else ())

    def _shown(self, clip: Clip, values: Mapping[str, Value]) -> Clip:
        """Return a clip at the wanted tempo and amplitude."""
        tempo, amplitude = self._tempo(values), values["amplitude"]
        assert isinstance(amplitude, int | float), "it is a number"
        if amplitude != 1.0:
            clip = Additive(clip, clip, float(amplitude) - 1.0)
        if tempo != 1.0:
            last = clip.end - clip.start
            clip = TimeWarp(((clip.start, clip.start), (clip.end, clip.start + last / tempo)), clip)
        return clip

    def _timed(self, clip: Clip, values: Mapping[str, Value]) -> Clip:
        """Return a clip whose peak and whose end come when they are wanted."""
        stroke, duration = (
            float(v) * RATE for n in ("stroke", "duration") if isinstance(v := values.get(n, 0.0), float)
        )
        known = self._alike(self._main, values)[0].annotations.strokes
        if not stroke and not duration:
            return clip
        last = clip.end - clip.start
        peak = (
            0.0
            if known is None or not stroke
            else known.stroke / (self._alike(self._main, values)[0].clip.length - 1.0)
        )
        keys = [(clip.start, clip.start)]
        if 0.0 < peak < 1.0:
            keys.append((clip.start + peak * last, clip.start + max(stroke, SHORTEST)))
        rest = last * (1.0 - peak) if len(keys) > 1 else last
        end = duration if duration else keys[-1][1] - clip.start + rest
        keys.append((clip.end, max(clip.start + end, keys[-1][1] + SHORTEST)))
        return TimeWarp(tuple(keys), clip)

    def _phase(self, phase: Phase, values: Mapping[str, Value]) -> Clip | None:
        """Return the start or stop clip, None where there is none."""
        found = self._alike(tuple(m for m in self.motions if m.annotations.phase == phase), values)
        return None if not found or self._main is self.motions else self._shown(found[0].clip, values)


def _followed(tree: Clip, tail: Clip, end: float) -> Clip:
    """Return a motion that goes over to its stop clip at a frame."""
    return crossfade(tree, started_at(end, tail), max(end - FADE, tree.start), end)


def _marks(motion: BaseMotion) -> list[float]:
    """Return the frames that meet those of other motions of the kind: strokes, else strikes."""
    known = motion.annotations
    if known.strokes is not None:
        own = known.strokes
        times = [own.ready, own.stroke_start, own.stroke, own.stroke_end, own.relax]
    else:
        times = [strike.frame for strike in known.strikes]
    last = motion.clip.length - 1.0
    return [time for i, time in enumerate(times) if 0.0 < time < last and (i == 0 or time > times[i - 1])]
