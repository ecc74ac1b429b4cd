"""Which bones of one body follow which bones of another: chains of any two lengths, matched end to end.

A link says that a target bone follows one place on a source chain. Where chains have the same number of bones the
places are the source's own bones; else they lie between two of them, spaced so that both ends agree.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..arrays import Array, Flags, Indices
from ..character.character import Character
from ..character.joints import FINGER_JOINTS, PARENTS, SIDES
from ..character.morphology import Limb, LimbKind
from ..errors import MappingError
from . import further, rests
from .rests import KNEE, UNTURNED, Direction, Turn

NONE = -1

_ARM = ("Shoulder", "UpperArm", "LowerArm", "Hand")
_LEG = ("UpperLeg", "LowerLeg", "Foot", "Toes")
_DIGITS = ("Thumb", "Index", "Middle", "Ring", "Little")
# The knuckle that a hand points to, best first.
_KNUCKLES = ("MiddleProximal", "IndexProximal", "RingProximal", "LittleProximal")


@dataclass(frozen=True)
class LimbLinks:
    """The links of one leg or arm that stands or reaches on both bodies."""

    name: str
    """For people: "Left Foot", "Right Hand", "Left Foot 2"."""
    chain: tuple[int, ...]
    """Links from the hip or shoulder to the foot or hand."""
    ball: int = NONE
    """Link of the toes, NONE without one."""
    pole: Direction = KNEE
    """Where the middle joint points at rest, character frame: knees forward, elbows back."""
    turn: Turn = UNTURNED
    """Of the foot, from the target's rest to how it stands on one who stands as the source rests; see `rests.foot`."""

    @property
    def end(self) -> int:
        """Link of the foot or hand."""
        return self.chain[-1]


@dataclass(frozen=True, eq=False)
class Links:
    """All links between two characters; carriers before what they carry, the hips first."""

    names: tuple[str, ...]
    """Canonical joint, or chain and place ("tail[2]")."""
    target: Indices
    """Target bone of each link, shape (link,)."""
    source: Indices
    """The two source bones between which the link lies, shape (link, 2)."""
    weight: Array
    """Place between the two, 0 at the first, shape (link,)."""
    above: Indices
    """The link before this one in the body, NONE for the hips, shape (link,)."""
    after: Indices
    """The link that ends this one's segment and so gives it a direction, NONE without one, shape (link,)."""
    curved: Flags
    """Whether joints not linked, or only in part, bend the source between a link and its end; shape (link,)."""
    twists: tuple[tuple[int, ...], ...]
    """Further target bones in line up to the next link, which share the link's twist; per link."""
    legs: tuple[LimbLinks, ...]
    arms: tuple[LimbLinks, ...]

    def __len__(self) -> int:
        return len(self.names)

    def index(self, name: str) -> int:
        """Return the link called ``name``, NONE when there is none."""
        return self.names.index(name) if name in self.names else NONE


@dataclass
class _Entry:
    target: int
    source: tuple[int, int]
    weight: float
    above: str | None
    after: str | None = None


