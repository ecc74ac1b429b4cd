"""Checking a BVH file before Blender's importer reads it, which takes a truncated file for a short one."""

from pathlib import Path

import numpy as np

from ...core.errors import FileError


def check(path: Path) -> None:
    """Check that a BVH file is whole: hierarchy, frames, and a finite number for every channel of every frame.

    Raises:
        FileError: It is not, with what is missing.
    """
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise FileError(f"{path}: cannot be read ({error.strerror}): check the file and its permissions") from error
    head, found, tail = text.partition("MOTION")
    if "HIERARCHY" not in head or not found:
        raise FileError(f"{path}: no BVH file, or cut off before its MOTION part: export it again")
    if head.count("{") != head.count("}") or "ROOT" not in head:
        raise FileError(f"{path}: the skeleton in its HIERARCHY part is not closed: export it again")
    channels = _channel_count(head, path)
    frames, values = _motion(tail, path)
    if frames <= 0:
        raise FileError(f"{path}: has no frames: choose a clip that moves")
    if values.size < frames * channels:
        whole = values.size // max(channels, 1)
        raise FileError(f"{path}: cut off after frame {whole} of {frames}: export it again")
    bad = np.flatnonzero(~np.isfinite(values[: frames * channels]))
    if bad.size:
        raise FileError(
            f"{path}: frame {bad[0] // channels + 1} holds a value that is no number: mend or export it again"
        )


def _channel_count(head: str, path: Path) -> int:
    words = head.split()
    try:
        return sum(int(words[i + 1]) for i, word in enumerate(words) if word.upper() == "CHANNELS")
    except (ValueError, IndexError) as error:
        raise FileError(f"{path}: a CHANNELS line in its HIERARCHY part has no count: export it again") from error


def _motion(tail: str, path: Path) -> tuple[int, np.ndarray]:
    """Return the number of frames that the file announces and all values that it holds."""
    lines = tail.split("\n")
    frames = seconds = None
    start = 0
    for start, line in enumerate(lines):  # noqa: B007 - where the loop stops is where the values begin
        name, colon, value = line.partition(":")
        if not colon:
            if frames is not None and seconds is not None:
                break
            continue
        try:
            if name.strip().lower() == "frames":
                frames = int(value)
            elif name.strip().lower() == "frame time":
                seconds = float(value)
        except ValueError as error:
            raise FileError(f"{path}: its line {line.strip()!r} holds no number: export it again") from error
    if frames is None or seconds is None or not seconds > 0.0:
        raise FileError(f"{path}: its MOTION part has no Frames or no Frame Time: export it again")
    try:
        values = np.array(" ".join(lines[start:]).split(), dtype=np.float64)
    except ValueError as error:
        raise FileError(f"{path}: its motion holds a value that is no number: export it again") from error
    return frames, values
