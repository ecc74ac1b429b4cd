"""What armature objects keep of the solver: how it is tuned for the whole character, and for single limbs."""

from collections.abc import Container
from math import degrees, pi, radians
from typing import Any

import bpy
from bpy.props import CollectionProperty, FloatProperty, IntProperty, PointerProperty

from ...core.solve.limb_settings import LimbSettings
from ...core.solve.settings import DEFAULT, SolverSettings
from ..declaring import OVERRIDABLE, OVERRIDABLE_LIST, fixed
from .values import tell_character

SHARED = ("pull", "spine_start", "slow_down", "full_reach", "softness", "outer_iterations")
"""What a character has for all limbs, and single limbs of their own."""

_FIXED = fixed(tell_character)
"""Of all that is here: all frames of a clip are solved with the same settings."""


def _share(name: str, description: str, default: float, least: float = 0.0, most: float = 1.0) -> Any:
    return FloatProperty(
        name=name,
        description=description,
        default=default,
        min=least,
        max=most,
        precision=3,
        subtype="FACTOR",
        **_FIXED,
    )


def _count(name: str, description: str, default: int, least: int, most: int, soft: int) -> Any:
    return IntProperty(
        name=name,
        description=description,
        default=default,
        min=least,
        max=most,
        soft_max=soft,
        **_FIXED,
    )


def _angle(name: str, description: str, default: float, least: float) -> Any:
    return FloatProperty(
        name=name,
        description=description,
        default=radians(default),
        min=least,
        max=pi,
        step=100,
        subtype="ANGLE",
        **_FIXED,
    )


class _Tuned:
    """What tunes a limb; part of the groups of characters and of single limbs."""

    pull: _share(
        "Pull",
        "How much its goal counts among what bends the spine; at 0 the limb leaves the spine alone. Needs Bend Spine",
        DEFAULT.pull,
    )
    spine_start: _share(
        "Spine From",
        "Share of the limb's length from which on it pulls at the spine, or from where its end is at rest if that is "
        "further. Needs Bend Spine",
        DEFAULT.spine_start,
    )
    slow_down: _share(
        "Slow Down",
        "Share of the limb's length from which on it stretches out ever more slowly toward goals that are too far, or "
        "from where its end is at rest if that is further",
        DEFAULT.slow_down,
    )
    full_reach: _share(
        "Full Reach",
        "Share of its length to which the limb stretches out in the end, or to where its end is at rest",
        DEFAULT.full_reach,
        most=0.9999,
    )
    softness: _share(
        "Softness",
        "How much limbs of three and more bones keep of their own bend as they are folded and stretched",
        DEFAULT.softness,
        least=0.001,
    )
    outer_iterations: _count(
        "Iterations",
        "How often the shapes of limbs of three and more bones are worked over; fewer leave them more as they rest",
        DEFAULT.outer_iterations,
        0,
        100,
        20,
    )

    def shared(self: Any) -> dict[str, Any]:
        """Return what limbs are tuned by, as the core has it: Blender keeps fewer digits, so that 0.98 is another."""
        return {name: round(getattr(self, name), 6) for name in SHARED}


class MORPHRETARGET_PG_limb_solver(_Tuned, bpy.types.PropertyGroup):
    """How the solver is tuned for the limb that ends with the bone of the same name."""

    swivel: _angle(
        "Swivel",
        "Turn about the line from the limb's start to its end, which stay: knees and elbows go outward, where they "
        "cannot up or forward",
        LimbSettings().swivel,
        -pi,
    )

    def settings(self) -> LimbSettings:
        """Return them as the core takes them."""
        return LimbSettings(swivel=round(degrees(self.swivel), 4), **self.shared())


class MORPHRETARGET_PG_solver(_Tuned, bpy.types.PropertyGroup):
    """How the solver is tuned for a character."""

    twist: _angle("Twist", "Most that the spine twists for limbs. Needs Bend Spine", DEFAULT.twist, 0.0)
    anti_buckling: _share(
        "Unfold", "How hard a spine that folds over is pulled back to rest. Needs Bend Spine", DEFAULT.anti_buckling
    )
    spine_shrink: _share(
        "Least Length", "To what share of its length the spine bends together. Needs Bend Spine", DEFAULT.spine_shrink
    )
    refinements: _count(
        "Refinements",
        "How often the spine gives way once more to limbs that still cannot reach their goals. Needs Bend Spine",
        DEFAULT.refinements,
        0,
        20,
        5,
    )
    nudge: _share(
        "Nudge Root",
        "Most that limbs which hang on the root and cannot reach their goals move it, as a share of their length",
        DEFAULT.nudge,
    )
    footing: _share(
        "Lower Hips",
        "How far hips that sway aside come down, so that feet which stand do not slide",
        DEFAULT.footing,
    )
    margin: _share(
        "Clearance",
        "By how much further than touching limbs keep apart, as a share of their thickness. Needs Avoid Self-Collision",
        DEFAULT.margin,
    )
    most_swivel: _angle(
        "Most Swivel", "Most that a limb swivels out of the way. Needs Avoid Self-Collision", DEFAULT.most_swivel, 0.0
    )
    limbs: CollectionProperty(
        type=MORPHRETARGET_PG_limb_solver,
        name="Settings of Limbs",
        description="Settings of single limbs, in place of those of the character",
        override=OVERRIDABLE_LIST,
    )
    active_limb: IntProperty(name="Active", description="Limb that the buttons beside the list act on")

    def settings(self, bones: Container[str]) -> SolverSettings:
        """Return them as the core takes them, without those of limbs that are not among ``bones``."""
        return SolverSettings(
            twist=round(degrees(self.twist), 4),
            anti_buckling=round(self.anti_buckling, 6),
            spine_shrink=round(self.spine_shrink, 6),
            refinements=self.refinements,
            nudge=round(self.nudge, 6),
            footing=round(self.footing, 6),
            margin=round(self.margin, 6),
            most_swivel=round(degrees(self.most_swivel), 4),
            limbs={item.name: item.settings() for item in self.limbs if item.name in bones},
            **self.shared(),
        )

    def lost(self, bones: Container[str]) -> list[str]:
        """Return the limbs that have settings and are not among ``bones``."""
        return [item.name for item in self.limbs if item.name not in bones]

    def add(self, bone: str) -> MORPHRETARGET_PG_limb_solver:
        """Return the settings of the limb that ends with a bone; made, as the character has them, if there are none."""
        found = self.limbs.get(bone)
        if found is not None:
            return found
        item = self.limbs.add()
        item.name = bone
        for name in SHARED:
            setattr(item, name, getattr(self, name))
        self.active_limb = len(self.limbs) - 1
        tell_character(self)
        return item

    def remove(self, place: int) -> None:
        """Remove the settings of one limb."""
        self.limbs.remove(place)
        self.active_limb = min(place, len(self.limbs) - 1)
        tell_character(self)


class Solved:
    """What a character has for the solver; part of the rig's own group."""

    solver: PointerProperty(
        type=MORPHRETARGET_PG_solver,
        name="Solver",
        description="How goals become poses on this character",
        override=OVERRIDABLE,
    )


CLASSES = (MORPHRETARGET_PG_limb_solver, MORPHRETARGET_PG_solver)
