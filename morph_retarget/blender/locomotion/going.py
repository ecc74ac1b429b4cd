"""Where a character goes: all that its course depends on, read from settings, curves and objects."""

from dataclasses import dataclass
from functools import cached_property

import bpy
import numpy as np

from ...core.arrays import Array, Indices
from ...core.character.character import Character
from ...core.character.frame import Placement
from ...core.errors import MotionError
from ...core.ground import Ground
from ...core.locomotion import course
from ...core.locomotion.course import Course
from .. import actions, terrain, ways
from ..actions import CurveMap
from ..properties import of_rig
from ..sampling import seconds_per_frame
from . import path
from .path import Line
from .properties import KEYED, MORPHRETARGET_PG_gait, Source

PREFIX = "morph_retarget.gait."
MOVES = ("speed", "turn_rate", "direction")
"""Settings that a course comes from."""


@dataclass(frozen=True)
class Clock:
    """Which frames a course is made for, and when they are."""

    first: float
    """Frame of the scene at which the course begins."""
    last: float
    second: float
    """Frames in a second."""
    start: float = 0.0
    """Frame at which the scene and the action are at the same frame."""
    rate: float = 1.0
    """Frames of the action for each frame of the scene."""

    @classmethod
    def of(
        cls, scene: bpy.types.Scene, found: CurveMap, start: float = 0.0, rate: float = 1.0, least: float = -np.inf
    ) -> "Clock":
        """Return that of a scene: it covers the scene's frames, all keys after its start, and the frame ``least``."""
        keyed = actions.frame_range(found.values())
        last = max(scene.frame_end, least, -np.inf if keyed is None else start + (keyed[1] - start) / rate)
        first = float(scene.frame_start)
        return cls(first, max(float(np.ceil(last)), first + 1.0), 1.0 / seconds_per_frame(scene), start, rate)

    @property
    def frames(self) -> Array:
        """All whole frames of the scene that it covers, shape (n,)."""
        return np.arange(self.first, self.last + 1.0)

    def times(self, frames: Array) -> Array:
        """Return when frames of the scene are [s]."""
        return frames / self.second

    def in_action(self, frames: Array) -> Array:
        """Return the frames of the action at frames of the scene."""
        return self.start + (frames - self.start) * self.rate


@dataclass(frozen=True, eq=False)
class Surface:
    """A mesh to go on."""

    corners: Array
    """[m], world space, shape (corner, 3)."""
    triangles: Indices
    """Places among the corners, shape (triangle, 3)."""

    @cached_property
    def key(self) -> tuple[object, ...]:
        """Equal for the same surface."""
        return self.corners.tobytes(), self.triangles.tobytes()


@dataclass(frozen=True, eq=False)
class Going:
    """What a course comes from."""

    source: Source
    clock: Clock
    frames: Array
    """Of the scene, shape (n,)."""
    moves: Array
    """Speed [m/s], turn rate [rad/s] and direction [rad] at the frames, shape (n, 3)."""
    stands: Array
    """Leads from the ground frame to the world: where the character frame is at the first frame, shape (4, 4)."""
    motion: Array | None = None
    """Where the character frame is in the world at the frames, if the character's own motion counts, (n, 4, 4)."""
    line: Line | None = None
    surface: Surface | None = None

    @property
    def key(self) -> tuple[object, ...]:
        """Equal for what gives the same gait."""
        return (
            self.source,
            self.clock,
            self.moves.tobytes(),
            self.stands.tobytes() if self.line is not None or self.surface is not None else b"",
            b"" if self.motion is None else self.motion.tobytes(),
            None if self.line is None else self.line.key,
            None if self.surface is None else self.surface.key,
        )

    @cached_property
    def from_world(self) -> Array:
        """Leads from the world to the ground frame, shape (4, 4).

        Raises:
            MotionError: The character has no extent.
        """
        try:
            return np.linalg.inv(self.stands).astype(np.float64)
        except np.linalg.LinAlgError:
            raise MotionError("its object, or what that hangs on, has a scale of 0: give it another") from None

    def course(self) -> Course:
        """Return the course.

        Raises:
            MotionError: The path leads nowhere.
        """
        times, speed = self.clock.times(self.frames), self.moves[:, 0]
        if self.motion is not None:
            return course.from_frames(times, self.from_world @ self.motion)
        if self.line is None:
            return course.from_speed(times, speed, self.moves[:, 1], self.moves[:, 2])
        points = _through(self.from_world, self.line.points)
        if self.surface is not None:
            points[:, 2] = 0.0  # the ground says how high it is
        return course.along(points, times, speed, self.line.closed)

    def ground(self, height: float) -> Ground | None:
        """Return how high the ground is, None for a flat one; a character of some height [m] looks for it."""
        if self.surface is None:
            return None
        corners = _through(self.from_world, self.surface.corners)
        return terrain.under(corners, self.surface.triangles, terrain.HIGH * height)


