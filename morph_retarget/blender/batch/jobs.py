"""What a batch is asked to do, and the jobs that come of it."""

import argparse
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

from ...core.errors import FileError
from ..cli import retargeting

EVERY = "*"
"""In place of an action's name: all actions of the file."""
FILES = ("map", "source-map")
"""Options that name files."""


@dataclass(frozen=True)
class Wish:
    """Clips that shall go onto rigs, as a user writes them."""

    sources: tuple[str, ...]
    """Files or patterns of files, each with ``#ACTION`` or ``#*`` if need be."""
    targets: tuple[str, ...]
    """Files or patterns of files."""
    out: str | None = None
    """Template of the results' names below the folder of the results; a usual one when None."""
    options: Mapping[str, str | bool] = field(default_factory=dict)
    """Long options of ``retarget`` without their dashes, as text; True for those that take no value."""
    base: Path = Path()
    """Folder that files are named from."""
    where: str = ""
    """Where it was written, for messages: file and line."""
    name: str = ""
    """What it is called where parts of it are refused: file and number."""
    by_folder: bool = False
    """Sources are files below ``base``, none a pattern, whose folders count."""


@dataclass(frozen=True)
class Job:
    """One clip onto one rig; with `EVERY` as the action, all clips of one file."""

    source: Path
    action: str | None
    target: Path
    out: Path
    """Result; ``{action}`` in its name is filled in when the action is known."""
    name: str
    """Result from the folder of the results on, with slashes: what the job is called, once in a batch."""
    options: Mapping[str, str | bool]
    labels: tuple[str, str]
    """Source and target as they are named in reports."""
    place: tuple[str, str] = ("", "")
    """`where` and `name` of its wish."""

    @property
    def inputs(self) -> tuple[Path, ...]:
        """Files that the job reads."""
        return self.source, self.target, *(Path(str(self.options[name])) for name in FILES if name in self.options)

    @property
    def argv(self) -> list[str]:
        """Arguments of ``retarget`` that do the same."""
        out = [str(self.source), str(self.target), f"--out={self.out}", *as_arguments(self.options)]
        if self.action is not None:
            out.append("--all-actions" if self.action == EVERY else f"--action={self.action}")
        return out


@dataclass(frozen=True)
class Refused:
    """What was asked for and cannot be done; it costs nothing but itself."""

    name: str
    """Once in a batch."""
    error: str
    """One line that names the place and says what to do."""
    labels: tuple[str, str] = ("", "")
    """Source and target as they were written, as far as they are known."""


Item = Job | Refused


def as_arguments(options: Mapping[str, str | bool]) -> list[str]:
    """Return options as they stand on a command line."""
    return [f"--{name}" if value is True else f"--{name}={value}" for name, value in options.items()]


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise FileError(message)


def read_arguments(argv: list[str]) -> argparse.Namespace:
    """Return the arguments of ``retarget`` as it reads them.

    Raises:
        FileError: One is missing, unknown, or has no such value.
    """
    parser = _Parser(prog="retarget", add_help=False, allow_abbrev=False)
    retargeting.add_to(parser)
    return parser.parse_args(argv)


def usual_options() -> dict[str, object]:
    """Return the options that a job can have with their usual values: False where they take none."""
    parser = _Parser(add_help=False)
    retargeting.add_options(parser)
    return {name.replace("_", "-"): value for name, value in vars(parser.parse_args([])).items()}


def check_options(options: Mapping[str, str | bool]) -> None:
    """Check values of options, before anything is read; those that name files are left to the jobs.

    Raises:
        MorphError: One cannot be used.
    """
    told = {name: value for name, value in options.items() if name not in FILES}
    arguments = read_arguments(["source", "target", "--out=out.blend", *as_arguments(told)])
    retargeting.options_of(arguments)
