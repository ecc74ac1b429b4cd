"""Scripts of commands for the command line: characters that do what a file tells them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import bpy

from ...core.clips.character_model import RATE
from ...core.errors import FileError
from ...core.morph.bind import GeneralizedAction
from .. import rig
from ..directing import scripts, walking
from ..locomotion.properties import Source
from ..morph import analyses, cast
from ..properties import of_rig
from ..sampling import seconds_per_frame
from .locomotion import NoAction

SUFFIXES = (scripts.TABLES, *scripts.MARKUP)
AFTER = 3.0
"""A character goes on for so long after its last command, where no frames are asked for [s] …"""
TO_REST = 1.0
"""… and for so long after the last motion has ended [s]."""


@dataclass(frozen=True)
class ScriptFile(NoAction):
    """In place of a file with an action: one with commands."""

    script: Path = field(default_factory=Path)


def is_script(text: str) -> bool:
    """Return whether what shall be played is a script."""
    return text.lower().endswith(SUFFIXES)


def found(text: str) -> ScriptFile:
    """Return a script that shall be played.

    Raises:
        FileError: There is no such file.
    """
    path = Path(text)
    if not path.is_file():
        raise FileError(f"{path}: no such file: check the path")
    render = rig.scene_of().render
    return ScriptFile(None, path.stem, GeneralizedAction(path.stem, ()), render.fps / render.fps_base, path)


def tell(source: ScriptFile, ob: bpy.types.Object) -> list[str]:
    """Tell a character what a script says, at the frame rate that its scene has, and return warnings.

    Raises:
        FileError: The file is no script.
    """
    scene = rig.scene_of()
    told = scripts.load(source.script, 1.0 / seconds_per_frame(scene))
    own = of_rig(ob)
    own.gait.enabled, own.gait.source = True, Source.COMMANDS.value
    own.directing.clear()
    _, character, _ = analyses.of(ob)
    warnings = scripts.bring_in(ob, character, told, scene, source.script.parent)
    cast.forget(ob)
    return warnings


def frames(characters: Sequence[bpy.types.Object]) -> tuple[int, int]:
    """Return the first and last frame in which characters do what they were told, with what had to wait."""
    scene = rig.scene_of()
    last = max(_last(ob, scene) for ob in characters)
    return scene.frame_start, math.ceil(last)


def _last(ob: bpy.types.Object, scene: bpy.types.Scene) -> float:
    rate = 1.0 / seconds_per_frame(scene)
    commanded = max((command.frame for command in of_rig(ob).directing.commands), default=scene.frame_start)
    performance = walking.performance_of(cast.member(ob), scene)
    settled = scene.frame_start if performance is None else scene.frame_start + performance.settled / RATE * rate
    return max(commanded + AFTER * rate, settled + TO_REST * rate)
