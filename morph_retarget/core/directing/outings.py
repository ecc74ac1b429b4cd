"""Outings: loops, starts and stops of a character's own gaits, or of how it goes without feet (Grünvogel 2003 §5.5).

All phases of one gait are parts of one and the same way to move: a start ends in the pose in which the loop begins, and
a stop begins in it, since there the gait goes steadily and is at the same point of its cycle. Before the start and
after the stop the body stands.
"""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .. import quat
from ..arrays import Array, Flags
from ..clips.character_model import RATE, CharacterModel
from ..clips.motions.annotations import Annotations, Phase, Strike
from ..locomotion.course import Course, from_speed
from ..locomotion.footless.floating import Floating
from ..locomotion.footless.inchworm import Inchworm
from ..locomotion.footless.serpentine import Serpentine
from ..locomotion.moving import UP, Moving, eased
from ..locomotion.settings import GaitSettings
from ..locomotion.stepping.gait import Gait
from .cycles import phase_of, reached, rounds_of
from .performing import moving_on, step_of
from .takes import Take

LEAST_LEAD = 0.05
"""A body begins to slow down no earlier than so much of a cycle after a stop begins."""
NEATLY, ALL = 0.03, 0.45
"""The last feet land within half a cycle and the first of these more after it stands, where there are four at most; of
more feet some have come to stand too early for where it ends, and step once more within the second."""
FEW = 4
OVER = 0.4
"""A stop changes within so much of a cycle from the loop to its own first steps, which are a little shorter already."""
SETTLED = 0.3
"""A start may end so much of a cycle after the body has its speed …"""
MOST_SETTLING = 3
"""… and ends no more than so many cycles later, as soon as it goes steadily …"""
SAME = 1e-3
"""… so that no goal is further from the loop's than this [body heights, radians]."""
SAMPLES = 9
"""Of a ramp."""
LANDING = 1.8
"""All feet have landed so many cycles of the gait's last steps after a body stands."""
LOOKS = 65
"""How often a body is looked at to see when it begins to move or has come to rest."""
STIRS, RESTS = 3e-4, 2e-5
"""It stands before some goal is this far from where it stands, and when all are within this [body heights, radians]."""
LATEST = 3
"""A loop begins in this cycle at the latest."""
GUESS = 6.5
"""How long a course is at first [s for a body 1 m high]; it gets longer where it holds too few cycles."""
ALONG = 1.3
"""What crawls is bent by so much more of its course than it is long, since corners are spread."""
NEAR = 1e-4
"""A foot that touches down so little before the first frame does so in it [frames]."""


@dataclass(frozen=True)
class Manner:
    """How fast, whereto and how an outing goes."""

    kind: str
    """"walk", "run" or "turn"."""
    speed: float
    """[m/s]."""
    turn_rate: float = 0.0
    """To the left [rad/s]."""
    direction: float = 0.0
    """Beside the heading, to the left [rad]."""
    ramp: float = 0.8
    """Within how much of a cycle it comes to its speed, and to a stand."""
    settings: GaitSettings = field(default_factory=GaitSettings)


