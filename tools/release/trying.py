"""Installing a built zip into an empty profile, and using it there: with Blender as a module, and in the program."""

import json
import os
import shlex
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from . import ReleaseError

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "sample_blends"
SECONDS = 300
_IN_MODULE = """
import sys, bpy
bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True)
from bl_ext.user_default.morph_retarget.morph_retarget.blender.cli import program
status = program.main(sys.argv[2:])
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.morph_retarget")
sys.stdout.flush()
import os
os._exit(status)  # Blender 4.5 as a module may block its end by a thread of its own
"""


def in_module(python: str, built: Path) -> None:
    """Install a zip for Blender as a module, and use it.

    Args:
        python: Of an environment that has Blender.
        built: The zip.

    Raises:
        ReleaseError: Something does not work.
    """
    with tempfile.TemporaryDirectory() as folder:
        _use([python, "-c", _IN_MODULE, str(built)], Path(folder))


def in_program(program: str, built: Path) -> None:
    """Do the same in the Blender program.

    Args:
        program: Command that starts it; it may have arguments of its own.
        built: The zip.

    Raises:
        ReleaseError: Something does not work.
    """
    start = shlex.split(program)
    with tempfile.TemporaryDirectory() as folder:
        _said([*start, "--command", "extension", "install-file", "-r", "user_default", "-e", str(built)], Path(folder))
        _use([*start, "-b", "--command", "morph_retarget"], Path(folder))


def _use(program: Sequence[str], folder: Path) -> None:
    """Ask what a rig is, and give it a clip."""
    rig, clip, out = SAMPLES / "sprout.blend", SAMPLES / "walk_and_wave.bvh", folder / "walk.glb"
    text = _said([*program, "map", str(rig), "--json"], folder)
    found = json.loads(text[text.index("{") : text.rindex("}") + 1])
    if found["joints"]["leftFoot"]["bone"] != "Foot.L":
        raise ReleaseError(f"the installed extension finds other joints: {found['joints']}")
    _said([*program, "retarget", str(clip), str(rig), "-o", str(out), "--frames", "1:30"], folder)
    if not out.exists():
        raise ReleaseError("the installed extension writes no result: run the command by hand")
    print(f"{len(found['joints'])} joints found and a clip retargeted by the installed extension")


def _said(command: Sequence[str], folder: Path) -> str:
    """Return what a program says that knows no profile but one in ``folder``."""
    own = dict(os.environ) | {"BLENDER_USER_RESOURCES": str(folder), "HOME": str(folder)}
    done = subprocess.run(command, env=own, capture_output=True, text=True, check=False, timeout=SECONDS)
    if done.returncode:
        raise ReleaseError(f"{shlex.join(command[-6:])}: failed: {(done.stderr or done.stdout).strip()[-600:]}")
    return done.stdout
