"""Pictures of the panels for the documentation, taken in the window of a Blender program.

``python -m tools.screenshots BLENDER [NAME…]``, where BLENDER starts the program on some screen: a path, or a command
in quotes. ``--language ja_JP``, ``--light`` and ``--out FOLDER`` take them in another manner, to look at.
"""

import argparse
import json
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

ROOT = Path(__file__).resolve().parent.parent
IMAGES = ROOT / "docs" / "images"
INSIDE = ROOT / "tools" / "window_shots.py"
SIZE = (1600, 1000)
"""Of the window [px]."""
COLORS = 64
"""Of a picture; panels have few."""
FOOT = 6
"""What is left of the empty space below the last panel [px]."""


def main() -> int:
    """Take them; 1 if one is missing."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("blender", help="what starts the program")
    parser.add_argument("names", nargs="*", help="pictures to take; all when none is named")
    parser.add_argument("--language", default="en_US", help="of the window, by Blender's code")
    parser.add_argument("--light", action="store_true", help="in the light theme")
    parser.add_argument("--out", type=Path, default=IMAGES, help="folder of the pictures")
    given = parser.parse_intermixed_args()
    with tempfile.TemporaryDirectory() as folder:
        wanted = {"names": given.names, "language": given.language, "light": given.light, "out": folder}
        geometry = ["--window-geometry", "0", "0", *map(str, SIZE)]
        start = [*shlex.split(given.blender), "--factory-startup", *geometry, "--python", str(INSIDE)]
        done = subprocess.run([*start, "--", json.dumps(wanted)], cwd=ROOT, check=False, timeout=600)
        taken = sorted(Path(folder).glob("*.npy"))
        given.out.mkdir(parents=True, exist_ok=True)
        for drawn in taken:
            path = given.out / f"panel_{drawn.stem}.png"
            write(np.load(drawn), path)
            print(f"{path.name}: {path.stat().st_size // 1024} kB")
    return int(done.returncode != 0 or not taken)


def write(pixels: NDArray[np.uint8], path: Path) -> None:
    """Write a picture without the empty space at its foot.

    Args:
        pixels: What was drawn, shape (height, width, 4).
        path: PNG to write.
    """
    height, width = pixels.shape[:2]
    lines = pixels[:, : int(0.85 * width), :3].astype(np.int16)  # the tabs are at the right
    full = np.flatnonzero(np.ptp(lines, axis=1).max(axis=-1) > FOOT)
    last = min(int(full[-1]) + FOOT, height) if len(full) else height
    Image.fromarray(np.ascontiguousarray(pixels[:last, :, :3])).quantize(COLORS).save(path, optimize=True)


if __name__ == "__main__":
    sys.exit(main())
