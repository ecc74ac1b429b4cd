"""What is known of a body whose bones are called like those of a common family, however its rest is bent.

The analysis weighs names, tree and shape; a rest that leans, lies or is curled up may look like another body than it
is. Twenty names of one family, in the right order in the tree, are no chance: where shape contradicts them, they count.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .. import quat
from ..arrays import Array
from . import families
from .anatomy import Body, Evidence, see
from .families import BODY, TRUNK, Family
from .frame import WORLD_AXES
from .joint_map import Decision, Found
from .joints import PARENTS, SIDES, mirrored
from .names import read_names
from .orientation import BLIND_TRUST, Sight
from .words import Sense

MARGIN = 6.0
"""Log-odds of a joint that the names of a family tell."""
LOPSIDED = 0.05
"""Distance between left limbs and the mirror images of right ones, in heights of the body, from which on a rest is bent
and says nothing of sides."""
LEVEL = 0.3
"""Hips are seen from the side when less than this share of the way between the legs is level."""
_PARTS = tuple(joint.removeprefix("left") for joint in BODY if joint.startswith("left"))


@dataclass(frozen=True)
class NamedBody:
    """A rig that belongs to a family, and whose tree agrees."""

    preset: str
    """Name of the family."""
    bones: Mapping[str, int]
    """Joint to bone."""

    def agrees(self, decision: Decision) -> bool:
        """Return whether a decision has the same bones for arms and legs, whichever side it takes for left.

        Of hips and head some rigs have several bones, each of which may do.
        """
        found = {joint: match.bone for joint, match in decision.joints.items()}
        turned = {mirrored(joint): bone for joint, bone in found.items()}
        sure = [joint for joint in BODY if joint.startswith(SIDES)]
        return any(all(own.get(joint) == self.bones[joint] for joint in sure) for own in (found, turned))

    def is_lopsided(self, body: Body) -> bool:
        """Return whether left and right are far from each other's mirror images, as in a rest that is bent."""
        pairs = [(self.bones["left" + part], self.bones["right" + part]) for part in _PARTS]
        left, right = (body.points[[pair[side] for pair in pairs]] for side in (0, 1))
        apart: Array = np.linalg.norm(left * np.array([-1.0, 1.0, 1.0]) - right, axis=-1)
        return float(apart.mean()) > LOPSIDED

    def left(self, evidence: Evidence, up: Array) -> Array:
        """Return the direction from the right leg to the left, level, unit vector in the world.

        Of the world's own level axes the one that is nearest: a bent rest tells no more.
        """
        legs = [evidence.positions[self.bones[side + "UpperLeg"]] for side in SIDES]
        way = legs[0] - legs[1]
        level = way - (way @ up) * up
        axes = [axis for axis in WORLD_AXES.values() if abs(float(axis @ up)) < 0.5]
        if np.linalg.norm(level) <= LEVEL * np.linalg.norm(way):
            level = WORLD_AXES["+X"]
        nearest = max(axes, key=lambda axis: float(axis @ level))
        return quat.unit(nearest - (nearest @ up) * up)

    def sight(self, evidence: Evidence, up: Array | None, forward: Array | None) -> Sight:
        """Return the body as its names have it, upright in the world.

        Args:
            evidence: The rig.
            up: The axis that the user gave, unit vector in the world, None otherwise.
            forward: The same.
        """
        axis = WORLD_AXES["+Z"] if up is None else up
        left = self.left(evidence, axis) if forward is None else quat.unit(quat.cross(axis, forward))
        joints = {joint: Found(bone, MARGIN, "name") for joint, bone in self.bones.items() if _is_searched(joint)}
        spine = [self.bones[joint] for joint in TRUNK[:-1] if joint in self.bones]
        return Sight(see(evidence, left, axis), Decision(joints, MARGIN * len(joints), 0.0, spine), BLIND_TRUST)


def find(evidence: Evidence) -> NamedBody | None:
    """Return what the names of a rig tell, None where it belongs to no family or its tree says otherwise.

    Families are of people: what has a tail, wings or fins besides, which its family has not, is left to its shape.
    """
    names = evidence.skeleton.names
    for fit in families.fitting(names):
        bones = {joint: evidence.skeleton.index[bone] for joint, bone in fit.joints.items()}
        connected = all(_hangs_together(evidence, bones, joint) for joint in BODY if joint != "hips")
        if connected and not _is_beast(evidence, fit.family):
            return NamedBody(fit.family.name, bones)
    return None


def _is_beast(evidence: Evidence, family: Family) -> bool:
    """Return whether a rig has a tail, wings or fins that its family has not."""
    beasts = (Sense.TAIL, Sense.WING, Sense.FIN)
    found = any(reading.has(*beasts) for reading in evidence.readings)
    return found and not any(reading.has(*beasts) for reading in read_names(family.needs))


def _hangs_together(evidence: Evidence, bones: Mapping[str, int], joint: str) -> bool:
    """Return whether a joint's bone is below that of the next joint of the body above it.

    Where hips have the legs alone, the upper body hangs beside them, on what carries both.
    """
    above = PARENTS[joint]
    while above is not None and above not in BODY:
        above = PARENTS[above]
    assert above is not None, "all joints of the body hang on the hips"
    carrier = int(evidence.tree.parents[bones[above]])
    beside = above == "hips" and carrier >= 0 and evidence.tree.is_below(carrier, bones[joint])
    return beside or evidence.tree.is_below(bones[above], bones[joint])


def _is_searched(joint: str) -> bool:
    """Return whether the search for a whole body settles a joint: face and fingers come after it."""
    limbs = ("Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes")
    return joint in ("hips", *TRUNK, "head") or joint.removeprefix("left").removeprefix("right") in limbs
