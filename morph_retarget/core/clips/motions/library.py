"""Libraries: all base motions of one character model (Grünvogel 2003 §5.4)."""

from collections.abc import Iterable
from dataclasses import dataclass

from ...errors import MotionError, listed
from ..character_model import CharacterModel
from .base_motion import BaseMotion


@dataclass(frozen=True, eq=False)
class Library:
    """Base motions that are made for the same body."""

    model: CharacterModel
    motions: tuple[BaseMotion, ...] = ()

    def __post_init__(self) -> None:
        names: set[str] = set()
        for motion in self.motions:
            if motion.clip.own_model is not self.model:
                raise MotionError(
                    f"base motion {motion.name!r} is made for another body: transfer it to this one first"
                )
            if motion.name in names:
                raise MotionError(f"two base motions are called {motion.name!r}: give one of them another name")
            names.add(motion.name)

    def __len__(self) -> int:
        return len(self.motions)

    @property
    def kinds(self) -> tuple[str, ...]:
        """What there are examples of, in order of their first ones."""
        return tuple(dict.fromkeys(motion.kind for motion in self.motions))

    def of_kind(self, kind: str) -> tuple[BaseMotion, ...]:
        """Return all examples of something, none where it has none."""
        return tuple(motion for motion in self.motions if motion.kind == kind)

    def named(self, name: str) -> BaseMotion:
        """Return the base motion of some name.

        Raises:
            MotionError: There is none.
        """
        for motion in self.motions:
            if motion.name == name:
                return motion
        names = listed((motion.name for motion in self.motions), 20)
        raise MotionError(f"the library has no base motion {name!r}: choose one of {names or 'none'}")

    def with_motions(self, motions: Iterable[BaseMotion]) -> "Library":
        """Return it with more base motions; those of a name that it has already replace the old ones.

        Raises:
            MotionError: One is made for another body.
        """
        new = {motion.name: motion for motion in motions}
        kept = tuple(motion for motion in self.motions if motion.name not in new)
        return Library(self.model, (*kept, *new.values()))