class _Builder:
    """Collects entries by name, then resolves names to places."""

    def __init__(self, source: Character, target: Character) -> None:
        self.source = source
        self.target = target
        self.entries: dict[str, _Entry] = {}
        self.legs: list[tuple[str, list[str], str | None]] = []
        self.arms: list[tuple[str, list[str], str | None]] = []

    def joint(self, name: str, above: str | None) -> str | None:
        """Add a canonical joint that both have; return its name, or ``above`` when one lacks it."""
        a, b = self.source.bone(name), self.target.bone(name)
        if a is None or b is None or not self.is_free(b):
            return above
        self.append(name, _Entry(b, (a, a), 0.0, above))
        return name

    def chain(
        self,
        name: str,
        source: Sequence[tuple[float, int]],
        target: Sequence[tuple[float, int]],
        above: str | None,
    ) -> str | None:
        """Add target bones at their places (0 … 1) along the source bones at theirs; return the last one's name."""
        for i, (place, bone) in enumerate(target):
            if not self.is_free(bone):
                continue
            own = f"{name}[{i}]"
            self.append(own, _Entry(bone, *_between(source, place), above))
            above = own
        return above

    def append(self, name: str, entry: _Entry) -> None:
        """Add an entry; the first that hangs on another ends the other's segment."""
        self.entries[name] = entry
        if entry.above is not None and self.entries[entry.above].after is None:
            self.entries[entry.above].after = name

    def is_free(self, bone: int) -> bool:
        """Return whether no link moves a bone of the target yet."""
        return all(entry.target != bone for entry in self.entries.values())

    def points_to(self, name: str, after: str | None) -> None:
        """Say where the segment of ``name`` ends: at ``after``, or nowhere."""
        if name in self.entries:
            self.entries[name].after = after

    def build(self) -> Links:
        """Return all links that were added, names resolved to places."""
        names = tuple(self.entries)
        place = {name: i for i, name in enumerate(names)} | {None: NONE}
        entries = list(self.entries.values())
        return Links(
            names,
            np.array([e.target for e in entries], dtype=np.intp),
            np.array([e.source for e in entries], dtype=np.intp),
            np.array([e.weight for e in entries]),
            np.array([place[e.above] for e in entries], dtype=np.intp),
            np.array([place[e.after] for e in entries], dtype=np.intp),
            np.array([self._is_curved(e) for e in entries], dtype=bool),
            tuple(self._twists(e) for e in entries),
            tuple(
                LimbLinks(
                    n,
                    tuple(place[j] for j in chain),
                    place[ball],
                    rests.knee(self.target, self._bones(chain)),
                    self._turn(chain[-1], ball),
                )
                for n, chain, ball in self.legs
            ),
            tuple(
                LimbLinks(n, tuple(place[j] for j in chain), pole=rests.elbow(self.target, self._bones(chain)))
                for n, chain, _ in self.arms
            ),
        )

    def _bones(self, chain: Sequence[str]) -> list[int]:
        return [self.entries[name].target for name in chain]

    def _turn(self, foot: str, ball: str | None) -> Turn:
        if ball is None or not (self.source.humanoid and self.target.humanoid):
            return UNTURNED
        own = [(entry.target, entry.source[0]) for entry in (self.entries[foot], self.entries[ball])]
        (ankle, their_ankle), (toes, their_toes) = own
        return rests.foot(self.source, self.target, (ankle, toes), (their_ankle, their_toes))

    def _is_curved(self, entry: _Entry) -> bool:
        if entry.after is None:
            return False
        after = self.entries[entry.after]
        between = self.source.skeleton.tree.path(entry.source[0], after.source[0])[1:-1]
        return entry.weight > 0.0 or after.weight > 0.0 or bool(between)

    def _twists(self, entry: _Entry) -> tuple[int, ...]:
        """Return the unlinked target bones in line between a link and the end of its segment."""
        if entry.after is None:
            return ()
        path = self.target.skeleton.tree.path(entry.target, self.entries[entry.after].target)
        return tuple(path[1:-1])


def _between(source: Sequence[tuple[float, int]], place: float) -> tuple[tuple[int, int], float]:
    for (u, a), (v, b) in pairwise(source):
        if place <= v + 1e-9:
            weight = 0.0 if v - u < 1e-9 else (place - u) / (v - u)
            if weight > 1.0 - 1e-9:
                return (b, b), 0.0
            return ((a, a), 0.0) if weight < 1e-9 else ((a, b), weight)
    return (source[-1][1], source[-1][1]), 0.0


def link(source: Character, target: Character, also: further.Also = ()) -> Links:
    """Return how the bones of ``target`` follow those of ``source``.

    Args:
        source: The body that moves.
        target: The body that shall move likewise.
        also: Further bones of the target.

    Raises:
        MappingError: One of the two has no hips, or they share nothing else; or a further bone does not exist, has a
            joint already, or follows a joint that the source does not have.
    """
    for character, role in ((source, "source"), (target, "target")):
        if character.bone("hips") is None:
            raise MappingError(f"the {role} has no bone for the hips: map it by hand")
    builder = _Builder(source, target)
    builder.joint("hips", None)
    chest = _add_trunk(builder)
    _add_limbs(builder, chest)
    _add_tails(builder)
    for joint, bone in also:
        _add_further(builder, joint, bone)
    # The hips carry legs and spine alike: no one segment is theirs.
    builder.points_to("hips", None)
    if len(builder.entries) < 3:
        raise MappingError("source and target share no joints besides the hips: map legs, arms and spine by hand")
    return builder.build()


