"""Rests that stand as people do: fighting, crouching, leaning. Joints of a figure turn, and the pose becomes the rest.

Turns are rotation vectors in the figure's world [deg]: it looks along -Y, so that a negative turn about X swings a leg
forward, and one about Z, of the left leg, turns its foot out.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.skeleton import Skeleton
from tests.skeletons import skeleton_of
from tools.figure import Bone

Turn = tuple[float, float, float]


def _both(**turns: Turn) -> dict[str, Turn]:
    """Return turns of left joints, and their mirror images of right ones."""
    left = {f"left{joint}": turn for joint, turn in turns.items()}
    return left | {f"right{joint}": (x, -y, -z) for joint, (x, y, z) in turns.items()}


STANCES: Mapping[str, Mapping[str, Turn]] = {
    "fighting": {
        "hips": (0, 0, 30),
        "spine": (15, 0, 0),
        "leftUpperLeg": (-35, -20, 20),
        "leftLowerLeg": (45, 0, 0),
        "leftFoot": (-10, 0, 0),
        "rightUpperLeg": (5, 25, -45),
        "rightLowerLeg": (40, 0, 0),
        "rightFoot": (-35, 0, 0),
        "leftUpperArm": (-40, 50, 0),
        "leftLowerArm": (-90, 0, 0),
        "rightUpperArm": (-20, -60, 0),
        "rightLowerArm": (-110, 0, 0),
    },
    "wide": _both(UpperLeg=(0, -30, 30), Foot=(0, 20, 0)),
    "turned out": _both(UpperLeg=(0, 0, 40)),
    "crouching": {
        "hips": (20, 0, 0),
        "spine": (25, 0, 0),
        "head": (-30, 0, 0),
        **_both(UpperLeg=(-120, 0, 0), LowerLeg=(120, 0, 0), Foot=(-20, 0, 0)),
    },
    "bent forward": {"spine": (45, 0, 0)},
    "leaning": {
        "hips": (45, 0, 0),
        **_both(UpperLeg=(-75, 0, 0), LowerLeg=(60, 0, 0), Foot=(-30, 0, 0), UpperArm=(0, 60, 0)),
    },
    "on its heels": {
        "hips": (45, 0, 0),
        "spine": (15, 0, 0),
        **_both(UpperLeg=(-140, 0, 0), LowerLeg=(140, 0, 0), Foot=(-45, 0, 0)),
        **_both(UpperArm=(0, 70, 0), LowerArm=(-40, 0, 0)),
    },
    "kneeling": {"leftUpperLeg": (-90, 0, 0), "leftLowerLeg": (90, 0, 0), "rightLowerLeg": (90, 0, 0)},
    "sitting": _both(UpperLeg=(-90, 0, 0), LowerLeg=(90, 0, 0)),
}


def stand(
    bones: Sequence[Bone],
    stance: str,
    names: Callable[[str], str],
    facing: float = 0.0,
    unrest: np.random.Generator | None = None,
) -> Skeleton:
    """Return a figure as a skeleton whose rest is a stance.

    Args:
        bones: The figure.
        stance: One of `STANCES`.
        names: Joint to bone name, those of the figure.
        facing: Turn of the whole about the vertical [deg].
        unrest: Where given, turns are up to 30 % smaller or 15 % larger, and each about 6° off.
    """
    skeleton = skeleton_of(bones)
    turns: dict[int, Array] = {}
    for joint, turn in STANCES[stance].items():
        if names(joint) in skeleton.index:
            own = np.array(turn, dtype=np.float64)
            if unrest is not None:
                own = own * unrest.uniform(0.7, 1.15) + unrest.normal(0.0, 6.0, 3)
            turns[skeleton.index[names(joint)]] = own
    return _grounded(turned(skeleton, turns, facing), skeleton)


def _grounded(stood: Skeleton, before: Skeleton) -> Skeleton:
    """Return a stance that is moved down until its lowest joint is as high as before; a bone on the ground stays."""
    body = before.rest_positions[:, 2] > 0.0
    lowest, wanted = (own.rest_positions[body, 2].min() for own in (stood, before))
    down = np.where(body, lowest - wanted, 0.0)[:, None] * np.array([0.0, 0.0, 1.0])
    return replace(stood, rest_positions=stood.rest_positions - down, rest_tails=stood.rest_tails - down)


def turned(skeleton: Skeleton, turns: Mapping[int, Array], facing: float = 0.0) -> Skeleton:
    """Return a skeleton whose rest is another pose of it.

    Args:
        skeleton: At rest.
        turns: Bone to its turn, armature space [deg]; what hangs on it goes along.
        facing: Turn of the whole about the vertical [deg].
    """
    whole = quat.from_rotation_vector(np.array([0.0, 0.0, np.radians(facing)]))
    total = np.tile(whole, (len(skeleton), 1))
    heads = quat.rotate(whole, skeleton.rest_positions)
    for bone, parent in enumerate(skeleton.parents):
        if parent >= 0:
            total[bone] = total[parent]
            heads[bone] = heads[parent] + quat.rotate(
                total[parent], skeleton.rest_positions[bone] - skeleton.rest_positions[parent]
            )
        if bone in turns:
            total[bone] = quat.multiply(total[bone], quat.from_rotation_vector(np.radians(turns[bone])))
    tails: Array = heads + quat.rotate(total, skeleton.rest_tails - skeleton.rest_positions)
    rotations = quat.multiply(total, skeleton.rest_rotations)
    return replace(skeleton, rest_positions=heads, rest_rotations=rotations, rest_tails=tails)
