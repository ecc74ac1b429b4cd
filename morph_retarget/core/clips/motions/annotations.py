"""Annotations: what is known of a base motion beside its frames (Grünvogel 2003 §5.4).

The paper leaves the purposes and types of annotations to each motion model; here they are one typed record that all
models share. Frames count from the clip's first, `character_model.RATE` of them in a second, and need not be whole.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, field, replace
from enum import StrEnum

from ...errors import MotionError, listed

NO_SIDE = ""
SIDES = (NO_SIDE, "left", "right")
"""Which side of the body a motion is done with; none for one of the whole body."""
TO_THE_LEFT = ("turn", "direction")
"""Parameters that count to the left, and to the right in the mirror."""


class Phase(StrEnum):
    """Which part of a motion a clip shows (§5.5)."""

    START = "start"
    """From standing into the loop."""
    LOOP = "loop"
    STOP = "stop"
    """From the loop back to standing."""
    WHOLE = "whole"
    """All of it."""


@dataclass(frozen=True)
class Strike:
    """A foot that touches down."""

    foot: int
    """Its place in `CharacterModel.feet`."""
    frame: float
    """When it comes to rest, heel or ball, whichever is first."""


@dataclass(frozen=True)
class Strokes:
    """The named times of a gesture [frames]; those of the Behavior Markup Language."""

    ready: float
    """The limbs leave where they rest."""
    stroke_start: float
    """They are where the gesture proper begins."""
    stroke: float
    """Its peak: they are fastest, or at the place that it is about."""
    stroke_end: float
    relax: float
    """They are back."""

    def __post_init__(self) -> None:
        times = astuple(self)
        if not all(math.isfinite(time) for time in times):
            raise MotionError("annotation 'strokes' holds a time that is no number: give five frames")
        if list(times) != sorted(times):
            raise MotionError(
                "annotation 'strokes' is not in order: ready, stroke start, stroke, stroke end and relax follow "
                "one after the other"
            )


@dataclass(frozen=True)
class Annotations:
    """What is known of a base motion."""

    kind: str
    """What it is an example of: "walk", "run", "idle", "wave", …; the name of the motion model that uses it."""
    style: str = ""
    """How it is done: "happy", "sneak", …; empty for the usual way."""
    cycle: bool = False
    """Whether the frame after the last is the first again, so that its length is its period."""
    strikes: tuple[Strike, ...] = ()
    """When feet touch down, in order of time."""
    speed: float = 0.0
    """Mean way of the body over the ground [m/s], without its sign."""
    turn_rate: float = 0.0
    """Mean change of its heading [rad/s], to the left."""
    direction: float = 0.0
    """Where it goes beside its heading [rad], to the left: 0 ahead, pi backward."""
    phase: str = Phase.WHOLE
    """Which part of the motion it is, one of `Phase`."""
    strokes: Strokes | None = None
    """The times of a gesture, None for what is none."""
    side: str = NO_SIDE
    """Which side it is done with, one of `SIDES`."""
    parts: tuple[str, ...] = ()
    """Parts of the body that matter (`CharacterModel.parts`): a motion holds them, and others wait; empty for all."""
    parameters: Mapping[str, float] = field(default_factory=dict[str, float], hash=False)
    """Its place among others of its kind: speed, turn, height, …"""

    def __post_init__(self) -> None:
        if not self.kind.strip():
            raise MotionError("annotation 'kind' is empty: say what the motion is an example of, such as walk")
        if self.phase not in list(Phase):
            raise MotionError(f"annotation 'phase' is {self.phase!r}: choose one of {listed(Phase)}")
        if self.side not in SIDES:
            raise MotionError(f"annotation 'side' is {self.side!r}: choose left or right, or leave it empty")
        numbers = {"speed": self.speed, "turn_rate": self.turn_rate, "direction": self.direction, **self.parameters}
        for name, value in numbers.items():
            if not math.isfinite(value):
                raise MotionError(f"annotation {name!r} is {value}: give a finite number")
        if self.speed < 0.0:
            raise MotionError(f"annotation 'speed' is {self.speed:g}: say by the direction where the body goes")
        for strike in self.strikes:
            if strike.foot < 0 or not math.isfinite(strike.frame):
                raise MotionError(f"annotation 'strikes' holds foot {strike.foot} at {strike.frame}: take it out")
        object.__setattr__(self, "strikes", tuple(sorted(self.strikes, key=lambda own: (own.frame, own.foot))))

    def strikes_of(self, foot: int) -> tuple[float, ...]:
        """Return the frames at which a foot touches down, in order."""
        return tuple(strike.frame for strike in self.strikes if strike.foot == foot)

    def mirrored(self, partners: Sequence[int]) -> "Annotations":
        """Return what is known of the same motion seen in a mirror.

        Args:
            partners: For each foot the place of the one on the other side, or its own.
        """
        return replace(
            self,
            strikes=tuple(replace(strike, foot=partners[strike.foot]) for strike in self.strikes),
            turn_rate=-self.turn_rate,
            direction=-self.direction,
            side=_other(self.side),
            parts=tuple(" ".join(_other(word) for word in part.split(" ")) for part in self.parts),
            parameters={name: -v if name in TO_THE_LEFT else v for name, v in self.parameters.items()},
        )


def _other(word: str) -> str:
    return {"left": "right", "right": "left"}.get(word, word)
