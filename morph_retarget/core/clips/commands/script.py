"""Scripts: commands, targets and what else a performance needs, as a TOML file.

::

    library = "my_motions.npz"          # left out: the starter library

    [targets]
    ball = [0.5, -2.0, 1.0]             # a place [m], or ...
    cup = "Cup"                         # ... an object of the character's file

    [[command]]
    at = 1.5                            # seconds, or frames of the scene as "36f"
    start = "walk"
    speed = 1.2

    [[command]]
    do = "4.0 stop walk"                # the same on one line

What is wrong with one command is told with its line, and the others play.
"""

import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import cast

from ...errors import FileError, MotionError, listed
from . import line as lines
from .command import Command, Value, Verb

Place = tuple[float, ...]
_TABLES = ("library", "targets", "command", "frame_rate")
_HEADER = re.compile(r"\s*\[\[\s*command\s*\]\]")
_FRAMES = re.compile(r"\s*([-+]?\d+(?:\.\d*)?)\s*f\s*$")


@dataclass(frozen=True)
class Script:
    """What a file tells a character to do."""

    commands: tuple[Command, ...] = ()
    """In the order of their times."""
    targets: Mapping[str, Place | str] = field(default_factory=dict[str, "Place | str"], hash=False)
    """Places [m], the frame of the ground where the character sets out, or names of objects."""
    library: str = ""
    """File of the motions, beside the script; empty for the starter library."""
    warnings: tuple[str, ...] = ()


def read(text: str, name: str, frame_rate: float = 24.0) -> Script:
    """Return a script.

    Args:
        text: Of the file.
        name: Of the file, for messages.
        frame_rate: Frames in a second, where times are given in frames and the file does not tell.

    Raises:
        FileError: It is no TOML, or its tables are none.
    """
    try:
        found = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # numbers of very many digits are no decoding errors
        raise FileError(f"{name}: {error or 'nested too deeply'}: it is no TOML file") from error
    warnings: list[str] = []
    unknown = [key for key in found if key not in _TABLES]
    if unknown:
        warnings.append(f"{name}: there is no {unknown[0]!r} in a script: choose of {listed(_TABLES)}")
    rate = found.get("frame_rate", frame_rate)
    if not _is_number(rate) or not 0.0 < rate < 1e6:
        raise FileError(f"{name}: frame_rate is {rate!r}: give the frames in a second")
    library = found.get("library", "")
    if not isinstance(library, str):
        raise FileError(f"{name}: library is {library!r}: give the name of a file")
    commands, told = _commands(found.get("command", []), text, name, float(rate))
    targets, also = _targets(found.get("targets", {}), name)
    return Script(commands, targets, library, (*warnings, *told, *also))


def written(script: Script) -> str:
    """Return a script as TOML; `read` gives the same script."""
    out = [f"library = {_text(script.library)}\n"] if script.library else []
    if script.targets:
        out.append("[targets]")
        out += [f"{_text(name)} = {_toml(value)}" for name, value in script.targets.items()] + [""]
    for command in script.commands:
        out += ["[[command]]", f"at = {command.time!r}", f"{command.verb.value} = {_text(command.model)}"]
        out += [f"{_text(name)} = {_toml(value)}" for name, value in command.parameters.items()] + [""]
    return "\n".join(out)


# --- commands ---


def _commands(tables: object, text: str, name: str, rate: float) -> tuple[tuple[Command, ...], list[str]]:
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in cast("list[object]", tables)):
        raise FileError(f"{name}: commands are tables: write [[command]] above each")
    commands: list[Command] = []
    warnings: list[str] = []
    for table, line in zip(cast("list[dict[str, object]]", tables), _header_lines(text), strict=False):
        origin = f"{name}, line {line}"
        try:
            commands.append(_command(table, origin, rate))
        except MotionError as error:
            warnings.append(f"{origin}: {error}")
    return tuple(sorted(commands, key=lambda command: command.time)), warnings


