"""Which controls pose a rig: what deform bones follow, read from names, tree and constraints as plain data.

A control rig has two halves. Deform bones move the mesh; controls are what animators take. Motion is found for the
first and has to be written on the second. Names tell most (`control_names`); where they do not, constraints do: what a
bone copies, what that copies, and so on up to what nothing else moves.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from ..errors import MappingError
from . import control_names
from .control_facts import CARRYING, WHOLE, BoneFacts, upstream, upstream_of_all
from .control_given import Reaching
from .control_limbs import LimbControls, Setting, has, limb_controls, switch
from .control_names import FAMILIES, Family, Limb
from .joints import PARENTS

LEAST = 4
"""A family is taken for a rig's own when it names the controls of at least as many bones."""
GIVEN, FOUND = "User", "Constraints"
"""Families of rigs whose controls the user has named, and whose constraints have told them."""


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
    reaches: Mapping[str, Reaching] = field(default_factory=dict[str, Reaching])
    """What the user says of limbs, by the deform bones of their ends."""


def read(facts: Sequence[BoneFacts], wanted: Wanted) -> Controls | None:
    """Return the controls of a rig, None for one that is posed by its deform bones.

    Raises:
        MappingError: A control or switch that the user has named does not exist.
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
    trunk = None if family is None else next((name for name in family.trunk if name in rig), None)
    hips = wanted.roles.get("hips", "")
    if hips in wanted.given:
        trunk = wanted.given[hips]
    trunk = trunk or turning.get(hips)
    found = (
        limb_controls(rig, family, limb, turning, _shared(rig, wanted, limb), wanted.reaches.get(limb.end))
        for limb in wanted.limbs
    )
    limbs = tuple(limb for limb in found if limb is not None)
    if all(bone == control for bone, control in turning.items()) and not limbs:
        return None
    own = {*turning.values(), *([trunk] if trunk else ()), *(limb.control for limb in limbs)}
    own |= {name for limb in limbs for name in (limb.pole, limb.tip, limb.heel) if name}
    name = GIVEN if (wanted.given or wanted.reaches) and family is None else FOUND if family is None else family.name
    settings = [] if family is None else [Setting(*one) for one in family.settings if has(rig, one[0], one[1])]
    bent = {limb.limb.upper for limb in limbs}
    for chain in wanted.chains:
        other = None if bent.intersection(chain) else switch(rig, family, chain, turning)
        settings += [replace(other[0], serves=tuple(chain))] if other else []
    around = upstream_of_all(rig, (*turning, *own))
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
        for name in upstream(rig, bone)
        if name != bone and not any(f.kind in CARRYING or f.kind == "IK" for f in rig[name].follows)
    ]
    shaped = [name for name in free if rig[name].shaped] or free
    turning = [name for name in shaped if "fk" in name.lower()] or [name for name in shaped if "ik" not in name.lower()]
    return next(iter(turning), None)


_MIDDLE = ("hips", "spine", "chest", "upperChest", "neck", "head")


def _shared(rig: Mapping[str, BoneFacts], wanted: Wanted, limb: Limb) -> dict[str, None]:
    """Return all that the body besides a limb follows and hangs on."""
    trunk = [wanted.roles[joint] for joint in _MIDDLE if joint in wanted.roles]
    others = [bone for one in wanted.limbs if one != limb for bone in (one.upper, one.middle, one.end)]
    return upstream_of_all(rig, [*trunk, *others])


# --- who carries whom ---


def _carriers(rig: Mapping[str, BoneFacts], own: set[str]) -> dict[str, str]:
    """Return the control that carries each control, over mechanism bones between them."""
    out: dict[str, str] = {}
    for control in own:
        name, seen = rig[control].parent, {control}
        while name is not None and name in rig and name not in own and name not in seen:
            seen.add(name)
            copied = [f for f in rig[name].follows if f.kind in WHOLE and f.bones and f.decides]
            name = copied[-1].bones[0] if copied else rig[name].parent
        if name is not None and name in own and name != control:
            out[control] = name
    return out


def joints_without(roles: Mapping[str, str], controls: Controls) -> list[str]:
    """Return the canonical joints that have a bone but no control."""
    return [joint for joint in PARENTS if joint in roles and roles[joint] not in controls.turning]
