"""Real files, each imported once for all tests of a run: what an importer made of it is kept as a .blend.

Importers take a second for what Blender's own files take hundredths of one.
"""

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

import bpy

from morph_retarget.blender.io import load
from morph_retarget.blender.io.load import Request
from tests.blender import scenes


@dataclass(frozen=True)
class Imported:
    """Real files, and what was imported from them."""

    folder: Path
    """Holds a .blend for each; processes may share it."""

    def open(self, path: Path) -> list[bpy.types.Object]:
        """Replace the open file with what a file holds and return its armatures."""
        kept = self.folder / f"{path.stem}_{hashlib.sha256(str(path).encode()).hexdigest()[:12]}.blend"
        if kept.exists():
            return load.load(Request(kept))
        found = load.load(Request(path))
        kept_actions = [action for action in bpy.data.actions if not action.users]
        for action in kept_actions:
            action.use_fake_user = True
        scenes.save(kept.with_suffix(f".{os.getpid()}")).replace(kept)
        for action in kept_actions:
            action.use_fake_user = False
        return found
