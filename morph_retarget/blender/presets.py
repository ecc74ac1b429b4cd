"""Joint maps and other presets that users keep: JSON files in the extension's own folder."""

from pathlib import Path

import bpy

from ..core.character import map_file
from ..core.character.control_given import Reaching
from ..core.errors import FileError

_folder: list[Path] = []


def use(package: str) -> None:
    """Choose the folder of an extension by its package name; a copy that is no extension uses Blender's own folder."""
    if package.startswith("bl_ext."):
        path = bpy.utils.extension_path_user(package, path="presets", create=False)
    else:
        path = bpy.utils.user_resource("SCRIPTS", path="presets/morph_retarget")
    _folder[:] = [Path(path)]


def names(kind: str = "") -> list[str]:
    """Return the presets of a kind, joint maps by default, in order of their names."""
    folder = _folder[0] / kind if _folder else None
    return sorted(path.stem for path in folder.glob("*.json")) if folder is not None and folder.is_dir() else []


def path_of(name: str, kind: str = "") -> Path:
    """Return the file of a preset; kinds other than joint maps have folders of their own.

    Raises:
        FileError: The name cannot be that of a file.
    """
    if not name.strip() or any(c in name for c in '/\\:*?"<>|') or name.startswith("."):
        raise FileError(f"preset name {name!r}: use letters, digits and spaces")
    return _folder[0] / kind / f"{name}.json"


def write(path: Path, text: str) -> None:
    """Write the text of a preset.

    Raises:
        FileError: It cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise FileError(f"{path}: cannot be written ({error.strerror}): choose another place") from error


def save(
    path: Path,
    joints: dict[str, str],
    controls: dict[str, str] | None = None,
    reaches: dict[str, Reaching] | None = None,
) -> None:
    """Write a joint map, with the controls that the user has named.

    Raises:
        FileError: It cannot be written.
    """
    write(path, map_file.preset(joints, controls or {}, reaches))


def delete(name: str) -> None:
    """Delete a preset.

    Raises:
        FileError: There is none of that name.
    """
    path = path_of(name)
    if not path.exists():
        raise FileError(f"there is no preset {name!r}: choose one of {', '.join(names()) or 'none'}")
    path.unlink()
