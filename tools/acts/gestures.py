"""Gestures that go with speech, and standing about: what the starter library of directed characters has beside acts.

They are laid over a body that stands on the feet of its gait. Hands come from wherever they hang, so what matters is
where they go, and weights bring them there and back.
"""

from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.branch import Answer, Branch
from morph_retarget.core.morph.context import Context, Extent

from ..acting import Act, Track, Vector
from .tracks import (
    HANDED,
    REST,
    ears,
    facing,
    graspers,
    head,
    limb,
    mouths,
    neck,
    palms,
    root,
    spine,
    tail,
    turning,
    wings,
)

CHEST = Context(Capability.SPINE, extent=Extent.FRONT_MOST)


def beat() -> Act:
    """Stress a word with both hands: they come up and are thrown down, and once more with less force."""
    up: Vector = (0.5, -0.3, -0.1)
    return Act(
        "Beat",
        46,
        (
            mouths(),
            root({1: REST, 12: (0, 0.05, -0.01), 18: (0, -0.1, 0.02), 26: REST, 31: (0, -0.05, 0.01), 46: REST}),
            spine({1: REST, 12: (-2, 0, 0), 18: (3, 0, 0), 26: REST, 31: (2, 0, 0), 46: REST}),
            head({1: REST, 13: (-4, 0, 0), 19: (6, 0, 0), 27: REST, 32: (4, 0, 0), 46: REST}),
            palms({1: _facing_in()}, {1: 0.0, 12: 0.8, 34: 0.8, 46: 0.0}),
            graspers(
                {1: up, 13: up, 18: (0.56, -0.46, 0.18), 26: (0.52, -0.36, 0.02), 31: (0.55, -0.44, 0.15), 46: up},
                limb(ground_relative=True, sagittal_relative=True),
            ),
        ),
        {"ready": 1, "stroke_start": 13, "stroke": 18, "stroke_end": 32, "relax": 46},
        branch=HANDED,
    )


def shrug() -> Act:
    """Know nothing: the hands turn up at the sides, the head tilts, the body rises a little and sinks again."""
    out: Vector = (0.3, -0.4, 0.14)
    return Act(
        "Shrug",
        54,
        (
            mouths(),
            root({1: REST, 8: (0, 0.05, 0.01), 17: (0, 0.1, -0.012), 30: (0, 0.1, -0.01), 40: (0, 0, 0.012), 54: REST}),
            spine({1: REST, 17: (-3, 0, 0), 30: (-3, 0, 0), 42: (2, 0, 0), 54: REST}),
            neck({1: REST, 18: (4, 3, 0), 30: (4, 3, 0), 54: REST}),
            head({1: REST, 8: (3, 0, 0), 19: (-3, 11, 4), 31: (-3, 11, 4), 43: (3, 0, 0), 54: REST}),
            palms({1: _facing_up()}, {1: 0.0, 15: 1.0, 32: 1.0, 50: 0.0}),
            graspers(
                {1: out, 17: (0.24, -0.44, 0.1), 22: (0.24, -0.44, 0.12), 31: (0.24, -0.44, 0.12), 54: out},
                limb(ground_relative=True, sagittal_relative=True),
            ),
        ),
        {"ready": 1, "stroke_start": 12, "stroke": 18, "stroke_end": 32, "relax": 54},
        branch=HANDED,
    )


def cheer() -> Act:
    """Throw the arms up, twice."""
    high: Vector = (-0.12, -0.12, 0.92)
    return Act(
        "Cheer",
        62,
        (
            mouths(),
            root(
                {1: REST, 8: (0, 0.1, 0.08), 16: (0, 0, -0.03), 24: (0, 0, 0.04), 31: (0, 0, -0.03), 44: REST, 62: REST}
            ),
            spine({1: REST, 8: (8, 0, 0), 17: (-8, 0, 0), 24: (0, 0, 0), 32: (-8, 0, 0), 50: (2, 0, 0), 62: REST}),
            head({1: REST, 9: (8, 0, 0), 19: (-14, 0, 0), 25: (-4, 0, 0), 34: (-14, 0, 0), 52: (3, 0, 0), 62: REST}),
            ears({1: REST, 18: (14, 0, 0), 25: REST, 33: (14, 0, 0), 50: REST}),
            graspers({1: high, 17: high, 24: (0.0, -0.3, 0.55), 32: high, 40: (-0.1, -0.12, 0.86), 62: high}),
        ),
        {"ready": 1, "stroke_start": 9, "stroke": 17, "stroke_end": 40, "relax": 62},
        branch=HANDED,
    )


def idle_on_feet() -> Act:
    """Breathe, and shift the weight from one leg to the other and back; the head looks a little about."""
    return Act(
        "Idle on Feet",
        1 + 2 * _BREATH,
        (
            root(
                {
                    frame: (0.42 * aside, 0.0, 0.004 * (abs(aside) - deep))
                    for (frame, deep), aside in zip(_breathing().items(), _aside(), strict=True)
                },
                {frame: (0.0, -1.3 * aside, 0.9 * aside) for frame, aside in zip(_breathing(), _aside(), strict=True)},
            ),
            turning(
                "Chest",
                CHEST,
                {
                    frame: (-1.6 * deep, 0.9 * aside, -0.5 * aside)
                    for (frame, deep), aside in zip(_breathing().items(), _aside(), strict=True)
                },
            ),
            head({1: REST, 27: (1, 0, 3), 66: (-0.5, 1, 4), 106: (1, 0, -3), 140: (0, -1, -3), 1 + 2 * _BREATH: REST}),
            *_wagging(),
        ),
        branch=Branch(has_feet=Answer.TRUE),
        cyclic=True,
    )


def idle_without_feet() -> Act:
    """Breathe and look about; what lies on the ground stays where it lies."""
    return Act(
        "Idle without Feet",
        1 + 2 * _BREATH,
        (
            head({1: REST, 30: (-2, 0, 8), 64: (1, 2, 9), 104: (-2, 0, -8), 138: (1, -2, -9), 1 + 2 * _BREATH: REST}),
            wings({frame: (0.0, -5.0 * deep, 0.0) for frame, deep in _breathing().items()}),
        ),
        branch=Branch(has_feet=Answer.FALSE),
        cyclic=True,
    )


_BREATH = 84
"""Frames of one breath."""


def _breathing() -> dict[int, float]:
    """Return how deep the breath is over two of them, 0 … 1, by frame."""
    half = _BREATH // 2
    return {1 + i * half: float(i % 2) for i in range(5)}


def _aside() -> tuple[float, ...]:
    """Return to which side the weight is at the same keys."""
    return 0.0, 1.0, 0.0, -1.0, 0.0


def _wagging() -> tuple[Track, ...]:
    """Return a tail that swings a little; its tip follows late, but begins and ends in the middle as well."""
    half = _BREATH // 2
    last = 1 + 4 * half
    base = {1: 0.0, 1 + half: 3.0, 1 + 2 * half: 0.0, 1 + 3 * half: -3.0, last: 0.0}
    tip = {1: 0.0, 11 + half: 6.0, 9 + 2 * half: 0.0, 9 + 3 * half: -6.0, last: 0.0}
    return tail(*({frame: (0.0, 0.0, yaw) for frame, yaw in keys.items()} for keys in (base, tip)))


def _facing_in() -> Vector:
    return facing((0.15, -1.0, 0.2), (0.8, 0.0, 0.6))


def _facing_up() -> Vector:
    return facing((0.55, -0.8, 0.1), (0.0, -0.1, -1.0))