def curve_path(name: str) -> str:
    """Return the data path of a setting, from the armature object."""
    return PREFIX + name


def read(
    ob: bpy.types.Object,
    character: Character,
    found: CurveMap,
    clock: Clock,
    graph: bpy.types.Depsgraph,
    stepped: "Stepped | None" = None,
) -> Going:
    """Return what the course of a character comes from.

    Args:
        ob: The character.
        character: What it is.
        found: Curves that give its settings.
        clock: Which frames are asked for.
        graph: Gives the path and the ground.
        stepped: What was read by stepping through all frames of the clock.

    Raises:
        MotionError: A path or what moves the character is missing, or can be known by stepping alone.
    """
    own = of_rig(ob).gait
    source = Source(own.source)
    keyed = any((curve_path(name), 0) in found for name in MOVES)
    whole = keyed or source is Source.OWN or stepped is not None
    frames = clock.frames if whole else np.array([clock.first, clock.last])
    if stepped is not None:
        moves, motion = stepped.moves, stepped.matrices @ _to_own(character)
    else:
        check_known(ob)
        moves = np.stack([values_over(own, name, found, clock.in_action(frames)) for name in MOVES], axis=-1)
        needed = frames if source is Source.OWN else frames[:1]
        motion = places(ob, needed) @ _to_own(character)
    line = None
    if source is Source.PATH:
        if own.path is None:
            raise MotionError(f"{ob.name!r} goes along a path and has none: choose a curve, or another source")
        line = path.line_of(own.path, graph, _standing_at(own.path, clock.first, graph))
    surface = None
    if own.ground is not None:
        surface = Surface(*terrain.surface_of(own.ground, graph, _standing_at(own.ground, clock.first, graph)))
    carried = motion if source is Source.OWN else None
    return Going(source, clock, frames, moves, motion[0], carried, line, surface)


@dataclass(frozen=True, eq=False)
class Stepped:
    """What only stepping through frames can tell."""

    moves: Array
    """As in `Going`, shape (n, 3)."""
    matrices: Array
    """Of the character's object, shape (n, 4, 4)."""


def values_over(own: MORPHRETARGET_PG_gait, name: str, found: CurveMap, frames: Array) -> Array:
    """Return a setting at frames of the action, shape (frame,), as it is now where nothing animates it."""
    now = float(getattr(own, name))
    sampled = actions.sample_vector(found, curve_path(name), frames, np.array([now]))
    limits: bpy.types.FloatProperty = own.bl_rna.properties[name]  # type: ignore[assignment]
    values = np.full(len(frames), now) if sampled is None else sampled[:, 0]
    return np.clip(values, limits.hard_min, limits.hard_max)  # as Blender keeps it


def check_known(ob: bpy.types.Object) -> None:
    """Raise an error if more than keys moves a character, or its settings, and this counts."""
    reasons = reasons_to_step(ob)
    if reasons:
        raise MotionError(f"{ob.name!r} goes when it is baked: {reasons[0]} cannot be followed live")


def reasons_to_step(ob: bpy.types.Object) -> tuple[str, ...]:
    """Return what only stepping through frames can tell of where a character goes, empty for nothing."""
    own, out = of_rig(ob).gait, list[str]()
    data = ob.animation_data
    if data is not None and any(curve.data_path.removeprefix(PREFIX) in KEYED for curve in data.drivers):
        out.append("drivers of its locomotion")
    if any(path.removeprefix(PREFIX) in KEYED for path in actions.paths_in_strips(ob)):
        out.append("NLA strips")
    placed = own.source == Source.OWN or own.source == Source.PATH or own.ground is not None
    if placed and not ways.readable(ob):
        out.append("what moves its object")
    return tuple(out)


def _to_own(character: Character) -> Array:
    """Return what leads from the character frame to the space of its object, shape (4, 4)."""
    return matrix_of(character.local_to_character.inverse())


def matrix_of(place: Placement) -> Array:
    """Return a placement as a matrix, shape (4, 4)."""
    out = np.eye(4)
    out[:3, :3] = place.scale * place.rotation
    out[:3, 3] = place.translation
    return out


def _standing_at(ob: bpy.types.Object, frame: float, graph: bpy.types.Depsgraph) -> Array:
    """Return where an object is in the world at a frame if keys move it, else where it is, shape (4, 4)."""
    if ways.keyed(ob):
        return ways.world(ob, np.array([frame]))[0]
    return np.array(ob.evaluated_get(graph).matrix_world, dtype=np.float64)


def places(ob: bpy.types.Object, frames: Array) -> Array:
    """Return where an object is in the world, as far as keys tell, shape (frame, 4, 4)."""
    return ways.world(ob, frames)


def _through(matrix: Array, points: Array) -> Array:
    return points @ matrix[:3, :3].T + matrix[:3, 3]
