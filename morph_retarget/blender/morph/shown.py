"""What a character shows at the moment."""

from collections.abc import Mapping
from dataclasses import dataclass

from ...core.arrays import Array
from ...core.morph.channels import Values
from ...core.play import Played
from .cast import Member
from .pose import Singles


@dataclass(eq=False)
class Shown:
    """What a character shows."""

    member: Member
    inputs: bytes
    """Values and targets, to see whether they have changed."""
    values: Values
    targets: Mapping[int, Array]
    played: Played
    state: dict[str, Singles]
    """Properties of its bones when they were last seen."""
