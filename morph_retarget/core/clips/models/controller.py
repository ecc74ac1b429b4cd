"""The motion controller: from commands to one motion tree after the other (Grünvogel 2003 §6).

It keeps the list of tokens, and for each command, and wherever a motion ends, it
  - drops tokens whose motions have no influence any more (§6.2.1),
  - lets the addressed model change its motion or begin one (§6.2.2),
  - builds the tree anew from the trees of the models (§6.2.3),
and goes over from the tree before to the new one, so that the pose never jumps. Nothing is decided by what was shown:
the same commands always make the same performance.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Flags
from ..character_model import RATE, CharacterModel
from ..clip import Clip, ClipPrimitive
from ..commands.command import Command, Verb
from ..commands.parameters import read, told
from ..frames import Frames
from ..motions.library import Library
from ..operators.loop import Loop
from ..operators.overlay import Overlay
from ..travel import Travel
from . import transitions
from .models import models_of
from .motion_model import MotionModel
from .performance import Performance, Segment
from .token import Token

BASE = "idle"
"""The model that moves what no other does."""
PATIENCE = 1.0
"""What begins later than this after it was told to is worth a word [s]."""


@dataclass(frozen=True, eq=False)
class Placing:
    """The character put somewhere else, from one frame to the next (§6.1)."""

    frame: float
    place: tuple[float, float]
    """On the ground [m]."""
    heading: float = 0.0
    """To the left [rad]."""


def perform(
    library: Library, commands: Iterable[Command], scale: float = 1.0, placings: Sequence[Placing] = ()
) -> Performance:
    """Return what a character does that has a library and is told commands.

    Args:
        library: Its base motions.
        commands: In any order; those of the same time are obeyed in the order that they have here.
        scale: Lengths that commands name over the same ones of the library's body: what shows the motion may be larger.
        placings: Where it is put.
    """
    return controlled(library.model, models_of(library, scale), commands, placings)


def controlled(
    model: CharacterModel,
    models: Mapping[str, MotionModel],
    commands: Iterable[Command],
    placings: Sequence[Placing] = (),
) -> Performance:
    """Return what a character does by its motion models; see `perform`."""
    given = sorted(commands, key=lambda command: command.time)
    first = min([0.0, *(command.time * RATE for command in given), *(placing.frame for placing in placings)])
    controller = Controller(model, models, first)
    agenda = [(command.time * RATE, command) for command in given] + [(placing.frame, placing) for placing in placings]
    agenda.sort(key=lambda entry: entry[0])
    while agenda or controller.next_end < math.inf:
        frame = min(agenda[0][0] if agenda else math.inf, controller.next_end)
        due = [entry for _, entry in agenda if _ <= frame]
        agenda = agenda[len(due) :]
        controller.update(frame, [entry for entry in due if isinstance(entry, Command)])
        for entry in due:
            if isinstance(entry, Placing):
                controller.put(entry)
    return controller.performance()


class Controller:
    """The motion controller while it goes through commands in order of time."""

    def __init__(self, model: CharacterModel, models: Mapping[str, MotionModel], first: float) -> None:
        self.model = model
        self.models = models
        self.tokens: list[Token] = []
        """In order; the motions that have influence, and those that wait."""
        self.base = self._default_base(first)
        self.warnings: list[str] = []
        tree = self._tree(first)
        self._settled: tuple[float, Clip] = (first, tree)
        """From when on the tree is what it goes over to, and that."""
        self._played = self._playing(first)
        """Of what that is made."""
        self.segments = [Segment(first, tree, Travel.still(), self._shown())]

    # --- the list of tokens ---

    @property
    def next_end(self) -> float:
        """The next frame at which a motion ends, or its influence."""
        ends = (token.last if token.influence == math.inf else token.influence for token in self.tokens)
        return min(ends, default=math.inf)

    def update(self, frame: float, commands: Sequence[Command]) -> None:
        """Go on to a frame: end what ends there, obey commands, begin what has waited, build the tree anew."""
        before = list(self.tokens), self.base
        self.tokens = [token for token in self.tokens if token.influence > frame]
        for command in commands:
            self._obey(command, frame)
        self._begin_waiting(frame)
        over = any(self._ends(token, frame) and token.influence == math.inf for token in self.tokens)
        if over or (self.tokens, self.base) != before:
            self._build(frame)

    def put(self, placing: Placing) -> None:
        """Put the character somewhere else (§6.1)."""
        there = Travel(np.array([placing.place], dtype=np.float64), np.array([placing.heading]))
        self._hold(replace(self.segments[-1], start=placing.frame, place=there))

    def performance(self) -> Performance:
        """Return all that was built."""
        for token in self.tokens:
            if token.waits:
                names = _in_the_way(token, [other for other in self.tokens if other is not token])
                self.warnings.append(
                    told(token.command, f"it waits for {names} to end, which never happens: stop that")
                )
        return Performance(self.model, tuple(self.segments), tuple(self.warnings))

    def _obey(self, command: Command, frame: float) -> None:
        model = self.models.get(command.model)
        if model is None:
            known = ", ".join(sorted(self.models)) or "none: the library is empty"
            self.warnings.append(told(command, f"there is no motion model of this name: choose one of {known}"))
            return
        values, warnings = read(command, model.parameters)
        self.warnings += warnings
        command = replace(command, parameters=values)
        if command.model == BASE:
            self._rest(model, command, frame)
            return
        place = self._own(model, frame)
        if place is None:
            self._insert(model, command, frame)
        elif self.tokens[place].waits:
            self._change_waiting(place, command)
        else:
            token = self.tokens[place]
            self._put_at(place, command, model.do_command(command, frame, token), frame)

    def _own(self, model: MotionModel, frame: float) -> int | None:
        """Return the place of the token of a model whose motion has not ended."""
        for i, token in enumerate(self.tokens):
            if token.model == model.name and not self._ends(token, frame):
                return i
        return None

    def _insert(self, model: MotionModel, command: Command, frame: float) -> None:
        """Begin a motion, take over one of the same family, or append it to those that block it (§6.2.3)."""
        if command.verb is not Verb.START:
            assert model.do_command(command, frame, None) is None, "nothing can be stopped that was not started"
            return
        for i, other in enumerate(self.tokens):
            if self._ends(other, frame) or self.models[other.model].family != model.family:
                continue
            if other.waits:
                self.tokens[i] = self._waiting(model, command, frame)
            else:
                self._put_at(i, command, model.do_command(command, frame, other), frame)
            return
        self.tokens.append(self._waiting(model, command, frame))  # It begins at once if nothing blocks it.

    def _put_at(self, place: int, command: Command, changed: Token | None, frame: float) -> None:
        token = self.tokens[place]
        if changed is token:
            return
        if changed is None:
            del self.tokens[place]
            return
        self.warnings += [told(command, warning) for warning in changed.warnings]
        for i, other in enumerate(self.tokens):
            if i != place and not other.waits and self._blocks(other, changed.crucial, frame):
                self.warnings.append(told(command, f"{other.model} needs the same joints: it stays as it was"))
                return
        self.tokens[place] = replace(changed, warnings=())

    def _change_waiting(self, place: int, command: Command) -> None:
        """Change what a motion will be that has not begun, or give it up."""
        token = self.tokens[place]
        if command.verb is not Verb.START:
            del self.tokens[place]
            return
        merged = {**token.command.parameters, **command.parameters}
        if merged != token.command.parameters:
            command = replace(command, parameters=merged)
            crucial = self.models[token.model].crucial(command)
            self.tokens[place] = replace(token, command=command, joints=crucial, crucial=crucial)

    def _begin_waiting(self, frame: float) -> None:
        """Begin what nothing blocks any more, the first that waits first."""
        i = 0
        while i < len(self.tokens):
            token = self.tokens[i]
            others = [
                *(other for other in self.tokens if not other.waits),
                *(own for own in self.tokens[:i] if own.waits),
            ]
            if token.waits and not any(self._blocks(other, token.crucial, frame) for other in others):
                begun = self.models[token.model].do_command(token.command, frame, None)
                if begun is None:
                    del self.tokens[i]
                    continue
                self.warnings += [told(token.command, warning) for warning in begun.warnings]
                waited = (frame - token.start) / RATE
                if waited > PATIENCE:
                    names = _in_the_way(token, [other for other in self.segments[-1].tokens if not other.waits])
                    self.warnings.append(told(token.command, f"it waits {waited:.1f} s for {names} to end"))
                self.tokens[i] = replace(begun, warnings=())
            i += 1

    def _waiting(self, model: MotionModel, command: Command, frame: float) -> Token:
        crucial = model.crucial(command)
        return Token(model.name, command, frame, None, crucial, crucial)

    def _blocks(self, other: Token, crucial: Flags, frame: float) -> bool:
        """Return whether a motion, that begins or waits, keeps joints from another that cannot do without them."""
        return not self._ends(other, frame) and bool((other.crucial & crucial).any())

    @staticmethod
    def _ends(token: Token, frame: float) -> bool:
        return token.last <= frame and not token.waits

    # --- what moves when nothing else does ---

    def _default_base(self, frame: float) -> Token | None:
        model = self.models.get(BASE)
        return None if model is None else model.do_command(Command(frame / RATE, Verb.START, BASE), frame, None)

    def _rest(self, model: MotionModel, command: Command, frame: float) -> None:
        """Change how the character idles; it always does where nothing else moves it."""
        if command.verb is Verb.START:
            self.base = model.do_command(command, frame, self.base)
        elif self.base is not None and self.base.command.parameters:
            self.base = self._default_base(frame)

    # --- the motion tree ---

    def _playing(self, frame: float) -> list[Token]:
        """Return the tokens of all motions that go on, the base first."""
        active = [token for token in self.tokens if not token.waits and not self._ends(token, frame)]
        return active if self.base is None else [self.base, *active]

    def _tree(self, frame: float) -> Clip:
        """Return the motion tree of all motions that go on (§6.2.3)."""
        tree = Loop(0, _at_rest(self.model)) if self.base is None else self.models[BASE].subtree(self.base)
        active = [token for token in self._playing(frame) if token is not self.base]
        for token in active:
            taken = np.zeros(len(self.model), dtype=np.bool_)
            for other in active:
                if other is not token:
                    taken |= other.crucial
            subtree = transitions.held_on(self.models[token.model].subtree(token))
            joints = (token.joints & ~taken) | token.crucial
            tree = subtree if (joints & subtree.active).all() else Overlay(tree, subtree, joints)
        return tree

    def _build(self, frame: float) -> None:
        """Build the tree anew and go over to it from the one before."""
        since, goal = self._settled
        tree = before = goal if frame >= since else self.segments[-1].tree
        playing = self._playing(frame)
        if playing != self._played:
            tree = goal = self._tree(frame)
            since = frame
            if transitions.differ(before, goal, frame):
                before = transitions.kept_small(before, frame, 2.0 * transitions.LONGEST, transitions.depth(goal))
                blend = transitions.transition(before, goal, frame)
                tree, since = blend, blend.finish
            self._settled, self._played = (since, goal), playing
        self.tokens = [
            replace(token, influence=max(since, frame))
            if self._ends(token, frame) and token.influence == math.inf
            else token
            for token in self.tokens
        ]
        self.tokens = [token for token in self.tokens if token.influence > frame]
        self._hold(Segment(frame, tree, self.segments[-1].travel(np.array([frame])), self._shown()))

    def _hold(self, segment: Segment) -> None:
        """Let a tree hold from its start on; nothing is left of one that held for no time."""
        if self.segments[-1].start >= segment.start:
            self.segments.pop()
        self.segments.append(segment)

    def _shown(self) -> tuple[Token, ...]:
        return (*(() if self.base is None else (self.base,)), *self.tokens)


def _in_the_way(token: Token, others: Iterable[Token]) -> str:
    """Return the names of the motions that need joints which one that waits cannot do without."""
    names = {other.model for other in others if (other.crucial & token.crucial).any()}
    return " and ".join(sorted(names))


def _at_rest(model: CharacterModel) -> ClipPrimitive:
    return ClipPrimitive("rest", model, Frames.at_rest(model), Travel.still())
