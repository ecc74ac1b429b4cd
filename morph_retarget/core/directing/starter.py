"""The starter library: base motions of our own, made on the very character that will show them.

Whoever has no library of mocap can direct at once, a hound or a beetle as well as a human. Only the kinds that are
asked for are made.
"""

from collections.abc import Iterable, Iterator

from ..character.character import Character
from ..clips.character_model import CharacterModel
from ..clips.motions.annotations import Annotations
from ..clips.motions.base_motion import BaseMotion
from ..clips.motions.library import Library
from ..errors import MotionError, listed
from . import acting, strolls
from .performing import model_of, performed
from .recipes import shelf
from .takes import Take

GOING = tuple(stroll.kind for stroll in strolls.STROLLS)


def kinds_of_starter() -> tuple[str, ...]:
    """Return all kinds of motions that a starter library may have, as commands name them."""
    return (*GOING, *shelf.kinds())


def starter(character: Character, kinds: Iterable[str] | None = None) -> Library:
    """Return the starter library of a character.

    Args:
        character: What the rig is.
        kinds: Those of `kinds_of_starter` that are wanted; None for all. A body may not be able to do all of them.

    Raises:
        RigError: The character cannot be posed.
        MotionError: There is no such kind.
    """
    return completed(Library(model_of(character)), kinds)


def completed(library: Library, kinds: Iterable[str] | None = None) -> Library:
    """Return a library with starter motions of all kinds, as `starter` makes them, of which it has none itself.

    Raises:
        RigError: The body cannot be posed.
        MotionError: There is no such kind.
    """
    known = kinds_of_starter()
    wanted = known if kinds is None else tuple(kinds)
    for kind in wanted:
        if kind not in known:
            raise MotionError(f"the starter library has no {kind!r}: choose from {listed(known, len(known))}")
    lacking = tuple(dict.fromkeys(kind for kind in wanted if kind not in library.kinds))
    acts = acting.motions_of(library.model, [kind for kind in lacking if kind not in GOING])
    return library.with_motions([*_going(library.model, lacking), *acts])


def _going(model: CharacterModel, wanted: tuple[str, ...]) -> Iterator[BaseMotion]:
    """Yield how the character goes, all posed in one batch."""
    found: list[tuple[Take, Annotations]] = []
    for stroll in strolls.STROLLS:
        if stroll.kind in wanted:
            found += strolls.takes_of(model, stroll)
    clips = performed(model, [take for take, _ in found])
    for clip, (take, known) in zip(clips, found, strict=True):
        yield BaseMotion(take.name, clip, known)
