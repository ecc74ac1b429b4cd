"""What a bone map says, whichever tool wrote it, before it is known which rig it is for."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..control_given import Reaching

KEEMAP, MWNI, ROKOKO, EXPY_KIT = "KeeMap", "Animation Retargeting", "Rokoko", "Expy Kit"
"""Tools whose maps are read, by the names that their users know: add-ons of N. Keeline, Mwni, Rokoko and P. Krime."""
OURS = "Morph Retarget"


@dataclass(frozen=True)
class Pair:
    """A bone of one rig and the bone of another that follows it."""

    source: str
    target: str


@dataclass(frozen=True)
class BoneMap:
    """A bone map: joints with names, or bones of one rig with those of another, or both."""

    tool: str
    origin: str
    """Where it came from, for messages."""
    joints: Mapping[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])
    """Joint to names of bones, of which the first that a rig has is meant; no names say that it has no such joint."""
    controls: Mapping[str, str] = field(default_factory=dict[str, str])
    """Joint to the control that animators move for it."""
    reaches: Mapping[str, Reaching] = field(default_factory=dict[str, Reaching])
    """Joint to how it is brought to places."""
    pairs: tuple[Pair, ...] = ()
    left_out: tuple[str, ...] = ()
    """What is in the file but means nothing here, each as a phrase."""

    @property
    def exact(self) -> bool:
        """Whether its names are those of the rig to the letter: one of ours."""
        return self.tool == OURS
