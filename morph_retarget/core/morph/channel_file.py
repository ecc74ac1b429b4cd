"""Channels as data: presets that animators keep and share. Nothing in a file is ever executed."""

import json
from collections.abc import Iterable
from dataclasses import asdict, fields, is_dataclass
from enum import StrEnum
from types import UnionType
from typing import Any, cast, get_args, get_type_hints

from ..errors import MotionError
from .channels import Channel

FORMAT = 1
"""Version of the form that presets are written in."""


def to_text(channels: Iterable[Channel]) -> str:
    """Return channels as the text of a preset."""
    data = {"format": FORMAT, "channels": [_plain(asdict(channel)) for channel in channels]}
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def _plain(values: dict[str, Any]) -> dict[str, Any]:
    """Return settings without those that are not there."""
    return {
        name: _plain(cast("dict[str, Any]", value)) if isinstance(value, dict) else value
        for name, value in values.items()
        if value is not None
    }


def parse(text: str, origin: str) -> tuple[Channel, ...]:
    """Return the channels of a preset; settings that it leaves out have their usual values.

    Args:
        text: JSON.
        origin: Where it came from, for messages.

    Raises:
        MotionError: It is no preset, a newer version made it, or a setting is unknown.
    """
    try:
        data: Any = json.loads(text)
    except json.JSONDecodeError as error:
        raise MotionError(f"{origin}: line {error.lineno} is no JSON ({error.msg}): save the preset again") from error
    except (ValueError, RecursionError) as error:  # numbers of very many digits, and brackets in brackets
        raise MotionError(f"{origin}: is no preset of channels: save one from a generalized action") from error
    table = cast("dict[str, Any]", data) if isinstance(data, dict) else {}
    rows: Any = table.get("channels")
    if not isinstance(rows, list) or not rows:
        raise MotionError(f"{origin}: is no preset of channels: save one from a generalized action")
    if table.get("format", FORMAT) != FORMAT:
        raise MotionError(f"{origin}: was made by a newer version of Morph Retarget: update the extension to use it")
    return tuple(_read(Channel, row, origin) for row in cast("list[Any]", rows))


def _read(kind: Any, row: Any, where: str) -> Any:
    """Return a dataclass, an enum or a plain value of some kind."""
    if is_dataclass(kind):
        return _record(cast("type[Any]", kind), row, where)
    if isinstance(kind, type) and issubclass(kind, StrEnum):
        if row not in list(kind):
            raise MotionError(f"{where}: {row!r} is unknown: use one of {', '.join(kind)}")
        return kind(row)
    number = kind is float and isinstance(row, int) and not isinstance(row, bool)
    if not (number or type(row) is kind):
        raise MotionError(f"{where}: {row!r} should be a {cast('type[Any]', kind).__name__}")
    return float(row) if number else row


def _record(kind: type[Any], row: Any, where: str) -> Any:
    hints = get_type_hints(kind)
    if not isinstance(row, dict):
        raise MotionError(f"{where}: {row!r} should be a table of settings")
    given = cast("dict[str, Any]", row)
    named = f"{where}: {given['name']!r}" if isinstance(given.get("name"), str) else where
    for name in given:
        if name not in hints:
            raise MotionError(f"{named}: unknown setting {name!r}: use one of {', '.join(hints)}")
    values: dict[str, Any] = {}
    for field in fields(kind):
        hint = hints[field.name]
        options = [own for own in get_args(hint) if own is not type(None)] if isinstance(hint, UnionType) else [hint]
        if field.name in given:
            values[field.name] = _read(options[0], given[field.name], f"{named}: {field.name}")
    try:
        return kind(**values)
    except TypeError as error:
        lacking = str(error).partition("argument")[2].strip(" s:")
        raise MotionError(f"{named}: lacks {lacking}: add it") from error
