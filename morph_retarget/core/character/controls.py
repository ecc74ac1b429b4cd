"""Which controls pose a rig: what deform bones follow, read from names, tree and constraints as plain data.

A control rig has two halves. Deform bones move the mesh; controls are what animators take. Motion is found for the
first and has to be written on the second. Names tell most (`control_names`); where they do not, constraints do: what a
bone copies, what that copies, and so on up to what nothing else moves.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

from ..errors import MappingError
from . import control_names
from .control_names import FAMILIES, Family, Limb
from .joints import PARENTS

CARRYING = frozenset(("COPY_TRANSFORMS", "COPY_ROTATION", "ARMATURE", "CHILD_OF", "DAMPED_TRACK", "STRETCH_TO"))
"""Constraints by which a bone turns as another one does."""
COPYING = frozenset(("COPY_TRANSFORMS", "COPY_ROTATION", "ARMATURE", "CHILD_OF"))
MOST = 0.9
"""A bone that follows another by less than this share only shares its turn, as twist bones do."""
_WHOLE = frozenset(("COPY_TRANSFORMS", "ARMATURE"))
DEPTH = 6
"""So many constraints a control may be away from the bone that follows it."""
LEAST = 4
"""A family is taken for a rig's own when it names the controls of at least as many bones."""
GIVEN, FOUND = "User", "Constraints"
"""Families of rigs whose controls the user has named, and whose constraints have told them."""


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


@dataclass(frozen=True)
class Setting:
    """A custom property of a bone and the value that it must have."""

    bone: str
    prop: str
    value: float
    serves: tuple[str, ...] = ()
    """Deform bones for which that matters, empty for all."""


@dataclass(frozen=True)
class LimbControls:
    """How a limb is brought to a place."""

    limb: Limb
    control: str
    """Of its end."""
    pole: str | None
    """What the middle joint points to, None where the rig has no such control."""
    tip: str | None
    """What turns the toes meanwhile, None where that is no other control."""
    turned: tuple[Setting, ...]
    """What lets forward kinematics count."""
    reached: tuple[Setting, ...]
    """What lets inverse kinematics count."""


@dataclass(frozen=True)
class Controls:
    """The controls of a rig."""

    family: str
    turning: Mapping[str, str]
    """Deform bone to the control that turns it."""
    trunk: str | None
    """What carries the whole body; the control of the hips does where there is nothing else."""
    limbs: tuple[LimbControls, ...]
    settings: tuple[Setting, ...]
    """What has to be so always."""
    carriers: Mapping[str, str]
    """Control to the one that carries it, for those that one carries."""
    still: tuple[str, ...]
    """Further bones that move the same deform bones, and must rest."""
    kept: tuple[tuple[str, str], ...]
    """Further properties, each with its bone, on which it depends what follows what; they must stay as they are."""


@dataclass(frozen=True)
class Wanted:
    """What controls are asked for."""

    bones: Sequence[str]
    """Deform bones that are to be posed, the hips first."""
    roles: Mapping[str, str]
    """Canonical joint to deform bone, as far as known."""
    limbs: Sequence[Limb] = ()
    """Those that can be brought to places."""
    chains: Sequence[Sequence[str]] = ()
    """Deform bones of all limbs, from the top down."""
    given: Mapping[str, str] = field(default_factory=dict[str, str])
    """The user's own: deform bone to control."""


