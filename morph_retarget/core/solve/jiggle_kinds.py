"""Kinds of parts that jiggle, how each of them does, and what a user can set about it (Hecker 2008 §4.4)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum


class JiggleKind(StrEnum):
    """What a jiggling sub-tree is."""

    TAIL = "tail"
    EAR = "ear"
    ANTENNA = "antenna"
    TENTACLE = "tentacle"
    WING = "wing"
    FIN = "fin"
    HAIR = "hair"
    CLOTH = "cloth"
    FLESH = "flesh"
    CHAIN = "chain"


@dataclass(frozen=True)
class Manner:
    """How a kind of sub-tree jiggles, compared with a tail."""

    half_life: float = 1.0
    stiffness: float = 1.0
    amount: float = 1.0
    limit: float = 70.0
    """How far it bends from where it is carried, at its tip [deg]."""
    least: int = 1
    """Bones in line that it takes: a cap of hair or a hat on one bone is no hair that hangs."""


MANNERS: Mapping[JiggleKind, Manner] = {
    JiggleKind.TAIL: Manner(),
    JiggleKind.EAR: Manner(0.5, 1.3, 0.7, 40.0),
    JiggleKind.ANTENNA: Manner(0.45, 1.0, 0.8, 40.0),
    JiggleKind.TENTACLE: Manner(1.2, 0.8, 1.0, 80.0, 2),
    JiggleKind.WING: Manner(0.7, 2.0, 0.3, 20.0),
    JiggleKind.FIN: Manner(0.7, 2.0, 0.4, 25.0),
    JiggleKind.HAIR: Manner(0.8, 1.0, 0.9, 55.0, 2),
    JiggleKind.CLOTH: Manner(0.9, 1.0, 0.7, 40.0, 2),
    JiggleKind.FLESH: Manner(0.4, 2.0, 0.4, 12.0),
    JiggleKind.CHAIN: Manner(0.8, 1.5, 0.7, 40.0, 3),
}
"""Bones of a chain say nothing about themselves, so there must be several."""


@dataclass(frozen=True)
class Override:
    """What the user has set for one kind or one bone."""

    half_life: float
    """[s]."""
    stiffness: float
    amount: float
    """0 keeps it still."""


@dataclass(frozen=True)
class JiggleSettings:
    """How a character jiggles. Kinds have their shares of it, see `MANNERS`."""

    half_life: float = 0.18
    """Time in which a tail comes back halfway once what carries it moves evenly [s], above 0."""
    stiffness: float = 2.0
    """How hard it resists: the rate of the quicker of its two dampers over that of the slower, above 1."""
    amount: float = 1.0
    """Size of the movement; 0 is none."""
    gravity: float = 0.3
    """Share of their length by which parts hang lower when what carries them is tilted off its rest."""
    ground: bool = False
    """Whether parts stay above the ground that the character stands on at rest."""
    loop: bool = True
    """Whether a clip that ends as it began goes over the seam without a jump."""
    kinds: Mapping[JiggleKind, Override] = field(default_factory=dict[JiggleKind, Override])
    """What is set for kinds; it goes before what is said above."""
    bones: Mapping[str, Override] = field(default_factory=dict[str, Override])
    """What is set for bones by name; it goes before what is set for kinds."""
