"""What directed characters can be told, from the registries of behaviours, and styles of gaits."""

from collections.abc import Iterator

from morph_retarget.core.clips.behaviours.registry import BEHAVIOURS
from morph_retarget.core.clips.commands.parameters import Parameter
from morph_retarget.core.directing import starter
from morph_retarget.core.locomotion.patterns.styles import STYLES

from .markdown import code, page, table

_INTRODUCTION = """
What the list of commands, markers, scripts and Python may say: `start`, `stop` or `reset`, then a motion or a
behavior, then parameters. How it all works: [directing](../motion-models.md).
"""


def commands() -> str:
    """Return the page of behaviors and the starter library's motions."""
    motions = ", ".join(code(kind) for kind in sorted(starter.kinds_of_starter()))
    return page(
        "Motions, behaviors and gaits",
        _INTRODUCTION.strip(),
        f"## Motions of the starter library\n\n{motions}. A body has those that it can do.",
        "## Behaviors",
        *_behaviours(),
        "## Styles of gaits\n\nFor *Style*, `--gait` and `object.morph_retarget.gait.style`:",
        table(("style", "in the window", "meaning"), ((code(s.name), s.title, s.description) for s in STYLES.values())),
    )


def _behaviours() -> Iterator[str]:
    for own in BEHAVIOURS.values():
        rows = ((code(name), _usual(known), known.unit, known.description) for name, known in own.parameters.items())
        yield f"### `{own.name}`\n\n{own.description}."
        yield table(("parameter", "usual", "unit", "meaning"), rows)


def _usual(known: Parameter) -> str:
    value = known.default
    if isinstance(value, tuple):
        return ""
    return code(f"{value:g}" if isinstance(value, float) else str(value))