def read(facts: Sequence[BoneFacts], wanted: Wanted) -> Controls | None:
    """Return the controls of a rig, None for one that is posed by its deform bones.

    Raises:
        MappingError: A control that the user has named does not exist.
    """
    rig = {bone.name: bone for bone in facts}
    for bone, control in wanted.given.items():
        if control not in rig:
            raise MappingError(
                f"bone {bone!r} is to be moved by control {control!r}, which the armature does not have: choose another"
            )
    family, named = _family(rig, wanted)
    turning: dict[str, str] = {}
    for bone in wanted.bones:
        control = wanted.given.get(bone) or named.get(bone)
        if control is None and (family is None or not rig[bone].follows):
            control = _followed(rig, bone)
        if control is not None:
            turning[bone] = control
    if all(bone == control for bone, control in turning.items()):
        return None
    trunk = None if family is None else next((name for name in family.trunk if name in rig), None)
    hips = wanted.roles.get("hips", "")
    if hips in wanted.given:
        trunk = wanted.given[hips]
    trunk = trunk or turning.get(hips)
    limbs = tuple(found for limb in wanted.limbs if (found := _limb(rig, family, limb, turning)))
    own = {*turning.values(), *([trunk] if trunk else ()), *(limb.control for limb in limbs)}
    own |= {name for limb in limbs for name in (limb.pole, limb.tip) if name}
    name = GIVEN if wanted.given and family is None else FOUND if family is None else family.name
    settings = [] if family is None else [Setting(*one) for one in family.settings if _has(rig, one[0], one[1])]
    bent = {limb.limb.upper for limb in limbs}
    for chain in wanted.chains:
        switch = None if bent.intersection(chain) else _switch(rig, family, chain, turning)
        settings += [replace(switch[0], serves=tuple(chain))] if switch else []
    around = _upstream_of_all(rig, (*turning, *own))
    still = tuple(name for name in rig if name in around and name not in own)
    switches = dict.fromkeys(f.switch for name in around for f in rig[name].follows if f.switch is not None)
    known = {(s.bone, s.prop) for s in (*settings, *(s for limb in limbs for s in (*limb.turned, *limb.reached)))}
    kept = tuple(switch for switch in switches if switch not in known)
    return Controls(name, turning, trunk, limbs, tuple(settings), _carriers(rig, own), still, kept)


def without_names(facts: Sequence[BoneFacts], wanted: Wanted) -> set[str]:
    """Return the bones for which a rig of a known family has no control by their names.

    They are segments of parts that other controls turn.
    """
    family, named = _family({bone.name: bone for bone in facts}, wanted)
    return set() if family is None else set(wanted.bones) - set(named) - set(wanted.given)


def _has(rig: Mapping[str, BoneFacts], bone: str, prop: str) -> bool:
    return bone in rig and prop in rig[bone].properties


# --- by names ---


def _family(rig: Mapping[str, BoneFacts], wanted: Wanted) -> tuple[Family | None, dict[str, str]]:
    """Return the family that names most of the controls, and these, by deform bone."""
    best: tuple[Family | None, dict[str, str]] = (None, {})
    for family in FAMILIES:
        found = _named(rig, family, wanted)
        if sum(bone != control for bone, control in found.items()) >= LEAST and len(found) > len(best[1]):
            best = family, found
    return best


def _named(rig: Mapping[str, BoneFacts], family: Family, wanted: Wanted) -> dict[str, str]:
    joint_of = {bone: joint for joint, bone in wanted.roles.items()}
    controls = {name for name, bone in rig.items() if bone.shaped or not bone.deform}
    out: dict[str, str] = {}
    for bone in wanted.bones:
        by_role = family.roles.get(joint_of.get(bone, ""), ())
        found = next((name for name in by_role if name in rig), None)
        found = found or control_names.among(family.turning, control_names.bases(family, bone), controls)
        if found is not None and found not in out.values():
            out[bone] = found
    return out


# --- by constraints ---


def _followed(rig: Mapping[str, BoneFacts], bone: str) -> str | None:
    """Return what a deform bone follows in the end: a control, or itself where it follows nothing; None if unclear."""
    if not any(f.leads for f in rig[bone].follows):
        return bone
    free = [
        name
        for name in _upstream(rig, bone)
        if name != bone and not any(f.kind in CARRYING or f.kind == "IK" for f in rig[name].follows)
    ]
    shaped = [name for name in free if rig[name].shaped] or free
    turning = [name for name in shaped if "fk" in name.lower()] or [name for name in shaped if "ik" not in name.lower()]
    return next(iter(turning), None)


def _upstream(rig: Mapping[str, BoneFacts], bone: str) -> Iterator[str]:
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


# --- limbs ---


