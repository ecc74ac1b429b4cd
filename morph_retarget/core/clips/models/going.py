"""Going: walking, running and any other way to get about, with or without feet (Grünvogel 2003 §5.5).

    start clip ─► loop ─► loop of other parameters ─► … ─► stop clip

All loops of a going body follow one pace (`pace`), also those of walk and run, so that each change of speed, turn,
direction, style or gait is a blend of cycles in step. A stop begins where a stop clip fits the cycle next: as a foot
lands.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array, Flags
from ..character_model import RATE
from ..clip import Clip, ClipPrimitive
from ..commands.command import Command, Value, Verb
from ..commands.parameters import Parameter, Parameters
from ..frames import Frames
from ..motions.annotations import Phase
from ..motions.base_motion import BaseMotion
from ..operators.time_warp import TimeWarp
from ..travel import Travel
from .cycles import STILL, Cycle, Cycles, Way
from .gone import Gone, Stage
from .matching import phase_at
from .motion_model import KindModel
from .pace import Pace
from .token import Token
from .transitions import crossfade, held_on, kept_small, transition

FAMILY = "going"
"""Of all ways to go: each goes over into another at once."""
GRAVITY = 9.81
"""[m/s²]"""
OVERLAP = 0.5
"""Start and stop clips, and loops of other parameters, are blended over this share of a cycle …"""
LEAST, MOST = 6.0, 20.0
"""… but within these limits [frames] …"""
HASTE = 0.35
"""… and no body changes its speed faster than by this share of gravity, or its turn by …"""
SWING = 2.5
"""… so much [rad/s²]."""
QUICKER = 1.6
"""Start and stop clips are played faster or slower by this factor at most, to keep the pace of the loop."""
USUAL = 5
"""Operators over the clips of a going body that starts or changes once."""
AHEAD = np.radians(50.0)
"""Start and stop clips serve for directions that differ by less."""
TURNED_BACK = 0.25
"""Who is told to go on within this share of a stop clip goes on in step; later it begins anew."""


@dataclass(frozen=True, eq=False)
class Going(KindModel):
    """The motion model of one way to go; among its motions is a loop, and there may be starts and stops."""

    phases: dict[str, float] = field(default_factory=dict[str, float], repr=False)
    """Where in the cycle start clips end, stop clips begin, and the body is as if it stood, as far as it was needed."""

    @property
    def family(self) -> str:
        """All ways to go."""
        return FAMILY

    @property
    def parameters(self) -> Parameters:
        """Speed, turn, direction and style."""
        return self._parameters

    @cached_property
    def _parameters(self) -> Parameters:
        cycles = self._cycles(self.styles[0])
        usual = cycles.usual
        known = [motion.annotations for motion in cycles.motions]
        fastest = max(own.speed for own in known) * self.scale
        out: dict[str, Parameter] = {}
        if fastest > 0.0:
            about = f"about {min(own.speed for own in known) * self.scale:.2g} to {fastest:.2g} as its motions are"
            out["speed"] = Parameter(usual.speed * self.scale, f"How fast it goes; {about}", "m/s", 0.01)
            out["direction"] = Parameter(0.0, "Where it goes beside its heading, to the left", "rad", -np.pi, np.pi)
        out["turn"] = Parameter(usual.turn, "How fast it turns to the left", "rad/s", -20.0, 20.0)
        if len(self.styles) > 1:
            out["style"] = Parameter(self.styles[0], "How it is done", choices=self.styles)
        return out

    @cached_property
    def styles(self) -> tuple[str, ...]:
        """Of its loops, the usual one first."""
        found = {motion.annotations.style for motion in self.motions if is_loop(motion)}
        return tuple(sorted(found))

    def crucial(self, command: Command) -> Flags:
        """Return the joints that carry the body."""
        own = self._cycles(self._way(command, {})).motions[0].annotations.parts
        model = self.model
        carry = own or (("legs",) if "legs" in model.parts else ("trunk",))
        out = model.part(*carry)
        out[model.root] = True
        # What is between the root and a leg moves the leg as well.
        for joint in np.flatnonzero(out).tolist():
            above = model.character.skeleton.tree.ancestors[joint]
            out[[own for own in above if model.root in model.character.skeleton.tree.ancestors[own]]] = True
        return out

    def do_command(self, command: Command, frame: float, token: Token | None) -> Token | None:
        """Start, change or stop going; see `MotionModel`."""
        gone = None if token is None else token.state
        assert gone is None or isinstance(gone, Gone), "only what goes is of this family"
        if command.verb is Verb.RESET or (command.verb is Verb.STOP and (gone is None or token is None)):
            return None
        if gone is None or token is None:
            return self._token(command, frame, *self._begun(self._way(command, {}), frame))
        if command.verb is Verb.STOP:
            return token if gone.tree.is_finite else self._token(command, token.start, self.stopped(gone, frame), "")
        way = self._way(command, gone.way if token.model == self.name else {})
        if token.model == self.name and way == gone.way and not gone.tree.is_finite:
            return token
        stops = gone.closing.start if gone.closing is not None else gone.end
        if frame < stops:
            going = replace(gone, closing=None, end=math.inf)
            if going.stages[-1].cycle.on_the_spot != self._cycle(way)[0].on_the_spot:
                return self._token(command, token.start, *self._after_standing(going, way, frame))
            return self._token(command, token.start, *self._changed(going, way, frame))
        if gone.closing is not None and frame < stops + TURNED_BACK * (gone.closing.end - stops):
            resumed = replace(gone, opening=gone.tree, stages=(), closing=None)
            return self._token(command, token.start, *self._changed(resumed, way, frame))
        return self._token(command, frame, *self._begun(way, frame))

    def _token(self, command: Command, start: float, gone: Gone, problem: str) -> Token:
        joints = np.ones(len(self.model), dtype=np.bool_)
        warnings = (problem,) if problem else ()
        return Token(self.name, command, start, gone.tree, joints, self.crucial(command), gone, warnings=warnings)

    # --- parameters ---

    def _way(self, command: Command, before: Mapping[str, Value]) -> dict[str, Value]:
        return {**{name: known.default for name, known in self.parameters.items()}, **before, **command.parameters}

    def _cycles(self, way: Mapping[str, Value] | str) -> Cycles:
        style = way if isinstance(way, str) else way.get("style", self.styles[0])
        loops = [motion for motion in self.motions if is_loop(motion) and motion.annotations.style == style]
        return Cycles(tuple(loops))

    def _cycle(self, way: Mapping[str, Value]) -> tuple[Cycle, str]:
        numbers = {name: float(value) for name, value in way.items() if isinstance(value, int | float)}
        speed, turn = numbers.get("speed", 0.0) / self.scale, numbers.get("turn", 0.0)
        return self._cycles(way).at(Way(speed, turn, numbers.get("direction", 0.0)))

    # --- phases ---

    def _begun(self, way: Mapping[str, Value], frame: float) -> tuple[Gone, str]:
        """Return a body that begins to go."""
        cycle, problem = self._cycle(way)
        start = self._nearest(way, Phase.START)
        if start is None:
            phase = self._stands(cycle)
            return Gone(
                self.stopped, way, Pace.steady(frame, phase, cycle.rate), (Stage(cycle, frame, frame),), frame
            ), problem
        own, phase = self._native(start), self._fits(start, start.clip.end)
        opening = self._played(start, own, cycle.rate, frame)
        overlap = min(_overlap(cycle.rate), 0.5 * (opening.end - frame))
        stage = Stage(cycle, opening.end - overlap, opening.end)
        pace = Pace.steady(opening.end, phase, cycle.rate)
        return Gone(self.stopped, way, pace, (stage,), stage.begin, opening), problem

    def _changed(self, gone: Gone, way: Mapping[str, Value], frame: float) -> tuple[Gone, str]:
        """Return a body that goes over to another cycle in step (eqs 20–23)."""
        cycle, problem = self._cycle(way)
        begin = max(frame, gone.settled)
        before = gone.stages[-1].cycle if gone.stages else cycle
        haste = quat.length(np.array(before.velocity) - np.array(cycle.velocity)) / (HASTE * GRAVITY)
        swing = abs(before.turn - cycle.turn) / SWING
        lasts = max(_overlap(max(cycle.rate, gone.pace.rate(begin))), float(max(haste, swing)) * RATE)
        gone = gone.since(frame)
        if gone.opening is not None or len(gone.stages) > 1:
            opening = kept_small(gone.tree, frame, begin - frame + lasts, USUAL)
            gone = gone if opening is gone.tree else replace(gone, opening=opening, stages=(), settled=begin)
        stage = Stage(cycle, begin, begin + lasts)
        pace = gone.pace.going_over(begin, cycle.rate, lasts)
        return replace(gone, stop=self.stopped, way=way, pace=pace, stages=(*gone.stages, stage)), problem

    def _after_standing(self, gone: Gone, way: Mapping[str, Value], frame: float) -> tuple[Gone, str]:
        """Return a body that stops and begins anew: steps on the spot and steps that lead on are never in step."""
        stopped = gone.stop(gone, frame).tree
        end = stopped.end
        fresh, problem = self._begun(way, end)
        blend = transition(held_on(stopped), fresh.tree, end)
        if fresh.opening is not None:
            return replace(fresh, opening=crossfade(stopped, fresh.opening, end, blend.finish)), problem
        first = replace(fresh.stages[0], finish=blend.finish)
        return replace(fresh, opening=held_on(stopped), stages=(first,)), problem

    def stopped(self, gone: Gone, frame: float) -> Gone:
        """Return a body that comes to a stand, as soon as a foot strikes."""
        gone = gone.since(frame)
        if gone.opening is not None and frame < gone.settled and _stood(gone.opening, frame):
            return replace(gone, end=frame)
        soon = max(frame, gone.settled)
        found: list[tuple[float, Clip, Cycle]] = []
        for motion in self._suiting(gone.way, Phase.STOP):
            native = self._native(motion)
            # The loop that the stop comes from is blended in first: a foot lands where it is to stand in the stop.
            before = 0.0 if native.is_like(gone.stages[-1].cycle) else _overlap(gone.pace.rate(soon))
            begin = gone.pace.reached(self._fits(motion, motion.clip.start), soon + before)
            found.append((begin, self._played(motion, native, gone.pace.rate(begin), begin), native))
        if not found:
            cycle = gone.stages[-1].cycle
            phases = (self._stands(cycle),) if cycle.on_the_spot else cycle.strikes
            return replace(gone, end=min(gone.pace.reached(phase, soon) for phase in phases))
        begin, closing, native = min(found, key=lambda entry: entry[0])
        stages = gone.stages
        if not native.is_like(stages[-1].cycle):
            stages = (*stages, Stage(native, begin - _overlap(gone.pace.rate(soon)), begin))
        return replace(gone, closing=closing, stages=stages)

    def _nearest(self, way: Mapping[str, Value], phase: Phase) -> BaseMotion | None:
        return next(iter(self._suiting(way, phase)), None)

    def _suiting(self, way: Mapping[str, Value], phase: Phase) -> Sequence[BaseMotion]:
        """Return the start or stop clips that suit a way to go: those nearest to its speed."""
        cycles = self._cycles(way)
        style, names = cycles.motions[0].annotations.style, ("speed", "turn", "direction")
        speed, turn, direction = (
            float(value) if isinstance(value := way.get(name, 0.0), int | float) else 0.0 for name in names
        )
        speed /= self.scale

        def away(motion: BaseMotion) -> float:
            known = motion.annotations
            return abs(known.speed - speed) + 0.2 * abs(known.turn_rate - turn)

        found = [
            motion
            for motion in self.motions
            if motion.annotations.phase == phase
            and motion.annotations.style == style
            and abs(_wrapped(motion.annotations.direction - direction)) < AHEAD
            and (motion.annotations.speed > 0.0 or np.sign(motion.annotations.turn_rate) == np.sign(turn))
        ]
        least = min((away(motion) for motion in found), default=0.0)
        return [motion for motion in found if away(motion) <= least + 1e-6]

    def _native(self, motion: BaseMotion) -> Cycle:
        """Return the cycle that a start clip leads to, or a stop clip comes from."""
        known = motion.annotations
        return self._cycles(known.style).at(Way(known.speed, known.turn_rate, known.direction))[0]

    def _fits(self, motion: BaseMotion, frame: float) -> float:
        """Return the phase of its cycle that a start or stop clip is at, at its last or its first frame."""
        if motion.name not in self.phases:
            own = self._native(motion)
            self.phases[motion.name] = (phase_at(own.clip, own.period, motion.clip, frame) - own.zero) / own.period
        return self.phases[motion.name]

    def _stands(self, cycle: Cycle) -> float:
        """Return the phase of a cycle at which the body is most as if it stood."""
        name = f"{cycle.velocity} {cycle.turn}"
        if name not in self.phases:
            rest = ClipPrimitive("rest", self.model, Frames.at_rest(self.model), Travel.still())
            self.phases[name] = (phase_at(cycle.clip, cycle.period, rest, 0.0) - cycle.zero) / cycle.period
        return self.phases[name]

    @staticmethod
    def _played(motion: BaseMotion, own: Cycle, rate: float, frame: float) -> Clip:
        """Return a start or stop clip that begins at a frame and keeps the pace of a loop (eqs 15–17)."""
        factor = float(np.clip(rate / own.rate, 1.0 / QUICKER, QUICKER))
        last = motion.clip.length - 1.0
        return TimeWarp(((0.0, frame), (last, frame + last / factor)), motion.clip)


def is_loop(motion: BaseMotion) -> bool:
    """Return whether a base motion is a cycle that gets about."""
    known = motion.annotations
    moves = known.speed > STILL * motion.clip.model.character.frame.height or abs(known.turn_rate) > STILL
    return known.cycle and moves and known.phase in {Phase.LOOP, Phase.WHOLE}


def _overlap(rate: float) -> float:
    """Return how long a blend lasts at a pace [frames]."""
    return float(np.clip(OVERLAP / rate, LEAST, MOST))


def _stood(opening: Clip, frame: float) -> bool:
    """Return whether all feet have stood from the start of a clip to a frame."""
    times: Array = np.arange(opening.start, frame + 1.0)
    contacts = opening.frame(times).contacts
    return bool(contacts.size) and bool((contacts > 0.5).all())


def _wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2.0 * np.pi) - np.pi)