def _add_trunk(builder: _Builder) -> str:
    """Add spine, neck, head and face; return the link that carries the arms."""
    source, target = builder.source, builder.target
    spine, own = source.spine[1:], target.spine[1:]
    hips = builder.source.bone("hips")
    assert hips is not None, "link() has checked that there are hips"
    along = [(0.0, hips), *((i / len(spine), bone) for i, bone in enumerate(spine, 1))]
    chest = _add_spine(builder, along, own)
    neck, own_neck = source.neck, target.neck
    head, own_head = source.head, target.head
    above: str | None = chest
    if head is not None and own_head is not None:
        base = spine[-1] if spine else hips
        steps = [(0.0, base), *((i / (len(neck) + 1), b) for i, b in enumerate(neck, 1)), (1.0, head)]
        if len(neck) == len(own_neck) == 1:
            above = builder.joint("neck", above) if source.bone("neck") is not None else above
        above = builder.chain("neck", steps, [(i / (len(own_neck) + 1), b) for i, b in enumerate(own_neck, 1)], above)
        builder.append("head", _Entry(own_head, (head, head), 0.0, above))
        for joint in ("jaw", "leftEye", "rightEye"):
            builder.joint(joint, "head")
        builder.points_to("head", None)
    return chest


def _add_spine(builder: _Builder, along: Sequence[tuple[float, int]], own: Sequence[int]) -> str:
    names = {m.bone: j for j, m in builder.target.joints.items() if j in ("spine", "chest", "upperChest")}
    above = "hips"
    for i, bone in enumerate(own, 1):
        if not builder.is_free(bone):
            continue  # the hips of a body in two trees are those of the half with the head
        name = names.get(builder.target.skeleton.names[bone], f"spine[{i}]")
        builder.append(name, _Entry(bone, *_between(along, i / len(own)), above))
        above = name
    return above


def _add_limbs(builder: _Builder, chest: str) -> None:
    source, target = builder.source, builder.target
    if source.humanoid and target.humanoid:
        for side in SIDES:
            _add_jointed(builder, side, _LEG, "hips")
            _add_jointed(builder, side, _ARM, chest)
            _add_fingers(builder, side)
            _note_limbs(builder, side)
        pairs = _pair_limbs(_extra(source), _extra(target))
    else:
        pairs = _pair_limbs(source.limbs, target.limbs)
    for name, a, b in pairs:
        above = "hips" if b.kind is LimbKind.LEG else chest
        builder.chain(name, _spread(a.bones), _spread(b.bones), _carrier(builder, b, above))
        chain = [n for i in range(len(b.bones)) if (n := f"{name}[{i}]") in builder.entries]
        if chain:
            builder.points_to(chain[-1], None)
        if a.kind is b.kind is LimbKind.LEG and len(chain) > 1:
            builder.legs.append((_label(b.side, "Foot", b.row), chain, None))


def _note_limbs(builder: _Builder, side: str) -> None:
    """Note the legs and arms that have all their joints, for constraints."""
    leg = [side + j for j in _LEG[:3]]
    if all(j in builder.entries for j in leg):
        ball = f"{side}Toes" if f"{side}Toes" in builder.entries else None
        builder.legs.append((f"{side.title()} Foot", leg, ball))
    arm = [side + j for j in _ARM if side + j in builder.entries]
    if all(side + j in arm for j in _ARM[1:]):
        builder.arms.append((f"{side.title()} Hand", arm, None))


def _label(side: int, part: str, row: int) -> str:
    name = f"{'Left ' if side > 0 else 'Right ' if side < 0 else ''}{part}"
    return name if row == 0 else f"{name} {row + 1}"


def _extra(character: Character) -> list[Limb]:
    """Return the limbs of a humanoid that are neither its legs nor its first pair of arms."""
    mapped = {character.skeleton.index[m.bone] for j, m in character.joints.items() if "Arm" in j or "Leg" in j}
    return [limb for limb in character.limbs if not mapped & set(limb.bones)]


def _carrier(builder: _Builder, limb: Limb, otherwise: str) -> str:
    """Return the link whose bone carries a limb on the target."""
    by_bone = {entry.target: name for name, entry in builder.entries.items()}
    return next((by_bone[b] for b in builder.target.skeleton.tree.ancestors[limb.bones[0]] if b in by_bone), otherwise)


