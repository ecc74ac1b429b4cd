"""What armature objects keep of their jiggles: few knobs for the whole, and more for single kinds and bones."""

from typing import Any

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty

from ...core.solve.jiggle_kinds import MANNERS, JiggleKind, JiggleSettings, Override
from ..declaring import OVERRIDABLE, OVERRIDABLE_LIST
from .values import OF_CHARACTER, tell_character

BONE = "bone"
_DEFAULT = JiggleSettings()
KINDS: Any = [
    (BONE, "Bone", "The bone of this name"),
    *((kind.value, kind.value.title(), f"All that jiggles as {kind.value}") for kind in JiggleKind),
]


def _half_life() -> Any:
    return FloatProperty(
        name="Half-Life",
        description="Time in which what lags behind comes back halfway",
        default=_DEFAULT.half_life,
        min=0.001,
        soft_min=0.02,
        soft_max=1.0,
        max=60.0,
        step=1,
        precision=3,
        unit="TIME_ABSOLUTE",
        **OF_CHARACTER,
    )


def _stiffness() -> Any:
    return FloatProperty(
        name="Stiffness",
        description="How hard it resists being left behind",
        default=_DEFAULT.stiffness,
        min=1.05,
        soft_max=10.0,
        max=1000.0,
        **OF_CHARACTER,
    )


def _amount() -> Any:
    return FloatProperty(
        name="Amount",
        description="Size of the movement; at 0 nothing jiggles",
        default=_DEFAULT.amount,
        min=0.0,
        soft_max=2.0,
        max=100.0,
        **OF_CHARACTER,
    )


class MORPHRETARGET_PG_jiggle_override(bpy.types.PropertyGroup):
    """What is set for one kind of parts, or for the bone of the same name."""

    kind: EnumProperty(name="For", description="What this is set for", items=KINDS, **OF_CHARACTER)
    half_life: _half_life()
    stiffness: _stiffness()
    amount: _amount()

    def override(self) -> Override:
        """Return it as the core takes it."""
        return Override(self.half_life, self.stiffness, self.amount)


class MORPHRETARGET_PG_jiggles(bpy.types.PropertyGroup):
    """How the loose parts of a character follow the rest of it."""

    enabled: BoolProperty(
        name="Jiggles",
        description="Let tails, ears, hair and the like follow, as far as the generalized action does not pose them",
        **OF_CHARACTER,
    )
    half_life: _half_life()
    stiffness: _stiffness()
    amount: _amount()
    gravity: FloatProperty(
        name="Gravity",
        description="How much lower parts hang when the body is tilted, as a share of their length",
        default=_DEFAULT.gravity,
        min=0.0,
        max=2.0,
        soft_max=1.0,
        subtype="FACTOR",
        **OF_CHARACTER,
    )
    ground: BoolProperty(
        name="Ground",
        description="Keep parts above the ground that the character stands on at rest",
        default=_DEFAULT.ground,
        **OF_CHARACTER,
    )
    loop: BoolProperty(
        name="Loop",
        description="Where an action ends as it began, go over the seam without a jump",
        default=_DEFAULT.loop,
        **OF_CHARACTER,
    )
    overrides: CollectionProperty(
        type=MORPHRETARGET_PG_jiggle_override,
        name="Settings of Parts",
        description="Settings of kinds and bones of their own, in place of those above",
        override=OVERRIDABLE_LIST,
    )
    active_override: IntProperty(name="Active", description="Part that the buttons beside the list act on")

    def settings(self) -> JiggleSettings:
        """Return them as the core takes them."""
        own = [(item.kind, item.name, item.override()) for item in self.overrides]
        return JiggleSettings(
            half_life=self.half_life,
            stiffness=self.stiffness,
            amount=self.amount,
            gravity=self.gravity,
            ground=self.ground,
            loop=self.loop,
            kinds={JiggleKind(kind): override for kind, _, override in own if kind != BONE},
            bones={name: override for kind, name, override in own if kind == BONE},
        )

    def add(self, kind: str, bone: str = "") -> MORPHRETARGET_PG_jiggle_override:
        """Return settings for a kind, or a bone, with the values that it has by default; made if there are none."""
        for item in self.overrides:
            if item.kind == kind and (kind != BONE or item.name == bone):
                return item
        item = self.overrides.add()
        item.name = bone if kind == BONE else kind.title()
        item.kind = kind
        if kind != BONE:
            manner = MANNERS[JiggleKind(kind)]
            item.half_life = self.half_life * manner.half_life
            item.stiffness = self.stiffness * manner.stiffness
            item.amount = self.amount * manner.amount
        self.active_override = len(self.overrides) - 1
        tell_character(self)
        return item

    def remove(self, place: int) -> None:
        """Remove the settings of one part."""
        self.overrides.remove(place)
        self.active_override = min(place, len(self.overrides) - 1)
        tell_character(self)


class Jiggler:
    """What a character has for its jiggles; part of the rig's own group."""

    jiggles: PointerProperty(
        type=MORPHRETARGET_PG_jiggles,
        name="Jiggles",
        description="How the loose parts of this character follow",
        override=OVERRIDABLE,
    )


CLASSES = (MORPHRETARGET_PG_jiggle_override, MORPHRETARGET_PG_jiggles)
