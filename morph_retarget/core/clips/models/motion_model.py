"""Motion models: independent tasks, such as walking or waving, with parameters of their own (Grünvogel 2003 §5.1–5.2).

A model makes a motion tree from its base motions when it is told to, and another one when it is told otherwise while it
moves. It keeps nothing: what it has to know later is in the token that it returns.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

from ...arrays import Flags
from ..character_model import CharacterModel
from ..clip import Clip
from ..commands.command import Command
from ..commands.parameters import Parameters
from ..motions.base_motion import BaseMotion
from .token import Token


class MotionModel(ABC):
    """The common interface of all motion models."""

    @property
    @abstractmethod
    def name(self) -> str:
        """By which commands address it."""

    @property
    @abstractmethod
    def model(self) -> CharacterModel:
        """The body that it moves."""

    @property
    @abstractmethod
    def parameters(self) -> Parameters:
        """What can be said about how it moves: the purposes of motion parameters, and their types."""

    @property
    def family(self) -> str:
        """Models of one family do the same thing in other ways: each goes over into another at once, as walk and run.

        By itself a model is its own family.
        """
        return self.name

    @abstractmethod
    def crucial(self, command: Command) -> Flags:
        """Return the joints that a motion cannot do without if it is started by a command, shape (joint,)."""

    @abstractmethod
    def do_command(self, command: Command, frame: float, token: Token | None) -> Token | None:
        """Return what a command makes of the motion.

        Starting what moves already changes it, as far as the command's parameters differ from those that it has; what
        the command does not name stays. Stopping ends it in a believable way, resetting at once.

        Args:
            command: Its parameters are known ones of the right types (`parameters.read`).
            frame: When it is given.
            token: Of the motion that is under way: of this model, or of one of its family that it takes over from; None
                when there is none.

        Returns:
            The same token if nothing changes, None if there is no motion (any more).
        """

    def subtree(self, token: Token) -> Clip:
        """Return the motion tree of a token, in the controller's own frames.

        Raises:
            AssertionError: The motion has not begun.
        """
        assert token.tree is not None, "it waits"
        return token.tree


@dataclass(frozen=True, eq=False)
class KindModel(MotionModel):
    """What the models of one kind of base motions share."""

    kind: str
    motions: tuple[BaseMotion, ...]
    """Base motions of the kind, at least one."""
    scale: float = 1.0
    """Lengths that commands name over those of the body."""

    @property
    def name(self) -> str:
        """By which commands address it: its kind."""
        return self.kind

    @property
    def model(self) -> CharacterModel:
        """The body that it moves."""
        return self.motions[0].clip.model
