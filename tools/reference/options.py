"""Options of the command line, from the parser that reads them."""

import argparse
from collections.abc import Iterator, Sequence

from morph_retarget.blender.cli import program

from .markdown import code, page, sentence, table

_INTRODUCTION = """
`blender -b [FILE.blend] --command morph_retarget COMMAND …` and `python -m morph_retarget COMMAND …` are the same
program. What the commands are for, with examples: [the command line](../command-line.md) and
[validation](../validation.md). Exit status: 0 all well, 1 a job or a check failed, 2 the request or an input was
unusable.
"""


def options() -> str:
    """Return the page of all commands and options."""
    return page("Options of the command line", _INTRODUCTION.strip(), *_commands(program.parser()))


def _commands(parser: argparse.ArgumentParser) -> Iterator[str]:
    (commands,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))  # noqa: SLF001 - argparse has
    for listed in commands._choices_actions:  # noqa: SLF001 - no public way to ask a parser what it knows
        yield from _command(str(listed.dest), str(listed.help), commands.choices[listed.dest])


def _command(name: str, purpose: str, parser: argparse.ArgumentParser) -> Iterator[str]:
    groups = [(group.title or "", group._group_actions) for group in parser._action_groups]  # noqa: SLF001
    placed = [action for _, actions in groups for action in actions if not action.option_strings]
    words = " ".join(_placed(action) for action in placed)
    yield f"## `{name} {words}`\n\n{sentence(purpose)}."
    yield table(("argument", "meaning"), ((code(_placed(action)), _help(action)) for action in placed))
    for title, actions in groups:
        named = [action for action in actions if action.option_strings and action.dest != "help"]
        rows = table(("option", "meaning"), ((_option(action), _help(action)) for action in named))
        if rows:
            heading = "" if title in {"options", "positional arguments"} else f"### {name}: {title}\n\n"
            yield heading + rows


def _placed(action: argparse.Action) -> str:
    return f"{action.metavar or action.dest}{'…' if action.nargs in {'+', '*'} else ''}"


def _option(action: argparse.Action) -> str:
    return f"{', '.join(code(name) for name in action.option_strings)} {_value(action)}"


def _value(action: argparse.Action) -> str:
    if action.nargs == 0:
        return ""
    if action.choices is not None:
        return " or ".join(code(str(choice)) for choice in action.choices)
    metavar: str | Sequence[str] = action.metavar or action.dest.upper()
    name = metavar if isinstance(metavar, str) else " ".join(metavar)
    return code(f"{name}{'…' if action.nargs in {'+', '*'} else ''}")


def _help(action: argparse.Action) -> str:
    return (action.help or "").replace("%%", "%")
