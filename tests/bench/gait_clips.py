"""Walks and runs of real animals, people and animators, beside the gait that a character of the same speed gets.

Clips of games walk on the spot and their feet slide; then it is the height of a foot that tells when it stands, and its
mean way over the ground meanwhile that tells how fast the body goes. In mocap it is where a foot is at rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import bpy
import numpy as np

from morph_retarget.blender import retarget, rig
from morph_retarget.blender.io.load import Request, load
from morph_retarget.blender.retarget import Source
from morph_retarget.blender.rig import armature_of
from morph_retarget.core import quat, smoothing
from morph_retarget.core.arrays import Array, Flags
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.locomotion.stepping import legs
from morph_retarget.core.locomotion.stepping.legs import Legs
from morph_retarget.core.locomotion.stepping.pace import GRAVITY
from tests import gait_courses, gait_measures
from tests.gait_courses import Size, Trial
from tests.goal_sets import Subject
from tests.skeletons import skeleton_of
from tools.figure import humanoid

LOW = 0.04
"""On the spot a foot stands that is no higher than this over its lowest place [leg lengths] …"""
BACKWARD = 0.15
"""… and goes to the rear faster than this share of its own greatest speed."""
SLOW = 0.45
"""Where the body travels, a foot stands that is slower than this share of the body's speed …"""
DOWN = 0.1
"""… and no higher than this over its lowest place: the ground of mocap is not quite level [leg lengths]."""
TRAVELS = 1.0
"""A body that goes further than this does not walk on the spot [hip heights]."""
PHASES = 96
"""Samples of a cycle that is drawn."""
WIDTH = 0.02
"""Ways of feet in mocap are smoothed over this time to either side [s]."""
SHORTEST = 0.4
"""No clip has shorter cycles [s]."""


@dataclass(frozen=True)
class Example:
    """A clip to compare with."""

    title: str
    path: str
    action: str
    metre: float
    """Length of the file's unit [m]."""
    feet: tuple[str, ...] = ()
    """Bones that stand on the ground, where they do not hang on the legs."""


EXAMPLES: Sequence[Example] = (
    Example("human walk, CMU 02_01", "mocap/cmu_02_01_walk.bvh", "cmu", 0.05644),
    Example("human run, CMU 02_03", "mocap/cmu_02_03_run_reallusion.bvh", "cmu", 0.01),
    Example("human run, CMU 09_11", "mocap/cmu_09_11_run.fbx", "09_11", 0.05644),
    Example("fox walk, Mesh2Motion", "rigs/m2m_fox_anim.glb", "Walk", 1.0),
    Example("fox run, Mesh2Motion", "rigs/m2m_fox_anim.glb", "Run", 1.0),
    Example("fox walk, Khronos", "rigs/khronos_fox.glb", "Walk", 0.01),
    Example("fox run, Khronos", "rigs/khronos_fox.glb", "Run", 0.01),
    Example("wolf walk, Quaternius", "rigs/quaternius_wolf.glb", "|Walk", 1.0, ("FF.L", "FF.R", "FFB.L", "FFB.R")),
    Example("wolf gallop, Quaternius", "rigs/quaternius_wolf.glb", "|Gallop", 1.0, ("FF.L", "FF.R", "FFB.L", "FFB.R")),
)


@dataclass(frozen=True, eq=False)
class Walk:
    """How some body walks. Lengths in hip heights, times in sqrt(hip height / gravity)."""

    speed: float
    cycle: float
    duty: Array
    """Of each foot, shape (foot,)."""
    contacts: Flags
    """Over one cycle, shape (`PHASES`, foot)."""
    heights: Array
    """Of the feet's joints over their lowest place, over one cycle, shape (`PHASES`, foot)."""

    @property
    def stride(self) -> float:
        """Way of a cycle."""
        return self.speed * self.cycle

    @property
    def figures(self) -> Array:
        """Stride, frequency and mean duty factor."""
        return np.array([self.stride, 1.0 / self.cycle, self.duty.mean()])


@dataclass(frozen=True, eq=False)
class Pair:
    """A clip and what we make of its speed."""

    example: Example
    names: tuple[str, ...]
    """Of the feet."""
    clip: Walk
    ours: Walk
    warnings: tuple[str, ...]
    """Of our gait."""

    @property
    def ratios(self) -> Array:
        """Our stride, frequency and duty factor over those of the clip."""
        return self.ours.figures / self.clip.figures


