"""What tunes the particle IK solver; the values are those of Hecker 2008 §4.3 wherever it tells them."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class SolverSettings:
    """Parameters of the solver; lengths are shares of a constraint's own rest length, so that size does not matter."""

    bends_spine: bool = False
    """Whether heads, mouths and limbs bend the spine in its own phase. Without, heads and mouths are brought to their
    goals as the ends of limbs are, and other limbs have to do with their own joints: a third of the time."""
    outer_iterations: int = 5
    """How often all constraints are enforced, from the leaves inward (§4.3.2)."""
    softness: float = 0.1
    """Length errors smaller than this are corrected less, the smaller the less: soft constraints (§4.3.1)."""
    shrink: float = 0.1
    """Least length of a simplified limb (§4.3.2)."""
    spine_shrink: float = 0.7
    """Least length of a spine constraint when it is projected. The paper's 0.1 is for bones that shrink; a spine whose
    bones keep their lengths would have to fold in two for that …"""
    stretch: float = 1.2
    """… and its most (§4.3.2); bones that keep their lengths stop at their own."""
    buckling_start: float = 60.0
    """A spine that folds by more than this between neighbouring constraints is pulled back toward rest [degrees] …"""
    buckling_full: float = 120.0
    """… and is pulled back with all of `anti_buckling` from here on."""
    anti_buckling: float = 0.5
    """Share of the way to the root-relative rest pose by which a buckled spine is pulled back, each iteration."""
    slow_down: float = 0.98
    """Share of a limb's length from which on it slows down toward goals that it cannot reach …"""
    full_reach: float = 0.9992
    """… and how far it stretches in the end: it reaches, and is never quite straight."""
    spine_start: float = 0.95
    """Share of a limb's length from which on it pulls at the spine, or its rest chord if that is longer. The paper
    pulls from the rest chord on (0); the later, the longer the spine stays where the animator has put it."""
    nudge: float = 0.0
    """Most that limbs which hang on the root and fall short of their goals move it, as a share of their length. The
    paper lets immediate children do so slightly (§4.3.1, footnote); 0 leaves the root where the animator has put it."""
    refinements: int = 2
    """How often the spine gives way to limbs that still cannot reach their goals, after it has been reconstructed."""
    twist: float = 60.0
    """Most that a branch point twists about the spine for them [degrees]."""
    avoids_collisions: bool = False
    """Whether limbs swivel, their ends where they are, out of the trunk, the head and each other."""
    margin: float = 0.05
    """By how much further than touching they keep apart, as a share of their radii."""
    most_swivel: float = 60.0
    """Most that a limb swivels [degrees]."""
    radii: Mapping[str, float] = field(default_factory=dict[str, float], hash=False)
    """Of bones that are thinner or thicker than the rule in `capsules` has them, by name [m]."""


DEFAULT = SolverSettings()
