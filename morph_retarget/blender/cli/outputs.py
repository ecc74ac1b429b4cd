"""Results of the command line: one file for all of them, or a file for each, by a template of its name."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ...core.errors import FileError
from .. import rig
from ..io import save
from ..io.load import Request
from .opening import armature_here


@dataclass(frozen=True)
class Outputs:
    """Where results go."""

    template: str
    """Path; ``{source}``, ``{target}`` and ``{action}`` are filled in, and give each result a file of its own."""
    source: str
    """What the results are made from, as it was asked for."""
    targets: Sequence[str]
    """What they are made for, as it was asked for."""
    report: str | None = None

    @property
    def separate(self) -> bool:
        """Whether each result gets a file of its own."""
        return any(field in self.template for field in ("{target}", "{action}", "{source}"))

    def path(self, target: str, action: str) -> Path:
        """Return the file of one result; files give their names without ending, armatures theirs."""
        names = {"{source}": short(self.source), "{action}": action, "{target}": short(target)}
        out = self.template
        for field, name in names.items():
            out = out.replace(field, "".join(c if c not in '/\\:*?"<>|' else "_" for c in name))
        return Path(out)

    def check(self) -> None:
        """Check all that can be known before anything is read.

        Raises:
            FileError: A file cannot be written, two results would get the same one, or a target is missing.
        """
        out = self.template
        save.check(self.path("target", "action"))
        if self.report:
            save.check_folder(Path(self.report))
        if len(self.targets) > 1 and out.lower().endswith(".bvh") and "{target}" not in out:
            raise FileError(f"{out}: a BVH file holds one armature: put {{target}} into its name")
        if len(self.targets) > 1 and self.separate and "{target}" not in out:
            raise FileError(f"{out}: all targets would get the same file: put {{target}} into its name")
        paths = [self.path(text, "action") for text in self.targets] if self.separate else []
        twice = [path for i, path in enumerate(paths) if path in paths[:i]]
        if twice:
            raise FileError(f"{twice[0]}: two targets would get this file: give them different names")
        for text in self.targets:
            if armature_here(text) is None:
                Request.parse(text).check()

    def write_report(self, outbox: save.Outbox, reports: Sequence[dict[str, object]]) -> None:
        """Write the report if one was asked for."""
        if self.report:
            outbox.text(Path(self.report), json.dumps(reports, indent=1, ensure_ascii=False) + "\n")


def short(text: str) -> str:
    """Return what a file or armature is called in names of results."""
    path = Request.parse(text).path
    return path.stem if path.exists() else text


def set_rate(wanted: float | None, target: str, usual: float) -> float:
    """Give the scene the frame rate asked for, or the usual one, and return its rate [1/s].

    A scene that came with the target keeps its own unless another was asked for.
    """
    render = rig.scene_of().render
    own_scene = target.lower().endswith(".blend") or armature_here(target) is not None
    rate = wanted or (None if own_scene else usual)
    if rate is not None:
        render.fps = max(round(rate), 1)
        render.fps_base = render.fps / rate
    return render.fps / render.fps_base


def set_range(first: float, last: float) -> None:
    """Give the scene a frame range."""
    scene = rig.scene_of()
    scene.frame_start = int(first)
    scene.frame_end = max(round(last), scene.frame_start)
