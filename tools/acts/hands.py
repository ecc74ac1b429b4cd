"""What hands and mouths do: clap, lick and pick up."""

from dataclasses import replace

from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.branch import Answer, Branch
from morph_retarget.core.morph.channels import Channel, MirrorRule, TargetKind
from morph_retarget.core.morph.context import Context, Extent

from ..acting import Act, Track, Vector
from .tracks import (
    FIRST,
    FRONT_FEET,
    HANDED,
    MOUTH,
    REST,
    WITH_VARIANT,
    Keys,
    ears,
    facing,
    feet,
    graspers,
    head,
    limb,
    mouths,
    neck,
    palms,
    root,
    spine,
    tail,
    wings,
)


def clap() -> Act:
    """Bring what is left and right together on the plane of symmetry: hands, and jaws that bite sideways."""
    apart, claps = 0.62, (20, 30, 40)
    meet: dict[int, Vector] = {}
    for frame in claps:
        meet |= {frame: (0.95, -0.44, 0.1), frame + 1: (0.95, -0.44, 0.1), frame + 6: (apart, -0.4, 0.13)}
    return Act(
        "Clap",
        66,
        (
            feet(),
            *tail(
                {1: REST, 22: (0, 0, 8), 32: (0, 0, -8), 42: (0, 0, 8), 60: REST},
                {1: REST, 26: (0, 0, 16), 36: (0, 0, -16), 46: (0, 0, 16), 66: REST},
            ),
            root(
                {
                    1: REST,
                    8: (0, 0, -0.01),
                    20: (0, 0, 0.03),
                    26: REST,
                    30: (0, 0, 0.03),
                    36: REST,
                    40: (0, 0, 0.03),
                    47: REST,
                }
            ),
            spine(
                {
                    1: REST,
                    10: (-3, 0, 0),
                    21: (4, 0, 0),
                    26: (0, 0, 0),
                    31: (4, 0, 0),
                    36: (0, 0, 0),
                    41: (4, 0, 0),
                    60: REST,
                }
            ),
            palms(
                {1: facing((0.1, -1.0, 0.45), (1.0, 0.1, 0.1))},
                {1: 0.0, 4: 0.0, 16: 1.0, 46: 1.0, 60: 0.0},
            ),
            mouths({1: 0.0, 12: 0.5, 20: 0.0, 25: 0.5, 30: 0.0, 35: 0.5, 40: 0.0, 50: 0.5, 60: 0.0}),
            wings(
                {
                    1: REST,
                    12: (0, 14, 0),
                    20: (0, -62, 0),
                    26: (0, -36, 0),
                    30: (0, -62, 0),
                    36: (0, -36, 0),
                    40: (0, -62, 0),
                    48: (0, -30, 0),
                    66: REST,
                }
            ),
            graspers(
                {1: REST, 7: (-0.05, 0.04, -0.02), 15: (apart - 0.1, -0.4, 0.15)} | meet | {64: REST},
                limb(sagittal_relative=True),
            ),
        ),
        {f"clap {i + 1}": frame for i, frame in enumerate(claps)},
    )


def _to_mouth(position: Keys, capability: Capability, **more: object) -> Track:
    """Return something that is carried to its own mouth."""
    movement = limb(secondary_relative=True)
    channel = Channel(
        "To Mouth",
        Context(capability),
        movement,
        TargetKind.CONTEXT,
        MOUTH,
        poses_rotation=False,
        varies=True,
        mirror=MirrorRule.LEFT,
        **more,
    )
    return Track(channel, position)


def hand_to_mouth() -> Act:
    """Put one hand to the mouth, in front of it, wherever both are."""
    return Act(
        "Hand to Mouth",
        66,
        (
            feet(),
            *tail(),
            mouths({1: 0.0, 12: 0.1, 22: 0.9, 28: 0.1, 33: 0.5, 38: 0.1, 43: 0.4, 48: 0.0}),
            root({1: REST, 6: (0.1, 0, 0.01), 20: (-0.2, 0, 0.01), 44: (-0.2, 0, 0.01), 64: REST}, mirror=WITH_VARIANT),
            spine({1: REST, 7: (-2, 0, 0), 21: (3, -2, 3), 46: (3, -2, 3), 66: REST}, mirror=WITH_VARIANT),
            head(
                {
                    1: REST,
                    9: (-4, 0, 0),
                    22: (10, 3, 6),
                    28: (6, 3, 6),
                    33: (10, 3, 6),
                    38: (6, 3, 6),
                    46: (8, 3, 6),
                    66: REST,
                },
                mirror=WITH_VARIANT,
            ),
            _to_mouth(
                {
                    1: REST,
                    6: (-0.05, 0, -0.03),
                    15: (0.6, 0.3, 0.0),
                    22: (0.92, 0.13, -0.03),
                    46: (0.92, 0.13, -0.03),
                    54: (0.5, 0.25, 0.0),
                    66: REST,
                },
                Capability.GRASPER,
            ),
        ),
        {"bite": 24},
        movement="Hand to Mouth",
        branch=replace(HANDED, has_mouth=Answer.TRUE),
    )


