"""Who does what when: commands to reach, touch, point and grasp, dealt out to the hands of a character."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..commands.command import Value
from ..commands.parameters import Parameter, Parameters
from . import timing
from .behaviour import AIMED, Behaviour, Cue, Scene
from .hands import Hand
from .posture import Posture

_TIMED: Parameters = {
    **AIMED,
    "side": Parameter("", "Which hand, the nearer one by itself", choices=("left", "right")),
    "stroke": Parameter(0.0, "When it arrives after the command, 0 for by itself", "s", 0.0, 60.0),
    "lean": Parameter(True, "Whether the body leans where the arm is too short"),
}
REACH = Behaviour("reach", "Bring the palm of a hand to something", _TIMED)
TOUCH = Behaviour("touch", "Touch something with a finger", _TIMED)
POINT = Behaviour("point", "Point at something", {name: _TIMED[name] for name in ("target", "place", "side", "stroke")})
GRASP = Behaviour(
    "grasp",
    "Take hold of something, and keep it until it is stopped",
    {**_TIMED, "radius": Parameter(0.0, "Of what is grasped, 0 for what its surface says", "m", 0.0, 2.0)},
)
REACHING = (REACH, TOUCH, POINT, GRASP)

QUICK = 0.35
"""No hand arrives in less by itself, and no body leans in less [s]."""


@dataclass(frozen=True, eq=False)
class Step:
    """What one hand, or a mouth, does from some time on."""

    at: float
    """[s]."""
    behaviour: Behaviour | None
    """None where it goes back to what the motion does with it."""
    cue: Cue

    @property
    def values(self) -> Mapping[str, Value]:
        """Parameters; none where it stops."""
        return self.cue.values or {}

    @property
    def stroke(self) -> float:
        """When it arrives, from `at` on, as it was told [s]; 0 for by itself."""
        return 0.0 if self.behaviour is None else self.cue.number("stroke", self.behaviour.parameters)


@dataclass(frozen=True, eq=False)
class Handling:
    """All that one hand does; the mouth where it is None."""

    hand: Hand | None
    steps: tuple[Step, ...]


def dealt(
    scene: Scene,
    posture: Posture,
    hands: Sequence[Hand],
    mouth: int | None,
    cues: Sequence[tuple[Behaviour, Cue]],
) -> tuple[Handling, ...]:
    """Return what each hand does, in the order of time.

    Without being told a side, the hand nearer to the target takes it, and keeps it while its behaviour goes on. Where
    there are no arms the mouth does, unless a side is told.

    Args:
        scene: When, and where the targets are.
        posture: What the motion does.
        hands: That it has.
        mouth: What it takes things with if it has no arms.
        cues: Of all behaviours that reach.
    """
    steps: dict[int, list[Step]] = {}
    busy: dict[int, str] = {}
    for behaviour, cue in sorted(cues, key=lambda own: own[1].at):
        running = [i for i, name in busy.items() if name == behaviour.name]
        if cue.values is None:
            for i in running:
                steps[i].append(Step(cue.at, None, cue))
                del busy[i]
            continue
        chosen = _chosen(scene, posture, hands, mouth, cue, running)
        if chosen is None:
            continue
        for i in running:
            if i != chosen:
                steps[i].append(Step(cue.at, None, cue))
                del busy[i]
        steps.setdefault(chosen, []).append(Step(cue.at, behaviour, cue))
        busy[chosen] = behaviour.name
    return tuple(Handling(None if i == MOUTH else hands[i], tuple(own)) for i, own in steps.items())


MOUTH = -1


def _chosen(
    scene: Scene,
    posture: Posture,
    hands: Sequence[Hand],
    mouth: int | None,
    cue: Cue,
    running: Sequence[int],
) -> int | None:
    """Return the number of the hand for a cue, `MOUTH` for the mouth, None when there is nothing to reach with."""
    assert cue.values is not None, "it starts"
    side = {"left": 1, "right": -1}.get(str(cue.values.get("side", "")), 0)
    able = [i for i, hand in enumerate(hands) if not side or hand.side == side]
    if mouth is not None and not side:
        return MOUTH
    if not able:
        return None
    kept = [i for i in running if i in able]
    if kept:
        return kept[0]
    target = timing.at(scene.times, scene.track(cue.values).at(scene.times), cue.at)
    starts = [timing.at(scene.times, posture.positions[:, hands[i].limb.bones[0]], cue.at) for i in able]
    return able[int(np.argmin([np.linalg.norm(target - start) for start in starts]))]
