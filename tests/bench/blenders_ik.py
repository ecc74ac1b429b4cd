"""Blender's own inverse kinematics on the characters and goals that the pose step is measured with.

Each character is built as an armature of a human's size. Its root follows its goal; the bones that lead to each other
goal, as long as those of its limb, trunk or tail, have one IK constraint; and what has a goal is turned as it wants.
Settings are Blender's defaults, but iTaSC is asked for a tenth of a millimetre: its default is half a centimetre.
"""

import statistics
from dataclasses import dataclass
from types import TracebackType
from typing import Self

import bpy
import numpy as np
from mathutils import Quaternion, Vector

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.solve.goals import Goals
from tests.goal_sets import HUMAN, Subject
from tools import armatures
from tools.figure import Bone

from .figures import seconds

SOLVERS = {"LEGACY": "standard", "ITASC": "iTaSC"}
PRECISION = 1e-4
"""What iTaSC is asked for [m]."""
SHORTEST = 1e-3
"""Blender drops bones without a length, so none is shorter than this [m]."""


@dataclass(frozen=True, eq=False)
class Solved:
    """Poses that Blender found, character frame."""

    places: Array
    """[m], shape (frame, body, 3)."""
    turns: Array
    """From rest, shape (frame, body, 4)."""
    seconds: float
    """Median time that the IK constraints took a frame, beyond that of the same scene without them."""


class Rival:
    """A character as an armature with IK constraints, in a scene of its own."""

    def __init__(self, subject: Subject) -> None:
        """Build the armature, its targets and its constraints."""
        bpy.ops.wm.read_homefile(use_empty=True)
        self.subject = subject
        self.chains = _chains(subject)
        self.armature = armatures.build("Rival", _bones(subject, self.chains))
        bones = self.armature.data.bones
        self._names = [f"b{body}" for body in range(len(subject.bodies))]
        self._rest = {name: bones[name].matrix_local.to_quaternion() for name in self._names}
        places = {name: i for i, name in enumerate(bones.keys())}
        self._order = [places[name] for name in self._names]
        self._targets = {int(goal): self._target(f"b{goal}") for goal in subject.goals}
        self._constraints = [self._reach(goal, chain) for goal, chain in self.chains.items()]
        bpy.context.view_layer.update()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type | None, error: BaseException | None, trace: TracebackType | None) -> None:
        bpy.ops.wm.read_homefile(use_empty=True)

    def _target(self, bone: str) -> bpy.types.Object:
        target = bpy.data.objects.new(bone, None)
        target.rotation_mode = "QUATERNION"
        bpy.context.scene.collection.objects.link(target)
        whole = bone == f"b{self.subject.root}"
        follow = self.armature.pose.bones[bone].constraints.new("COPY_TRANSFORMS" if whole else "COPY_ROTATION")
        follow.target = target
        return target

    def _reach(self, goal: int, chain: list[int]) -> bpy.types.Constraint:
        reach = self.armature.pose.bones[f"b{chain[-1]}"].constraints.new("IK")
        reach.target, reach.chain_count = self._targets[goal], len(chain)
        return reach

    def solve(self, solver: str, goals: Goals) -> Solved:
        """Return the poses of one of `SOLVERS`, each found by itself."""
        pose = self.armature.pose
        pose.ik_solver = solver
        if solver == "ITASC":
            pose.ik_param.precision = PRECISION
        idle, _ = self._shown(goals, mute=True)
        taken, read = self._shown(goals, mute=False)
        matrices = read[:, self._order]
        rest = np.array([self._rest[name] for name in self._names])
        turned = matrices[..., :3] / quat.length(np.swapaxes(matrices[..., :3], -1, -2))[..., None, :]
        turns = quat.multiply(quat.from_matrix(turned), quat.conjugate(rest))
        return Solved(matrices[..., 3] * self.subject.scale, turns, max(taken - idle, 0.0))

    def _shown(self, goals: Goals, mute: bool) -> tuple[float, Array]:
        """Return the median time of a frame with or without constraints [s], and matrices, (frame, bone, 3, 4)."""
        for constraint in self._constraints:
            constraint.mute = mute
        self._show(goals, 0)
        times: list[float] = []
        read: list[Array] = []
        for frame in range(len(goals)):
            times.append(seconds(lambda frame=frame: self._show(goals, frame)))
            read.append(self._read())
        return statistics.median(times), np.array(read)

    def _show(self, goals: Goals, frame: int) -> None:
        for i, body in enumerate(goals.bodies.tolist()):
            target = self._targets[body]
            target.location = Vector(goals.positions[frame, i] / self.subject.scale)
            target.rotation_quaternion = Quaternion(goals.turns[frame, i]) @ self._rest[f"b{body}"]
        bpy.context.view_layer.update()

    def _read(self) -> Array:
        """Return the matrices of all bones, shape (bone, 3, 4)."""
        bones = self.armature.evaluated_get(bpy.context.evaluated_depsgraph_get()).pose.bones
        buffer = np.empty(16 * len(bones), dtype=np.float32)
        bones.foreach_get("matrix", buffer)
        return buffer.reshape(-1, 4, 4).transpose(0, 2, 1)[:, :3].astype(np.float64)


def _chains(subject: Subject) -> dict[int, list[int]]:
    """Return the bones that lead to each goal that can be reached, from the trunk outward."""
    ancestors = subject.bodies.tree.ancestors
    stops = {subject.root, *ancestors[subject.root], *subject.goals.tolist()}
    first = {hinged.limb.end: hinged.first for hinged in subject.limbs}
    out: dict[int, list[int]] = {}
    taken: set[int] = set()
    for goal in sorted(subject.goals.tolist(), key=lambda body: body not in first):
        chain: list[int] = []
        for bone in ancestors[goal]:
            if bone in stops | taken:
                break
            chain.insert(0, bone)
            if bone == first.get(goal):
                break
        if chain and goal != subject.root:
            out[goal] = chain
            taken.update(chain)
    return out


def _bones(subject: Subject, chains: dict[int, list[int]]) -> list[Bone]:
    """Return the bones, scaled to a human's size; those of a chain lead to the next, the last to the goal."""
    bodies, places = subject.bodies, subject.bodies.positions / subject.scale
    leads = {bone: child for child in range(len(bodies)) if (bone := int(bodies.parents[child])) >= 0}
    for goal, chain in chains.items():
        leads.update(zip(chain, [*chain[1:], goal], strict=True))
    out: list[Bone] = []
    for body in range(len(bodies)):
        along = places[leads[body]] - places[body] if body in leads else np.array([0.0, 0.0, 0.02 * HUMAN])
        if np.linalg.norm(along) < SHORTEST:
            along = np.array([0.0, 0.0, SHORTEST])
        parent = int(bodies.parents[body])
        tail = places[body] + along
        out.append(Bone(f"b{body}", f"b{parent}" if parent >= 0 else None, tuple(places[body]), tuple(tail)))
    return out
