"""Commands as one line of text: ``start walk speed=1.2 target=Ball``; in scripts, markers and lists."""

import re
import shlex
from collections.abc import Mapping

from ...errors import MotionError, listed
from .command import Value, Verb

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")
_WORDS: Mapping[str, bool] = {"yes": True, "no": False, "true": True, "false": False, "on": True, "off": False}


def parse(text: str) -> tuple[Verb, str, dict[str, Value]]:
    """Return what a line says: the verb, whom it addresses, and the parameters.

    Raises:
        MotionError: It is no command.
    """
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise MotionError(f"{text!r} is no command: close its quotation marks") from error
    if len(words) < 2 or words[0].lower() not in {verb.value for verb in Verb}:
        raise MotionError(f"{text!r} is no command: write {listed(Verb)} and then who is meant, as in 'start walk'")
    parameters: dict[str, Value] = {}
    for word in words[2:]:
        name, sign, value = word.partition("=")
        if not sign or not name:
            raise MotionError(f"{text!r}: {word!r} is no parameter: write it as name=value, with no spaces")
        parameters[name] = value_of(value)
    return Verb(words[0].lower()), words[1], parameters


def written(verb: Verb, model: str, parameters: Mapping[str, Value]) -> str:
    """Return a command as a line; the way back from `parse`."""
    words = [verb.value, shlex.quote(model)]
    words += [shlex.quote(f"{name}={written_value(value)}") for name, value in parameters.items()]
    return " ".join(words)


def value_of(text: str) -> Value:
    """Return the value that a text stands for: a number, yes or no, a place as numbers with commas, or a word.

    A word that would be read as something else stands in double quotation marks of its own.
    """
    if len(text) > 1 and text[0] == text[-1] == '"':
        return text[1:-1]
    if text.lower() in _WORDS:
        return _WORDS[text.lower()]
    if _NUMBER.match(text):
        return float(text)
    parts = [part.strip() for part in text.strip("()[]").split(",")]
    if len(parts) > 1 and all(_NUMBER.match(part) for part in parts):
        return tuple(float(part) for part in parts)
    return text


def written_value(value: Value) -> str:
    """Return a value as text; the way back from `value_of`."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple):
        return ",".join(repr(float(number)) for number in value)
    if isinstance(value, str):
        return value if value_of(value) == value else f'"{value}"'
    return repr(float(value))
