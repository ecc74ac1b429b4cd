"""What the whole body does: jump, sit and dance."""

from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.branch import Answer, Branch
from morph_retarget.core.morph.channels import Channel, MirrorRule
from morph_retarget.core.morph.context import Context, Extent, Side
from morph_retarget.core.morph.movement import Movement, ScaleMode

from ..acting import Act, Track, Vector
from .tracks import REST, ears, feet, graspers, head, limb, mouths, neck, root, spine, tail, wings


def jump() -> Act:
    """Leap on the spot: the hips crouch by their height and rise by the size of the creature; the feet let go."""
    low, off, top, down = 16, 23, 31, 39
    leap = {f: (0.0, 0.0, 0.07 + 0.23 * (1.0 - ((f - top) / (top - off)) ** 2)) for f in (*range(off, down, 2), down)}
    rising = Channel(
        "Leap",
        Context(Capability.ROOT),
        Movement(scale=ScaleMode.CREATURE_SIZE),
        poses_rotation=False,
        blend_group="root",
    )
    crouch = Channel("Root", Context(Capability.ROOT), limb(ground_relative=True), blend_group="root")
    grounded = {1: 1.0, off - 2: 1.0, off + 3: 0.0, down - 3: 0.0, down + 1: 1.0}
    return Act(
        "Jump",
        66,
        (
            feet(grounded),
            *tail(
                {
                    1: REST,
                    low: (12, 0, 0),
                    off + 2: (-10, 0, 0),
                    top: (4, 0, 0),
                    down: (14, 0, 0),
                    46: (-8, 0, 0),
                    60: REST,
                },
                {
                    1: REST,
                    low + 3: (22, 0, 0),
                    off + 5: (-20, 0, 0),
                    top + 4: (8, 0, 0),
                    down + 4: (24, 0, 0),
                    50: (-10, 0, 0),
                    64: REST,
                },
            ),
            mouths({1: 0.0, off - 2: 0.0, off + 2: 0.6, down - 2: 0.5, down + 2: 0.0}),
            Track(
                crouch,
                {
                    1: REST,
                    low: (0, 0.5, 0.23),
                    low + 2: (0, 0.5, 0.24),
                    off: (0, -0.1, -0.12),
                    down: (0, 0, -0.1),
                    45: (0, 0.45, 0.22),
                    57: (0, 0, -0.02),
                    66: REST,
                },
                {1: REST, low: (8, 0, 0), off: (-4, 0, 0), down: (2, 0, 0), 45: (6, 0, 0), 58: REST},
                {1: 1.0, off - 1: 1.0, off + 1: 0.0, down - 1: 0.0, down + 1: 1.0},
            ),
            Track(rising, leap, weight={1: 0.0, off - 1: 0.0, off + 1: 1.0, down - 1: 1.0, down + 1: 0.0}),
            spine(
                {
                    1: REST,
                    low: (12, 0, 0),
                    off: (-6, 0, 0),
                    top: (4, 0, 0),
                    down: (4, 0, 0),
                    46: (12, 0, 0),
                    59: (-2, 0, 0),
                    66: REST,
                }
            ),
            head(
                {
                    1: REST,
                    low: (8, 0, 0),
                    off + 1: (-12, 0, 0),
                    top + 2: (4, 0, 0),
                    down + 1: (6, 0, 0),
                    47: (16, 0, 0),
                    60: (-3, 0, 0),
                    66: REST,
                }
            ),
            ears(
                {
                    1: REST,
                    low: (-10, 0, 0),
                    off + 3: (24, 0, 0),
                    top: (0, 0, 0),
                    down: (-26, 0, 0),
                    46: (16, 0, 0),
                    60: REST,
                }
            ),
            wings(
                {
                    1: REST,
                    low: (0, -30, 0),
                    off: (0, 34, 0),
                    off + 5: (0, -26, 0),
                    top: (0, 26, 0),
                    down - 3: (0, -24, 0),
                    46: (0, 10, 0),
                    60: REST,
                }
            ),
            graspers(
                {
                    1: REST,
                    low: (0.0, 0.3, -0.3),
                    off + 1: (-0.1, -0.3, 0.75),
                    top: (-0.06, -0.2, 0.95),
                    down: (-0.04, -0.25, 0.35),
                    46: (0.0, -0.1, -0.25),
                    58: (0, 0, 0.03),
                    66: REST,
                }
            ),
        ),
        {"take off": off, "land": down},
    )


def sit() -> Act:
    """Sit down as on a chair, half as high as the hips; the trunk leans ahead on the way, the hands come to rest."""
    return Act(
        "Sit",
        78,
        (
            feet(),
            *tail(
                {1: REST, 26: (16, 0, 0), 52: (16, 0, 0), 74: REST}, {1: REST, 30: (26, 0, 0), 54: (22, 0, 0), 78: REST}
            ),
            mouths(),
            root(
                {
                    1: REST,
                    6: (0, -0.1, -0.01),
                    26: (0, 2.0, 0.44),
                    30: (0, 2.0, 0.42),
                    34: (0, 2.0, 0.43),
                    52: (0, 2.0, 0.43),
                    76: REST,
                },
                {1: REST, 18: (16, 0, 0), 32: (-4, 0, 0), 52: (0, 0, 0), 62: (16, 0, 0), 76: REST},
            ),
            spine(
                {
                    1: REST,
                    6: (-2, 0, 0),
                    18: (32, 0, 0),
                    31: (-3, 0, 0),
                    36: (2, 0, 0),
                    50: (2, 0, 0),
                    62: (34, 0, 0),
                    76: (-1, 0, 0),
                    78: REST,
                }
            ),
            head({1: REST, 16: (14, 0, 0), 34: (-3, 0, 0), 40: (2, 0, 0), 50: (2, 0, 0), 62: (16, 0, 0), 78: REST}),
            wings({1: REST, 18: (0, -16, 0), 34: (0, 6, 0), 52: (0, 6, 0), 62: (0, -12, 0), 78: REST}),
            graspers(
                {
                    1: REST,
                    18: (0.3, -0.3, 0.2),
                    33: (0.55, -0.22, 0.42),
                    52: (0.55, -0.22, 0.42),
                    62: (0.35, -0.3, 0.25),
                    78: REST,
                },
                limb(ground_relative=True, sagittal_relative=True),
            ),
        ),
        {"seated": 30},
        movement="Sit",
        branch=Branch(upright_spine=Answer.TRUE),
    )


