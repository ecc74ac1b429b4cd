"""One authored set of gait parameters: how feet and body move at one speed, and the maker of metachronal waves.

The animators of Hecker 2008 §4.2 author a mapping from speed to such parameters for groups of one to six feet; for more
feet they are generated. Speeds and strides are free of size: the speed is u = v / sqrt(g h) with the hip height h (its
square is Alexander's Froude number), the stride is in hip heights; animals of all sizes that are alike in u move alike
(Alexander & Jayes 1983, "dynamic similarity").
"""

from dataclasses import dataclass

MOST_FEET = 6
"""Groups of more feet have generated patterns."""
MOST_BEATS = 2
"""A body goes up and down no more often in a cycle."""
WAVES = 1.6
"""So many waves stand in a body of more than three rows …"""
LONGEST_LAG, LEGS_TO_A_WAVE = 0.4, 6.0
"""… unless neighbours were further apart than this [cycles], or the wave took more legs of a side than this."""


@dataclass(frozen=True)
class Manner:
    """How a group of feet and the body go at one speed. Phases are shares of the group's cycle."""

    speed: float
    """u for which it was authored."""
    duty: float
    """Share of the cycle for which a foot is on the ground (Alexander 2003)."""
    triggers: tuple[float, ...]
    """Phase at which each foot touches down; pairs from the rear to the front, left before right, then the odd foot."""
    stride: float
    """Way of one cycle [hip heights]."""
    lift: float = 0.08
    """Height of a foot's arc over the straight way [leg lengths]."""
    bob: float = 0.0
    """Up and down of the body, half of peak to peak [leg lengths]."""
    bob_beats: int = 2
    """How often it goes up and down in a cycle, 1 … `MOST_BEATS`."""
    bob_phase: float = 0.0
    """When it is highest for the first time."""
    sway: float = 0.0
    """How far the body shifts over the feet that carry it: 0 not at all … 1 until it is above them."""
    yaw: float = 0.0
    """How far the hips turn with feet that are one leg length ahead and behind [rad]."""
    roll: float = 0.0
    """How far the hips drop to the side that flies [rad]."""
    pitch: float = 0.0
    """How far the body pitches as it is carried by its fore or its hind feet [rad]."""
    lean: float = 0.0
    """How far the body leans forward [rad]."""
    crouch: float = 0.0
    """How much the hips are lowered [leg lengths]."""
    swing: float = 0.0
    """How far arms swing to the front and back [rad]."""
    toe_off: float = 0.0
    """How far the heel is up when the foot leaves the ground [rad]."""
    heel_strike: float = 0.0
    """How far the toes are up when it lands [rad]."""


def wave(feet: int, lag: float) -> tuple[float, ...]:
    """Return the triggers of a metachronal wave: each foot steps ``lag`` cycles after the one behind it.

    Left and right are half a cycle apart. With a lag of 1 - duty a foot lands just when the next one leaves: these are
    the wave gaits, the most stable ones of all for going straight ahead (McGhee & Frank 1968 for four feet, Song &
    Waldron 1989 for more). For six feet duty 1/2 gives the alternating tripod, 2/3 two feet in the air at a time, 5/6
    one (Wilson 1966); for four feet 3/4 gives the walk of even beats.
    """
    pairs = feet // 2
    phases = [row * lag + side for row in range(pairs) for side in (0.0, 0.5)]
    if feet % 2:
        phases.append(pairs * lag + (0.25 if pairs else 0.0))
    return tuple(phase % 1.0 for phase in phases)


def lag(feet: int, duty: float) -> float:
    """Return by how much of a cycle a foot is behind the one behind it in a generated wave.

    Bodies of up to three rows go in wave gaits. In longer ones the lag is the same at all duty factors, since a change
    of it would rush the front legs through many phases. Eight feet come near to alternating fours, as those of spiders
    (Barth 2002), but on a side they step in the order 4, 1, 3, 2 from the rear, where most spiders' go 4, 2, 3, 1. In
    long bodies several waves follow each other; they run forward, as in millipedes and some centipedes, while those of
    others run back (Manton 1977). `WAVES` and the bounds are our choice.
    """
    rows = (feet + 1) // 2
    return 1.0 - duty if feet <= MOST_FEET else min(max(WAVES / rows, 1.0 / LEGS_TO_A_WAVE), LONGEST_LAG)
