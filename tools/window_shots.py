"""What `tools.screenshots` runs in Blender's window: shows panels one after the other and keeps what was drawn."""

import json
import os
import sys
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import gpu
import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[np.uint8]
ROOT = Path(__file__).resolve().parent.parent
SAMPLES = ROOT / "sample_blends"
PAUSE = 0.25
"""Between two steps, for the window to draw [s]."""


@dataclass(frozen=True)
class Shot:
    """A picture of some panels."""

    file: str
    """Sample that is opened; a new file when empty."""
    prepare: Callable[[], None]
    """Sets up what is shown."""
    panels: tuple[str, ...]
    """Ends of the names of the panels that are seen."""
    headings: tuple[str, ...] = ()
    """Of those, the ones of which the heading is enough."""
    space: str = "VIEW_3D"


def _pair() -> None:
    """Bring a clip to a character, and choose both."""
    target = _armature()
    bpy.ops.import_anim.bvh(filepath=str(SAMPLES / "walk_and_wave.bvh"), update_scene_fps=True)
    own = bpy.context.scene.morph_retarget
    own.source, own.target = bpy.context.object, target
    _activate(target)


def _retargeted() -> None:
    _pair()
    bpy.ops.morph_retarget.analyze(rig=bpy.context.object.name)
    bpy.ops.morph_retarget.retarget()


def _with_contacts() -> None:
    _pair()
    bpy.ops.morph_retarget.detect_contacts()


def _annotated() -> None:
    _pair()
    _activate(bpy.context.scene.morph_retarget.source)
    bpy.ops.morph_retarget.find_annotations()


def _shown_at(frame: int, name: str = "") -> Callable[[], None]:
    def prepare() -> None:
        bpy.context.scene.frame_set(frame)
        _activate(bpy.data.objects[name] if name else _armature())

    return prepare


def _armature() -> bpy.types.Object:
    return next(ob for ob in bpy.data.objects if ob.type == "ARMATURE")


def _activate(ob: bpy.types.Object) -> None:
    for other in bpy.context.view_layer.objects:
        other.select_set(other == ob)
    bpy.context.view_layer.objects.active = ob


_BIPED = _shown_at(30, "Biped")
SHOTS: dict[str, Shot] = {
    "first": Shot("", lambda: None, ("main", "joints", "generalized")),
    "retarget": Shot("sprout", _retargeted, ("main", "joints")),
    "options": Shot("sprout", _with_contacts, ("main", "transfer", "feet", "keys"), ("main",)),
    "generalized": Shot("stage", _BIPED, ("generalized",)),
    "channel": Shot("stage", _BIPED, ("generalized", "context", "movement", "target"), ("generalized",)),
    "values": Shot("stage", _BIPED, ("generalized", "values"), ("generalized",)),
    "binding": Shot("stage", _BIPED, ("generalized", "blending", "variants", "branch"), ("generalized",)),
    "solver": Shot("stage", _BIPED, ("generalized", "solver", "solver_tuning"), ("generalized",)),
    "locomotion": Shot("gaits_hound", _shown_at(148), ("locomotion", "gait_styles", "gait_details")),
    "directing": Shot("direct_biped", _shown_at(100), ("directing", "library", "motion_tree")),
    "annotations": Shot("sprout", _annotated, ("annotations",)),
    "jiggles": Shot("stage", _BIPED, ("jiggles", "jiggle_parts")),
    "graph": Shot("stage", _BIPED, ("graph_channels", "graph_values", "graph_movement"), space="GRAPH_EDITOR"),
}
_shown: set[str] = set()
_headings: set[str] = set()


def _prepare() -> None:
    """Register the extension so that all its panels are open, and seen only when a picture asks for them."""
    from morph_retarget.blender import registration

    for cls in registration.CLASSES:
        if issubclass(cls, bpy.types.Panel):
            cls.bl_options = getattr(cls, "bl_options", set()) - {"DEFAULT_CLOSED"}
            cls.poll = classmethod(_poll_of(cls))
            cls.draw = _draw_of(cls)
    registration.register("morph_retarget")


def _draw_of(cls: Any) -> Callable[..., None]:
    name, before = cls.__name__.partition("_PT_")[2], cls.draw

    def draw(panel: bpy.types.Panel, context: bpy.types.Context) -> None:
        if name not in _headings:
            before(panel, context)

    return draw


def _poll_of(cls: Any) -> Callable[..., bool]:
    name, before = cls.__name__.partition("_PT_")[2], getattr(cls, "poll", None)

    def poll(_: Any, context: bpy.types.Context) -> bool:
        return name in _shown and (before is None or before(context))

    return poll


def _take(name: str, shot: Shot, out: Path) -> Iterator[None]:
    """Show what a picture shows, let the window draw it, and keep the sidebar as it was drawn."""
    _shown.clear()
    _headings.clear()
    if shot.file:
        bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / f"{shot.file}.blend"), load_ui=False)
    else:
        bpy.ops.wm.read_homefile(load_ui=False, use_factory_startup=True)
    yield
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window):
        shot.prepare()
    yield
    area = max((a for a in window.screen.areas if a.type == "VIEW_3D"), key=lambda a: a.width * a.height)
    area.type = shot.space
    area.spaces.active.show_region_ui = True
    _shown.update(shot.panels)
    _headings.update(shot.headings)
    yield
    region = next(region for region in area.regions if region.type == "UI")
    region.active_panel_category = "Morph Retarget"
    region.tag_redraw()
    yield
    space, seen = type(area.spaces.active), list[Pixels]()
    handle = space.draw_handler_add(lambda: seen.append(_read(bpy.context.region)), (), "UI", "POST_PIXEL")
    while not seen:
        region.tag_redraw()
        yield
    space.draw_handler_remove(handle, "UI")
    np.save(out / f"{name}.npy", seen[-1])
    area.type = "VIEW_3D"
    yield


def _read(region: bpy.types.Region) -> Pixels:
    """Return what has been drawn of a region, from its top, shape (height, width, 4)."""
    size = (region.width, region.height)
    buffer = gpu.state.active_framebuffer_get().read_color(0, 0, *size, 4, 0, "UBYTE")
    buffer.dimensions = size[0] * size[1] * 4
    return np.array(buffer, dtype=np.uint8).reshape(size[1], size[0], 4)[::-1]


def _all(wanted: dict[str, Any]) -> Iterator[None]:
    preferences = bpy.context.preferences
    preferences.view.show_splash = False
    preferences.system.use_region_overlap = False  # the sidebar alone, without the scene behind it
    if wanted["light"]:
        light = next(Path(bpy.utils.resource_path("SYSTEM")).glob("scripts/presets/interface_theme/*[Ll]ight.xml"))
        bpy.ops.script.execute_preset(filepath=str(light), menu_idname="USERPREF_MT_interface_theme_presets")
    _prepare()
    yield
    if wanted["language"] != "en_US":
        preferences.view.language = wanted["language"]
        preferences.view.use_translate_interface = True
    for name in wanted["names"] or SHOTS:
        yield from _take(name, SHOTS[name], Path(wanted["out"]))


def _tick() -> float:
    status: int | None = 1
    try:
        status = next(_steps, 0)
    finally:
        if status == 1:
            traceback.print_exc()
        if status is not None:
            sys.stdout.flush()
            os._exit(status)
    return PAUSE


sys.path.insert(0, str(ROOT))
_steps = _all(json.loads(sys.argv[-1]))
bpy.app.timers.register(_tick, first_interval=1.0, persistent=True)
