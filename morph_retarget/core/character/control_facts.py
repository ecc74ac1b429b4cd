"""What a control rig is made of, as plain data, and what its bones follow."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

CARRYING = frozenset(("COPY_TRANSFORMS", "COPY_ROTATION", "ARMATURE", "CHILD_OF", "DAMPED_TRACK", "STRETCH_TO"))
"""Constraints by which a bone turns as another one does."""
COPYING = frozenset(("COPY_TRANSFORMS", "COPY_ROTATION", "ARMATURE", "CHILD_OF"))
AIMING = frozenset(("STRETCH_TO", "DAMPED_TRACK", "LOCKED_TRACK"))
"""Constraints by which a bone points to others."""
MOST = 0.9
"""A bone that follows another by less than this share only shares its turn, as twist bones do."""
WHOLE = frozenset(("COPY_TRANSFORMS", "ARMATURE"))
DEPTH = 6
"""So many constraints a control may be away from the bone that follows it."""


@dataclass(frozen=True)
class Follows:
    """A constraint of a bone to others of the same armature."""

    kind: str
    """Blender's name of its type."""
    bones: tuple[str, ...]
    switch: tuple[str, str] | None = None
    """Bone and property that drive how far it counts, None when nothing does."""
    counts: tuple[float, float] = (1.0, 1.0)
    """How far it counts at the lowest and at the highest value of the property, or always."""
    span: tuple[float, float] = (0.0, 1.0)
    """These two values."""
    local: bool = False
    """Whether it adds to what carries the bone already."""
    pole: str | None = None
    """Of inverse kinematics: bone that the middle joint points to, None without one."""

    @property
    def leads(self) -> bool:
        """Whether the bone turns with what it follows, at least where that is switched on."""
        return self.kind in COPYING and max(self.counts) >= MOST

    @property
    def decides(self) -> bool:
        """Whether it leaves nothing of what carries the bone, whatever drives it."""
        return not self.local and self.counts == (1.0, 1.0)


@dataclass(frozen=True)
class BoneFacts:
    """What can be known of a bone of a control rig without posing it."""

    name: str
    parent: str | None
    deform: bool
    shaped: bool
    """Whether it is drawn in a shape of its own, as controls are."""
    follows: tuple[Follows, ...] = ()
    properties: tuple[str, ...] = ()
    """Its custom properties that are numbers."""


def upstream(rig: Mapping[str, BoneFacts], bone: str) -> Iterator[str]:
    """Yield a bone and all that it copies or what holds that, directly or not, nearest first."""
    level, seen = [bone], {bone}
    for _ in range(DEPTH):
        yield from level
        after = [b for name in level for b in _led_by(rig[name])]
        level = [name for name in dict.fromkeys(after) if name not in seen and name in rig]
        seen.update(level)


def _led_by(bone: BoneFacts) -> list[str]:
    """Return what a bone copies; for a mechanism that copies nothing, what holds it."""
    copied = [b for f in bone.follows if f.leads for b in f.bones]
    held = bone.parent is not None and not (copied or bone.shaped or bone.deform)
    return [bone.parent] if held and bone.parent is not None else copied


def upstream_of_all(rig: Mapping[str, BoneFacts], bones: Iterable[str]) -> dict[str, None]:
    """Return all that bones follow and hang on, and these again, themselves included."""
    waiting, out = list(bones), dict[str, None]()
    while waiting:
        name = waiting.pop()
        if name in out or name not in rig:
            continue
        out[name] = None
        parent = rig[name].parent
        waiting += [b for follows in rig[name].follows for b in follows.bones]
        waiting += [] if parent is None else [parent]
    return out