def _command(table: Mapping[str, object], origin: str, rate: float) -> Command:
    rest = dict(table)
    if "do" in rest:
        if len(rest) > 1:
            raise MotionError("'do' says all in one line: leave out the other entries, or 'do'")
        text = rest["do"]
        if not isinstance(text, str):
            raise MotionError(f"do is {text!r}: write it as in do = '1.5 start walk speed=1.2'")
        when, _, what = text.strip().partition(" ")
        verb, model, parameters = lines.parse(what)
        return Command(_time(lines.value_of(when), rate), verb, model, parameters, origin)
    if "at" not in rest:
        raise MotionError("it has no time: write at = seconds")
    time = _time(rest.pop("at"), rate)
    verbs = [verb for verb in Verb if verb.value in rest]
    if len(verbs) != 1:
        raise MotionError(f"it needs one of {listed(Verb)}, as in start = 'walk'")
    model = rest.pop(verbs[0].value)
    if not isinstance(model, str) or not model:
        raise MotionError(f"{verbs[0].value} is {model!r}: name a motion model or a behaviour")
    return Command(time, verbs[0], model, {key: _value(key, value) for key, value in rest.items()}, origin)


def _time(value: object, rate: float) -> float:
    """Return a time [s]."""
    found = _FRAMES.match(value) if isinstance(value, str) else None
    seconds = float(found[1]) / rate if found else value
    if not _is_number(seconds) or not abs(cast("float", seconds)) < 1e9:
        raise MotionError(f"at is {value!r}: give seconds, or frames as '36f'")
    return float(cast("float", seconds))


def _value(name: str, value: object) -> Value:
    if isinstance(value, bool | str):
        return value
    if _is_number(value):
        return float(cast("float", value))
    if isinstance(value, list) and value and _are_numbers(cast("list[object]", value)):
        return tuple(float(part) for part in cast("list[float]", value))
    raise MotionError(f"{name} is {value!r}: give a number, a word, true or false, or a place as [x, y, z]")


def _is_number(value: object) -> bool:
    return isinstance(value, float) or (
        isinstance(value, int) and not isinstance(value, bool) and abs(value) < 1 << 1000
    )


def _are_numbers(values: list[object]) -> bool:
    return all(_is_number(value) for value in values)


def _header_lines(text: str) -> list[int]:
    """Return the lines on which the tables of commands begin, counted from 1; not those within long texts."""
    out: list[int] = []
    within = ""
    for number, line in enumerate(text.splitlines(), 1):
        if not within and _HEADER.match(line):
            out.append(number)
        for sign in re.findall(r'"""|' + "'''", line):
            within = "" if within == sign else within or sign
    # Commands may also stand as an array of tables in one place: they have its line.
    first = next((n for n, line in enumerate(text.splitlines(), 1) if re.match(r"\s*command\s*=", line)), 1)
    return out or [first] * text.count("{")


# --- targets ---


def _targets(table: object, name: str) -> tuple[dict[str, Place | str], list[str]]:
    if not isinstance(table, dict):
        raise FileError(f"{name}: targets are a table: write [targets] above them")
    out: dict[str, Place | str] = {}
    warnings: list[str] = []
    for key, value in cast("dict[str, object]", table).items():
        if isinstance(value, str) and value:
            out[key] = value
        elif (place := _place(value)) is not None:
            out[key] = place
        else:
            warnings.append(f"{name}: target {key!r} is {value!r}: give a place as [x, y, z], or the name of an object")
    return out, warnings


def _place(value: object) -> Place | None:
    numbers = cast("list[object]", value) if isinstance(value, list) else []
    if len(numbers) not in {2, 3} or not _are_numbers(numbers):
        return None
    return tuple(float(part) for part in cast("list[float]", numbers))


def _toml(value: Value) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(_toml(number) for number in value)}]"
    if isinstance(value, bool):
        return str(value).lower()
    return _text(value) if isinstance(value, str) else repr(float(value))


def _text(value: str) -> str:
    """Return a text as a string of TOML, whose escapes are those of JSON."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007F")
