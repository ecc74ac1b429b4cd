"""Takes: what a character performs and when, before it is posed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .. import quat
from ..arrays import Array
from ..character.character import Character
from ..clips.travel import Travel
from ..layering import Layer
from ..locomotion.course import Course
from ..locomotion.moving import UP, Moving, eased
from ..morph.channels import Values
from ..solve.goals import Goals


@dataclass(frozen=True, eq=False)
class Take:
    """A way of moving, and perhaps an action over it, at some times."""

    name: str
    moving: Moving
    course: Course
    """Of the same."""
    times: Array
    """Of its frames [s], shape (n,). They are shown at `RATE`, however far apart they are here."""
    cycle: bool = False
    """Whether the frame after the last is the first again."""
    leaves: tuple[Moving, float] | None = None
    """Another way of moving along the same course that it still is at its first frame, and for how long it changes over
    from that [s]; None where it is its own from the beginning."""
    values: Values | None = None
    """Of the action's channels at these frames, None without an action."""
    anchored: bool = False
    """Whether the action is meant for the body as it stands, and not for the rest pose: its root keeps lower than at
    rest where a gait lowers it."""

    @property
    def stands(self) -> bool:
        """Whether all its frames are of one and the same time."""
        return bool((self.times == self.times[0]).all())

    @property
    def way(self) -> Travel:
        """Where its course leads."""
        places, headings = self.course.at(self.times)
        return Travel(places[:, :2], headings)


def layer_of(character: Character, takes: Sequence[Take]) -> Layer:
    """Return what takes ask of the body, one after the other, as the layer that actions are laid over."""
    return layer_of_all([_layer(character, take) for take in takes])


def layer_of_all(layers: Sequence[Layer]) -> Layer:
    """Return layers of the same bodies, one after the other, as one."""
    goals = [layer.goals for layer in layers]
    return Layer(
        Goals(
            goals[0].bodies,
            np.concatenate([own.positions for own in goals]),
            np.concatenate([own.turns for own in goals]),
            np.concatenate([own.position_influence for own in goals]),
            np.concatenate([own.rotation_influence for own in goals]),
        ),
        np.concatenate([layer.places for layer in layers]),
        np.concatenate([layer.turns for layer in layers]),
    )


def values_of(takes: Sequence[Take], channels: int) -> Values:
    """Return the values of an action's channels in takes, one after the other; none count where a take has none."""
    found: list[Values] = []
    for take in takes:
        count = len(take.times)
        nothing = Values(np.zeros((count, channels, 3)), quat.identity(count, channels), np.zeros((count, channels)))
        found.append(take.values or nothing)
    return Values(
        np.concatenate([own.positions for own in found]),
        np.concatenate([own.rotations for own in found]),
        np.concatenate([own.weights for own in found]),
    )


def _layer(character: Character, take: Take) -> Layer:
    if take.stands and len(take.times) > 1:
        once = _layer(character, replace(take, times=take.times[:1]))
        return layer_of_all([once] * len(take.times))
    places, headings = take.course.at(take.times)
    goals = take.moving.evaluate(take.times)
    if take.leaves is not None:
        before, lasts = take.leaves
        goals = _changing(before.evaluate(take.times), goals, eased((take.times - take.times[0]) / lasts))
    turned = quat.from_axis_angle(UP, headings)
    if take.anchored:
        root = int(goals.bodies[0])
        rest = character.local_to_character.points(character.skeleton.rest_positions[root])
        places = goals.positions[:, 0] - quat.rotate(turned, np.broadcast_to(rest, places.shape))
    return Layer(goals, places, turned)


def _changing(first: Goals, second: Goals, share: Array) -> Goals:
    """Return goals that go over from the first to the second, which count alike; share has the shape (frame,)."""
    return replace(
        second,
        positions=first.positions + share[:, None, None] * (second.positions - first.positions),
        turns=quat.slerp(first.turns, second.turns, share[:, None]),
    )
