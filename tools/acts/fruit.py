"""What is done to the target: take it and eat it, or strike at it."""

from morph_retarget.core.morph.channels import Channel, MirrorRule, TargetKind

from ..acting import Act, Track
from .tracks import (
    GRASPER,
    MOUTH,
    REST,
    WITH_VARIANT,
    eyes,
    feet,
    limb,
    root,
    tail,
    trunk,
)


def eat_fruit() -> Act:
    """Take the target and put it into the mouth, in one movement: the weights of two channels cross."""
    one: dict[str, object] = {
        "poses_rotation": False,
        "blend_group": "hand",
        "varies": True,
        "variant_group": "hand",
        "mirror": MirrorRule.LEFT,
    }
    reach = Channel("Reach", GRASPER, limb(secondary_relative=True), TargetKind.EXTERNAL, **one)
    bring = Channel("To Mouth", GRASPER, limb(secondary_relative=True), TargetKind.CONTEXT, MOUTH, **one)
    return Act(
        "Eat Fruit",
        102,
        (
            feet(),
            *tail(
                {1: REST, 26: (0, 0, 8), 44: (0, 0, -8), 62: (0, 0, 8), 80: (0, 0, -4), 96: REST},
                {1: REST, 30: (0, 0, 16), 48: (0, 0, -16), 66: (0, 0, 16), 84: (0, 0, -8), 100: REST},
            ),
            eyes({1: 0.0, 6: 1.0, 40: 1.0, 52: 0.0}),
            Track(
                reach,
                {
                    1: REST,
                    7: (-0.06, 0.0, -0.04),
                    18: (0.75, 0.0, 0.08),
                    26: (1.0, 0, 0),
                    33: (1.0, 0, 0),
                    42: (0.94, 0, 0.02),
                },
                weight={1: 1.0, 33: 1.0, 50: 0.0},
                deforms={"closed": {1: 0.0, 24: 0.0, 31: 1.0, 102: 1.0}},
            ),
            Track(
                bring,
                {
                    1: (0.86, 0.2, -0.12),
                    54: (0.86, 0.2, -0.12),
                    57: (0.92, 0.11, -0.1),
                    62: (0.86, 0.2, -0.12),
                    72: (0.86, 0.2, -0.12),
                    84: (0.4, 0.1, 0),
                    102: REST,
                },
                weight={1: 0.0, 33: 0.0, 50: 1.0},
                deforms={"closed": {1: 1.0, 70: 1.0, 80: 0.0}},
            ),
            root({1: REST, 7: (0, 0.15, 0.02), 26: (0, -0.6, 0.02), 36: (0, -0.5, 0.02), 52: REST}),
            trunk({1: REST, 8: (-1, 0, 0), 27: (4, 0, 0), 36: (4, 0, 0), 54: (-1, 0, 0), 72: REST}),
            Track(
                Channel("Chewing", MOUTH, poses_position=False, poses_rotation=False),
                deforms={
                    "open": {
                        1: 0.0,
                        18: 0.0,
                        27: 0.3,
                        40: 0.3,
                        50: 1.0,
                        56: 1.0,
                        61: 0.1,
                        67: 0.5,
                        72: 0.05,
                        78: 0.45,
                        83: 0.05,
                        89: 0.35,
                        95: 0.0,
                    }
                },
            ),
        ),
        {"take": 30, "bite": 57},
    )


def punch() -> Act:
    """Strike toward the target; it turns with the target and keeps its size, however near that is."""
    channel = Channel(
        "Strike",
        GRASPER,
        limb(secondary_relative=True, directional_only=True),
        TargetKind.EXTERNAL,
        poses_rotation=False,
        varies=True,
        mirror=MirrorRule.LEFT,
    )
    return Act(
        "Punch",
        54,
        (
            feet(),
            *tail(tip={1: REST, 14: (0, 0, 10), 24: (0, 0, -22), 34: (0, 0, 8), 48: REST}),
            eyes({1: 0.0, 5: 1.0, 40: 1.0, 50: 0.0}),
            root(
                {1: REST, 14: (0, 0.5, 0.1), 19: (0, -0.5, 0.09), 24: (0, -0.5, 0.08), 34: (0, -0.25, 0.04), 54: REST},
                {1: REST, 14: (0, 0, 8), 19: (0, 0, -8), 24: (0, 0, -7), 54: REST},
                WITH_VARIANT,
            ),
            trunk(
                {1: REST, 15: (-3, 0, 18), 20: (8, 0, -22), 25: (6, 0, -20), 36: (2, 0, -8), 54: REST},
                mirror=WITH_VARIANT,
            ),
            Track(
                channel,
                {
                    1: REST,
                    12: (-0.2, 0.05, -0.02),
                    15: (-0.22, 0.04, -0.02),
                    19: (0.7, 0, 0),
                    20: (0.74, 0, 0),
                    25: (0.68, 0, 0),
                    38: (0.1, 0.05, -0.03),
                    54: REST,
                },
                deforms={"closed": {1: 0.0, 12: 1.0, 34: 1.0, 46: 0.0}},
            ),
        ),
        {"hit": 20},
    )
