"""Plays the paths of a user in the real window, one after the other, and ends Blender with what came of them.

blender --factory-startup --enable-event-simulate --python tests/window/run.py [-- NAME…]

Each path is a file with one generator `path(hand)`; wherever it yields, the window gets time to answer.
"""

import importlib
import os
import sys
import time
import traceback
from collections.abc import Iterator
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parents[2]
PATHS = ("retargeting", "following", "authoring", "baking", "saving", "languages")
PAUSE = 0.12
"""Between two steps, for the window to answer [s]."""
LIMIT = 300.0
"""Longer than this no run may take, on however slow a machine [s]."""


def _all() -> Iterator[None]:
    """Play the paths that were asked for."""
    from morph_retarget.blender import registration
    from tests.window.hand import Hand

    wanted = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else list(PATHS)
    registration.register("morph_retarget")
    yield
    for name in wanted:
        started = time.monotonic()
        bpy.ops.wm.read_homefile(use_empty=False, load_ui=False, use_factory_startup=True)
        for ob in list(bpy.data.objects):
            bpy.data.objects.remove(ob)
        yield
        yield from importlib.import_module(f"tests.window.{name}").path(Hand())
        print(f"{name}: as it should be ({time.monotonic() - started:.1f} s)", flush=True)


def _end(status: int) -> None:
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def _tick() -> float:
    """Take the next step; what a path does not find as it should be ends the run."""
    if time.monotonic() > _until:
        print(f"not done after {LIMIT:.0f} s", file=sys.stderr)
        _end(1)
    status: int | None = 1
    try:
        status = next(_steps, 0)
    finally:
        if status == 1:
            traceback.print_exc()
        if status is not None:
            _end(status)
    return PAUSE


def _draw_little() -> None:
    """Let the window draw as little as it can; without a graphics card most of the time goes there."""
    bpy.context.preferences.view.show_splash = False
    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type == "VIEW_3D":
                area.spaces.active.shading.type = "WIREFRAME"
                area.spaces.active.overlay.show_floor = False


sys.path.insert(0, str(ROOT))
_draw_little()
_until = time.monotonic() + LIMIT
_steps = _all()
bpy.app.timers.register(_tick, first_interval=1.0, persistent=True)
