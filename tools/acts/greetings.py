"""Greetings: waves, bows, nods and a handshake."""

from collections.abc import Mapping

import numpy as np

from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.branch import Answer, Branch
from morph_retarget.core.morph.channels import Channel, MirrorRule, TargetKind
from morph_retarget.core.morph.context import Context, Extent, Side
from morph_retarget.core.morph.movement import Movement

from ..acting import Act, Track, Vector
from .tracks import (
    FIRST,
    FRONT_FEET,
    GRASPER,
    HANDED,
    REST,
    WITH_VARIANT,
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


def wave_by_hand() -> Act:
    """Raise one hand and wave it: rest-relative by limb length, its fingers up whatever they rest like."""
    channel = Channel(
        "Hand", GRASPER, limb(), poses_rotation=False, varies=True, variant_group="hand", mirror=MirrorRule.LEFT
    )
    up = {1: REST, 6: (0.0, 0.02, -0.04), 12: (0.08, -0.3, 0.35), 18: (-0.24, -0.16, 0.82)}
    swings = {23: -0.15, 30: -0.38, 37: -0.15, 44: -0.38, 51: -0.22}
    sways = {8: 0.0, 18: 0.0, 26: 24.0, 33: -18.0, 40: 24.0, 47: -18.0, 54: 0.0}
    sideways = {frame: float(np.radians(angle)) for frame, angle in sways.items()}
    return Act(
        "Wave by Hand",
        72,
        (
            feet(),
            *tail(),
            mouths({1: 0.0, 14: 0.0, 20: 0.35, 50: 0.25, 60: 0.0}),
            root({1: REST, 6: (0.15, 0, 0.02), 19: (-0.5, 0, 0), 53: (-0.5, 0, 0), 72: REST}, mirror=WITH_VARIANT),
            spine({1: REST, 6: (2, 1, 0), 19: (-2, -4, -4), 53: (-2, -4, -4), 72: REST}, mirror=WITH_VARIANT),
            head({1: REST, 8: (5, 0, 3), 23: (-4, 8, 2), 54: (-4, 8, 2), 70: REST}, mirror=WITH_VARIANT),
            Track(
                channel,
                up
                | {frame: (x, -0.16, 0.78 + 0.05 * (i % 2)) for i, (frame, x) in enumerate(swings.items())}
                | {66: (-0.02, 0.02, -0.04), 72: REST},
            ),
            palms(
                {f: facing((np.sin(a), -0.1, np.cos(a)), (0.0, 1.0, 0.0)) for f, a in sideways.items()},
                {1: 0.0, 8: 0.0, 18: 1.0, 54: 1.0, 67: 0.0},
                "hand",
            ),
        ),
        movement="Wave",
        branch=HANDED,
    )


def wave_by_paw() -> Act:
    """Lift one of the foremost feet and wave it, or the tail where there are no feet."""
    paw = Channel(
        "Paw",
        FRONT_FEET,
        limb(ground_relative=True),
        poses_rotation=False,
        priority=FIRST,
        varies=True,
        mirror=MirrorRule.LEFT,
    )
    wags = {22: 0.12, 28: -0.08, 34: 0.12, 40: -0.08, 46: 0.02}
    return Act(
        "Wave by Paw",
        66,
        (
            Track(
                paw,
                {1: REST, 6: (0, 0.03, 0), 16: (0.0, -0.32, -1.7)}
                | {f: (x, -0.34, -1.7) for f, x in wags.items()}
                | {60: REST},
            ),
            feet(),
            mouths({1: 0.0, 16: 0.0, 22: 0.5, 44: 0.4, 54: 0.0}),
            root(
                {1: REST, 5: (0.2, -0.2, 0.03), 16: (-0.5, 0.5, 0.04), 48: (-0.5, 0.5, 0.04), 66: REST},
                mirror=WITH_VARIANT,
            ),
            *tail(
                {
                    1: REST,
                    12: (0, 0, -14),
                    20: (0, 0, 22),
                    28: (0, 0, -22),
                    36: (0, 0, 22),
                    44: (0, 0, -16),
                    52: (0, 0, 8),
                    62: REST,
                },
                {
                    1: REST,
                    15: (0, 0, -24),
                    23: (0, 0, 36),
                    31: (0, 0, -36),
                    39: (0, 0, 36),
                    47: (0, 0, -24),
                    55: (0, 0, 12),
                    66: REST,
                },
            ),
            spine({1: REST, 16: (-4, -2, -2), 48: (-4, -2, -2), 66: REST}, mirror=WITH_VARIANT),
            neck({1: REST, 7: (4, 0, 0), 19: (-8, 4, 3), 50: (-8, 4, 3), 66: REST}, mirror=WITH_VARIANT),
            head({1: REST, 9: (6, 0, 0), 22: (-2, 12, 4), 52: (-2, 12, 4), 66: REST}, mirror=WITH_VARIANT),
            ears({1: REST, 10: (-8, 0, 0), 20: (14, -10, 0), 26: (4, 0, 0), 50: (4, 0, 0), 62: REST}),
        ),
        movement="Wave",
        branch=Branch(has_wings=Answer.FALSE),
    )


def wave_by_wing() -> Act:
    """Spread the wings and flutter."""
    beats = {18: -40, 23: -8, 28: -46, 33: -8, 38: -46, 43: -10, 50: -30}
    return Act(
        "Wave by Wing",
        66,
        (
            feet(),
            mouths({1: 0.0, 16: 0.0, 22: 0.9, 30: 0.3, 36: 0.9, 50: 0.0}),
            root({1: REST, 6: (0, 0.2, 0.12), 16: (0, -0.1, -0.06), 48: (0, 0, -0.03), 66: REST}),
            wings({1: REST, 7: (0, 12, 0)} | {f: (-6, float(a), 0) for f, a in beats.items()} | {66: REST}),
            *tail(
                {1: REST, 8: (-8, 0, 0), 20: (14, 0, 0), 48: (10, 0, 0), 64: REST},
                {1: REST, 11: (-12, 0, 0), 24: (22, 0, 0), 50: (14, 0, 0), 66: REST},
            ),
            spine({1: REST, 6: (8, 0, 0), 16: (-10, 0, 0), 48: (-8, 0, 0), 66: REST}),
            neck({1: REST, 8: (10, 0, 0), 19: (-12, 0, 0), 50: (-8, 0, 0), 66: REST}),
            head({1: REST, 10: (12, 0, 0), 22: (-8, 8, 0), 30: (-4, -8, 0), 38: (-8, 8, 0), 52: REST}),
        ),
        movement="Wave",
        branch=Branch(has_wings=Answer.TRUE),
    )


def bow() -> Act:
    """Bend the trunk bit by bit from the hips up; the hands come to the sides, and the head is the last to follow."""
    return Act(
        "Bow",
        78,
        (
            feet(),
            *tail(
                {1: REST, 24: (6, 0, 0), 50: (6, 0, 0), 74: REST}, {1: REST, 28: (12, 0, 0), 54: (12, 0, 0), 78: REST}
            ),
            mouths(),
            root(
                {1: REST, 6: (0, -0.1, -0.01), 24: (0, 0.9, 0.03), 50: (0, 0.9, 0.03), 70: REST},
                {1: REST, 6: (-2, 0, 0), 24: (14, 0, 0), 50: (14, 0, 0), 70: REST},
            ),
            spine({1: REST, 7: (-4, 0, 0), 27: (34, 0, 0), 32: (32, 0, 0), 51: (32, 0, 0), 68: (-2, 0, 0), 74: REST}),
            neck({1: REST, 8: (-3, 0, 0), 29: (42, 0, 0), 52: (42, 0, 0), 70: (-3, 0, 0), 77: REST}),
            head({1: REST, 9: (-5, 0, 0), 31: (54, 0, 0), 35: (50, 0, 0), 53: (50, 0, 0), 72: (-4, 0, 0), 78: REST}),
            ears({1: REST, 32: (22, 0, 0), 38: (12, 0, 0), 54: (12, 0, 0), 70: (-8, 0, 0), 78: REST}),
            wings({1: REST, 22: (0, -8, 18), 48: (0, -8, 18), 70: REST}),
            graspers(
                {
                    1: REST,
                    20: (0.42, -0.16, 0.18),
                    28: (0.46, -0.3, 0.26),
                    50: (0.46, -0.3, 0.26),
                    70: (0.1, 0, 0.05),
                    78: REST,
                },
                limb(sagittal_relative=True, ground_relative=True),
            ),
        ),
        movement="Bow",
        branch=Branch(upright_spine=Answer.TRUE),
    )


def bow_on_all_fours() -> Act:
    """Stretch out the front on the ground: the chest sinks by a share of its height, so that none goes below."""
    front = Context(Capability.SPINE, extent=Extent.FRONT_MOST)
    chest = Channel("Chest", front, limb(ground_relative=True), poses_rotation=False)
    return Act(
        "Bow on All Fours",
        78,
        (
            feet(),
            *tail(
                {1: REST, 24: (6, 0, 0), 50: (6, 0, 0), 74: REST}, {1: REST, 28: (12, 0, 0), 54: (12, 0, 0), 78: REST}
            ),
            mouths({1: 0.0, 28: 0.0, 34: 0.3, 46: 0.3, 56: 0.0}),
            root(
                {1: REST, 6: (0, -0.1, -0.02), 24: (0, 0.8, 0.03), 50: (0, 0.8, 0.03), 70: REST},
                {1: REST, 6: (-2, 0, 0), 24: (10, 0, 0), 50: (10, 0, 0), 70: REST},
            ),
            Track(
                chest,
                {1: REST, 7: (0, 0, -0.04), 27: (0, 0.5, 0.45), 32: (0, 0.5, 0.42), 50: (0, 0.5, 0.42), 72: REST},
            ),
            neck({1: REST, 8: (-3, 0, 0), 29: (12, 0, 0), 52: (12, 0, 0), 70: (-3, 0, 0), 77: REST}),
            head({1: REST, 9: (-5, 0, 0), 31: (20, 0, 0), 35: (16, 0, 0), 53: (16, 0, 0), 72: (-4, 0, 0), 78: REST}),
            ears({1: REST, 32: (22, 0, 0), 38: (12, 0, 0), 54: (12, 0, 0), 70: (-8, 0, 0), 78: REST}),
        ),
        movement="Bow",
        branch=Branch(upright_spine=Answer.FALSE),
    )


def look_and_nod() -> Act:
    """Look at the target, wherever it is, and nod while doing so."""

    def gaze(name: str, capability: Capability, weight: float, nods: Mapping[int, float], late: int) -> Track:
        movement = Movement(look_at=True)
        channel = Channel(
            name, Context(capability), movement, TargetKind.EXTERNAL, poses_position=False, rotation_weight=weight
        )
        turn: dict[int, Vector] = {frame + late: (angle, 0.0, 0.0) for frame, angle in nods.items()}
        return Track(channel, turn=turn, weight={1: 0.0, 3 + late: 0.0, 14 + late: 1.0, 58 + late: 1.0, 69 + late: 0.0})

    nods = {18: 0.0, 22: -6.0, 27: 20.0, 33: -4.0, 38: 14.0, 44: -2.0, 49: 8.0, 55: 0.0}
    return Act(
        "Look and Nod",
        72,
        (
            feet(),
            gaze("Gaze", Capability.HEAD, 1.0, nods, 2),
            gaze("Neck Gaze", Capability.NECK, 0.5, {f: 0.5 * a for f, a in nods.items()}, 0),
            ears(
                {
                    1: REST,
                    10: (-6, 0, 0),
                    15: (16, -6, 0),
                    20: (8, 0, 0),
                    30: (20, 0, 0),
                    35: (4, 0, 0),
                    41: (14, 0, 0),
                    60: (4, 0, 0),
                    72: REST,
                }
            ),
            *tail(
                {1: REST, 22: (0, 0, 10), 34: (0, 0, -10), 46: (0, 0, 8), 58: (0, 0, -4), 68: REST},
                {1: REST, 26: (0, 0, 20), 38: (0, 0, -20), 50: (0, 0, 14), 62: (0, 0, -6), 72: REST},
            ),
        ),
    )


def shake_hands() -> Act:
    """Give the right hand to the partner's, half way between the two, and shake it."""
    channel = Channel(
        "Shake",
        Context(Capability.GRASPER, side=Side.RIGHT),
        limb(secondary_relative=True),
        TargetKind.EXTERNAL,
        poses_rotation=False,
        varies=True,
        variant_group="hand",
    )
    shakes = {25: 0.05, 29: -0.06, 33: 0.05, 37: -0.05, 41: 0.03, 46: 0.0}
    return Act(
        "Shake Hands",
        72,
        (
            feet(),
            *tail(),
            root({1: REST, 6: (0, 0.15, 0.01), 20: (0, -0.5, 0.01), 48: (0, -0.5, 0.01), 70: REST}),
            spine({1: REST, 7: (-2, 0, 0), 22: (7, 0, 4), 48: (7, 0, 4), 72: REST}),
            Track(
                channel,
                {1: REST, 6: (-0.04, 0, -0.03), 20: (0.51, 0.0, 0.0)}
                | {f: (0.51, 0, z) for f, z in shakes.items()}
                | {50: (0.51, 0, 0), 66: (0.02, 0, -0.03), 72: REST},
                deforms={"closed": {1: 0.0, 18: 0.0, 24: 0.6, 47: 0.6, 54: 0.0}},
            ),
        ),
        {"clasp": 22, "let go": 50},
    )
