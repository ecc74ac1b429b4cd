"""How families of control rigs name their controls: affixes around the name of a body part, no lists of bones.

A pattern is a name with a field for the part, as ``c_{}_fk`` or ``{}_ik``; the side and number that end the part's own
name (``.L``, ``.001``) end that of the control too.
"""

import re
from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

Patterns = tuple[str, ...]

_END = re.compile(r"^(.*?)((?:[._-][LRXlrx])?)((?:\.\d{3})?)$", re.DOTALL)


@dataclass(frozen=True)
class Limb:
    """The deform bones of an arm or leg."""

    kind: str
    """"arm" or "leg"."""
    upper: str
    middle: str
    end: str
    tip: str = ""
    """Toes, empty without them."""
    heel: str = ""
    """What lies between the middle one and the end in legs of three bones, as of beasts; empty in all others."""

    @property
    def bones(self) -> tuple[str, ...]:
        """What inverse kinematics poses, from the top down: in legs of three bones the end turns by itself."""
        return (self.upper, self.middle, self.heel or self.end)


@dataclass(frozen=True)
class Family:
    """How one family of rigs names what it is made of; each tuple is tried in order."""

    name: str
    deform: Patterns
    """Of deform bones."""
    turning: Patterns
    """Of the controls that turn parts by forward kinematics."""
    reaching: Patterns
    """Of the controls that bring the ends of limbs to places."""
    heels: Patterns
    """Of what turns the last segment of a leg of three bones about its end."""
    poles: Patterns
    """Of what middle joints point to; with the fields ``{upper}``, ``{end}`` and ``{kind}``."""
    trunk: Patterns
    """What carries the whole body."""
    roles: Mapping[str, Patterns] = field(default_factory=dict[str, Patterns])
    """Controls of joints whose bones have names of their own."""
    holders: Patterns = ()
    """Who holds a limb's switch; fields as for ``poles``."""
    switches: Patterns = ()
    """Property that switches a limb, with the field ``{kind}`` and ``{side}`` ("left", "right")."""
    turned: float = 1.0
    """Value of the switch for forward kinematics."""
    reached: float = 0.0
    """Value for inverse kinematics."""
    beside: tuple[tuple[str, float], ...] = ()
    """Properties of a limb's holder, and their values, that let its pole count and take it off what else carries it."""
    settings: tuple[tuple[str, str, float], ...] = ()
    """Bone, property and value that make parts go with what carries them."""


FAMILIES = (
    Family(
        name="Rigify",
        deform=("DEF-{}",),
        turning=("{}_fk", "{}"),
        reaching=("{}_ik",),
        heels=("{}_heel_ik",),
        poles=("{upper}_ik_target",),
        trunk=("torso",),
        roles={"neck": ("neck",), "head": ("head",), "jaw": ("jaw_master",)},
        holders=("{upper}_parent",),
        switches=("IK_FK",),
        beside=(("pole_vector", 1.0), ("IK_parent", 1.0), ("pole_parent", 1.0)),
        settings=(("torso", "neck_follow", 1.0), ("torso", "head_follow", 1.0), ("torso", "tail_follow", 1.0)),
    ),
    Family(
        name="Auto-Rig Pro",
        deform=("{}_stretch", "{}_twist", "{}_01", "{}"),
        turning=("c_{}_fk", "c_{}"),
        reaching=("c_{}_ik",),
        heels=(),
        poles=("c_{kind}s_pole", "c_{kind}_pole"),
        trunk=("c_root_master.x", "c_root_master"),
        holders=("c_{end}_ik",),
        switches=("ik_fk_switch",),
    ),
    Family(
        name="CloudRig",
        deform=("DEF-{}_1", "DEF-{}1", "DEF-{}"),
        turning=("FK-{}",),
        reaching=("IK-MSTR-{}", "IK-{}"),
        heels=(),
        poles=("IK-POLE-{upper}", "POLE-{upper}"),
        trunk=("MSTR-Torso", "MSTR-Spine_Torso", "MSTR-Spine", "MSTR-Hips", "Torso"),
        holders=("Properties", "Properties_IKFK", "PRP-Properties"),
        switches=("ik_{side}_{kind}", "ik_{kind}_{side}"),
        turned=0.0,
        reached=1.0,
    ),
)
"""Rigify's generated rigs; Auto-Rig Pro; CloudRig, with which the rigs of Blender Studio are made."""


def split(name: str) -> tuple[str, str]:
    """Return the name of a part and the side and number that end it: ``("thigh", ".L")``."""
    found = _END.match(name)
    assert found is not None, "the pattern fits every name"
    return found[1], found[2] + found[3]


def bases(family: Family, deform: str) -> Iterator[tuple[str, str]]:
    """Yield what part a deform bone may be, with side and number: each way in which a family may name it so."""
    name, end = split(deform)
    for pattern in family.deform:
        before, _, after = pattern.partition("{}")
        if name.startswith(before) and name.endswith(after) and len(name) > len(before) + len(after):
            yield name[len(before) : len(name) - len(after)], end


def among(patterns: Sequence[str], parts: Iterator[tuple[str, str]], names: Container[str]) -> str | None:
    """Return the first control that a rig has under one of some patterns, None without one."""
    own = list(parts)
    made = (pattern.format(base) + end for pattern in patterns for base, end in own)
    return next((name for name in made if name in names), None)


def of_limb(family: Family, patterns: Sequence[str], limb: Limb, names: Container[str]) -> str | None:
    """Return the first bone that a rig has under one of some patterns with fields of a limb, None without one."""
    for upper, end in bases(family, limb.upper):
        for last, _ in bases(family, limb.end):
            for pattern in patterns:
                name = pattern.format(upper=upper, end=last, kind=limb.kind)
                found = next((made for made in (name + end, name) if made in names), None)
                if found is not None:
                    return found
    return None