@dataclass(frozen=True, eq=False)
class Outing:
    """A character that goes in some manner, steadily."""

    model: CharacterModel
    manner: Manner
    moving: Moving
    course: Course
    start: float
    """When a cycle begins [s]."""
    period: float
    """Of the cycle [s]."""

    @classmethod
    def of(cls, model: CharacterModel, manner: Manner) -> "Outing":
        """Return how a character goes.

        Raises:
            RigError: It cannot go.
        """
        lasts = float(GUESS * np.sqrt(model.character.frame.height))
        course, moving = _steady(model, manner, lasts)
        frequency = float(np.diff(phase_of(moving, np.array([0.0, lasts])))[0]) / lasts
        bent = _bent(moving, manner)
        needed = 2.0 * bent + (LATEST + 2.1) / frequency
        if needed > lasts:
            course, moving = _steady(model, manner, needed)
        first = np.ceil(phase_of(moving, np.array([bent]))[0]) + 1.0
        begins = [reached(moving, first + i, bent, bent + (LATEST + 2.0) / frequency) for i in range(LATEST + 1)]
        seen = _seen(model, moving, course, np.array(begins))
        repeats = np.abs(np.diff(seen, axis=0)).max(axis=1) < SAME
        # Where feet had to be set apart, it goes steadily only after some steps.
        place = int(repeats.argmax()) if repeats.any() else LATEST - 1
        return cls(model, manner, moving, course, begins[place], begins[place + 1] - begins[place])

    @cached_property
    def step(self) -> tuple[int, float]:
        """Frames of a cycle, and how far they are apart in it [s]."""
        return step_of(self.period)

    @property
    def pace(self) -> float:
        """By what factor it is shown faster than it goes, since a cycle has whole frames."""
        return RATE * self.step[1]

    def loop(self, name: str) -> Take:
        """Return one cycle."""
        count, step = self.step
        return Take(name, self.moving, self.course, self.start + step * np.arange(float(count)), cycle=True)

    def set_out(self, name: str) -> Take:
        """Return how it gets from standing to where the loop begins."""
        ramp = self.manner.ramp * self.period
        course, moving = self._on_ramp(0.0, ramp, ramp + (MOST_SETTLING + 1.0) * self.period)
        settled = ramp + SETTLED * self.period
        whole = np.ceil(phase_of(moving, np.array([settled]))[0])
        ends = [reached(moving, whole + i, settled, settled + (i + 1.1) * self.period) for i in range(MOST_SETTLING)]
        steady = self._steadily(moving, course, np.array(ends))
        end = ends[int(steady.argmax()) if steady.any() else -1]
        _, step = self.step
        before = self._stirs(moving, course, -ramp, end)
        if isinstance(moving, Floating):
            before = end - self.period * np.ceil((end - before) / self.period)
        count = int(np.ceil((end - before) / step - 1e-6))
        return Take(name, moving, course, end - step * np.arange(count, -1.0, -1.0))

    def come_to_stand(self, name: str, foot_phase: float = 0.0) -> Take:
        """Return how it gets from where the loop is at a phase to standing.

        Args:
            name: Of the take.
            foot_phase: Where the loop is left, 0 … 1.
        """
        first = self.start + foot_phase * self.period
        slows = first + ((self._lead - foot_phase - LEAST_LEAD) % 1.0 + LEAST_LEAD) * self.period
        stands = slows + self.manner.ramp * self.period
        course, moving = self._on_ramp(stands, slows, stands + self.period)
        _, step = self.step
        last = self._rests(moving, course, stands)
        if isinstance(moving, Floating):
            last = first + self.period * np.ceil((last - first) / self.period)
        count = int(np.ceil((last - first) / step - 1e-6)) + 1
        leaves = (self.moving, OVER * self.period)
        return Take(name, moving, course, first + step * np.arange(float(count)), leaves=leaves)

    @cached_property
    def _lead(self) -> float:
        """How long after a cycle's beginning the body slows down [cycles], for what comes then to be short and neat."""
        half = 0.5 * self.manner.ramp
        if not isinstance(self.moving, Gait):
            # It comes to a stand after whole cycles, and so stands as it does before it sets out.
            return -half
        slows = self.start + self.period
        stands = slows + self.manner.ramp * self.period
        _, tried = self._on_ramp(stands, slows, stands + self.period)
        assert isinstance(tried, Gait), "it goes on the same feet"
        more = NEATLY if len(self.model.feet) <= FEW else ALL
        # Feet land one after the other until the cycle waits; at best half a cycle after the body stands.
        first = tried.paces[0]
        idle = int(((first.times > slows) & (first.frequency == first.idle)).argmax())
        spare = (first.phase[-1] - first.phase[idle] - 0.5 - more) % 1.0
        return spare / rounds_of(tried)

    def annotations(self, take: Take, phase: Phase, side: str = "") -> Annotations:
        """Return what is known of a take of it."""
        manner = self.manner
        speed, turn = float(manner.speed * self.pace), float(manner.turn_rate * self.pace)
        cycle = phase is Phase.LOOP
        return Annotations(
            manner.kind,
            cycle=cycle,
            strikes=strikes_of(take, cycle),
            speed=speed,
            turn_rate=turn,
            direction=float(manner.direction),
            phase=phase,
            side=side,
            parts=_carriers(self.model),
            parameters={"speed": speed, "turn": turn, "direction": float(manner.direction)},
        )

    def _on_ramp(self, still: float, full: float, last: float) -> tuple[Course, Moving]:
        """Return a course, and how it is gone, that leads from standing to the full speed or back.

        Args:
            still: Up to when, or from when on, it stands [s].
            full: From when on, or up to when, it has its speed [s].
            last: When the course ends [s].
        """
        share = np.linspace(0.0, 1.0, SAMPLES)
        ramp = np.sort(still + share * (full - still))
        # A course that begins as the steady one does has the same phase up to the ramp.
        begin = 0.0 if still > full else ramp[0] - self.period
        times = np.concatenate([[begin], ramp, [last]])
        speeds = eased((times - still) / (full - still))
        manner = self.manner
        course = from_speed(times, manner.speed * speeds, manner.turn_rate * speeds, manner.direction)
        return course, moving_on(self.model, course, manner.settings)

    def _steadily(self, moving: Moving, course: Course, times: Array) -> Flags:
        """Return at which times [s] the body goes as it does where its loop begins, shape (n,)."""
        loop = _seen(self.model, self.moving, self.course, np.array([self.start]))
        return np.abs(_seen(self.model, moving, course, times) - loop).max(axis=1) < SAME

    def _stirs(self, moving: Moving, course: Course, first: float, last: float) -> float:
        """Return when a body that stands begins to move, between two times [s]."""
        if not isinstance(moving, Gait):
            return 0.0
        times = np.linspace(first, last, LOOKS)
        return float(times[max(int(self._away(moving, course, times, 0, STIRS).argmax()) - 1, 0)])

    def _rests(self, moving: Moving, course: Course, stands: float) -> float:
        """Return when a body whose course stands from ``stands`` on has come to rest [s]."""
        if not isinstance(moving, Gait):
            return stands
        times = np.linspace(stands, stands + LANDING / moving.paces[0].idle, LOOKS)
        away = self._away(moving, course, times, -1, RESTS).nonzero()[0]
        return float(times[min(int(away.max(initial=-1)) + 1, LOOKS - 1)])

    def _away(self, moving: Moving, course: Course, times: Array, still: int, least: float) -> Flags:
        """Return at which times [s] some goal is away from where it is at that of a row, shape (n,)."""
        found = _seen(self.model, moving, course, times)
        return np.abs(found - found[still]).max(axis=1) > least


