"""What is left when one of Blender's operators fails: a short reason, and what it holds on to."""

import contextlib
import gc
import sys
from collections.abc import Iterator

_PLACES = ("Location:", "File ", "Traceback")
_KEPT = ("last_exc", "last_type", "last_value", "last_traceback")


def reason_of(error: Exception) -> str:
    """Return the last line of an error but for those that tell where in Blender's code it was raised."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    told = [line for line in lines if not line.startswith(_PLACES)]
    return (told[-1] if told else type(error).__name__).removeprefix("Error: ")


@contextlib.contextmanager
def letting_go() -> Iterator[None]:
    """Let go of what a failing operator had open: Python keeps its last error for debuggers, with all of its frames.

    A half-written file that nobody has closed takes its room on the disk even when it was removed.
    """
    try:
        yield
    except Exception:
        for name in _KEPT:
            if hasattr(sys, name):
                delattr(sys, name)
        gc.collect()
        raise