def paw_to_mouth() -> Act:
    """Lick one of the foremost feet: it comes up, and the head comes down to it."""
    movement = limb(secondary_relative=True)
    paw = Channel(
        "Paw to Mouth",
        FRONT_FEET,
        movement,
        TargetKind.CONTEXT,
        MOUTH,
        poses_rotation=False,
        priority=FIRST,
        varies=True,
        mirror=MirrorRule.LEFT,
    )
    licks = {26: 0.0, 31: 0.9, 36: 0.1, 41: 0.9, 46: 0.1, 51: 0.0}
    return Act(
        "Paw to Mouth",
        72,
        (
            Track(
                paw,
                {
                    1: REST,
                    6: (-0.02, 0, 0),
                    22: (0.72, 0.05, 0),
                    31: (0.77, 0.02, 0),
                    36: (0.72, 0.02, 0),
                    41: (0.77, 0.02, 0),
                    50: (0.72, 0.02, 0),
                    68: REST,
                },
            ),
            feet(),
            mouths({1: 0.0} | licks),
            root(
                {1: REST, 5: (0.2, -0.2, 0.02), 18: (-0.4, 0.6, 0.05), 52: (-0.4, 0.6, 0.05), 72: REST},
                mirror=WITH_VARIANT,
            ),
            *tail(tip={1: REST, 24: (0, 0, 10), 38: (0, 0, -10), 52: (0, 0, 6), 68: REST}),
            neck({1: REST, 7: (-5, 0, 0), 22: (26, 0, 10), 52: (26, 0, 10), 70: REST}, mirror=WITH_VARIANT),
            head(
                {
                    1: REST,
                    8: (-6, 0, 0),
                    24: (40, 0, 14),
                    31: (34, 0, 14),
                    36: (42, 0, 14),
                    41: (34, 0, 14),
                    52: (40, 0, 14),
                    72: REST,
                },
                mirror=WITH_VARIANT,
            ),
        ),
        movement="Hand to Mouth",
        branch=Branch(has_mouth=Answer.TRUE),
    )


def pick_up_by_hand() -> Act:
    """Squat and bend down to the ground with all hands, and bring something up in front of the body."""
    return Act(
        "Pick Up by Hand",
        90,
        (
            feet(),
            *tail(
                {1: REST, 26: (10, 0, 0), 40: (10, 0, 0), 66: REST}, {1: REST, 30: (20, 0, 0), 44: (20, 0, 0), 70: REST}
            ),
            mouths({1: 0.0, 36: 0.0, 42: 0.3, 56: 0.0}),
            root(
                {
                    1: REST,
                    6: (0, -0.1, -0.02),
                    26: (0, 1.1, 0.45),
                    34: (0, 1.1, 0.46),
                    52: (0, 0.15, 0.02),
                    72: (0, 0.1, 0.02),
                    90: REST,
                },
                {1: REST, 26: (28, 0, 0), 34: (28, 0, 0), 52: (-2, 0, 0), 90: REST},
            ),
            spine({1: REST, 7: (-3, 0, 0), 28: (68, 0, 0), 34: (70, 0, 0), 55: (-5, 0, 0), 72: (-3, 0, 0), 90: REST}),
            head({1: REST, 5: (12, 0, 0), 28: (44, 0, 0), 36: (46, 0, 0), 56: (16, 0, 0), 72: (14, 0, 0), 88: REST}),
            graspers(
                {
                    1: REST,
                    7: (-0.05, 0.03, -0.05),
                    20: (0.5, -0.42, 0.45),
                    29: (0.5, -0.5, 0.84),
                    35: (0.52, -0.5, 0.84),
                    52: (0.68, -0.42, -0.02),
                    58: (0.68, -0.4, 0.03),
                    72: (0.68, -0.4, 0.02),
                    84: (0.1, -0.05, 0.02),
                    90: REST,
                },
                limb(ground_relative=True, sagittal_relative=True),
                {1: 0.0, 28: 0.0, 35: 0.9, 72: 0.9, 80: 0.0},
            ),
        ),
        {"grab": 34, "put away": 74},
        movement="Pick Up",
        branch=HANDED,
    )


def pick_up_by_mouth() -> Act:
    """Lower the front of the trunk by a share of its height, and the mouth to the ground."""
    chest = Context(Capability.SPINE, extent=Extent.FRONT_MOST)
    low = Channel("Chest", chest, limb(ground_relative=True), poses_rotation=False)
    mouth = Channel("Bite", MOUTH, limb(ground_relative=True), poses_rotation=False)
    return Act(
        "Pick Up by Mouth",
        78,
        (
            feet(),
            *tail(
                {1: REST, 24: (14, 0, 0), 38: (14, 0, 0), 60: REST},
                {1: REST, 28: (24, 0, 0), 42: (24, 0, 0), 66: (-6, 0, 0), 78: REST},
            ),
            root({1: REST, 6: (0, 0.2, -0.02), 24: (0, 0.2, 0.21), 36: (0, 0.2, 0.21), 54: REST}),
            Track(
                low,
                {1: REST, 7: (0, 0.1, -0.03), 25: (0, 0.35, 0.38), 36: (0, 0.35, 0.38), 56: (0, 0, -0.02), 64: REST},
            ),
            Track(
                mouth,
                {
                    1: REST,
                    8: (0, 0.15, -0.08),
                    20: (0, -0.15, 0.6),
                    28: (0, -0.1, 0.86),
                    36: (0, -0.1, 0.86),
                    54: (0, -0.08, -0.12),
                    60: (0, -0.02, -0.06),
                    78: REST,
                },
                deforms={"open": {1: 0.0, 14: 0.0, 24: 1.0, 29: 1.0, 35: 0.25, 60: 0.25, 72: 0.0}},
            ),
            ears({1: REST, 30: (18, 0, 0), 40: (8, 0, 0), 54: (-12, 0, 0), 66: REST}),
            wings({1: REST, 24: (0, -14, 0), 38: (0, -14, 0), 56: (0, 8, 0), 70: REST}),
        ),
        {"grab": 34},
        movement="Pick Up",
        branch=Branch(has_mouth=Answer.TRUE),
    )
