"""Commands: what a character is told to do, and when (Grünvogel 2003 §5.2)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

Value = float | str | bool | tuple[float, ...]
"""What a parameter may hold; a tuple of two or three numbers is a place on the ground or in space [m]."""


class Verb(StrEnum):
    """The command identifiers of the paper."""

    START = "start"
    """Begin, or change what runs already according to the parameters."""
    STOP = "stop"
    """Finish in a believable way: a foot in the air lands first."""
    RESET = "reset"
    """Go to the default state at once."""


@dataclass(frozen=True)
class Command:
    """One command to a motion model or a behaviour."""

    time: float
    """When it is given [s]."""
    verb: Verb
    model: str
    """Whom it addresses: the name of a motion model or of a behaviour."""
    parameters: Mapping[str, Value] = field(default_factory=dict[str, Value], hash=False)
    """Motion parameters: purpose and data."""
    origin: str = ""
    """Where it was written, for messages: "dance.toml, line 12"; empty for one that was given by a script."""

    def __str__(self) -> str:
        words = [self.verb, self.model, *(f"{name} {value}" for name, value in self.parameters.items())]
        return " ".join(map(str, words))
