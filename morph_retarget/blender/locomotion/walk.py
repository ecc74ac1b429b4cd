"""A character that goes: its gait, and what this asks of the solver at frames of the scene."""

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from ...core import quat
from ...core.arrays import Array
from ...core.character.character import Character
from ...core.directing.director import Directed
from ...core.layering import Layer
from ...core.locomotion import getting_about
from ...core.locomotion.course import Course
from ...core.locomotion.footless.crawling import Movement
from ...core.locomotion.moving import UP, Moving
from ...core.locomotion.settings import GaitSettings
from . import going
from .going import Clock, Going
from .properties import Source

BLOCK = 32
"""Frames that are evaluated at once where they are asked for one by one."""
MOST_BLOCKS = 128


@dataclass(frozen=True, eq=False)
class Walk:
    """How a character goes over the ground."""

    gait: Moving
    course: Course
    clock: Clock
    carried: Array | None = None
    """Leads from the world to the ground frame where the character's object moves, shape (4, 4)."""
    to_character: Array | None = None
    """Leads from the space of its object to the character frame, likewise."""

    @classmethod
    def of(cls, character: Character, root: int, own: Going, settings: GaitSettings, movement: Movement | None) -> Self:
        """Return how a character goes.

        Args:
            character: What it is.
            root: The body that carries all others.
            own: Where it goes.
            settings: In what manner.
            movement: What carries it, as for `getting_about.prepare`.

        Raises:
            MorphError: It cannot go there.
        """
        course = own.course()
        made = getting_about.prepare(character, root, course, settings, movement, own.ground(character.frame.height))
        if own.source is not Source.OWN:
            return cls(made, course, own.clock)
        return cls(made, course, own.clock, own.stands, going.matrix_of(character.local_to_character))

    _blocks: dict[int, Layer] = field(default_factory=dict[int, Layer])
    """What was asked for one by one, in blocks of frames: a block takes hardly longer than a single one."""

    @property
    def is_carried(self) -> bool:
        """Whether the goals depend on where the object is."""
        return self.carried is not None

    def layer(self, frames: Array, weight: Array | float, objects: Array | None = None) -> Layer:
        """Return what a generalized action is laid over, character frame.

        Args:
            frames: Of the scene, shape (frame,).
            weight: How much the gait counts, shape (frame,).
            objects: Where the object is in the world, shape (frame, 4, 4), if the goals depend on it.
        """
        return self._placed(self._on_ground(frames), weight, objects)

    def layer_at(self, frame: float, weight: float, objects: Array | None = None) -> Layer:
        """Return the same for one frame."""
        block, row = divmod(frame, BLOCK)
        if row != int(row):
            return self.layer(np.array([frame]), weight, objects)
        known = self._blocks.get(int(block))
        if known is None:
            if len(self._blocks) >= MOST_BLOCKS:
                del self._blocks[next(iter(self._blocks))]
            known = self._blocks[int(block)] = self._on_ground(np.arange(BLOCK, dtype=np.float64) + block * BLOCK)
        return self._placed(known.at(slice(int(row), int(row) + 1)), weight, objects)

    def _on_ground(self, frames: Array) -> Layer:
        """Return the layer of a gait that counts in full, ground frame."""
        times = self.clock.times(frames)
        places, headings = self.course.at(times)
        places[:, 2] = self.gait.floors(times)
        shown = self.gait.deforms(times) if isinstance(self.gait, Directed) else {}
        return Layer(self.gait.evaluate(times), places, quat.from_axis_angle(UP, headings), shown)

    def _placed(self, own: Layer, weight: Array | float, objects: Array | None) -> Layer:
        """Return a layer of the ground frame as the character sees it, with its weight."""
        goals, places, turns = own.goals, own.places, own.turns
        if self.carried is not None:
            assert objects is not None and self.to_character is not None, "they are known for a moving object"  # noqa: PT018
            carried = self.to_character @ np.linalg.inv(objects) @ self.carried
            turn = quat.from_matrix(carried[:, :3, :3])
            goals = replace(
                goals,
                positions=_moved(carried, goals.positions),
                turns=quat.multiply(np.broadcast_to(turn[:, None], goals.turns.shape), goals.turns),
            )
            places, turns = _moved(carried, places[:, None])[:, 0], quat.multiply(turn, turns)
        share = np.broadcast_to(weight, places.shape[:1])
        goals = replace(
            goals,
            position_influence=goals.position_influence * share[:, None],
            rotation_influence=goals.rotation_influence * share[:, None],
        )
        still = quat.identity(len(turns))
        shown = {key: share * curve for key, curve in own.deforms.items()}
        return Layer(goals, share[:, None] * places, quat.slerp(still, turns, share), shown)


def _moved(matrices: Array, points: Array) -> Array:
    """Return points moved by matrices, shapes (frame, 4, 4) and (frame, n, 3)."""
    return points @ np.swapaxes(matrices[:, :3, :3], -1, -2) + matrices[:, None, :3, 3]
