"""What the command line says besides its results."""

import contextlib
import sys
from collections.abc import Iterator

from ...core.errors import MorphError

NAME = "morph_retarget"


def say(text: str) -> None:
    """Print one line on stderr."""
    print(f"{NAME}: {' '.join(text.split())}", file=sys.stderr)


@contextlib.contextmanager
def naming(label: str) -> Iterator[None]:
    """Put the name of a file in front of errors that do not have it."""
    try:
        yield
    except MorphError as error:
        if str(error).startswith(label):
            raise
        raise type(error)(f"{label}: {error}") from error
