"""Clips and rigs as files, made once for all tests."""

from dataclasses import dataclass
from pathlib import Path

from morph_retarget.blender.io.save import Outbox
from tests.blender import scenes
from tools import gait
from tools.figure import Build

KINDS = ("blend", "glb", "fbx", "bvh")
LONG = 1.5 * scenes.STEP
"""Duration of the longer of two clips [s]."""


@dataclass(frozen=True)
class Files:
    """Clips and rigs as files."""

    folder: Path

    @classmethod
    def make(cls, folder: Path) -> "Files":
        """Write all files into ``folder``."""
        scenes.empty()
        ob = scenes.walker()
        scenes.bpy.context.scene.frame_end = scenes.COUNT
        with Outbox() as outbox:
            for kind in KINDS:
                outbox.rigs(folder / f"walk.{kind}", [ob])
        (folder / "walk.vrm").write_bytes((folder / "walk.glb").read_bytes())
        scenes.empty()
        both = scenes.walker("Actor", action="Stroll")
        scenes.walk(both, gait.walk(LONG, scenes.FPS), "March")
        for action in (scenes.bpy.data.actions["Stroll"], scenes.bpy.data.actions["March"]):
            action.use_fake_user = True
        scenes.save(folder / "clips.blend")
        scenes.empty()
        ob = scenes.sprout()
        scenes.save(folder / "sprout.blend")
        scenes.empty()
        tall = scenes.figure("Tall", seed=3, height=2.2, build=Build(fingers=2))
        scenes.save(folder / "tall.blend")
        with Outbox() as outbox:
            outbox.rigs(folder / "tall.glb", [tall])
        return cls(folder)

    def clip(self, kind: str = "bvh") -> Path:
        """Return the walk as a file of some kind."""
        return self.folder / f"walk.{kind}"

    @property
    def clips(self) -> Path:
        """A .blend whose armature "Actor" has the actions "Stroll" and, longer, "March", which it plays."""
        return self.folder / "clips.blend"

    @property
    def sprout(self) -> Path:
        """A .blend with a small body, big-headed, with a root bone."""
        return self.folder / "sprout.blend"

    @property
    def tall(self) -> Path:
        """A .blend with a tall body without a root bone."""
        return self.folder / "tall.blend"

    @property
    def tall_glb(self) -> Path:
        """The same as a .glb."""
        return self.folder / "tall.glb"
