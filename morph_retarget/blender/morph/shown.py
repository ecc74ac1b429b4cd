"""What a character shows at the moment."""

from dataclasses import dataclass

from ...core.play import Played
from .deforms import Given
from .member import Member
from .pose import Singles
from .stage import ToldTargets


@dataclass(eq=False)
class Shown:
    """What a character shows."""

    member: Member
    inputs: tuple[object, ...]
    """What it depends on, to see whether that has changed."""
    targets: ToldTargets
    played: Played
    state: dict[str, Singles]
    """Properties of its bones when they were last seen."""
    deforms: list[Given]
    """What deforms were given to, which is there until something is edited."""
