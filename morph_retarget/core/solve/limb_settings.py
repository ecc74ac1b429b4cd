"""What tunes the solver for a single limb: for all of a character's limbs, or for one that has settings of its own."""

from dataclasses import dataclass


@dataclass(frozen=True)
class LimbSettings:
    """Parameters of one limb; lengths are shares of the limb's own, so that size does not matter."""

    swivel: float = 0.0
    """Turn of the limb about the line from its start to its end [degrees], -180 to 180: knees and elbows go outward,
    where they cannot up or forward, and on limbs in the middle to the left; so the same for both sides is symmetric."""
    pull: float = 1.0
    """How much it counts among what bends the spine, 0 to 1; at 0 it leaves the spine alone."""
    spine_start: float = 0.95
    """Share of its length from which on it pulls at the spine, or its rest chord if that is longer. The paper pulls
    from the rest chord on (0); the later, the longer the spine stays where the animator has put it."""
    slow_down: float = 0.98
    """Share of its length from which on it slows down toward goals that it cannot reach …"""
    full_reach: float = 0.9992
    """… and how far it stretches in the end, below 1: it reaches, and is never quite straight."""
    softness: float = 0.1
    """Length errors smaller than this share of a bone are corrected less, the smaller the less: soft constraints
    (Hecker 2008 §4.3.1). The softer, the more a limb of many bones keeps of its own bend; above 0."""
    outer_iterations: int = 5
    """How often all constraints are enforced, from the leaves inward (§4.3.2)."""
