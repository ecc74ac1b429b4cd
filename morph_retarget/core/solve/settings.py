"""What tunes the particle IK solver; the values are those of Hecker 2008 §4.3 wherever it tells them."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace

from .limb_settings import LimbSettings


@dataclass(frozen=True)
class SolverSettings(LimbSettings):
    """Parameters of the solver: those of limbs for all that have none of their own, and those of the whole body.

    Lengths are shares of a constraint's own rest length, so that size does not matter. The spine has softness and
    iterations as limbs have.
    """

    bends_spine: bool = False
    """Whether heads, mouths and limbs bend the spine in its own phase. Without, heads and mouths are brought to their
    goals as the ends of limbs are, and other limbs have to do with their own joints: a third of the time."""
    allows_stretch: bool = False
    """Whether bones of limbs, and of a spine that bends, get longer and shorter for goals that they do not reach
    otherwise, by `stretch` and `shrink` at most. A skinned bone must not, unless the user wants it."""
    shrink: float = 0.1
    """Least length of a simplified limb (§4.3.2), and of a bone that is compressed."""
    spine_shrink: float = 0.7
    """Least length of a spine constraint when it is projected. The paper's 0.1 is for bones that shrink; a spine whose
    bones keep their lengths would have to fold in two for that …"""
    stretch: float = 1.2
    """… and its most (§4.3.2); bones that keep their lengths stop at their own. The same is that of limbs."""
    buckling_start: float = 60.0
    """A spine that folds by more than this between neighbouring constraints is pulled back toward rest [degrees] …"""
    buckling_full: float = 120.0
    """… and is pulled back with all of `anti_buckling` from here on."""
    anti_buckling: float = 0.5
    """Share of the way to the root-relative rest pose by which a buckled spine is pulled back, each iteration."""
    nudge: float = 0.0
    """Most that limbs which hang on the root and fall short of their goals move it, as a share of their length. The
    paper lets immediate children do so slightly (§4.3.1, footnote)."""
    footing: float = 1.0
    """Share of the way by which hips that sway aside come down, so that feet which stand do not slide; see `footing`.
    With this and `nudge` at 0 the root is where the animator has put it."""
    refinements: int = 5
    """How often the spine gives way to limbs that still cannot reach their goals, after it has been reconstructed."""
    twist: float = 60.0
    """Most that a branch point twists about the spine for them [degrees]."""
    avoids_collisions: bool = False
    """Whether limbs swivel, their ends where they are, out of the trunk, the head and each other."""
    keeps_above_ground: bool = True
    """Whether what nothing brings to a place, as fingers, tails and wings, is turned up where it would be below the
    ground: of an action alone, whose ground is level. A gait knows its own ground."""
    margin: float = 0.05
    """By how much further than touching they keep apart, as a share of their radii."""
    most_swivel: float = 75.0
    """Most that a limb swivels [degrees]."""
    radii: Mapping[str, float] = field(default_factory=dict[str, float], hash=False)
    """Of bones that are thinner or thicker than the rule in `capsules` has them, by name [m]."""
    limbs: Mapping[str, LimbSettings] = field(default_factory=dict[str, LimbSettings], hash=False)
    """Of limbs that have some of their own, by the names of the bones at their ends: those that have the goals, and
    where an arm's goals are those of its fingers, the hand."""

    def of_limb(self, name: str) -> LimbSettings:
        """Return the settings of a limb, by the name of the bone at its end."""
        return self.limbs.get(name, self)

    def swivelled(self, angles: Mapping[str, float]) -> "SolverSettings":
        """Return settings with which some limbs swivel further.

        Args:
            angles: By how much [degrees], by the names of the bones at their ends.
        """
        shared = {own.name: getattr(self, own.name) for own in fields(LimbSettings)}
        limbs = {name: self.limbs.get(name, LimbSettings(**shared)) for name in angles}
        more = {name: replace(own, swivel=own.swivel + angles[name]) for name, own in limbs.items()}
        return replace(self, limbs={**self.limbs, **more}) if angles else self


DEFAULT = SolverSettings()