def _limb(
    rig: Mapping[str, BoneFacts], family: Family | None, limb: Limb, turning: Mapping[str, str]
) -> LimbControls | None:
    """Return how a limb is brought to a place, None where the rig has no control for that."""
    if family is None:
        return None
    control = control_names.among(family.reaching, control_names.bases(family, limb.end), rig)
    if control is None:
        return None
    pole = control_names.of_limb(family, family.poles, limb, rig)
    switch = _switch(rig, family, (limb.upper, limb.middle, limb.end), turning)
    if switch is None:
        return None
    turned, reached = switch
    beside = [Setting(turned.bone, prop, value) for prop, value in family.beside if _has(rig, turned.bone, prop)]
    tip = control_names.among(family.reaching, control_names.bases(family, limb.tip), rig)
    serves = (limb.upper, limb.middle, limb.end)
    kinds = ((turned,), (reached, *beside))
    own = [tuple(replace(setting, serves=serves) for setting in kind) for kind in kinds]
    return LimbControls(limb, control, pole, tip, *own)


def _switch(
    rig: Mapping[str, BoneFacts], family: Family | None, chain: Sequence[str], turning: Mapping[str, str]
) -> tuple[Setting, Setting] | None:
    """Return what lets a limb follow its turning controls, and what lets it reach; None where nothing switches it."""
    driven = _driven_switch(rig, chain, turning)
    return driven if driven is not None or family is None else _named_switch(rig, family, chain)


def _named_switch(rig: Mapping[str, BoneFacts], family: Family, chain: Sequence[str]) -> tuple[Setting, Setting] | None:
    """Return the switch of a limb by the names of its family."""
    _, end = control_names.split(chain[-1])
    side = {"l": "left", "r": "right"}.get(end[1:2].lower(), "")
    for upper, last, kind in product(chain, chain, ("arm", "leg")):
        holder = control_names.of_limb(family, family.holders, Limb(kind, upper, upper, last), rig)
        for pattern in family.switches if holder is not None else ():
            prop = pattern.format(kind=kind, side=side)
            if holder is not None and _has(rig, holder, prop):
                return Setting(holder, prop, family.turned), Setting(holder, prop, family.reached)
    return None


def _driven_switch(
    rig: Mapping[str, BoneFacts], chain: Sequence[str], turning: Mapping[str, str]
) -> tuple[Setting, Setting] | None:
    """Return the switch of a limb as drivers of constraints tell it."""
    votes: Counter[tuple[str, str, float, float]] = Counter()
    for part in chain:
        for name in _upstream(rig, part):
            for follows in rig[name].follows:
                if follows.switch is None or follows.kind not in COPYING or follows.counts[0] == follows.counts[1]:
                    continue
                turns = any(turning.get(part) in (*_upstream(rig, b),) for b in follows.bones if b in rig)
                rises = follows.counts[1] > follows.counts[0]
                low, high = follows.span
                votes[(*follows.switch, *((high, low) if turns == rises else (low, high)))] += 1
    if not votes:
        return None
    (bone, prop, turned, reached), _ = votes.most_common(1)[0]
    return Setting(bone, prop, turned), Setting(bone, prop, reached)


# --- who carries whom ---


def _carriers(rig: Mapping[str, BoneFacts], own: set[str]) -> dict[str, str]:
    """Return the control that carries each control, over mechanism bones between them."""
    out: dict[str, str] = {}
    for control in own:
        name, seen = rig[control].parent, {control}
        while name is not None and name in rig and name not in own and name not in seen:
            seen.add(name)
            copied = [f for f in rig[name].follows if f.kind in _WHOLE and f.bones and f.decides]
            name = copied[-1].bones[0] if copied else rig[name].parent
        if name is not None and name in own and name != control:
            out[control] = name
    return out


def _upstream_of_all(rig: Mapping[str, BoneFacts], bones: Iterable[str]) -> dict[str, None]:
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


def joints_without(roles: Mapping[str, str], controls: Controls) -> list[str]:
    """Return the canonical joints that have a bone but no control."""
    return [joint for joint in PARENTS if joint in roles and roles[joint] not in controls.turning]