def compared(data: Path, example: Example) -> Pair:
    """Return a clip beside our walk of the same body at the same speed, or of a human where its rest is no pose."""
    source = _source(data, example)
    found = legs.find(source.character)
    clip = _Clip(source, found, example).walk()
    names = example.feet or tuple(source.character.skeleton.names[leg.foot] for leg in found.legs)
    body = source.character if source.character.rest_is_pose else analyze(skeleton_of(humanoid()))
    return Pair(example, names, clip, *_ours(body, clip))


def _source(data: Path, example: Example) -> Source:
    armature = max(load(Request(data / example.path)), key=lambda ob: len(armature_of(ob).bones))
    action = next(a for a in bpy.data.actions if example.action in a.name)
    read = retarget.read_source(rig.read(armature), action, action.slots[0], bpy.context.scene)
    return retarget.run(read)


# --- the clip ---


@dataclass(frozen=True, eq=False)
class _Clip:
    source: Source
    legs: Legs
    example: Example

    @property
    def step(self) -> float:
        """Time between two frames [s]."""
        return self.source.clip.seconds_per_frame

    @cached_property
    def height(self) -> float:
        """Of the hips, in units of the file; where the rest is no pose, as the body stands straightest."""
        if self.source.character.rest_is_pose:
            return self.legs.groups[0].height
        hips = self.places[:, self.legs.legs[0].path[0], 2]
        return float((hips - np.min([points[..., 2].min(axis=1) for points in self.soles], axis=0)).max())

    @cached_property
    def places(self) -> Array:
        """Of all bones' joints, in units of the file, shape (frame, bone, 3)."""
        return self.source.character.local_to_character.points(self.source.clip.pose.positions)

    @cached_property
    def root(self) -> Array:
        """Where the body is on the ground, shape (frame, 2)."""
        return self.places[:, self.source.character.spine[0], :2]

    @cached_property
    def travels(self) -> bool:
        """Whether it does not walk on the spot."""
        return float(np.hypot(*(self.root[-1] - self.root[0]))) > TRAVELS * self.height

    @cached_property
    def bones(self) -> list[int]:
        """Of the feet."""
        index = self.source.character.skeleton.index
        return [index[name] for name in self.example.feet] or [leg.foot for leg in self.legs.legs]

    @cached_property
    def soles(self) -> list[Array]:
        """Points of each foot: heel, tip and the ends of its bones, each (frame, point, 3)."""
        character, pose = self.source.character, self.source.clip.pose
        skeleton, place = character.skeleton, character.local_to_character
        out: list[Array] = []
        for i, foot in enumerate(self.bones):
            points = [(bone, skeleton.rest_tails[bone]) for bone in (foot, *skeleton.tree.below(foot))]
            if not self.example.feet and character.rest_is_pose:
                leg = self.legs.legs[i]
                points = points[1:] if len(points) > 1 else points
                rest = skeleton.rest_positions[foot]
                points += [(foot, rest + p @ place.rotation / place.scale) for p in (leg.heel, leg.tip)]
            moved = [
                pose.positions[:, b]
                + quat.rotate(
                    pose.rotations[:, b],
                    quat.rotate(quat.conjugate(skeleton.rest_rotations[b]), p - skeleton.rest_positions[b]),
                )
                for b, p in points
            ]
            out.append(place.points(np.stack(moved, axis=1)))
        return out

    def walk(self) -> Walk:
        """Return how it walks."""
        stands = self._travelling() if self.travels else self._on_the_spot()
        speed = self._speed(stands)
        cycle, first = self._cycle(stands)
        frames = first + np.linspace(0.0, cycle / self.step, PHASES, endpoint=False)
        rows = np.round(frames).astype(np.intp) % len(stands)
        high = self.places[:, self.bones, 2]
        heights = (high - high.min(axis=0))[rows] / self.height
        # A small unit makes a small body: times and speeds are as its own size makes them.
        unit = float(np.sqrt(self.height * self.example.metre / GRAVITY))
        u = speed * unit / self.height
        own = stands[rows]
        return Walk(u, cycle / unit, own.mean(axis=0), own, heights)

    @cached_property
    def backward(self) -> Array:
        """How fast the soles go to the rear, in units of the file a second, shape (frame, foot)."""
        return np.stack([np.gradient(points[..., 1].mean(axis=1), self.step) for points in self.soles], axis=1)

    def _on_the_spot(self) -> Flags:
        """Return when feet are low and go to the rear, shape (frame, foot); the last frame is the first one again."""
        lengths = [leg.length for leg in self.legs.legs]
        low = [
            (p[..., 2] - p[..., 2].min(axis=0)).min(axis=1) < LOW * n for p, n in zip(self.soles, lengths, strict=True)
        ]
        quick = self.backward > BACKWARD * np.percentile(self.backward, 90.0, axis=0)
        return (np.stack(low, axis=1) & quick)[:-1]

    def _travelling(self) -> Flags:
        """Return when feet stand by their speeds, shape (frame, foot)."""
        width = max(1, round(WIDTH / self.step))
        mean = float(np.hypot(*(self.root[-1] - self.root[0]))) / ((len(self.root) - 1) * self.step)
        out: list[Flags] = []
        for points, leg in zip(self.soles, self.legs.legs, strict=True):
            flat = points[..., :2].reshape(len(points), -1)
            ways = [smoothing.moving_average(flat[:, i], width) for i in range(flat.shape[1])]
            smooth = np.stack(ways, axis=1).reshape(len(points), -1, 2)
            moved = quat.length(np.gradient(smooth, axis=0)) / self.step
            low = points[..., 2] - points[..., 2].min(axis=0) < DOWN * leg.length
            out.append(np.any((moved < SLOW * mean) & low, axis=1))
        return np.stack(out, axis=1)

    def _speed(self, stands: Flags) -> float:
        """Return how fast the body goes over the ground, in units of the file a second."""
        if self.travels:
            return float(np.hypot(*(self.root[-1] - self.root[0]))) / ((len(self.root) - 1) * self.step)
        return float(self.backward[: len(stands)][stands].mean())

    def _cycle(self, stands: Flags) -> tuple[float, float]:
        """Return the time of a cycle [s], and a frame at which one begins."""
        if not self.travels:
            return len(stands) * self.step, 0.0
        cycle = self._repeats()
        touches = np.flatnonzero(stands[1:, 0] & ~stands[:-1, 0])
        first = float(touches[0] + 1) if len(touches) else 0.0
        return cycle, min(first, max(len(stands) - 1 - cycle / self.step, 0.0))

    def _repeats(self) -> float:
        """Return after what time the feet are for the first time again where they were beside the body [s]."""
        beside = self.places[:, self.bones] - self.places[:, [self.source.character.spine[0]]]
        most = len(beside) * 3 // 4
        shifts = np.arange(max(round(SHORTEST / self.step), 1), most)
        errors = np.array([quat.length(beside[k:] - beside[:-k]).mean() for k in shifts.tolist()])
        dips = np.flatnonzero((errors[1:-1] < errors[:-2]) & (errors[1:-1] <= errors[2:])) + 1
        deep = [i for i in dips.tolist() if errors[i] < 2.0 * errors[dips].min()]
        return float(shifts[deep[0]]) * self.step


# --- ours ---


def _ours(body: Character, clip: Walk) -> tuple[Walk, tuple[str, ...]]:
    """Return our walk of a body at the speed of a clip, as its soles and bones come out, and what is told of it."""
    found = legs.find(body)
    subject, size = Subject(body), Size.of(found)
    trial = Trial(gait_courses.straight(size, clip.speed, far=40.0), steady=True)
    made = gait_measures.prepared(subject, trial)
    times = gait_measures.steady_times(made, 0)
    walked = gait_measures.walk(subject, trial, times=times, made=made)
    stands = gait_measures.resting(walked)
    order = list(found.groups[0].legs)
    landed = stands[1:, order[0]] & ~stands[:-1, order[0]]
    often = float(landed.sum()) / float(times[-1] - times[0])
    unit = float(np.sqrt(size.height / GRAVITY))
    rows = np.round(np.linspace(0.0, gait_measures.SAMPLES, PHASES, endpoint=False)).astype(np.intp)
    feet = [leg.foot for leg in found.legs]
    high = walked.places[:, feet, 2]
    heights = (high - high.min(axis=0))[rows] / size.height
    walk = Walk(clip.speed, 1.0 / (often * unit), stands.mean(axis=0), stands[rows], heights)
    return walk, made.warnings
