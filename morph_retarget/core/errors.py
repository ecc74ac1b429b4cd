"""The one family of errors that users are meant to read.

Every message is a single line that names the item and says what to do. Edges (operators, the command line)
turn a `MorphError` into a report or into one line on stderr; anything else is a mistake of ours and stays a traceback.
"""

from collections.abc import Iterable


class MorphError(Exception):
    """Root of all errors that a user can cause and mend."""


class RigError(MorphError):
    """An armature cannot be used for what was asked."""


class MotionError(MorphError):
    """A clip cannot be read, or holds nothing that can be transferred."""


class MappingError(MorphError):
    """A joint map names a joint or a bone that does not exist, or contradicts itself."""


class FileError(MorphError):
    """A file is missing, unreadable, of an unknown kind, or cannot be written."""


def listed(items: Iterable[str], most: int = 8) -> str:
    """Return ``items`` as one readable phrase, cut after ``most`` names, for use in messages."""
    names = list(items)
    shown = ", ".join(names[:most])
    return f"{shown} and {len(names) - most} more" if len(names) > most else shown
