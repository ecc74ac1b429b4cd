"""Tokens: what the motion controller keeps of each motion model that moves the character (Grünvogel 2003 §6.2)."""

import math
from dataclasses import dataclass, field

from ...arrays import Flags
from ..clip import Clip
from ..commands.command import Command


@dataclass(frozen=True, eq=False)
class Token:
    """One motion model at work, or one that waits until others leave it the joints that it cannot do without.

    Models are stateless: all that one has to know of what it did is in here, so a token and a command always lead to
    the same token.
    """

    model: str
    """The identifier of the motion model."""
    command: Command
    """The last that it has received."""
    start: float
    """Frame at which the motion began; of one that waits, that at which it was told to."""
    tree: Clip | None
    """The motion tree, in the controller's own frames; None while it waits."""
    joints: Flags
    """Which it moves where no other motion cannot do without them, shape (joint,)."""
    crucial: Flags
    """Which it cannot share with others without being spoilt, shape (joint,)."""
    state: object = None
    """What the model has to know to change the motion later; of its own type."""
    influence: float = math.inf
    """Last frame at which it has influence on the character: later than the motion's own last frame by the transition
    to what follows it; infinite as long as there is no end to it."""
    warnings: tuple[str, ...] = field(default=())
    """What could not be done as the last command says."""

    @property
    def waits(self) -> bool:
        """Whether the motion has not begun."""
        return self.tree is None

    @property
    def is_finite(self) -> bool:
        """Whether the motion ends by itself."""
        return self.tree is not None and self.tree.is_finite

    @property
    def last(self) -> float:
        """Last frame of the motion; infinite for one without end, and for one that waits."""
        return math.inf if self.tree is None else self.tree.end
