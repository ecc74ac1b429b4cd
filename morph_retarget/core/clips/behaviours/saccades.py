"""Saccades: the small jumps that eyes make all the time, by the statistics of "Eyes Alive" (Lee, Badler, Badler 2002).

How far eyes jump, where to and when is drawn at random, by a seed, from the moment of the command on; so a character
always does the same. Large jumps take longer: the main sequence.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ... import quat
from ...arrays import Array
from ...locomotion.moving import eased, pointed
from ..commands.parameters import Parameter
from . import timing
from .actor import Actor
from .behaviour import Behaviour, Cue, Scene
from .posture import Posture

SACCADE = Behaviour(
    "saccade",
    "Let the eyes jump about as living eyes do",
    {
        "mood": Parameter("talk", "What the character does meanwhile", choices=("talk", "listen")),
        "amount": Parameter(1.0, "How far they jump, 1 as people's do", "", 0.0, 3.0),
        "seed": Parameter(0.0, "Another number for other jumps", "", 0.0, 1e6),
    },
)
SHORTEST, PER_DEGREE = 0.025, 0.0024
"""Duration of a jump: this and as much for each degree [s] (the paper: 20 to 30 ms, and 2.4 ms a degree)."""
SLOPE, RARE = 6.9, 15.7
"""Size of jumps [deg]: -6.9 ln(P / 15.7) for a share P of 0 to 15 in a hundred."""
MOST = {"talk": 27.5, "listen": 22.7}
"""No jump is larger [deg]."""
WAYS = np.array([15.54, 6.46, 17.69, 7.44, 16.80, 7.89, 20.38, 7.80])
"""How often eyes jump to the left, up to the left, up and so on round [per cent]."""
STAYS = {"talk": ((3.13, 3.16), (0.93, 0.80)), "listen": ((7.92, 1.57), (0.43, 0.24))}
"""Mean and deviation of how long eyes look at the other person, and away [s]."""
AWAY_AGAIN = 0.3
"""How often eyes that look away go on to somewhere else, and not back."""
LEAST = 0.15
"""No look is shorter [s]."""
EYE = np.radians([30.0, 22.0])
"""Eyes do not turn farther by themselves, to the side and up [rad]."""


@dataclass(frozen=True)
class Jump:
    """One jump of the eyes."""

    at: float
    """[s]."""
    lasts: float
    """[s]."""
    start: tuple[float, float]
    """To the left and up against where the character looks [rad] …"""
    end: tuple[float, float]
    """… and afterwards."""

    @property
    def size(self) -> float:
        """[rad]."""
        return float(np.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]))


def perform(actor: Actor, scene: Scene, posture: Posture, cues: Sequence[Cue]) -> Posture:
    """Return a posture whose eyes jump about; one without eyes stays as it is."""
    if not cues or not actor.eyes or actor.head is None:
        return posture
    looks = angles(scene.times, cues)
    if not looks.any():
        return posture
    head = posture.turns[:, actor.head]
    to_head = quat.between(np.array([0.0, -1.0, 0.0]), actor.forward)
    frame = quat.multiply(head, np.broadcast_to(to_head, head.shape))
    turn = quat.multiply(quat.multiply(frame, pointed(looks[:, 0], looks[:, 1])), quat.conjugate(frame))
    return posture.turned(actor.tree, dict.fromkeys(actor.eyes, turn))


def angles(times: Array, cues: Sequence[Cue]) -> Array:
    """Return where eyes look against where the character does, to the left and up [rad], shape (n, 2)."""
    out = np.zeros((len(times), 2))
    for i, cue in enumerate(cues):
        until = cues[i + 1].at if i + 1 < len(cues) else float(times[-1])
        if cue.values is None or until <= cue.at:
            continue
        own = np.zeros_like(out)
        for jump in jumps(cue, until):
            rise = eased((times - jump.at) / jump.lasts)[:, None]
            own = own + rise * (np.array(jump.end) - np.array(jump.start))
        if i + 1 < len(cues):  # the next cue finds the eyes where the character looks
            own = own * (1.0 - timing.risen(times, until, 0.0 if cues[i + 1].sudden else SHORTEST))[:, None]
        out = out + own
    return out


def jumps(cue: Cue, until: float) -> Iterator[Jump]:
    """Yield the jumps from a command on up to some time [s]: away from where the character looks, and back to it."""
    known, mood = SACCADE.parameters, cue.text("mood", SACCADE.parameters)
    amount = cue.number("amount", known)
    rng = np.random.default_rng([int(cue.number("seed", known)), round(1000.0 * abs(cue.at))])
    now, time, away = (0.0, 0.0), cue.at, False
    while True:
        mean, deviation = STAYS[mood][away]
        time += max(float(rng.normal(mean, deviation)), LEAST)
        size = min(-SLOPE * float(np.log(rng.uniform(1e-3, 15.0) / RARE)), MOST[mood])
        way = np.pi / 4.0 * float(rng.choice(8, p=WAYS / WAYS.sum()))
        if time >= until:
            return
        end = (0.0, 0.0)
        if not away or rng.random() < AWAY_AGAIN:
            angle = np.radians(amount * size)
            side, up = now[0] + angle * np.cos(way), now[1] + angle * np.sin(way)
            end = (float(np.clip(side, -EYE[0], EYE[0])), float(np.clip(up, -EYE[1], EYE[1])))
        jump = Jump(time, 0.0, now, end)
        lasts = SHORTEST + PER_DEGREE * float(np.degrees(jump.size))
        yield Jump(time, lasts, now, end)
        time, now, away = time + lasts, end, end != (0.0, 0.0)
