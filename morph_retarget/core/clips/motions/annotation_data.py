"""Annotations as plain data: what library files hold, and what can be written as JSON."""

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any, cast

from ...errors import MotionError, listed
from .annotations import Annotations, Strike, Strokes


def to_data(annotations: Annotations) -> dict[str, Any]:
    """Return annotations as data; those that hold nothing are left out."""
    out: dict[str, Any] = {"kind": annotations.kind}
    for name in _NAMES[1:]:
        value = getattr(annotations, name)
        if value == _DEFAULTS[name]:
            continue
        if isinstance(value, Strokes):
            out[name] = asdict(value)
        elif name == "strikes":
            out[name] = [[strike.foot, strike.frame] for strike in annotations.strikes]
        elif isinstance(value, Mapping):
            out[name] = dict(cast("Mapping[str, float]", value))
        else:
            out[name] = list(cast("tuple[str, ...]", value)) if isinstance(value, tuple) else value
    return out


def from_data(data: object, origin: str) -> Annotations:
    """Return annotations from data; what is left out has its usual value.

    Args:
        data: From `to_data`, or from a file.
        origin: Whose they are, for messages.

    Raises:
        MotionError: An annotation is unknown, or its value makes no sense.
    """
    table = _table(data, f"{origin}: its annotations")
    for name in table:
        if name not in _NAMES:
            raise MotionError(f"{origin}: there is no annotation {name!r}: use one of {listed(_NAMES, 20)}")
    if "kind" not in table:
        raise MotionError(f"{origin}: has no annotation 'kind': say what the motion is an example of, such as walk")
    values = {name: _value(name, value, f"{origin}: annotation {name!r}") for name, value in table.items()}
    try:
        return Annotations(**values)
    except MotionError as error:
        raise MotionError(f"{origin}: {error}") from error


_NAMES = [one.name for one in fields(Annotations)]
_USUAL = Annotations(kind="any")
_DEFAULTS = {name: getattr(_USUAL, name) for name in _NAMES}


def _value(name: str, value: object, where: str) -> Any:
    """Return the value of one annotation in its own type."""
    match name:
        case "strikes":
            return tuple(_strike(row, where) for row in _list(value, where))
        case "strokes":
            return None if value is None else _strokes(value, where)
        case "parts":
            return tuple(_text(row, where) for row in _list(value, where))
        case "parameters":
            return {key: _number(own, f"{where}: {key}") for key, own in _table(value, where).items()}
        case "cycle":
            if not isinstance(value, bool):
                raise MotionError(f"{where} is {value!r}: say true or false")
            return value
        case "speed" | "turn_rate" | "direction":
            return _number(value, where)
        case _:
            return _text(value, where)


def _strike(row: object, where: str) -> Strike:
    pair = _list(row, where)
    if len(pair) != 2 or not isinstance(pair[0], int) or isinstance(pair[0], bool):
        raise MotionError(f"{where} holds {row!r}: give the place of a foot and a frame")
    return Strike(pair[0], _number(pair[1], where))


def _strokes(value: object, where: str) -> Strokes:
    table = _table(value, where)
    names = [one.name for one in fields(Strokes)]
    if set(table) != set(names):
        raise MotionError(f"{where} has the times {listed(table) or 'none'}: give {listed(names)}")
    return Strokes(**{name: _number(table[name], f"{where}: {name}") for name in names})


def _table(value: object, where: str) -> dict[str, object]:
    if not isinstance(value, dict):
        raise MotionError(f"{where} is {value!r}: give names with their values")
    return cast("dict[str, object]", value)


def _list(value: object, where: str) -> list[object]:
    if not isinstance(value, list | tuple):
        raise MotionError(f"{where} is {value!r}: give a list")
    return list(cast("list[object]", value))


def _number(value: object, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise MotionError(f"{where} is {value!r}: give a number")
    return float(value)


def _text(value: object, where: str) -> str:
    if not isinstance(value, str):
        raise MotionError(f"{where} is {value!r}: give a word")
    return value
