"""What a walk comes to: rebuilt from the keys of bones alone, and measured on the soles of the feet."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from morph_retarget.core import play, quat
from morph_retarget.core.arrays import Array, Flags, Indices
from morph_retarget.core.layering import Layer
from morph_retarget.core.locomotion import getting_about
from morph_retarget.core.locomotion.course import Course
from morph_retarget.core.locomotion.moving import UP
from morph_retarget.core.locomotion.patterns import styles
from morph_retarget.core.locomotion.patterns.pattern import pattern
from morph_retarget.core.locomotion.settings import GaitSettings
from morph_retarget.core.locomotion.stepping import feet, gait
from morph_retarget.core.locomotion.stepping.gait import Gait
from morph_retarget.core.locomotion.stepping.legs import Leg
from morph_retarget.core.morph.bind import GeneralizedAction, bind
from morph_retarget.core.morph.channels import Values
from morph_retarget.core.play import Played
from morph_retarget.core.skeleton import Pose
from morph_retarget.core.solve.settings import DEFAULT as SOLVER
from morph_retarget.core.verdicts.played import rebuilt
from tests.gait_courses import Trial
from tests.goal_sets import Subject

FPS = 24.0
CYCLES, SAMPLES = 2, 200
"""Steps are measured over so many cycles, and at so many times in each."""
AT_REST = 0.05
"""What moves slower than this is at rest [leg lengths a cycle]."""
ON_GROUND = 5e-3
"""What is no higher than this touches the ground [leg lengths]."""
ROLLS = np.radians(0.01)
"""A foot that is turned less than this lies flat."""
STRAIGHT = np.radians(8.0)
"""A joint that is bent less than this bends to no side."""
DEFAULT = GaitSettings()


@dataclass(frozen=True, eq=False)
class Walked:
    """A character that walks, over some frames."""

    subject: Subject
    gait: Gait
    trial: Trial
    times: Array
    """[s], shape (frame,)."""
    played: Played
    """What an action without channels over the gait makes."""

    @cached_property
    def pose(self) -> Pose:
        """All bones in armature space, by forward kinematics from the keys alone."""
        return rebuilt(self.subject.character, self.played)

    @cached_property
    def places(self) -> Array:
        """Of all bones [m], ground frame, shape (frame, bone, 3)."""
        return self.subject.character.local_to_character.points(self.pose.positions)

    @property
    def turns(self) -> Array:
        """Of all bodies from rest, ground frame, shape (frame, bone, 4)."""
        return self.played.pose.turns

    @property
    def lengths(self) -> Array:
        """Of the legs [m], shape (leg,)."""
        return np.array([leg.length for leg in self.gait.legs.legs])

    @cached_property
    def soles(self) -> Array:
        """Heels and tips of the feet [m], ground frame, shape (frame, leg, 2, 3)."""
        legs = self.gait.legs.legs
        return np.stack([np.stack([self._point(leg, p) for p in (leg.heel, leg.tip)], axis=1) for leg in legs], axis=1)

    def _point(self, leg: Leg, away: Array) -> Array:
        """Return where a point of a foot is [m], ground frame, shape (frame, 3)."""
        place = self.subject.character.local_to_character
        rest = self.subject.character.skeleton.rest_rotations[leg.foot]
        own = quat.rotate(quat.conjugate(rest), away @ place.rotation / place.scale)
        moved = self.pose.positions[:, leg.foot] + quat.rotate(self.pose.rotations[:, leg.foot], own)
        return place.points(moved)

    @cached_property
    def floors(self) -> Array:
        """Height of the ground under heels and tips [m], shape (frame, leg, 2)."""
        ground = self.trial.ground
        if ground is None:
            return np.zeros(self.soles.shape[:-1])
        return ground(self.soles.reshape(-1, 3)).reshape(self.soles.shape[:-1])


def walk(
    subject: Subject,
    trial: Trial | Course,
    settings: GaitSettings = DEFAULT,
    times: Array | None = None,
    made: Gait | None = None,
) -> Walked:
    """Return a walk; the times are those of all frames at `FPS` unless given.

    Args:
        subject: Who walks.
        trial: The way, or a course on flat ground.
        settings: Of the gait.
        times: At which it is looked at [s], shape (frame,).
        made: Its gait, where that is there already.
    """
    trial = trial if isinstance(trial, Trial) else Trial(trial, steady=False)
    made = made or prepared(subject, trial, settings)
    chosen = frames_of(trial.course) if times is None else times
    return Walked(subject, made, trial, chosen, _played(subject, made, trial.course, chosen))


def frames_of(course: Course) -> Array:
    """Return the times of all frames of a course [s], shape (frame,)."""
    first, last = course.times[[0, -1]]
    return first + np.arange(int((last - first) * FPS) + 1) / FPS


def prepared(subject: Subject, trial: Trial, settings: GaitSettings = DEFAULT) -> Gait:
    """Return the gait of a character over a course."""
    return gait.prepare(subject.character, play.root_of(subject.bodies), trial.course, settings, trial.ground)


def _played(subject: Subject, made: Gait, course: Course, times: Array) -> Played:
    binding = bind(GeneralizedAction("Nothing", ()), subject.bodies)
    part = play.prepare(subject.character, binding, getting_about.tuned(SOLVER, made), lower=made.wanted)
    places, headings = course.at(times)
    layer = Layer(made.evaluate(times), places, quat.from_axis_angle(UP, headings))
    count = len(times)
    nothing = Values(np.empty((count, 0, 3)), np.empty((count, 0, 4)), np.empty((count, 0)))
    return play.evaluate(part, nothing, {}, layer)


# --- stances as they were planned ---


def slips(walked: Walked) -> Array:
    """Return how far what stands of each foot moves in a stance, at most [leg lengths], shape (leg,).

    That is the heel while the foot rolls onto its sole, all of the sole while it lies, and the tip while it rolls off.
    """
    standing, cycles = walked.gait.contacts(walked.times), walked.gait.steps.contacts.cycles(walked.times)
    pitch = feet.at(walked.gait.steps, walked.times).pitch
    out = np.zeros(len(walked.lengths))
    for leg in range(len(out)):
        for cycle in np.unique(cycles[standing[:, leg], leg]):
            own = standing[:, leg] & (cycles[:, leg] == cycle)
            for point, stands in enumerate((pitch[:, leg] < ROLLS, pitch[:, leg] > -ROLLS)):
                held = walked.soles[own & stands, leg, point]
                if len(held):
                    out[leg] = max(out[leg], float(quat.length(held - held[0]).max()))
    return out / walked.lengths


def gaps(walked: Walked) -> Array:
    """Return how far the lowest point of each standing sole is off the ground, at most [leg lengths], shape (leg,)."""
    above = (walked.soles[..., 2] - walked.floors).min(axis=-1)
    return np.abs(np.where(walked.gait.contacts(walked.times), above, 0.0)).max(axis=0) / walked.lengths


def sinks(walked: Walked) -> Array:
    """Return how deep each sole gets below the ground in flight, at most [leg lengths], shape (leg,)."""
    below = (walked.floors - walked.soles[..., 2]).max(axis=-1)
    return np.where(walked.gait.contacts(walked.times), 0.0, np.maximum(below, 0.0)).max(axis=0) / walked.lengths


# --- steps as they came out ---


@dataclass(frozen=True, eq=False)
class Steps:
    """When the feet of one group stand, as seen on their soles over whole cycles."""

    duty: Array
    """Share of the time for which each stands, shape (foot,)."""
    triggers: Array
    """When each touches down after the first one, in cycles, in [0, 1), shape (foot,); NaN for one that never does."""


def steady_times(made: Gait, group: int) -> Array:
    """Return the times at which steps of a group are measured, in the middle of the course [s], shape (frame,)."""
    pace = made.paces[group]
    middle = 0.5 * (made.course.times[0] + made.course.times[-1])
    cycle = 1.0 / float(np.interp(middle, pace.times, pace.frequency))
    return middle + cycle * np.linspace(-0.5 * CYCLES, 0.5 * CYCLES, CYCLES * SAMPLES + 1)


def resting(walked: Walked) -> Flags:
    """Return whether some point of each sole is at rest on the ground between frames, shape (frame - 1, leg)."""
    pace = walked.gait.paces[0]
    cycles = np.diff(walked.times) * np.interp(walked.times[1:], pace.times, pace.frequency)
    slow = AT_REST * cycles[:, None] * walked.lengths
    moved = quat.length(np.diff(walked.soles, axis=0))
    high = (walked.soles[..., 2] - walked.floors)[1:] / walked.lengths[:, None]
    out: Flags = np.any((moved < slow[..., None]) & (np.abs(high) < ON_GROUND), axis=-1)
    # One step of the solver or two, as one way to stretch a limb gives way to another, are no flight.
    near = out.copy()
    near[1:] |= out[:-1]
    near[:-1] |= out[1:]
    out[1:-1] |= near[1:-1] & near[:-2] & near[2:]
    return out


def steps_of(walked: Walked, group: int) -> Steps:
    """Return the steps of a group, seen at `steady_times`."""
    order = list(walked.gait.legs.groups[group].legs)
    stands = resting(walked)[:, order]
    landed: list[float] = []
    for foot in range(len(order)):
        touches = np.flatnonzero(stands[1:, foot] & ~stands[:-1, foot]) / SAMPLES
        angle = np.angle(np.exp(2j * np.pi * touches).mean()) if len(touches) else np.nan
        landed.append(float(angle / (2.0 * np.pi)))
    return Steps(stands.mean(axis=0), (np.array(landed) - landed[0]) % 1.0)


def wanted_steps(walked: Walked, group: int, settings: GaitSettings = DEFAULT) -> Steps:
    """Return what the styles want of a group at its speed in the middle of the course."""
    made, own = walked.gait, walked.gait.paces[group]
    layers = styles.named(settings.of_group.get(group, settings.styles))
    speed = np.interp([walked.times[len(walked.times) // 2]], own.times, own.speeds)
    wanted = pattern(layers, made.legs.sides(made.legs.groups[group]), speed)
    return Steps(wanted.duty[0], (wanted.triggers[0] - wanted.triggers[0, 0]) % 1.0)


def apart(a: Array, b: Array) -> Array:
    """Return how far phases are apart, round the cycle; a step that never comes is half a cycle off."""
    return np.nan_to_num(np.abs((a - b + 0.5) % 1.0 - 0.5), nan=0.5)


# --- poses ---


def jumps(walked: Walked) -> Array:
    """Return how far each body turns from each frame to the next [deg], shape (frame - 1, body)."""
    return np.degrees(quat.angle_between(walked.turns[1:], walked.turns[:-1]))


def flips(walked: Walked) -> Indices:
    """Return in how many frames the knee of each leg is bent to the other side than at rest, shape (leg,).

    A leg is first turned, by the shortest way, as the line from its hip to its foot is; the knee is the joint of it
    that is furthest from that line at rest. A straight leg has no side, that of a humanoid bends forward.
    """
    out = np.zeros(len(walked.gait.legs.legs), dtype=np.intp)
    rest = walked.subject.bodies.positions
    for i, leg in enumerate(walked.gait.legs.legs):
        if len(leg.path) < 3:
            continue
        path = list(leg.path)
        line = rest[path[-1]] - rest[path[0]]
        away = _off_line(rest[path][None])[0]
        knee = int(np.argmax(quat.length(away)))
        side = away[knee]
        if walked.subject.character.humanoid:
            side = np.array([0.0, -1.0, 0.0])
        elif float(quat.length(side)) < STRAIGHT * 0.25 * leg.length:
            continue
        carried = walked.turns[:, leg.carrier] if leg.carrier >= 0 else walked.turns[:, walked.played.root]
        now = walked.places[:, path]
        turned = quat.between(quat.rotate(carried, line), now[:, -1] - now[:, 0])
        wanted = quat.rotate(quat.multiply(turned, carried), side)
        bent = _off_line(now)[:, knee]
        counts = quat.length(bent) > STRAIGHT * 0.25 * leg.length
        out[i] = int((counts & ((bent * wanted).sum(axis=-1) < 0.0)).sum())
    return out


def _off_line(places: Array) -> Array:
    """Return how far joints of a chain are off the line from its first to its last, (frame, joint, 3)."""
    along = quat.unit(places[:, -1] - places[:, 0])[:, None]
    away = places - places[:, :1]
    return away - (away * along).sum(axis=-1, keepdims=True) * along
