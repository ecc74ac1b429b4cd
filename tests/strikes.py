"""When feet touch down in real clips, as read by eye.

Each clip was drawn as strips: for every foot its side view at each frame, the height of its joints over time and their
speed along and up. A strike is where the first of heel, ball or paw comes to rest on the ground: the kink at the end of
its forward swing where mocap rolls over a heel, the end of its descent where animators keyed a foot that then slides
back under a body on the spot. Frames were read to about half a frame, before any of them was looked for by program, and
are those of `character_model.RATE` from the first frame of the clip; in cycles the frame after the last is the first.
Feet are in the order of `CharacterModel.feet`: left, right, and for four feet the front ones first.

In `cmu_01_01` and `cmu_09_11` the first frame is a T-pose and counts for nothing. Feet that turn on the spot without
being lifted do not strike.
"""

from collections.abc import Sequence
from dataclasses import dataclass

LEFT, RIGHT = 0, 1
FRONT_LEFT, FRONT_RIGHT, BACK_LEFT, BACK_RIGHT = 0, 1, 2, 3


@dataclass(frozen=True)
class Read:
    """The strikes of a clip."""

    path: str
    """Within the folder of real rigs and clips."""
    action: str
    """How the name of its action ends."""
    kind: str
    """What it shows."""
    strikes: Sequence[tuple[int, float]]
    """Foot and frame."""


