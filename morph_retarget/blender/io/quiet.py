"""Keeping what Blender's importers, exporters and renderers print to themselves."""

import contextlib
import io
import os
import sys
from collections.abc import Iterator


@contextlib.contextmanager
def quiet(errors: bool = False) -> Iterator[None]:
    """Keep everything off stdout, from Python and from C, so that it carries nothing but results.

    Args:
        errors: Keep everything off stderr as well.
    """
    numbers = (1, 2) if errors else (1,)
    sys.stdout.flush()
    sys.stderr.flush()
    kept = {number: os.dup(number) for number in numbers}
    with contextlib.ExitStack() as stack:
        nowhere = stack.enter_context(open(os.devnull, "w"))  # noqa: PTH123 - a device
        # Exporters' loggers keep the stream they first saw, so it must never be closed.
        stack.enter_context(contextlib.redirect_stdout(io.StringIO()))
        if errors:
            stack.enter_context(contextlib.redirect_stderr(io.StringIO()))
        stack.callback(_restore, kept)
        for number in numbers:
            os.dup2(nowhere.fileno(), number)
        yield


def _restore(kept: dict[int, int]) -> None:
    for number, copy in kept.items():
        os.dup2(copy, number)
        os.close(copy)
