"""What the tests in Blender share: an empty file for each test, the command line, and files to work on."""

from functools import partial
from pathlib import Path

import pytest

from tests.blender import command, scenes
from tests.blender.command import Command
from tests.blender.files import Files


@pytest.fixture(autouse=True)
def _empty_file() -> None:
    """Start each test with an empty file, whatever the one before has left open."""
    scenes.empty()


@pytest.fixture
def cli(capfd: pytest.CaptureFixture[str]) -> Command:
    """Return the command line as a function: arguments to status, stdout and stderr."""
    return partial(command.run, capfd)


@pytest.fixture(scope="session")
def files(tmp_path_factory: pytest.TempPathFactory) -> Files:
    """Return clips and rigs as files; tests read them and leave them as they are."""
    return Files.make(tmp_path_factory.mktemp("files"))


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """Return an empty folder for results."""
    folder = tmp_path / "out"
    folder.mkdir()
    return folder