def _add_jointed(builder: _Builder, side: str, joints: Sequence[str], top: str) -> None:
    above: str | None = top
    for joint in joints:
        above = builder.joint(side + joint, above)
    if side + joints[-1] in builder.entries:
        builder.points_to(side + joints[-1], None)


def _add_fingers(builder: _Builder, side: str) -> None:
    hand = f"{side}Hand"
    if hand not in builder.entries:
        return
    for digit in _DIGITS:
        joints = [j for j in PARENTS if j in FINGER_JOINTS and j.startswith(side + digit)]
        ours = [b for j in joints if (b := builder.target.bone(j)) is not None]
        theirs = [b for j in joints if (b := builder.source.bone(j)) is not None]
        if len(ours) == len(theirs):
            above: str | None = hand
            for joint in joints:
                above = builder.joint(joint, above)
            if above is not None and above != hand:
                builder.points_to(above, None)
        elif ours and theirs:
            last = builder.chain(f"{side}{digit}", _spread(theirs), _spread(ours), hand)
            if last is not None:
                builder.points_to(last, None)
    knuckle = next((side + k for k in _KNUCKLES if side + k in builder.entries), None)
    builder.points_to(hand, knuckle)


def _add_further(builder: _Builder, joint: str, bone: str) -> None:
    """Let a further bone of the target turn as a joint of the source does."""
    taken = {entry.target: name for name, entry in builder.entries.items()}
    own = further.find(builder.source, builder.target, taken, joint, bone)
    builder.entries[own.name] = _Entry(own.target, (own.source, own.source), 0.0, own.above)
    # A joint's own segment does not end at what hangs on it besides.
    if further.is_further(own.above) and builder.entries[own.above].after is None:
        builder.entries[own.above].after = own.name


def _spread(bones: Sequence[int]) -> list[tuple[float, int]]:
    last = max(len(bones) - 1, 1)
    return [(i / last, bone) for i, bone in enumerate(bones)]


def _pair_limbs(source: Sequence[Limb], target: Sequence[Limb]) -> Iterator[tuple[str, Limb, Limb]]:
    """Yield matching limbs: legs from the hind row forward, then arms, wings and fins from the front row back.

    A forelimb follows a forelimb, whatever it has become: an arm, a front leg or a wing.
    """
    theirs, ours = _slots(source), _slots(target)
    for slot, limb in ours.items():
        if slot in theirs:
            yield _limb_name(slot), theirs[slot], limb


def _slots(limbs: Sequence[Limb]) -> dict[tuple[str, int, int], Limb]:
    out: dict[tuple[str, int, int], Limb] = {}
    legs = [m for m in limbs if m.kind is LimbKind.LEG]
    rows = max((m.row for m in legs), default=-1) + 1
    for leg in legs:
        out["leg", rows - 1 - leg.row, leg.side] = leg
    for kind in (LimbKind.ARM, LimbKind.WING, LimbKind.FIN, LimbKind.TENTACLE):
        for limb in (m for m in limbs if m.kind is kind):
            # The forelimbs of a body with one pair of legs stand where others have their second pair of legs.
            fore = limb.row == 0 and rows == 1 and kind in (LimbKind.ARM, LimbKind.WING)
            slot = (
                ("leg", 1, limb.side)
                if fore and ("leg", 1, limb.side) not in out
                else (kind.value, limb.row, limb.side)
            )
            out[slot] = limb
    return out


def _limb_name(slot: tuple[str, int, int]) -> str:
    kind, row, side = slot
    return f"{kind}{row}{'.l' if side > 0 else '.r' if side < 0 else ''}"


def _add_tails(builder: _Builder) -> None:
    for i, (theirs, ours) in enumerate(zip(builder.source.tails, builder.target.tails, strict=False)):
        hips = builder.source.bone("hips")
        assert hips is not None, "link() has checked that there are hips"
        steps = [(0.0, hips), *((k / len(theirs), b) for k, b in enumerate(theirs, 1))]
        last = builder.chain(f"tail{i}", steps, [(k / len(ours), b) for k, b in enumerate(ours, 1)], "hips")
        if last is not None and last != "hips":
            builder.points_to(last, None)
