"""What the behaviours of BML are called here, and what their attributes mean."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ...errors import MotionError, listed
from .bml_file import Element
from .bml_timing import POINTS, Timed
from .command import Command, Value, Verb

_TIMES = {*POINTS, "strokeStart", "strokeEnd", "attackPeak", "peak", "duration", "id"}
_MODES: Mapping[str, str] = {"LEFT_HAND": "left", "RIGHT_HAND": "right", "BOTH_HANDS": ""}
_INFLUENCE: Mapping[str, str] = {
    "EYES": "eyes", "HEAD": "head", "NECK": "head", "SHOULDER": "chest", "CHEST": "chest", "WAIST": "waist",
    "BACK": "waist", "WHOLE": "waist",
}  # fmt: skip
"""How much of the body shares in a gaze, from the eyes downward."""
_HEADS: Mapping[str, str] = {"NOD": "nod", "SHAKE": "shake", "TILT": "tilt"}
MOST: Mapping[str, float] = {"nod": 28.0, "shake": 32.0, "tilt": 30.0}
"""How far the head turns at an amount of 1 [deg]; the usual amount is a half."""
_SPEECHLESS = "is not supported: it is left out"


@dataclass(frozen=True)
class _Entry:
    """How a behaviour of BML is told to a character."""

    attributes: frozenset[str]
    """Those that are understood beside times and the id."""
    model: Callable[[Element], str]
    """Whom it addresses."""
    parameters: Callable[[Element], dict[str, Value]]
    stays: bool = False
    """Whether it goes on until something else is told."""
    finite: bool = False
    """Whether it ends by itself, so that nothing has to stop it."""


def _number(element: Element, name: str) -> dict[str, float]:
    text = element.get(name)
    if not text:
        return {}
    try:
        return {name: float(text)}
    except ValueError as error:
        raise MotionError(f"{name} is {text!r}, which is no number: <{element.name}> is left out") from error


def _choice(element: Element, name: str, known: Mapping[str, str]) -> str:
    text = element.get(name).upper()
    if text and text not in known:
        raise MotionError(f"{name} is {text!r}: choose one of {listed(known)}: <{element.name}> is left out")
    return known.get(text, "")


def _side(element: Element) -> dict[str, Value]:
    side = _choice(element, "mode", _MODES)
    return {"side": side} if side else {}


def _target(element: Element) -> dict[str, Value]:
    target = element.get("target")
    if not target:
        raise MotionError(f"<{element.name}> has no target: it is left out")
    numbers = target.replace(",", " ").split()
    try:
        place = tuple(float(number) for number in numbers)
    except ValueError:
        place = ()
    return {"place": place} if len(place) in {2, 3} else {"target": target}


def _gaze(element: Element) -> dict[str, Value]:
    influence = _choice(element, "influence", _INFLUENCE)
    return _target(element) | ({"level": influence} if influence else {})


def _head(element: Element) -> dict[str, Value]:
    out: dict[str, Value] = {}
    repeats = [*_number(element, "repetition").values(), *_number(element, "repeats").values()]
    if repeats and _nodding(element) != "tilt":
        out["repeats"] = repeats[0]
    for amount in _number(element, "amount").values():
        out["amplitude"] = MOST[_nodding(element)] * amount
    return out


def _lexeme(element: Element) -> str:
    name = element.get("lexeme") or element.get("type") or element.get("name")
    if not name:
        raise MotionError(f"<{element.name}> has no lexeme: it is left out")
    return name.lower()


def _nodding(element: Element) -> str:
    return _choice(element, "lexeme" if element.get("lexeme") else "type", _HEADS) or "nod"


def _going(element: Element) -> str:
    if element.get("target"):
        return "go"
    return element.get("manner").lower() or "walk"


def _way(element: Element) -> dict[str, Value]:
    if not element.get("target"):
        return {**_number(element, "speed")}
    manner = element.get("manner").lower()
    return _target(element) | _number(element, "speed") | ({"manner": manner} if manner else {})


def _named(element: Element) -> str:
    return element.name.lower()


def _held(element: Element) -> dict[str, Value]:
    return _target(element) | _side(element)


def _nothing(_: Element) -> dict[str, Value]:
    return {}


def _face(element: Element) -> dict[str, Value]:
    unit, side = element.get("au"), element.get("side").upper()
    name = f"AU{unit}" if unit else element.get("lexeme") or element.get("type")
    if not name:
        raise MotionError(f"<{element.name}> has neither a lexeme nor an au: it is left out")
    if side in {"LEFT", "RIGHT"}:
        name += "_" + side[0]
    return {"key": name, **_number(element, "amount")}


_FACIAL = frozenset({"lexeme", "type", "au", "side", "amount"})
_TARGETED = frozenset({"target", "mode"})
_ENTRIES: Mapping[str, _Entry] = {
    "gaze": _Entry(frozenset({"target", "influence"}), _named, _gaze),
    "gazeShift": _Entry(frozenset({"target", "influence"}), lambda _: "gaze", _gaze, stays=True),
    "headDirectionShift": _Entry(
        frozenset({"target"}), lambda _: "gaze", lambda one: _target(one) | {"level": "head"}, stays=True
    ),
    "head": _Entry(frozenset({"lexeme", "type", "repetition", "repeats", "amount"}), _nodding, _head, finite=True),
    "saccade": _Entry(frozenset({"mode"}), _named, _nothing),
    "gesture": _Entry(frozenset({"lexeme", "type", "name", "mode"}), _lexeme, _side, finite=True),
    "animation": _Entry(frozenset({"name"}), _lexeme, _nothing, finite=True),
    "pointing": _Entry(_TARGETED, lambda _: "point", _held),
    "reach": _Entry(_TARGETED, _named, _held),
    "touch": _Entry(_TARGETED, _named, _held),
    "grasp": _Entry(_TARGETED, _named, _held),
    "locomotion": _Entry(frozenset({"target", "manner", "speed", "type"}), _going, _way),
    "face": _Entry(_FACIAL, lambda _: "face", _face),
    "faceLexeme": _Entry(_FACIAL, lambda _: "face", _face),
    "faceFacs": _Entry(_FACIAL, lambda _: "face", _face),
    "faceShift": _Entry(_FACIAL, lambda _: "face", _face, stays=True),
    "wait": _Entry(frozenset(), _named, _nothing, finite=True),
}


def problem_of(element: Element) -> str:
    """Return why a behaviour cannot be understood at all, empty if it can."""
    return "" if element.name in _ENTRIES else f"<{element.name}> {_SPEECHLESS}"


def commands_of(timed: Timed, warnings: list[str]) -> list[Command]:
    """Return a behaviour as commands.

    Raises:
        MotionError: It says what cannot be.
    """
    element = timed.element
    entry = _ENTRIES[element.name]
    unknown = element.attributes.keys() - entry.attributes - _TIMES
    warnings += [f"{element.origin}: {name!r} of <{element.name}> {_SPEECHLESS}" for name in sorted(unknown)]
    model = entry.model(element)
    if element.name == "wait":
        return []
    values = entry.parameters(element)
    if element.name == "head":
        values |= _tempo(timed, values)
    elif entry.finite:
        values |= _timing(timed)
    start = Command(timed.at("start"), Verb.START, model, values, element.origin)
    ends = entry.finite and model != "tilt"
    if entry.stays or ends or (element.name == "locomotion" and element.get("target")):
        return [start]
    ended: dict[str, Value] = {}
    if model == "face":
        # Several show at once, so it is said which of them goes, and how long it takes.
        values["fade"] = round(max(timed.at("ready") - timed.at("start"), 0.0), 6)
        ended = {"key": values["key"], "fade": round(max(timed.end - timed.at("relax"), 0.0), 6)}
    return [start, Command(timed.at("relax"), Verb.STOP, model, ended, element.origin)]


def _tempo(timed: Timed, values: Mapping[str, Value]) -> dict[str, Value]:
    """Return how fast a head moves that has to be done by a time, if the file tells one."""
    repeats, lasts = values.get("repeats", 2.0), timed.end - timed.at("start")
    if _nodding(timed.element) == "tilt" or "end" not in timed.told or not isinstance(repeats, float) or lasts <= 0.0:
        return {}
    return {"speed": round(max(repeats, 1.0) / lasts, 6)}


def _timing(timed: Timed) -> dict[str, Value]:
    """Return when a motion has its sync points, as far as the file tells, from its start [s]."""
    start = timed.at("start")
    out: dict[str, Value] = {}
    if timed.told & {"stroke", "stroke_start", "stroke_end"}:
        out["stroke"] = round(timed.at("stroke") - start, 6)
    if "end" in timed.told or timed.element.get("duration"):
        out["duration"] = round(timed.end - start, 6)
    return out
