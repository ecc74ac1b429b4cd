"""Parameters of motion models and behaviours: their purposes, types and limits (Grünvogel 2003 §5.2).

Data of the wrong type for its purpose is ignored, as the paper says; here with a warning that names the command.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ...errors import listed
from .command import Command, Value


@dataclass(frozen=True)
class Parameter:
    """One thing that can be said about how a motion is done."""

    default: Value
    """Its type is the parameter's type; a place is a tuple, and a name of a target a text."""
    description: str
    """For people; a sentence without its full stop."""
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    choices: tuple[str, ...] = ()
    """What a text may be; empty for any."""
    needed: bool = False
    """Whether a command without it makes no sense."""


Parameters = Mapping[str, Parameter]


def read(command: Command, known: Parameters) -> tuple[dict[str, Value], list[str]]:
    """Return the parameters of a command that its addressee understands, and warnings about all others."""
    out: dict[str, Value] = {}
    warnings: list[str] = []
    for name, value in command.parameters.items():
        problem = f"it has no parameter {name!r}: choose one of {listed(known, 20)}" if name not in known else ""
        if not problem:
            problem = _problem(name, value, known[name])
        if problem:
            warnings.append(told(command, problem))
        else:
            out[name] = _fitted(value, known[name])
    return out, warnings


def told(command: Command, problem: str) -> str:
    """Return a warning about a command in words."""
    where = command.origin or f"at {command.time:g} s"
    return f"{where}: {command.verb} {command.model}: {problem}"


def _problem(name: str, value: Value, known: Parameter) -> str:
    wanted = _kind(known.default)
    if _kind(value) != wanted:
        return f"{name} is {value!r}, not {_KINDS[wanted]}: it is ignored"
    numbers = value if isinstance(value, tuple) else (value,) if wanted == "number" else ()
    if not all(isinstance(number, int | float) and math.isfinite(number) for number in numbers):
        return f"{name} is {value!r}, which is no finite number: it is ignored"
    if known.choices and value not in known.choices:
        return f"{name} is {value!r}: choose one of {listed(known.choices, 20)}"
    if wanted == "place" and len(numbers) not in {2, 3}:
        return f"{name} is {value!r}: a place has two or three numbers"
    return ""


def _fitted(value: Value, known: Parameter) -> Value:
    """Return a value within its limits."""
    if _kind(value) != "number":
        return value
    assert isinstance(value, int | float), "it is a number"
    return min(max(float(value), known.low), known.high)


_KINDS = {"switch": "yes or no", "number": "a number", "text": "a word", "place": "a place"}


def _kind(value: Value) -> str:
    if isinstance(value, bool):
        return "switch"
    if isinstance(value, int | float):
        return "number"
    return "text" if isinstance(value, str) else "place"