def strikes_of(take: Take, cycle: bool) -> tuple[Strike, ...]:
    """Return when feet touch down in a take that is all one gait."""
    if not isinstance(take.moving, Gait):
        return ()
    times = take.times
    step = float(times[1] - times[0])
    last = times[-1] + (step if cycle else NEAR * step)
    most = len(times) - (0.0 if cycle else 1.0)
    out: list[Strike] = []
    for foot, row in enumerate(take.moving.steps.contacts.touch):
        own = row[(row > times[0] - NEAR * step) & (row < last - (NEAR * step if cycle else 0.0))]
        out += [Strike(foot, float(np.clip((touch - times[0]) / step, 0.0, most))) for touch in own]
    return tuple(out)


def _steady(model: CharacterModel, manner: Manner, lasts: float) -> tuple[Course, Moving]:
    times = np.array([0.0, lasts])
    course = from_speed(times, np.full(2, manner.speed), np.full(2, manner.turn_rate), manner.direction)
    return course, moving_on(model, course, manner.settings)


def _seen(model: CharacterModel, moving: Moving, course: Course, times: Array) -> Array:
    """Return what a moving body asks for at times [s], as it sees it, shape (frame, n).

    Places are in body heights, and of turns a radian counts as much as one.
    """
    goals, (places, headings) = moving.evaluate(times), course.at(times)
    back = quat.from_axis_angle(UP, -headings)[:, None]
    away = quat.rotate(back, goals.positions - places[:, None])[:, goals.position_influence[0] > 0.0]
    turns = goals.turns[:, goals.rotation_influence[0] > 0.0]
    turned = quat.to_matrix(quat.multiply(np.broadcast_to(back, turns.shape), turns))
    count = len(times)
    return np.concatenate([away.reshape(count, -1) / model.character.frame.height, turned.reshape(count, -1)], axis=1)


def _bent(moving: Moving, manner: Manner) -> float:
    """Return for how long before and after a frame the course of a turning body has to turn likewise [s]."""
    if not isinstance(moving, Serpentine | Inchworm) or manner.turn_rate == 0.0:
        return 0.0
    # On the spot it follows a point ahead of it that goes round.
    return ALONG * moving.track.reach / max(manner.speed, moving.track.lead * abs(manner.turn_rate))


def _carriers(model: CharacterModel) -> tuple[str, ...]:
    return ("legs",) if len(model.feet) else ("trunk",)
