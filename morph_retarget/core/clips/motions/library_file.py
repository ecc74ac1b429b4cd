"""Libraries as files: one archive of arrays with a header in JSON. Nothing in it is ever executed.

The file holds the library's own body as well, so that it serves any target. Frames are kept in single precision.
"""

import io
import json
import os
import tokenize
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np

from ... import quat
from ...arrays import Array
from ...errors import FileError, MotionError
from ..character_model import CharacterModel
from ..clip import ClipPrimitive
from ..frames import Frames
from ..travel import Travel
from . import annotation_data, body_data
from .base_motion import BaseMotion
from .library import Library

FORMAT = 1
"""Version of the form that libraries are written in."""
SUFFIX = ".npz"
_MARK = "Morph Retarget library"
_HEADER = "header"


def save(library: Library, path: Path) -> None:
    """Write a library to a file, whole or not at all.

    Raises:
        FileError: It cannot be written.
    """
    path = Path(path)
    beside = path.with_name(f".{os.getpid()}.{path.name}")
    try:
        beside.write_bytes(encoded(library))
        beside.replace(path)
    except OSError as error:
        raise FileError(f"{path}: cannot be written ({error.strerror}): choose another folder") from error
    finally:
        beside.unlink(missing_ok=True)


def load(path: Path) -> Library:
    """Return the library of a file.

    Raises:
        FileError: It is missing, broken, no library, or was made by a newer version.
    """
    try:
        return decoded(Path(path).read_bytes(), str(path))
    except OSError as error:
        raise FileError(f"{path}: cannot be read ({error.strerror}): choose a library of motions") from error


def encoded(library: Library) -> bytes:
    """Return a library as the content of a file."""
    body, arrays = body_data.to_data(library.model)
    header = {
        "is": _MARK,
        "format": FORMAT,
        "body": body,
        "motions": [
            {"name": motion.name, "clip": motion.clip.name, "annotations": annotation_data.to_data(motion.annotations)}
            for motion in library.motions
        ],
    }
    content: dict[str, Any] = {f"body.{name}": values for name, values in arrays.items()}
    for i, motion in enumerate(library.motions):
        content |= {f"{i}.{name}": values for name, values in _arrays(motion.clip).items()}
    text = json.dumps(header, ensure_ascii=False, allow_nan=False).encode()
    out = io.BytesIO()
    np.savez_compressed(out, **{_HEADER: np.frombuffer(text, dtype=np.uint8)}, **content)
    return out.getvalue()


def decoded(content: bytes, origin: str) -> Library:
    """Return the library in the content of a file.

    Args:
        content: The file's bytes.
        origin: Where they came from, for messages.

    Raises:
        FileError: It is broken, no library, or was made by a newer version.
    """
    try:
        # Each member is read as a whole before NumPy parses it, so that its checksum is known to be right.
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = {name.removesuffix(".npy"): archive.read(name) for name in archive.namelist()}
        arrays = {name: np.load(io.BytesIO(member), allow_pickle=False) for name, member in members.items()}
        header: Any = json.loads(arrays.pop(_HEADER).tobytes())
    except _BROKEN as error:
        raise FileError(f"{origin}: is no library of motions: choose a file that Save Library wrote") from error
    if not isinstance(header, dict) or cast("dict[str, Any]", header).get("is") != _MARK:
        raise FileError(f"{origin}: is no library of motions: choose a file that Save Library wrote")
    table = cast("dict[str, Any]", header)
    if table.get("format") != FORMAT:
        raise FileError(f"{origin}: was made by a newer version of Morph Retarget: update the extension to use it")
    try:
        return _library(table, arrays)
    except (*_BROKEN, MotionError) as error:
        raise FileError(f"{origin}: is a broken library ({error}): save it again") from error


_BROKEN = (
    AttributeError,
    EOFError,
    KeyError,
    MemoryError,
    OSError,
    RuntimeError,
    SyntaxError,
    TypeError,
    ValueError,
    tokenize.TokenError,
    zipfile.BadZipFile,
    zlib.error,
)
"""What reading a file raises that somebody else made, or that was cut off."""


def _library(header: Mapping[str, Any], arrays: Mapping[str, Array]) -> Library:
    own = {name.removeprefix("body."): values for name, values in arrays.items() if name.startswith("body.")}
    model = body_data.from_data(header["body"], own)
    return Library(model, tuple(_motion(model, i, entry, arrays) for i, entry in enumerate(header["motions"])))


def _motion(model: CharacterModel, place: int, entry: Mapping[str, Any], arrays: Mapping[str, Array]) -> BaseMotion:
    name = str(entry["name"])

    def read(what: str, *shape: int) -> Array:
        values = arrays[f"{place}.{what}"].astype(np.float64)
        if values.shape[1:] != shape or not np.isfinite(values).all():
            raise ValueError(f"{what} of motion {name!r} do not fit the body")
        return values

    feet = len(model.feet)
    data = Frames(
        quat.normalize(read("rotations", len(model), 4)),
        read("translations", len(model.moving), 3),
        read("feet", feet, 3),
        read("contacts", feet),
    )
    if len({len(data), len(data.translations), len(data.feet), len(data.contacts)}) > 1:
        raise ValueError(f"motion {name!r} has arrays of several lengths")
    joints = arrays[f"{place}.joints"].astype(np.bool_)
    if joints.shape not in {(0,), (len(model),)}:
        raise ValueError(f"joints of motion {name!r} do not fit the body")
    way = read("travel", 3)
    clip = ClipPrimitive(str(entry["clip"]), model, data, Travel(way[:, :2], way[:, 2]), joints)
    return BaseMotion(name, clip, annotation_data.from_data(entry["annotations"], f"motion {name!r}"))


def _arrays(clip: ClipPrimitive) -> dict[str, Any]:
    way = np.column_stack([clip.way.places, clip.way.headings])
    data = {
        "rotations": clip.data.rotations,
        "translations": clip.data.translations,
        "feet": clip.data.feet,
        "contacts": clip.data.contacts,
        "travel": way,
    }
    return {name: values.astype(np.float32) for name, values in data.items()} | {"joints": clip.joints}
