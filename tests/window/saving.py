"""A user saves the library of a character: takes the work back with Escape, then lets it be done."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

import bpy

from morph_retarget.core.clips.motions import library_file
from tests.blender import scenes
from tests.window.hand import Hand
from tests.window.scenes import choose, search, until

NAME = f"mine{library_file.SUFFIX}"


def path(hand: Hand) -> Iterator[None]:
    """Play it."""
    ob = scenes.sprout()
    choose(ob)
    bpy.ops.morph_retarget.direct(character=ob.name)
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        yield from _save(hand, folder)
        hand.press("ESC")
        yield from until(lambda: not _at_work(), "an end of the work")
        assert not any(folder.iterdir()), "nothing was written"
        yield from _save(hand, folder)
        yield from until(lambda: (folder / NAME).exists() and not _at_work(), "the library")
        assert {"idle", "walk", "run"} <= set(library_file.load(folder / NAME).kinds)
        assert [file.name for file in folder.iterdir()] == [NAME]


def _save(hand: Hand, folder: Path) -> Iterator[None]:
    """Ask for a file, name it, and wait until the work has begun."""
    yield from search(hand, "save library")
    yield from until(_browsers, "a file browser")
    yield from until(lambda: _browsers()[0].spaces.active.params, "its folder")
    area = _browsers()[0]
    area.spaces.active.params.directory = str(folder).encode()
    area.spaces.active.params.filename = NAME
    yield
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=hand.window, area=area, region=region):
        bpy.ops.file.execute()
    yield from until(_at_work, "work in steps")


def _browsers() -> list[bpy.types.Area]:
    windows = bpy.context.window_manager.windows
    return [area for window in windows for area in window.screen.areas if area.type == "FILE_BROWSER"]


def _at_work() -> bool:
    return any(
        operator.bl_idname == "MORPH_RETARGET_OT_save_library"
        for window in bpy.context.window_manager.windows
        for operator in window.modal_operators
    )
