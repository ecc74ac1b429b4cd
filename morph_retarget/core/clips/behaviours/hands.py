"""What takes hold of things: hands with their palms and fingers, and what creatures have instead.

All places and directions of a hand are those of the rest pose, seen from the hand's joint.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ... import quat
from ...arrays import Array
from ...character.morphology import Capability, Limb, LimbKind
from .actor import Actor

PALM = 0.6
"""Where the middle of a palm is on the way from the hand's joint to its fingers."""
THICK = 0.12
"""How far the skin of a palm is off the line of its bones, as a share of the hand's length."""
LAST = 0.8
"""Length of a last phalanx whose end nobody tells, as a share of the one before it."""
DIGITS = ("Thumb", "Index", "Middle", "Ring", "Little")
SEGMENTS = ("Metacarpal", "Proximal", "Intermediate", "Distal")


@dataclass(frozen=True, eq=False)
class Finger:
    """A finger or toe."""

    bones: tuple[int, ...]
    """From the hand outward."""
    points: Array
    """Of its joints, and of its tip [m], shape (bone + 1, 3)."""
    digit: str
    """"Thumb" … "Little" where it is known, else empty."""

    @property
    def is_thumb(self) -> bool:
        """Whether it meets the others from the other side."""
        return self.digit == "Thumb"

    @property
    def along(self) -> Array:
        """From its first joint to its tip, unit vector, shape (3,)."""
        return quat.unit(self.points[-1] - self.points[0])

    @property
    def length(self) -> float:
        """Of its bones [m]."""
        return float(quat.length(np.diff(self.points, axis=0)).sum())


@dataclass(frozen=True, eq=False)
class Hand:
    """The end of a limb that reaches for things: a hand, the tip of a tentacle, a front foot."""

    body: int
    limb: Limb
    side: int
    """+1 left, -1 right, 0 in the middle."""
    along: Array
    """From the joint to the fingers, unit vector, shape (3,)."""
    palm: Array
    """Where the palm looks, square to that, unit vector, shape (3,)."""
    length: float
    """From the joint to the tip of the longest finger [m]."""
    middle: Array
    """Of the palm, among its bones [m], shape (3,)."""
    fingers: tuple[Finger, ...]

    @property
    def is_arm(self) -> bool:
        """Whether it is the hand of an arm, and not a foot or a tentacle."""
        return self.limb.kind is LimbKind.ARM

    @property
    def is_taking(self) -> bool:
        """Whether it is made to take things, and does not stand on the ground."""
        return self.limb.kind is not LimbKind.LEG

    @property
    def thickness(self) -> float:
        """How far the skin of the palm is off its bones [m]."""
        return THICK * self.length if self.fingers else 0.0

    @cached_property
    def pointer(self) -> Finger | None:
        """The finger to point with: the index, else the first that is no thumb."""
        own = [finger for finger in self.fingers if not finger.is_thumb]
        return next((f for f in own if f.digit == "Index"), own[0] if own else None)


def hands_of(actor: Actor) -> tuple[Hand, ...]:
    """Return what reaches for things: hands and tentacles, else front feet; a mouth is none of them."""
    own = actor.character
    taking = [limb for limb in own.limbs if actor.bodies.has(limb.end, Capability.GRASPER) and _reaches(limb)]
    arms = [limb for limb in taking if limb.kind is not LimbKind.LEG]
    return tuple(_hand(actor, limb) for limb in arms or _front(actor, taking))


def mouth_of(actor: Actor) -> int | None:
    """Return the body that a creature without hands takes things with: its mouth or head; None when it has none."""
    if actor.head is None or actor.character.humanoid:
        return None
    mouths = [b for b in actor.bodies.with_capability(Capability.MOUTH) if actor.tree.is_below(actor.head, b)]
    return min(mouths, key=lambda body: float(actor.rest[body, 1]), default=actor.head)


def _reaches(limb: Limb) -> bool:
    return len(limb.bones) > 1


def _front(actor: Actor, taking: Sequence[Limb]) -> Sequence[Limb]:
    """Return the limbs to reach with where there are no arms: those that grasp, else the front legs."""
    return taking or [leg for leg in actor.character.legs if leg.row == 0 and _reaches(leg)]


