"""Names with fields in braces: fields are filled in, and nothing else that formatting could do is done."""

import re

from ..core.errors import MotionError

_FIELD = re.compile(r"\{([a-z]+)\}")


def filled(template: str, what: str, **values: str) -> str:
    """Return a template with its fields filled in.

    Args:
        template: Such as ``{action} on {target}``.
        what: What it is, for messages.
        values: Of all fields that it may have, by their names.

    Raises:
        MotionError: It has another field, or a lone brace.
    """
    pieces = _FIELD.split(template)
    if any(name not in values for name in pieces[1::2]) or any(sign in text for text in pieces[::2] for sign in "{}"):
        *first, last = (f"{{{name}}}" for name in values)
        names = f"{', '.join(first)} and {last}" if first else last
        raise MotionError(f"{what} {template!r}: use {names} and no other braces")
    return "".join(values[piece] if i % 2 else piece for i, piece in enumerate(pieces))