def sit_on_haunches() -> Act:
    """Lower the hips of a prone body, and leave its front where it is."""
    front = Channel(
        "Chest", Context(Capability.SPINE, extent=Extent.FRONT_MOST), limb(ground_relative=True), poses_rotation=False
    )
    return Act(
        "Sit on Haunches",
        78,
        (
            feet(),
            *tail(
                {1: REST, 30: (-10, 0, 0), 38: (-10, 0, 8), 46: (-10, 0, -8), 54: (-10, 0, 4), 74: REST},
                {1: REST, 32: (-8, 0, 10), 42: (-8, 0, -16), 50: (-8, 0, 16), 78: REST},
            ),
            mouths({1: 0.0, 34: 0.0, 40: 0.4, 52: 0.4, 60: 0.0}),
            root(
                {1: REST, 6: (0, 0.1, -0.02), 26: (0, -1.0, 0.5), 30: (0, -1.0, 0.47), 52: (0, -1.0, 0.48), 74: REST},
                {1: REST, 26: (-20, 0, 0), 52: (-20, 0, 0), 74: REST},
            ),
            Track(
                front,
                {1: REST, 8: (0, 0, 0.04), 28: (0, 0.4, -0.06), 34: (0, 0.4, -0.04), 52: (0, 0.4, -0.04), 76: REST},
            ),
            neck({1: REST, 8: (6, 0, 0), 30: (-8, 0, 0), 52: (-8, 0, 0), 76: REST}),
            head({1: REST, 10: (8, 0, 0), 32: (-4, 0, 0), 38: (0, 8, 0), 46: (0, 8, 0), 54: REST, 78: REST}),
            ears({1: REST, 28: (14, 0, 0), 34: (-4, 0, 0), 60: (10, 0, 0), 72: REST}),
            wings({1: REST, 20: (0, -8, 0), 32: (0, 4, 0), 52: (0, 2, 0), 64: (0, -8, 0), 76: REST}),
        ),
        {"seated": 28},
        movement="Sit",
        branch=Branch(upright_spine=Answer.FALSE),
    )


def dance() -> Act:
    """Sway on the spot, over and over: from the hips outward everything follows later and farther."""
    pump = (0.06, -0.1, 0.22)
    sway = (0.0, 0.75, 1.0, 0.75, 0.0, -0.75, -1.0, -0.75, 0.0)
    swaying = {
        frame: (0.76 * x, y, z)
        for x, (frame, (_, y, z)) in zip(sway, _bounce((0, 0, 0.06), 0, (0, 0, 0.12)).items(), strict=True)
    }
    hands = [
        Track(
            Channel(
                f"{own.value.title()} Graspers",
                Context(Capability.GRASPER, side=own),
                limb(),
                poses_rotation=False,
                mirror=MirrorRule.LEFT,
            ),
            _swing(pump, late, (-0.2, -0.32, 0.28)),
        )
        for own, late in ((Side.LEFT, 4), (Side.RIGHT, 4 + 2 * _BEAT))
    ]
    return Act(
        "Dance",
        1 + 4 * _BEAT,
        (
            feet(),
            *tail(_swing((0, 0, -16), 4), _swing((0, 4, -30), 10)),
            mouths({frame: place[0] for frame, place in _bounce((0.3, 0, 0), 4, (0.3, 0, 0)).items()}),
            root(swaying, _swing((0, 7, -5), 0)),
            spine(_swing((0, -9, 6), 3, (3, 0, 0))),
            neck(_swing((0, 8, 5), 6)),
            head(_swing((4, 12, 6), 8, (2, 0, 0))),
            ears(_swing((10, 8, 0), 11)),
            wings(_bounce((0, -22, 0), 3, (0, -14, 0))),
            *hands,
        ),
        cyclic=True,
    )


_BEAT = 16
"""Frames from one side to the middle, and on to the other."""


def _swing(size: Vector, late: int, middle: Vector = REST) -> dict[int, Vector]:
    """Return keys of a swing to the left and to the right."""
    way = (0.0, 1.0, 0.0, -1.0, 0.0)
    return {1 + late + i * _BEAT: _sum(middle, size, way[i]) for i in range(5)}


def _bounce(size: Vector, late: int, middle: Vector = REST) -> dict[int, Vector]:
    """Return keys of a movement up and down on every beat."""
    return {1 + late + i * _BEAT // 2: _sum(middle, size, (1.0, -1.0)[i % 2]) for i in range(9)}


def _sum(a: Vector, b: Vector, share: float) -> Vector:
    return a[0] + share * b[0], a[1] + share * b[1], a[2] + share * b[2]
