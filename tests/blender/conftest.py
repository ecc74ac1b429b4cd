"""What the tests in Blender share: an empty file for each test, the command line, and files to work on."""

import os
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import bpy
import pytest

from morph_retarget.blender.retarget import Source
from morph_retarget.core.arrays import Array
from tests.blender import command, control_rigs, scenes, walking, window
from tests.blender.command import Command, Refused
from tests.blender.files import Files
from tests.blender.imported import Imported
from tools.figure import blender


@pytest.fixture(autouse=True)
def _empty_file() -> None:
    """Start each test with an empty file, whatever the one before has left open."""
    scenes.empty()


@pytest.fixture
def registered(_empty_file: None) -> Iterator[None]:
    """Register the extension for a test."""
    with window.registered():
        yield


@pytest.fixture
def walked(_empty_file: None) -> None:
    """Let the scene last as long as `walking.WHOLE` does."""
    bpy.context.scene.frame_end = walking.WHOLE[-1]


@pytest.fixture
def cli(capfd: pytest.CaptureFixture[str]) -> Command:
    """Return the command line as a function: arguments to status, stdout and stderr."""
    return partial(command.run, capfd)


@pytest.fixture(scope="session")
def files(tmp_path_factory: pytest.TempPathFactory) -> Files:
    """Return clips and rigs as files; tests read them and leave them as they are."""
    return Files.make(tmp_path_factory.mktemp("files"))


@pytest.fixture(scope="session")
def imported(tmp_path_factory: pytest.TempPathFactory) -> Imported:
    """Return real files as they are once imported; the processes of a run share them."""
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "imported"
    folder.mkdir(exist_ok=True)
    return Imported(folder)


@pytest.fixture(scope="session")
def rigify_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a file with a person that Rigify has generated; its armature is called "rig"."""
    return control_rigs.rigify(tmp_path_factory.mktemp("rigify") / "rigify.blend")


@pytest.fixture(scope="session")
def horse_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a file with a horse that Rigify has generated; its armature is called "rig"."""
    return control_rigs.rigify(tmp_path_factory.mktemp("horse") / "horse.blend", "horse")


@pytest.fixture(scope="session")
def walk() -> Source:
    """Return the usual clip; what was read outlives the file that it was read from."""
    scenes.empty()
    return scenes.source_of(scenes.walker())


@pytest.fixture(scope="session")
def expected(walk: Source) -> Array:
    """Return the directions of the small body's segments when it plays the usual clip, shape (frame, segment, 3)."""
    scenes.empty()
    ob = scenes.sprout()
    scenes.give(walk, ob)
    return scenes.directions(ob, scenes.FRAMES, blender)


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """Return an empty folder for results."""
    folder = tmp_path / "out"
    folder.mkdir()
    return folder


@pytest.fixture
def refused(cli: Command, out: Path) -> Refused:
    """Return a function that runs a command which must fail without a trace, and returns its one message."""
    (out / "older.blend").write_text("kept")
    return partial(command.refused, cli, out)
