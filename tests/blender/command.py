"""The command line, called as a program is: arguments in; status, results and messages out."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from morph_retarget.blender.cli import program


@dataclass(frozen=True)
class Said:
    """What a run of the command line gave back."""

    status: int
    out: str
    """Everything on stdout."""
    errors: list[str]
    """The lines on stderr."""


Command = Callable[..., Said]
Refused = Callable[..., str]


def run(capfd: pytest.CaptureFixture[str], *arguments: object) -> Said:
    """Run the command line with ``arguments``, each turned into text."""
    capfd.readouterr()
    status = program.main([str(argument) for argument in arguments])
    out, errors = capfd.readouterr()
    return Said(status, out, errors.splitlines())


def contents(folder: Path) -> dict[str, bytes | None]:
    """Return all files below a folder with what is in them; folders have None."""
    return {str(p.relative_to(folder)): None if p.is_dir() else p.read_bytes() for p in folder.rglob("*")}


def refused(command: Command, folder: Path, *arguments: object, names: object) -> str:
    """Run a command that must fail without a trace, and return its one message.

    Args:
        command: The command line.
        folder: Where nothing may change.
        arguments: Of the command.
        names: What the message must name.
    """
    before = contents(folder)
    said = command(*arguments)
    assert said.status == 2, said
    assert said.out == "", said.out
    assert len(said.errors) == 1, said.errors[:20]
    (message,) = said.errors
    assert message.startswith("morph_retarget: "), message
    assert str(names) in message, message
    assert "Location:" not in message, f"{message}: tells where in the code"
    assert contents(folder) == before, f"left in the folder: {sorted(contents(folder))}"
    return message