READ: Sequence[Read] = (
    Read(
        "mocap/cmu_02_01_walk.bvh",
        "cmu_02_01_walk",
        "walk",
        [(LEFT, 1.0), (RIGHT, 18.2), (LEFT, 34.8), (RIGHT, 51.3), (LEFT, 67.5), (RIGHT, 83.8)],
    ),
    Read(
        "mocap/cmu_02_01_walk_reallusion.bvh",
        "cmu_02_01_walk_reallusion",
        "walk",
        [(LEFT, 0.8), (RIGHT, 17.9), (LEFT, 34.8), (RIGHT, 51.3), (LEFT, 67.0), (RIGHT, 84.0)],
    ),
    Read(
        "mocap/cmu_02_03_run_reallusion.bvh",
        "cmu_02_03_run_reallusion",
        "run",
        [(RIGHT, 1.3), (LEFT, 12.8), (RIGHT, 24.8), (LEFT, 36.3)],
    ),
    Read("mocap/cmu_09_11_run.fbx", "09_11", "run", [(LEFT, 1.7), (RIGHT, 13.4), (LEFT, 24.9), (RIGHT, 36.6)]),
    Read(
        "mocap/cmu_01_01_forward_jumps_turn.bvh",
        "cmu_01_01_forward_jumps_turn",
        "jump",
        [
            *((LEFT, 68.5), (RIGHT, 68.3), (LEFT, 117.6), (RIGHT, 117.6), (LEFT, 160.9), (RIGHT, 160.4)),
            *((LEFT, 208.8), (RIGHT, 208.5)),
            *((RIGHT, 268.6), (LEFT, 279.5), (RIGHT, 293.0)),
            *((LEFT, 334.2), (RIGHT, 334.2), (LEFT, 398.5), (RIGHT, 398.2), (LEFT, 456.7), (RIGHT, 456.4)),
            *((RIGHT, 504.5), (LEFT, 518.8)),
            *((LEFT, 565.4), (RIGHT, 565.0), (LEFT, 620.3), (RIGHT, 619.9), (LEFT, 670.8), (RIGHT, 670.5)),
        ],
    ),
    Read(
        "mocap/fair1_jumping.bvh", "fair1_jumping", "jump", [(LEFT, 85.2), (RIGHT, 85.4), (RIGHT, 98.5), (LEFT, 105.3)]
    ),
    Read(
        "rigs/quaternius_wolf.glb",
        "|Walk",
        "walk",
        [(FRONT_LEFT, 30.9), (FRONT_RIGHT, 17.0), (BACK_LEFT, 25.7), (BACK_RIGHT, 10.0)],
    ),
    Read(
        "rigs/quaternius_wolf.glb",
        "|Gallop",
        "run",
        [(FRONT_LEFT, 17.3), (FRONT_RIGHT, 3.4), (BACK_LEFT, 8.6), (BACK_RIGHT, 10.4)],
    ),
    Read(
        "rigs/quaternius_wolf.glb",
        "|Gallop_Jump",
        "jump",
        [(FRONT_RIGHT, 3.4), (BACK_LEFT, 12.0), (BACK_RIGHT, 12.0)],
    ),
    Read(
        "rigs/quaternius_wolf.glb",
        "|Jump_ToIdle",
        "jump",
        [
            *((FRONT_RIGHT, 3.5), (BACK_LEFT, 12.0), (BACK_RIGHT, 12.0)),
            *((FRONT_LEFT, 28.0), (FRONT_RIGHT, 28.1), (BACK_LEFT, 31.2), (BACK_RIGHT, 31.2)),
        ],
    ),
    Read(
        "rigs/khronos_fox.glb",
        "Walk",
        "walk",
        [(FRONT_LEFT, 1.0), (FRONT_RIGHT, 11.3), (BACK_LEFT, 16.0), (BACK_RIGHT, 2.3)],
    ),
    Read(
        "rigs/khronos_fox.glb",
        "Run",
        "run",
        [(FRONT_LEFT, 17.7), (FRONT_RIGHT, 13.6), (BACK_LEFT, 0.3), (BACK_RIGHT, 3.9)],
    ),
    Read(
        "rigs/m2m_fox_anim.glb",
        "Walk",
        "walk",
        [(FRONT_LEFT, 21.7), (FRONT_RIGHT, 12.0), (BACK_LEFT, 21.0), (BACK_RIGHT, 3.9)],
    ),
    Read("rigs/m2m_fox_anim.glb", "Run", "run", [(FRONT_RIGHT, 1.2), (BACK_LEFT, 8.8), (BACK_RIGHT, 6.9)]),
    Read(
        "rigs/m2m_fox_anim.glb",
        "Sneak",
        "walk",
        [(FRONT_LEFT, 28.8), (FRONT_RIGHT, 8.5), (BACK_LEFT, 23.3), (BACK_RIGHT, 4.8)],
    ),
    Read(
        "rigs/m2m_fox_anim.glb",
        "Jump",
        "jump",
        [(FRONT_LEFT, 40.8), (FRONT_RIGHT, 40.8), (BACK_LEFT, 46.9), (BACK_RIGHT, 46.9)],
    ),
    Read("rigs/kaykit_knight.glb", "Walking_A", "walk", [(LEFT, 31.6), (RIGHT, 15.6)]),
    Read("rigs/kaykit_knight.glb", "Walking_B", "walk", [(LEFT, 31.6), (RIGHT, 15.6)]),
    Read("rigs/kaykit_knight.glb", "Walking_C", "walk", [(LEFT, 47.2), (RIGHT, 23.2)]),
    Read("rigs/kaykit_knight.glb", "Walking_Backwards", "walk", [(LEFT, 17.8), (RIGHT, 2.5)]),
    Read("rigs/kaykit_knight.glb", "Running_A", "run", [(LEFT, 4.0), (RIGHT, 16.0)]),
    Read("rigs/kaykit_knight.glb", "Running_B", "run", [(LEFT, 2.8), (RIGHT, 18.8)]),
    Read("rigs/kaykit_knight.glb", "Running_Strafe_Left", "run", [(LEFT, 3.8), (RIGHT, 16.0)]),
    Read("rigs/kaykit_knight.glb", "Running_Strafe_Right", "run", [(LEFT, 4.0), (RIGHT, 15.8)]),
    Read("rigs/kaykit_knight.glb", "Jump_Full_Long", "jump", [(LEFT, 57.2), (RIGHT, 55.6)]),
    Read("rigs/kaykit_knight.glb", "Jump_Full_Short", "jump", [(LEFT, 22.2), (RIGHT, 20.6)]),
    Read("rigs/kaykit_knight.glb", "Jump_Land", "jump", [(LEFT, 7.2), (RIGHT, 5.6)]),
    Read("rigs/kaykit_anim_movement_advanced.glb", "Sneaking", "walk", [(LEFT, 11.9), (RIGHT, 43.9)]),
    Read("rigs/kaykit_anim_movement_advanced.glb", "Running_HoldingBow", "run", [(LEFT, 6.0), (RIGHT, 18.0)]),
)
