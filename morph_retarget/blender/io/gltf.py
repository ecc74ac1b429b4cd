"""What a glTF file says about itself that Blender's importer does not use or explain.

Keys have times and no frames, so Blender would lay those of a clip of 30 frames a second between its own 24.
"""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

RATES = (12.0, 15.0, 20.0, 23.976, 24.0, 25.0, 29.97, 30.0, 48.0, 50.0, 59.94, 60.0, 90.0, 100.0, 120.0, 240.0)
NEAR = 0.001
"""A rate this near to a usual one, in shares of it, is taken for that."""
_MAGIC, _JSON = 0x46546C67, 0x4E4F534A


COMPRESSIONS = ("KHR_draco_mesh_compression", "EXT_meshopt_compression")


def frame_rate(path: Path) -> float | None:
    """Return the rate of most of a file's clips [frames a second], None where they were not sampled evenly.

    The importer says what is wrong with a file; here a broken one merely has no rate.
    """
    try:
        data = _json(path.read_bytes())
        found = [_rate(data, sampler) for clip in data.get("animations", []) for sampler in clip.get("samplers", [])]
    except (OSError, ValueError, KeyError, IndexError, TypeError, AttributeError, struct.error):
        return None
    usual = [rate for rate in found if rate is not None]
    return max(sorted(set(usual)), key=usual.count) if usual else None


def compression(path: Path) -> str | None:
    """Return the extension that a file's meshes are compressed with, None when they are not or nobody can tell."""
    try:
        used = _json(path.read_bytes()).get("extensionsUsed", [])
        return next((name for name in COMPRESSIONS if name in used), None)
    except (OSError, ValueError, TypeError, AttributeError, struct.error):
        return None


def _json(content: bytes) -> Any:
    if len(content) < 20 or struct.unpack_from("<I", content)[0] != _MAGIC:
        return json.loads(content)
    length, kind = struct.unpack_from("<II", content, 12)
    if kind != _JSON:
        raise ValueError("a GLB begins with JSON")
    return json.loads(content[20 : 20 + length])


def _rate(data: Any, sampler: Any) -> float | None:
    times = data["accessors"][sampler["input"]]
    span = times["max"][0] - times["min"][0]
    if times["count"] < 3 or not span > 0.0:
        return None
    rate = (times["count"] - 1) / span
    nearest = RATES[int(np.argmin(np.abs(np.array(RATES) - rate)))]
    return nearest if abs(rate - nearest) < NEAR * nearest else None