def _hand(actor: Actor, limb: Limb) -> Hand:
    joint = actor.rest[limb.end]
    fingers = tuple(_fingers(actor, limb))
    reaching = [finger for finger in fingers if not finger.is_thumb] or list(fingers)
    if reaching:
        bases = np.mean([finger.points[0] for finger in reaching], axis=0)
        length = max(float(np.linalg.norm(finger.points[0])) + finger.length for finger in reaching)
    else:
        bases = _tip_beyond(actor, limb)
        length = float(np.linalg.norm(bases))
    above = joint - actor.rest[limb.bones[-2]]
    along = quat.unit(bases if np.linalg.norm(bases) > 1e-6 * actor.height else above)
    if limb.kind is LimbKind.LEG:  # toes do not close
        fingers = ()
    return Hand(limb.end, limb, limb.side, along, _palm(limb.side, along, fingers), length, PALM * bases, fingers)


def _tip_beyond(actor: Actor, limb: Limb) -> Array:
    """Return where a hand without fingers ends, from its joint [m]; feet are taken by their joints."""
    if limb.kind is not LimbKind.ARM:
        return np.zeros(3)
    place, skeleton = actor.character.local_to_character, actor.character.skeleton
    tail = place.points(skeleton.rest_tails[[limb.end]])[0] - actor.rest[limb.end]
    above = actor.rest[limb.end] - actor.rest[limb.bones[-2]]
    told, most = float(np.linalg.norm(tail)), 0.8 * float(np.linalg.norm(above))
    ahead = quat.dot(tail, above) > 0.5 * told * float(np.linalg.norm(above))
    return tail if 0.1 * most < told < most and ahead else 0.3 * above


def _palm(side: int, along: Array, fingers: Sequence[Finger]) -> Array:
    """Return where a palm looks: across the row of its fingers, else down and to the body."""
    bases = {finger.digit: finger.points[0] for finger in fingers}
    usual = np.array([-0.5 * side, 0.0, -1.0])
    first = next((bases[digit] for digit in ("Index", "Middle", "Ring") if digit in bases), None)
    last = next((bases[digit] for digit in ("Little", "Ring", "Middle") if digit in bases), None)
    across = None
    if first is not None and last is not None and not np.array_equal(first, last):
        across = first - last
    elif "Thumb" in bases and first is not None:
        across = bases["Thumb"] - first
    normal = usual - quat.dot(usual, along) * along
    if across is not None and side:
        told = side * quat.cross(along[None], across[None])[0]
        normal = told if np.linalg.norm(told) > 0.0 else normal
    return quat.unit(normal)


def _fingers(actor: Actor, limb: Limb) -> Iterator[Finger]:
    """Yield the fingers of a hand: those of the joint map, else lines of its digits."""
    own, joint = actor.character, actor.rest[limb.end]
    name = next((n for n, match in own.joints.items() if own.skeleton.index[match.bone] == limb.end), "")
    side = name.removesuffix("Hand")
    found = False
    for digit in DIGITS if name.endswith("Hand") else ():
        bones = [bone for part in SEGMENTS if (bone := own.bone(side + digit + part)) is not None]
        if bones:
            found = True
            yield _finger(actor, bones, joint, digit)
    if not found:
        digits = set(limb.digits)
        for first in (bone for bone in limb.digits if int(actor.tree.parents[bone]) not in digits):
            line = [first]
            while below := [b for b in actor.tree.children[line[-1]] if b in digits]:
                line.append(below[0])
            yield _finger(actor, line, joint, "")


def _finger(actor: Actor, bones: Sequence[int], joint: Array, digit: str) -> Finger:
    points = actor.rest[list(bones)] - joint
    below = actor.tree.children[bones[-1]]
    before = points[-1] - (points[-2] if len(points) > 1 else np.zeros(3))
    if below:
        tip = actor.rest[below[0]] - joint
    else:
        place, skeleton = actor.character.local_to_character, actor.character.skeleton
        tip = place.points(skeleton.rest_tails[[bones[-1]]])[0] - joint
    told = float(np.linalg.norm(tip - points[-1])) / max(float(np.linalg.norm(before)), 1e-9)
    ahead = quat.dot(tip - points[-1], before) > 0.0
    if not (0.3 < told < 1.5 and ahead):
        tip = points[-1] + LAST * before
    return Finger(tuple(bones), np.vstack([points, tip]), digit)
