"""Files of BML as elements with their lines: XML without anything that could make a reader do more than read."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from xml.parsers import expat

from ...errors import FileError

LARGEST = 10_000_000
"""Longer files are refused [characters]."""
DEEPEST = 50
_REFERENCE = re.compile(r"\s*(?:([^:+\s]+(?::[^:+\s]+)?):)?([A-Za-z_]\w*)?\s*([-+]\s*\d*\.?\d+)?\s*$")


@dataclass(frozen=True)
class Element:
    """An element of a file; names are without their namespaces."""

    name: str
    attributes: Mapping[str, str]
    origin: str
    """File and line, for messages."""
    children: list["Element"] = field(default_factory=list["Element"])

    def get(self, name: str) -> str:
        """Return an attribute, empty where it is not given."""
        return self.attributes.get(name, "").strip()

    @property
    def id(self) -> str:
        """What others call it."""
        return self.get("id")


@dataclass(frozen=True)
class Reference:
    """A time that is told by another one: a sync point of a behaviour, and how much later."""

    behaviour: str
    """Its id; empty for the behaviour itself."""
    point: str
    """Empty for the start of the block."""
    offset: float
    """[s]."""


@dataclass(frozen=True)
class Constraint:
    """What the block demands of the times of behaviours."""

    kind: str
    """"synchronize", "before" or "after"."""
    first: Reference
    """What the others are timed by."""
    others: tuple[Reference, ...]
    origin: str


def parse(text: str, name: str) -> list[Element]:
    """Return the blocks of a file.

    Raises:
        FileError: It is no XML, holds what no BML needs, or has no block.
    """
    if len(text) > LARGEST:
        raise FileError(f"{name}: it is longer than {LARGEST} characters: cut it into parts")
    top = Element("", {}, name)
    stack = [top]
    parser = expat.ParserCreate()

    def begin(tag: str, attributes: Mapping[str, str]) -> None:
        if len(stack) > DEEPEST:
            raise FileError(f"{name}, line {parser.CurrentLineNumber}: elements are nested too deeply")
        own = {_plain(key): value for key, value in attributes.items()}
        element = Element(_plain(tag), own, f"{name}, line {parser.CurrentLineNumber}")
        stack[-1].children.append(element)
        stack.append(element)

    def end(_: str) -> None:
        stack.pop()

    def refuse(*_: object) -> None:
        # Entities may grow without bound, or read other files.
        raise FileError(f"{name}, line {parser.CurrentLineNumber}: a BML file declares no document type: remove it")

    parser.StartElementHandler = begin
    parser.EndElementHandler = end
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(text.encode("utf-8", "surrogatepass"), True)
    except expat.ExpatError as error:
        raise FileError(f"{name}, line {error.lineno}: {expat.ErrorString(error.code)}: it is no XML") from error
    blocks = list(_blocks(top))
    if not blocks:
        raise FileError(f"{name}: it has no <bml> element")
    return blocks


def _blocks(element: Element) -> Iterator[Element]:
    """Yield the blocks of a file, which may be wrapped in others."""
    for child in element.children:
        if child.name == "bml":
            yield child
        else:
            yield from _blocks(child)


def _plain(name: str) -> str:
    return name.rpartition(":")[2]


def parts_of(block: Element) -> tuple[list[Element], list[Constraint], list[str]]:
    """Return the behaviours of a block, its constraints, and warnings."""
    behaviours: list[Element] = []
    constraints: list[Constraint] = []
    warnings: list[str] = []
    for child in block.children:
        if child.name == "required":
            more, also, told = parts_of(child)
            behaviours += more
            constraints += also
            warnings += told
        elif child.name == "constraint":
            for part in child.children:
                found = _constraint(part)
                if found is None:
                    warnings.append(f"{part.origin}: <{part.name}> is no constraint that is understood: it is left out")
                else:
                    constraints.append(found)
        else:
            behaviours.append(child)
    return behaviours, constraints, warnings


def _constraint(element: Element) -> Constraint | None:
    first = element.get("ref")
    others = [sync.get("ref") for sync in element.children if sync.name == "sync"]
    if not first and others:
        first, others = others[0], others[1:]
    found = [reference(text) for text in (first, *others)]
    known = [one for one in found if one is not None]
    if element.name not in {"synchronize", "before", "after"} or len(known) != len(found) or len(known) < 2:
        return None
    return Constraint(element.name, known[0], tuple(known[1:]), element.origin)


def reference(text: str) -> Reference | None:
    """Return the time that a text tells: seconds, ``id:point``, ``point+0.5``, or ``block:id:point - 1``."""
    try:
        seconds = float(text)
    except ValueError:
        pass
    else:
        return Reference("", "", seconds) if abs(seconds) < 1e9 else None
    found = _REFERENCE.match(text)
    if found is None or not found[2]:
        return None
    behaviour = (found[1] or "").rpartition(":")[2]
    return Reference(behaviour, found[2], float((found[3] or "0").replace(" ", "")))
