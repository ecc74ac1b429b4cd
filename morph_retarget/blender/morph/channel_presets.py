"""Sets of channels that animators keep and use again; some come with the extension."""

from pathlib import Path

import bpy

from ...core.errors import FileError
from ...core.morph import channel_file
from ...core.morph.channels import Channel
from .. import presets
from . import definitions

KIND = "channels"
BIPED = "Biped Mocap"
"""Comes with the extension: what matters about the motion of a captured human."""

_SHIPPED = Path(__file__).parent / "presets"


def names() -> list[str]:
    """Return all presets, in order of their names; one's own take the place of those that come with the extension."""
    return sorted({path.stem for path in _SHIPPED.glob("*.json")} | set(presets.names(KIND)))


def load(name: str) -> tuple[Channel, ...]:
    """Return the channels of a preset.

    Raises:
        FileError: There is no such preset, or it cannot be read.
        MotionError: It is none.
    """
    if name not in names():
        raise FileError(f"there is no preset of channels {name!r}: choose one of {', '.join(names())}")
    path = presets.path_of(name, KIND) if name in presets.names(KIND) else _SHIPPED / f"{name}.json"
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(f"{path}: cannot be read: save the preset again") from error
    return channel_file.parse(text, str(path))


def save(action: bpy.types.Action, name: str) -> None:
    """Keep the channels of a generalized action as a preset.

    Raises:
        FileError: The name cannot be that of a file, or the file cannot be written.
        MotionError: The action cannot be read.
    """
    channels = definitions.read(action).channels
    presets.write(presets.path_of(name, KIND), channel_file.to_text(channels))


def delete(name: str) -> None:
    """Delete a preset of one's own.

    Raises:
        FileError: There is none of that name.
    """
    if name not in presets.names(KIND):
        raise FileError(f"there is no preset of your own {name!r}: choose one of {presets.names(KIND) or 'none'}")
    presets.path_of(name, KIND).unlink()
