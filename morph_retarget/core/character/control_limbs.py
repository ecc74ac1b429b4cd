"""How limbs of a control rig are brought to places, and what switches them: by names, by drivers, by constraints."""

from collections import Counter
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product, takewhile

from ..errors import MappingError
from . import control_names
from .control_facts import COPYING, BoneFacts, Follows, upstream
from .control_given import Reaching, switch_of
from .control_names import Family, Limb

_SWITCHED = COPYING | {"IK"}
"""Constraints whose drivers tell what switches a limb."""


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
    heel: str | None
    """What turns the last segment of a leg of three bones about the end, None for all others."""
    turned: tuple[Setting, ...]
    """What lets forward kinematics count; nothing where inverse kinematics always does."""
    reached: tuple[Setting, ...]
    """What lets inverse kinematics count."""


def has(rig: Mapping[str, BoneFacts], bone: str, prop: str) -> bool:
    """Return whether a bone is there and has a custom property."""
    return bone in rig and prop in rig[bone].properties


def limb_controls(
    rig: Mapping[str, BoneFacts],
    family: Family | None,
    limb: Limb,
    turning: Mapping[str, str],
    shared: Container[str],
    said: Reaching | None = None,
) -> LimbControls | None:
    """Return how a limb is brought to a place, None where the rig has no control for that.

    Args:
        rig: All bones by their names.
        family: How the rig names its controls, None where names tell nothing.
        limb: The limb.
        turning: Deform bone to the control that turns it.
        shared: Bones that the rest of the body follows too.
        said: What the user says of it.

    Raises:
        MappingError: The user has named a bone or property that does not exist, or no control and none is found.
    """
    named = None if family is None else _named(rig, family, limb, turning)
    found = named or _constrained(rig, family, limb, turning, shared)
    return found if said is None else _as_said(rig, family, limb, turning, found, said)


def _as_said(
    rig: Mapping[str, BoneFacts],
    family: Family | None,
    limb: Limb,
    turning: Mapping[str, str],
    found: LimbControls | None,
    said: Reaching,
) -> LimbControls:
    """Return the controls of a limb with what the user says of them."""
    chain = limb.bones
    control = said.control or (found.control if found else "")
    pole = said.pole or (found.pole if found else None)
    if not control:
        raise MappingError(f"what brings {limb.end!r} to its place is not found: name its IK control too")
    for name in filter(None, (control, pole)):
        if name not in rig:
            raise MappingError(
                f"bone {limb.end!r} is to be moved by {name!r}, which the armature does not have: choose another"
            )
    turned, reached = (found.turned, found.reached) if found else ((), ())
    if said.switch:
        bone, prop, value = switch_of(said.switch, limb.end)
        if not has(rig, bone, prop):
            raise MappingError(f"the switch of {limb.end!r} is {said.switch!r}, which the armature does not have")
        turned, reached = (Setting(bone, prop, 1.0 - value),), (Setting(bone, prop, value),)
    elif found is None and (by_drivers := switch(rig, family, chain, turning)) is not None:
        turned, reached = (by_drivers[0],), (by_drivers[1],)
    tip, heel = (found.tip, found.heel) if found and found.control == control else (None, None)
    return LimbControls(limb, control, pole, tip, heel, _serving(chain, turned), _serving(chain, reached))


def _named(rig: Mapping[str, BoneFacts], family: Family, limb: Limb, turning: Mapping[str, str]) -> LimbControls | None:
    chain = limb.bones
    control = control_names.among(family.reaching, control_names.bases(family, chain[-1]), rig)
    heel = control_names.among(family.heels, control_names.bases(family, limb.heel), rig)
    found = None if control is None else switch(rig, family, chain, turning)
    if control is None or found is None or (limb.heel and heel is None):
        return None
    turned, reached = found
    beside = [Setting(turned.bone, prop, value) for prop, value in family.beside if has(rig, turned.bone, prop)]
    pole = control_names.of_limb(family, family.poles, limb, rig)
    tip = control_names.among(family.reaching, control_names.bases(family, limb.tip), rig)
    return LimbControls(limb, control, pole, tip, heel, _serving(chain, (turned,)), _serving(chain, (reached, *beside)))


