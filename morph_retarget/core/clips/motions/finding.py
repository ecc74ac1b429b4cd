"""Annotations found from the motion itself: what the paper wishes for instead of making them by hand (§5.4).

Nothing is known but the body and its motion: no names, no frame rate that is usual, no ground but where the feet stand.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...arrays import Array
from ...character.character import Character
from ...skeleton import Pose
from ..character_model import RATE, CharacterModel
from . import cycles, strokes
from .annotations import Annotations, Phase, Strike, Strokes
from .cycles import Cycle
from .footfalls import DEFAULT, Footfalls, FootfallSettings
from .kinds import GESTURE, GOING, IDLE, JUMP, TURN, Judged
from .seen import Seen

SLOW, FAST = 0.3, 0.6
"""A motion starts or stops if its speed at one end is below, and at the other above, these shares of its greatest."""
END_TIME = 0.15
"""Speeds at the ends are taken over this time [s]."""
HALF = 0.5
"""Hands that move less than this share of what the liveliest does take no part in a gesture."""
STILL = 0.05
"""What goes slower than this stays where it is [leg lengths/s]."""


@dataclass(frozen=True, eq=False)
class Found:
    """All that was found of a motion."""

    judged: Judged
    cycle: Cycle | None
    """The motion as a cycle, or the best one within it; None where there is none."""

    @property
    def seen(self) -> Seen:
        """The motion."""
        return self.footfalls.seen

    @property
    def footfalls(self) -> Footfalls:
        """When its feet stand."""
        return self.judged.footfalls

    @property
    def kind(self) -> str:
        """What it is an example of."""
        return self.judged.kind

    @property
    def is_loop(self) -> bool:
        """Whether the whole of it is a cycle."""
        return self.cycle is not None and self.cycle.whole

    @cached_property
    def speed(self) -> float:
        """Mean speed over the ground [m/s], 0 for what stays where it is."""
        return self.judged.pace * self.seen.size if self.judged.pace > STILL else 0.0

    @cached_property
    def direction(self) -> float:
        """Where it goes beside its heading [rad], 0 for what stays where it is."""
        x, y = self.judged.drift.tolist()
        return float(np.arctan2(x, -y)) if self.speed > 0.0 else 0.0

    @cached_property
    def phase(self) -> Phase:
        """Which part of its kind it shows."""
        if self.kind in (*GOING, TURN, IDLE) and self.is_loop:
            return Phase.LOOP
        if self.kind not in GOING or self.footfalls.is_on_the_spot:
            return Phase.WHOLE
        speed = np.hypot(*self.footfalls.velocity.T)
        reach = max(round(END_TIME / self.seen.step), 1)
        first, last = (float(end.mean() / speed.max()) for end in (speed[:reach], speed[-reach:]))
        if first < SLOW and last > FAST:
            return Phase.START
        return Phase.STOP if last < SLOW and first > FAST else Phase.WHOLE

    @cached_property
    def strokes(self) -> Strokes | None:
        """The times of a gesture in rows, None for what is none."""
        if self.kind != GESTURE:
            return None
        reach = self.judged.reach
        hands = [hand for hand, far in zip(self.judged.hands, reach, strict=True) if far > HALF * reach.max()]
        return strokes.find(self.seen.shape[:, hands], self.seen.step)

    @cached_property
    def parameters(self) -> dict[str, float]:
        """Its place among others of its kind."""
        if self.kind in (*GOING, TURN):
            return {"speed": self.speed, "turn": self.judged.turn_rate, "direction": self.direction}
        if self.kind == JUMP:
            root = self.seen.places[:, self.seen.root]
            over = self.footfalls.stands.all(axis=1)
            usual = float(np.median(root[over, 2])) if over.any() else float(root[0, 2])
            away = self.footfalls.way.places[-1] - self.footfalls.way.places[0]
            return {"height": float(root[:, 2].max()) - usual, "distance": float(np.hypot(*away))}
        return {}

    def frames(self, rows: Array | float) -> Array:
        """Return rows as frames of the clip, whatever was left out before its first."""
        return (np.asarray(rows) + self.seen.first) * self.seen.step * RATE

    @property
    def annotations(self) -> Annotations:
        """Of the motion as it is."""
        times = None
        if self.strokes is not None:
            own = self.strokes
            rows = np.array([own.ready, own.stroke_start, own.stroke, own.stroke_end, own.relax])
            times = Strokes(*self.frames(rows).tolist())
        # A cycle has been looked at as if it had a whole number of rows.
        share = self.cycle.length / self.footfalls.cycle if self.footfalls.cycle and self.cycle else 1.0
        return Annotations(
            kind=self.kind,
            cycle=self.is_loop,
            strikes=tuple(Strike(foot, float(self.frames(row * share))) for foot, row in self.footfalls.strikes),
            speed=self.speed,
            turn_rate=self.judged.turn_rate,
            direction=self.direction,
            phase=self.phase,
            strokes=times,
            side=self.judged.side if self.kind == GESTURE else "",
            parts=self.judged.parts,
            parameters=self.parameters,
        )


def find(character: Character, pose: Pose, seconds_per_frame: float, settings: FootfallSettings = DEFAULT) -> Found:
    """Return what can be found of a motion.

    Args:
        character: Who moves.
        pose: Armature space, shape (frame, bone, ...).
        seconds_per_frame: Time between frames [s].
        settings: When a foot counts as standing.
    """
    seen = Seen.of(character, pose, seconds_per_frame)
    model = CharacterModel(character, seen.root)
    closed = cycles.closing(seen)
    rounds = min(round(closed.length), len(seen)) if closed is not None else 0
    judged = Judged(model, Footfalls(seen, settings, rounds))
    if judged.kind not in (*GOING, TURN, IDLE) and closed is not None and cycles.rests_at_ends(seen):
        # It comes back to where it began and rests there: that may be repeated, but it is no cycle.
        closed, judged = None, Judged(model, Footfalls(seen, settings))
    if judged.kind == JUMP and closed is not None and judged.footfalls.stands[0].all():
        closed, judged = None, Judged(model, Footfalls(seen, settings))
    return Found(judged, closed or (cycles.find(seen) if judged.kind in (*GOING, TURN) else None))


def annotate(
    character: Character, pose: Pose, seconds_per_frame: float, kind: str = "", style: str = ""
) -> Annotations:
    """Return the annotations of a motion.

    Args:
        character: Who moves.
        pose: Armature space, shape (frame, bone, ...).
        seconds_per_frame: Time between frames [s].
        kind: What it is an example of, where somebody knows better.
        style: How it is done; nobody finds that.
    """
    found = find(character, pose, seconds_per_frame).annotations
    return replace(found, kind=kind or found.kind, style=style)
