"""BML 1.0, the Behavior Markup Language: blocks of behaviours that are timed by each other, as commands.

Feng 2013 §6.1 controls its characters by it. A subset is read: gaze, head, face as deforms, gesture, pointing, posture,
locomotion and reaching for things; what else a file holds is named in a warning with its line, and the rest plays.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ...errors import MotionError
from . import bml_file, bml_lexicon, bml_timing
from .bml_file import Element
from .bml_timing import Lasting, Timed
from .command import Command
from .script import Script


@dataclass(frozen=True)
class _Block:
    """A block with its behaviours, when that begins."""

    element: Element
    timed: tuple[Timed, ...]
    start: float
    end: float


def read(text: str, name: str, lasting: Mapping[str, Lasting] | None = None) -> Script:
    """Return a file as a script.

    Args:
        text: Of the file.
        name: Of the file, for messages.
        lasting: How long motions take, by the names of their models, where that is known.

    Raises:
        FileError: It is no BML.
    """
    document = bml_file.parse(text, name)
    warnings: list[str] = []
    commands: list[Command] = []
    blocks: list[_Block] = []
    for element in document:
        block, told = _block(element, blocks, {} if lasting is None else lasting)
        warnings += told
        if _composition(element, warnings) == "REPLACE":
            commands = [command for command in commands if command.time < block.start]
        blocks.append(block)
        for timed in block.timed:
            try:
                commands += bml_lexicon.commands_of(timed, warnings)
            except MotionError as error:
                warnings.append(f"{timed.element.origin}: {error}")
    return Script(tuple(sorted(commands, key=lambda command: command.time)), warnings=tuple(dict.fromkeys(warnings)))


def _block(element: Element, before: Iterable[_Block], lasting: Mapping[str, Lasting]) -> tuple[_Block, list[str]]:
    """Return a block at its time, and warnings: appended ones begin when all before them have ended."""
    behaviours, constraints, warnings = bml_file.parts_of(element)
    kept: list[Element] = []
    for one in behaviours:
        problem = bml_lexicon.problem_of(one)
        if problem:
            warnings.append(f"{one.origin}: {problem}")
        else:
            kept.append(one)
    timed, told = bml_timing.resolved(kept, constraints, lasting)
    start = 0.0
    if element.get("composition").upper() == "APPEND":
        start = max((block.end for block in before), default=0.0)
    moved = tuple(one.later(start) for one in timed)
    end = max([start, *(one.end for one in moved)])
    return _Block(element, moved, start, end), [*warnings, *told]


def _composition(element: Element, warnings: list[str]) -> str:
    found = element.get("composition").upper() or "MERGE"
    if found not in {"MERGE", "APPEND", "REPLACE"}:
        warnings.append(f"{element.origin}: composition is {found!r}: choose MERGE, APPEND or REPLACE; it is merged")
    return found