def _constrained(
    rig: Mapping[str, BoneFacts], family: Family | None, limb: Limb, turning: Mapping[str, str], shared: Container[str]
) -> LimbControls | None:
    """Return how a limb is brought to a place by what inverse kinematics aims at."""
    chain = limb.bones
    if limb.heel:
        return None  # what turns its last segment is not to be seen from constraints
    aiming = _aiming([rig[name] for part in chain[1::-1] for name in upstream(rig, part)])
    control = None if aiming is None else _held_by(rig, aiming.bones[0], shared)
    if aiming is None or control is None or control not in _above_all(rig, limb.end):
        return None
    found = switch(rig, family, chain, turning)
    always = aiming.decides and _aiming([rig[name] for name in _ruling(rig, limb.middle)]) is aiming
    if found is None and not always:
        return None
    pole = None if aiming.pole is None else _held_by(rig, aiming.pole, shared)
    turned, reached = ((), ()) if found is None else ((found[0],), (found[1],))
    return LimbControls(limb, control, pole, None, None, _serving(chain, turned), _serving(chain, reached))


def _aiming(bones: Iterable[BoneFacts]) -> Follows | None:
    """Return the first inverse kinematics among bones."""
    return next((follows for bone in bones for follows in bone.follows if follows.kind == "IK" and follows.bones), None)


def _ruling(rig: Mapping[str, BoneFacts], bone: str) -> list[str]:
    """Return a bone and what it follows whatever is switched, nearest first."""
    out = [bone]
    while True:
        copied = [f.bones[0] for f in rig[out[-1]].follows if f.leads and f.decides and f.bones]
        if not copied or copied[-1] in out or copied[-1] not in rig:
            return out
        out.append(copied[-1])


def _held_by(rig: Mapping[str, BoneFacts], bone: str, shared: Container[str]) -> str | None:
    """Return the control that carries a bone, and no other part of the body: the outermost one."""
    above = [name for name in _line(rig, bone) if not rig[name].deform]
    own = [name for name in takewhile(lambda name: name not in shared, above) if not _is_held(rig[name])]
    return next(iter([name for name in reversed(own) if rig[name].shaped] or own), None)


def _is_held(bone: BoneFacts) -> bool:
    """Return whether constraints leave nothing of what an animator would do to a bone."""
    return any(follows.kind in COPYING and follows.decides for follows in bone.follows)


def _line(rig: Mapping[str, BoneFacts], bone: str) -> list[str]:
    """Return a bone and those above it, nearest first."""
    out: list[str] = []
    name: str | None = bone
    while name is not None and name in rig and name not in out:
        out.append(name)
        name = rig[name].parent
    return out


def _above_all(rig: Mapping[str, BoneFacts], bone: str) -> set[str]:
    """Return all that turns a bone along: what it copies, and what carries that."""
    return {above for name in upstream(rig, bone) for above in _line(rig, name)}


def _serving(bones: tuple[str, ...], settings: Sequence[Setting]) -> tuple[Setting, ...]:
    return tuple(replace(setting, serves=bones) for setting in settings)


def switch(
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
            if holder is not None and has(rig, holder, prop):
                return Setting(holder, prop, family.turned), Setting(holder, prop, family.reached)
    return None


def _driven_switch(
    rig: Mapping[str, BoneFacts], chain: Sequence[str], turning: Mapping[str, str]
) -> tuple[Setting, Setting] | None:
    """Return the switch of a limb as drivers of constraints tell it."""
    votes: Counter[tuple[str, str, float, float]] = Counter()
    for part in chain:
        for name in upstream(rig, part):
            for follows in rig[name].follows:
                if follows.switch is None or follows.kind not in _SWITCHED or follows.counts[0] == follows.counts[1]:
                    continue
                held = [b for b in follows.bones if b in rig and follows.kind in COPYING]
                turns = any(turning.get(part) in (*upstream(rig, b),) for b in held)
                rises = follows.counts[1] > follows.counts[0]
                low, high = follows.span
                votes[(*follows.switch, *((high, low) if turns == rises else (low, high)))] += 1
    if not votes:
        return None
    (bone, prop, turned, reached), _ = votes.most_common(1)[0]
    return Setting(bone, prop, turned), Setting(bone, prop, reached)
