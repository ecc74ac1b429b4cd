"""Scripts of commands, from files and texts into a character's list and back.

A script counts seconds from the first frame of the scene, and tells places as the character sees them where it sets
out. The list has frames of the scene and places in the world.
"""

from pathlib import Path

import bpy
import numpy as np

from ...core.arrays import Array
from ...core.character.character import Character
from ...core.clips.commands import bml, script
from ...core.clips.commands.command import Command, Value
from ...core.clips.commands.script import Script
from ...core.errors import FileError
from ..locomotion.going import matrix_of
from ..properties import of_rig
from ..sampling import seconds_per_frame
from .changes import together
from .known import TARGET
from .parameters import found

MARKUP = (".bml", ".xml")
TABLES = ".toml"


def load(path: Path, frame_rate: float) -> Script:
    """Return the script of a file.

    Args:
        path: Its name tells what it is: ``.toml``, ``.bml`` or ``.xml``.
        frame_rate: Frames in a second, where the file counts in frames.

    Raises:
        FileError: It cannot be read, or is no script.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"{path}: cannot be read as a script of commands: check the path") from error
    return parse(text, path.name, frame_rate)


def parse(text: str, name: str, frame_rate: float) -> Script:
    """Return the script in a text; see `load`. One whose name tells nothing is told by how it begins.

    Raises:
        FileError: It is no script.
    """
    suffix = Path(name).suffix.lower()
    markup = suffix in MARKUP or (suffix != TABLES and text.lstrip().startswith("<"))
    return bml.read(text, name) if markup else script.read(text, name, frame_rate)


def bring_in(
    ob: bpy.types.Object, character: Character, told: Script, scene: bpy.types.Scene, folder: Path | None = None
) -> list[str]:
    """Give a character the commands of a script beside those that it has, and return warnings.

    Places with a name become empties of that name; one that is there already is moved there.

    Args:
        ob: The character.
        character: What it is.
        told: The script.
        scene: Gives the frames, and gets the empties.
        folder: Of the script's file, in which its library is.
    """
    own, seconds, to_world = of_rig(ob).directing, seconds_per_frame(scene), _stands(ob, character)
    warnings = list(told.warnings)
    names: dict[str, str] = {}
    for name, target in told.targets.items():
        if isinstance(target, str):
            names[name] = target
        elif not _put_empty(name, _moved(target, to_world, 3), scene):
            warnings.append(f"there is an object {name!r} that is no empty: it is the target where it is")
    with together(own):
        for command in told.commands:
            values = {name: _here(name, value, names, to_world) for name, value in command.parameters.items()}
            item = own.command(scene.frame_start + command.time / seconds, command.verb, command.model, **values)
            item.origin = command.origin
        if told.library:
            own.library = str(told.library if folder is None else folder / told.library)
    return warnings


def taken_out(ob: bpy.types.Object, character: Character, scene: bpy.types.Scene) -> Script:
    """Return what a character's list says as a script."""
    own, from_world = of_rig(ob).directing, np.linalg.inv(_stands(ob, character)).astype(np.float64)
    first = scene.frame_start * seconds_per_frame(scene)
    commands = [
        Command(
            round(command.time - first, 9),
            command.verb,
            command.model,
            {name: _moved(v, from_world) if isinstance(v, tuple) else v for name, v in command.parameters.items()},
        )
        for command in own.commands_of(scene)
    ]
    library = "" if own.library_path is None else str(own.library_path)
    return Script(tuple(commands), library=library)


def _stands(ob: bpy.types.Object, character: Character) -> Array:
    """Return what leads from where a character stands to the world, shape (4, 4)."""
    return np.array(ob.matrix_world, dtype=np.float64) @ matrix_of(character.local_to_character.inverse())


def _here(name: str, value: Value, names: dict[str, str], to_world: Array) -> object:
    """Return the value of a script's parameter as the list has it."""
    if isinstance(value, tuple):
        return _moved(value, to_world, 3)
    if name == TARGET and isinstance(value, str):
        return found(names.get(value, value)) or names.get(value, value)
    return value


def _moved(place: tuple[float, ...], matrix: Array, count: int = 0) -> tuple[float, ...]:
    """Return a place through a matrix, with as many coordinates as it has, or as are asked for."""
    point = np.array([*place, 0.0][:3])
    return tuple((matrix[:3, :3] @ point + matrix[:3, 3]).round(6).tolist()[: count or len(place)])


def _put_empty(name: str, place: tuple[float, ...], scene: bpy.types.Scene) -> bool:
    """Put an empty of some name at a place of the world; False if the name is taken by something else."""
    ob = bpy.data.objects.get(name)
    if ob is None:
        ob = bpy.data.objects.new(name, None)
        ob.empty_display_size = 0.1
        scene.collection.objects.link(ob)
    if ob.type == "EMPTY":
        ob.location = place
    return ob.type == "EMPTY"
